//! Instruments as a procedure uses them: acts, their runner, their readings, and the trace of all samples, as recorded
//! and as stored.

pub mod act;
pub mod curve;
pub mod readings;
pub mod trace;
