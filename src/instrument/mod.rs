//! Instruments as a procedure uses them: acts, their runner, and the trace of what was seen.

pub mod act;
pub mod trace;
