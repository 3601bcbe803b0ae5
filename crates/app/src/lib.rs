//! What the program does with the machine: one turn of the rig, a lot, a day of service, a story.
//!
//! - [`cycle`]: scans, steps, clears, applies, records, publishes.

pub mod cycle;
