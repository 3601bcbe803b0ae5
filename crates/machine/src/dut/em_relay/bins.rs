//! Bins of a failed relay, one per correctable cause.

use crate::rig::bin::Bin;

/// Coil resistance out of limits.
pub const COIL: Bin = Bin::named("coil");
/// Contact resistance out of limits, or a stuck contact.
pub const CONTACT: Bin = Bin::named("contact");
/// Operate or release voltage out of limits.
pub const VOLTAGE: Bin = Bin::named("voltage");
/// Times or bounce out of limits.
pub const TIME: Bin = Bin::named("time");

/// All bins, worst first: a relay with several causes goes to the first of them.
pub const BY_RANK: [Bin; 4] = [COIL, CONTACT, VOLTAGE, TIME];
