//! Instruments as the procedure of a test uses them: acts, the runner that carries them out, their readings, and the
//! trace of all samples, as recorded and as stored.

pub mod act;
pub mod curve;
pub mod readings;
pub mod trace;
