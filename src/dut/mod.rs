//! Devices under test: what a part is, how it is measured and judged.
//!
//! A kind of device is one folder. The rest of the program knows [`Recipe`], [`Verdict`] and [`Judgement`], never a kind.

pub mod em_relay;
pub mod recipe;
pub mod verdict;

pub use recipe::Recipe;
pub use verdict::{Bin, Judgement, Verdict};
