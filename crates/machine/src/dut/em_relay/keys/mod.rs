//! Keys that only a relay and its board bring to the files of `config/`.

pub mod board;
pub mod golden;
pub mod recipe;
