//! Who gives orders during a run.

use super::lines::Behind;
#[cfg(feature = "sim")]
use crate::cli::story::Play;
use app::cycle::Event;
use bus::Pace;
use machine::view::OrderRequest;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;

/// Who gives orders.
#[derive(Debug)]
pub enum Orders {
    /// Nobody: the station resets and starts by itself.
    Nobody,
    /// Whoever is at a screen.
    Screens(mpsc::Receiver<OrderRequest>),
    /// A script, which also meddles with the simulated rig and tells what it saw.
    #[cfg(feature = "sim")]
    Script(Play),
}

/// Where orders come in, and who looks on.
pub struct Desk {
    /// Orders for the cycle.
    pub orders: mpsc::Receiver<OrderRequest>,
    /// Hears every event of the run.
    pub onlooker: Option<mpsc::UnboundedSender<Event>>,
    /// A script under way; it gives the exit status.
    pub playing: Option<JoinHandle<i32>>,
    /// Kept, so that the cycle does not take a silent desk for a closed one.
    _nobody: Option<mpsc::Sender<OrderRequest>>,
}

impl Desk {
    /// The desk of a run; a script begins to play. Inside of a runtime.
    ///
    /// # Errors
    /// A script without a simulated rig.
    pub fn open(
        orders: Orders,
        rig: &Behind,
        pace: Pace,
        stop: &Arc<AtomicBool>,
    ) -> anyhow::Result<Self> {
        let (given, taken) = mpsc::channel(1);
        let desk = |orders| Self {
            orders,
            onlooker: None,
            playing: None,
            _nobody: None,
        };
        Ok(match orders {
            Orders::Nobody => Self {
                _nobody: Some(given),
                ..desk(taken)
            },
            Orders::Screens(screens) => desk(screens),
            #[cfg(feature = "sim")]
            Orders::Script(play) => {
                let Some(rig) = rig.rig() else {
                    anyhow::bail!("a script plays on the simulated rig only");
                };
                let (onlooker, seen) = mpsc::unbounded_channel();
                let playing = tokio::spawn(play.run(seen, given, rig, pace, Arc::clone(stop)));
                Self {
                    onlooker: Some(onlooker),
                    playing: Some(playing),
                    ..desk(taken)
                }
            }
        })
    }
}
