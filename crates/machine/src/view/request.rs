//! An order on its way to the station, with the way back for its answer.

use super::order::{By, Order};
use std::fmt;
use texts::Message;

/// What an order comes to.
pub type Answer = Result<(), Message>;

/// An order on its way to the station.
pub struct OrderRequest {
    /// What is wanted.
    pub order: Order,
    /// Who wants it.
    pub by: By,
    /// It is not to be taken, for this reason; it comes for the audit alone.
    pub denied: Option<String>,
    way_back: Box<dyn FnOnce(Answer) + Send>,
}

impl OrderRequest {
    /// An order whose answer goes to `way_back`. A request that is dropped drops it unanswered.
    pub fn new(order: Order, by: By, way_back: impl FnOnce(Answer) + Send + 'static) -> Self {
        Self {
            order,
            by,
            denied: None,
            way_back: Box::new(way_back),
        }
    }

    /// An order that is not to be taken and comes for the audit alone; nobody waits for its answer.
    pub fn denied(order: Order, by: By, why: String) -> Self {
        Self {
            denied: Some(why),
            ..Self::new(order, by, drop)
        }
    }

    /// Answers; a screen that has gone away misses nothing that it could use.
    pub fn say(self, answer: Answer) {
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
