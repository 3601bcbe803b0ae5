//! Every key that may stand in the files of `config/`, file by file.

pub mod card;
pub mod golden;
pub mod lot;
pub mod recipe;
pub mod rig;
