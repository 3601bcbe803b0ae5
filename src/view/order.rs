//! An order in words, as it comes from a screen or a script, and the words that are known.

use serde::{Deserialize, Serialize};

/// Every word that an order may have.
pub const ORDERS: [&str; 16] = [
    "reset",
    "start",
    "stop",
    "hold",
    "unhold",
    "suspend",
    "unsuspend",
    "abort",
    "clear",
    "complete",
    "mode",
    "jog",
    "step",
    "lamp_test",
    "acknowledge",
    "shelve",
];

/// An order; members that its word does not need are let pass.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
pub struct Order {
    /// One of [`ORDERS`].
    pub order: String,
    /// Of `mode`: `production`, `maintenance`, `manual`.
    #[serde(default)]
    pub mode: Option<String>,
    /// Of `jog`: `pusher_extend`, ...
    #[serde(default)]
    pub motion: Option<String>,
    /// Of `acknowledge` (without it: all) and `shelve`: code of the alarm.
    #[serde(default)]
    pub alarm: Option<String>,
    /// Of `shelve`, 1 to 480; 30 without it.
    #[serde(default)]
    pub minutes: Option<u32>,
}

/// Why an order was not taken.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NotTaken {
    /// English.
    pub en: String,
    /// Chinese.
    pub zh: String,
}
