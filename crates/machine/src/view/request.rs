//! An order on its way to the station, with the channel for its answer.

use super::order::{By, Order};
use std::fmt;
use texts::Message;

/// Outcome of an order: done, perhaps with a remark, or refused with the reason.
pub type Answer = Result<Option<Message>, Message>;

/// An order on its way to the station.
pub struct OrderRequest {
    /// The order.
    pub order: Order,
    /// The person who gives the order.
    pub by: By,
    /// Refusal by the program before the order reaches the station; the request then serves the audit trail only.
    pub denied: Option<Message>,
    way_back: Box<dyn FnOnce(Answer) + Send>,
}

impl OrderRequest {
    /// Makes a request that sends its answer to `way_back`. A dropped request sends no answer.
    pub fn new(order: Order, by: By, way_back: impl FnOnce(Answer) + Send + 'static) -> Self {
        Self {
            order,
            by,
            denied: None,
            way_back: Box::new(way_back),
        }
    }

    /// Makes a request that is already refused and serves the audit trail only; it sends no answer.
    pub fn denied(order: Order, by: By, why: Message) -> Self {
        Self {
            denied: Some(why),
            ..Self::new(order, by, drop)
        }
    }

    /// Sends the answer; does nothing after the page has disconnected.
    pub fn answer(self, answer: Answer) {
        (self.way_back)(answer);
    }
}

impl fmt::Debug for OrderRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OrderRequest")
            .field("order", &self.order)
            .field("by", &self.by)
            .field("denied", &self.denied)
            .finish_non_exhaustive()
    }
}
