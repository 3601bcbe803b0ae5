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

/// Words of orders about lots and what wears, which do not move the rig by themselves.
pub const LOT_ORDERS: [&str; 4] = ["hold_lot", "release_lot", "close_lot", "replaced"];

/// An order; members that its word does not need are let pass.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Order {
    /// One of [`ORDERS`] or [`LOT_ORDERS`].
    pub order: String,
    /// Of `mode`: `production`, `maintenance`, `manual`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<String>,
    /// Of `jog`: `pusher_extend`, ...
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<String>,
    /// Of `acknowledge` (without it: all) and `shelve`: code of the alarm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alarm: Option<String>,
    /// Of `shelve`, 1 to 480; 30 without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minutes: Option<u32>,
    /// Of `shelve` and `hold_lot`: why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Of `start` (without it: the lot under way goes on), `hold_lot`, `release_lot`, `close_lot`: name of the lot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lot: Option<String>,
    /// Of `start` with a lot: name of the recipe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recipe: Option<String>,
    /// Of `start` with a lot: parts wanted; without it the lot goes on until it is ended.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u64>,
    /// Of `start` with a lot: parts are tested again, to which this person has agreed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub retest: Option<String>,
    /// Of `replaced`: name of the counter that begins anew.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counter: Option<String>,
}

/// Who orders, and from where.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct By {
    /// Name at login.
    pub who: String,
    /// Role at login.
    pub role: String,
    /// Address of the screen.
    pub origin: String,
}

/// An order with its answer, for the audit.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Answered {
    /// What was ordered.
    pub order: Order,
    /// Who ordered it.
    pub by: By,
    /// Why it was refused, English; none when it was taken.
    pub refused: Option<String>,
}
