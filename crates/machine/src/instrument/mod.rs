//! Instruments as a procedure uses them: acts, their runner, queries of SCPI instruments, readings, and the trace of
//! all samples, as recorded and as stored.

pub mod act;
pub mod conversion;
pub mod curve;
pub mod query;
pub mod readings;
pub mod trace;
