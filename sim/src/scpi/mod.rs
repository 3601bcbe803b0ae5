//! The simulated side of SCPI: instruments with their errors, and the links by which a host reaches them.
//!
//! | module | content, in reading order |
//! |---|---|
//! | [`message`], [`status`] | program messages, headers, numbers, blocks; registers and error queue |
//! | [`circuit`], [`mod@line`], [`sources`] | terminals with what instruments connect to them |
//! | [`passive`], [`relay`] | what the instruments measure |
//! | [`instrument`] | the instruments |
//! | [`device`] | an instrument behind its message queue |
//! | [`adapter`], [`port`] | GPIB adapter; bytes in and out of a link, with its faults |
//! | [`mod@bench`], [`mod@file`] | instruments and circuit together, from a file |
//! | [`of_rig`] | instruments of a rig, from its files |
//! | [`serve`] | sockets and pseudo-terminals in real time, streams in virtual time |

pub mod adapter;
pub mod bench;
pub mod circuit;
pub mod device;
pub mod file;
pub mod instrument;
pub mod line;
pub mod message;
pub mod of_rig;
pub mod passive;
pub mod port;
pub mod relay;
pub mod serve;
pub mod sources;
pub mod status;
#[cfg(test)]
mod tests;
