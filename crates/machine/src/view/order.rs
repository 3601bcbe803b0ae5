//! An order as a page or a script sends it, and the known order words.

use serde::{Deserialize, Serialize};

/// Words of the orders that the station executes.
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

/// Words of orders about lots and wear counters, which never move the rig.
pub const LOT_ORDERS: [&str; 5] = [
    "hold_lot",
    "release_lot",
    "close_lot",
    "reopen_lot",
    "replaced",
];

/// An order; the station ignores members that its word does not need.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Order {
    /// One of [`ORDERS`] or [`LOT_ORDERS`].
    pub order: String,
    /// For `mode`: `production`, `maintenance`, `manual`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<String>,
    /// For `jog`: name of the motion, for example `pusher_extend`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<String>,
    /// For `acknowledge` (all alarms if absent) and `shelve`: code of the alarm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alarm: Option<String>,
    /// For `shelve`: minutes, 1 to 480; 30 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minutes: Option<u32>,
    /// For `shelve`, `hold_lot` and `reopen_lot`: the reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// For `start` (continues the open lot if absent), `hold_lot`, `release_lot`, `close_lot`,
    /// `reopen_lot`: name of the lot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lot: Option<String>,
    /// For `start` with a lot: name of the recipe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recipe: Option<String>,
    /// For `start` with a lot: parts wanted; endless if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u64>,
    /// For `start` with a lot: name of the person who agreed to test parts a second time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub retest: Option<String>,
    /// For `replaced`: name of the counter to reset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counter: Option<String>,
}

/// Person who gives an order, and the network address from which it comes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct By {
    /// Name at login.
    pub who: String,
    /// Role at login.
    pub role: String,
    /// Network address of the browser or script.
    pub origin: String,
}

/// An order with its outcome, for the audit trail.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AnsweredOrder {
    /// The order.
    pub order: Order,
    /// The person who gave the order.
    pub by: By,
    /// Reason for the refusal, English; `None` for an accepted order.
    pub refused: Option<String>,
}
