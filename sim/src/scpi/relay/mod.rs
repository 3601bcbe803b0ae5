//! Solid-state relays with their true values: input, light threshold, MOSFET or triac output, leakage, heat, defects.

mod heat;
mod input;
mod light;
mod output;
mod truth;

pub use heat::{CASE_K_PER_W, CASE_S, Heat, JUNCTION_S};
pub use light::Light;
pub use output::SolidState;
pub use truth::{Defect, Kind, Truth};
