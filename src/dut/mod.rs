//! Devices under test: what a part is, how it is measured and judged.
//!
//! A kind of device is one folder. The rest of the program knows [`Recipe`], [`Verdict`] and [`Judgement`], never a kind.

pub mod em_relay;
pub mod recipe;
pub mod verdict;

use crate::rig::point::Fixture;

/// The points that each kind declares.
pub const FIXTURES: &[Fixture] = &[em_relay::points::FIXTURE];

pub use recipe::Recipe;
pub use verdict::{Bin, Judgement, Verdict};
