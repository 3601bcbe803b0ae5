//! Solid-state relays with their true values: input, light threshold, MOSFET or triac output, leakage, heat, defects.

mod output;
mod truth;

pub use output::SolidState;
pub use truth::{Defect, Kind, Truth};
