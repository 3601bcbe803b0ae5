//! Keys of the files in `config/` that only relays and their board need.

pub mod board;
pub mod recipe;
pub mod reference_part;
