//! Keys of the files of `config/`, file by file.

/// Keys of a table, one a row: name, form, the part of the program that reads it, meaning.
macro_rules! keys {
    ($($row:expr;)*) => { &[$($row),*] };
}

pub mod card;
pub mod golden;
pub mod lot;
pub mod recipe;
pub mod rig;
