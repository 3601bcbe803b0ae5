//! Passes the cycle's parts of a view to the screens through a channel, so that no screen delays the cycle.

use machine::view::{AlarmLine, LatenessView, Machine, View};
use tokio::sync::{mpsc, watch};
use units::Span;

/// Largest number of snapshots that wait in the channel; the cycle drops further ones.
const WAITING: usize = 16;
/// Shortest rig time between two snapshots.
const EVERY: Span = Span::ms(50);
/// Shortest wall time between two snapshots of a simulated rig that runs faster than the clock: a person sees no more.
const SEEN_S: f64 = 0.01;

/// Parts of a [`View`] that the cycle knows.
#[derive(Debug)]
pub struct Snapshot {
    pub(super) at_us: i64,
    pub(super) state: String,
    pub(super) doing: String,
    pub(super) stage: Option<&'static str>,
    pub(super) inside: u64,
    /// Numbers of parts that came in and that went out; `None` between lots, so that the screen keeps those of the last
    /// lot.
    pub(super) counts: Option<(u64, u64)>,
    pub(super) alarms: Vec<AlarmLine>,
    pub(super) machine: Machine,
    pub(super) lateness: LatenessView,
}

impl Snapshot {
    fn show(self, view: &mut View) {
        view.at_us = self.at_us;
        view.state = self.state;
        view.doing = self.doing;
        view.stage = self.stage;
        view.inside = self.inside;
        if let Some((came_in, went_out)) = self.counts {
            view.came_in = came_in;
            view.went_out = went_out;
        }
        view.alarms = self.alarms;
        view.machine = self.machine;
        view.host.lateness = self.lateness;
    }
}

/// The cycle's end of the channel to the screens.
#[derive(Debug, Clone)]
pub struct Snapshots {
    pub(super) channel: mpsc::Sender<Snapshot>,
    /// Shortest rig time between two snapshots.
    pub(super) every: Span,
}

/// Returns the cycle's end of the channel, `None` without a screen, and a future that puts each snapshot into `view`
/// until the cycle drops its end. `speed` is that of the rig in multiples of the wall clock, `None` where no clock holds
/// it.
pub fn snapshots(
    view: watch::Sender<View>,
    speed: Option<f64>,
) -> (Option<Snapshots>, impl Future<Output = ()>) {
    let (channel, mut receiver) = mpsc::channel::<Snapshot>(WAITING);
    let every = EVERY.max(Span::seconds(SEEN_S * speed.unwrap_or(1.0)));
    let snapshots = Snapshots { channel, every };
    let is_seen = view.receiver_count() > 0;
    let showing = async move {
        while let Some(snapshot) = receiver.recv().await {
            view.send_modify(|view| snapshot.show(view));
        }
    };
    (is_seen.then_some(snapshots), showing)
}
