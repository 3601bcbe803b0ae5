//! Where the orders of a run come in.

use machine::view::OrderRequest;
use tokio::sync::mpsc;

/// Orders on their way to the cycle of a run.
#[derive(Debug)]
pub struct OrderQueue {
    pub(super) orders: mpsc::Receiver<OrderRequest>,
    /// Kept, so that the cycle does not take a silent queue for a closed one.
    _nobody: Option<mpsc::Sender<OrderRequest>>,
}

impl OrderQueue {
    /// Nobody orders anything: an unattended station resets and starts by itself.
    pub fn nobody() -> Self {
        let (given, orders) = mpsc::channel(1);
        Self {
            orders,
            _nobody: Some(given),
        }
    }
}

impl From<mpsc::Receiver<OrderRequest>> for OrderQueue {
    fn from(orders: mpsc::Receiver<OrderRequest>) -> Self {
        Self {
            orders,
            _nobody: None,
        }
    }
}
