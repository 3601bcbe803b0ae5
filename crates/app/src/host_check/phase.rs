//! One phase of the test: waits of one millisecond on the rig's timer.

use super::cpu_time::CpuTime;
use crate::real_time::INTERVAL;
use bus::{Pace, Timer};
use cycle::Lateness;
use machine::view::LatenessView;
use serde::Serialize;
use units::Span;

/// A phase of the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// With the usual programs of this computer.
    AsItIs,
    /// With the load of the test in addition.
    Loaded,
}

impl Phase {
    /// Both phases in the order of the test.
    pub const ALL: [Self; 2] = [Self::AsItIs, Self::Loaded];

    /// Returns the name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::AsItIs => "as it is",
            Self::Loaded => "under load",
        }
    }
}

/// Result of a phase.
#[derive(Debug, Clone, Serialize)]
pub struct PhaseResult {
    /// Phase that was measured.
    pub phase: Phase,
    /// How late the waits of the phase ended.
    pub lateness: LatenessView,
    /// Time of all CPUs during the phase.
    #[serde(flatten)]
    pub cpu_time: CpuTime,
}

/// Repeats waits of [`INTERVAL`] for `span` and returns how late they ended. Runs on the rig's thread.
pub(super) async fn measure(span: Span) -> Lateness {
    let pace = Pace::real();
    let timer = Timer::new(pace);
    let mut lateness = Lateness::default();
    let (mut next, end) = (pace.now() + INTERVAL, pace.now() + span);
    while next < end {
        timer.until(next).await;
        let now = pace.now();
        lateness.count(next, now);
        next = next.max(now) + INTERVAL;
    }
    lateness
}
