//! Instruments as a procedure uses them: acts, their runner, what they have read, the trace of what was seen, and its
//! curves as kept.

pub mod act;
pub mod curve;
pub mod readings;
pub mod trace;
