//! Keys of the files in `config/` that only relays and their board need.

pub mod board;
pub mod golden;
pub mod recipe;
