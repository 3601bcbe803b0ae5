//! The channel that brings orders to the cycle of a run.

use machine::view::OrderRequest;
use tokio::sync::mpsc;

/// Orders for the cycle of a run.
#[derive(Debug)]
pub struct OrderQueue {
    pub(super) orders: mpsc::Receiver<OrderRequest>,
    /// Keeps the channel open, because the cycle stops reading orders from a closed channel.
    _sender: Option<mpsc::Sender<OrderRequest>>,
}

impl OrderQueue {
    /// Returns a queue that stays open and never delivers an order, for an unattended station, which resets and starts
    /// by itself.
    pub fn without_orders() -> Self {
        let (given, orders) = mpsc::channel(1);
        Self {
            orders,
            _sender: Some(given),
        }
    }
}

impl From<mpsc::Receiver<OrderRequest>> for OrderQueue {
    fn from(orders: mpsc::Receiver<OrderRequest>) -> Self {
        Self {
            orders,
            _sender: None,
        }
    }
}
