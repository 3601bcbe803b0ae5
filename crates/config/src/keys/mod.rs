//! Keys of the configuration files, one module per file.

/// Makes the keys of a table, one per row: name, form, which part of the program reads it, meaning.
macro_rules! keys {
    ($($row:expr;)*) => { &[$($row),*] };
}

pub mod card;
pub mod fleet;
pub mod golden;
pub mod instrument;
pub mod lot;
pub mod recipe;
pub mod rig;
