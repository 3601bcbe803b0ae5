//! Instruments as a procedure uses them: acts, their runner, what they have read, and the trace of what was seen.

pub mod act;
pub mod readings;
pub mod trace;
