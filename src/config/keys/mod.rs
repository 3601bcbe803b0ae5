//! Every key that may stand in the files of `config/`, file by file.

pub mod card;
pub mod golden;
pub mod recipe;
pub mod rig;
