//! Starts the tasks of the instruments of a run, and waits for their end.

use super::instrument_log::InstrumentLog;
use super::real_time::Keeper;
use bus::Pace;
use bus::instrument::{Link, Opener, serve};
use cycle::InstrumentEnds;
use machine::instrument::query::Instrument;
use machine::rig::wiring::Wiring;
use scpi::{Failure, LinkAddress};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;

/// What the tasks of all instruments of a run share.
pub(super) struct InstrumentTasks<'a> {
    /// Spawns the tasks; the thread of the rig waits for their end.
    pub keeper: &'a Keeper,
    /// Profiles and links.
    pub wiring: &'a Wiring,
    /// Clock of the rig.
    pub pace: &'a Pace,
    /// Number that differs from run to run; with this number a link proves that a reply belongs to its query.
    pub seed: u64,
}

/// A running task, which makes its instrument safe once the cycle has dropped the ends of the task's queues.
pub struct InstrumentTask {
    name: String,
    /// Traffic and health.
    pub log: InstrumentLog,
    task: JoinHandle<Result<(), Failure>>,
}

impl InstrumentTask {
    /// Waits until the task has ended; logs an instrument whose output may still be on.
    pub async fn end(self) {
        let name = &self.name;
        match self.task.await {
            Ok(Ok(())) => {}
            Ok(Err(failure)) => {
                let why = bus::instrument::message(&failure).say(texts::Lang::En);
                tracing::error!("{name} may still be on: {why}");
            }
            Err(_) => tracing::error!("{name} may still be on: an assertion of its task failed"),
        }
    }
}

impl InstrumentTasks<'_> {
    /// Starts a task for each instrument, at the link that `other` returns for its name, or else that of `rig.toml`.
    pub fn open_all(
        &self,
        other: impl Fn(&str) -> Option<LinkAddress>,
    ) -> Vec<(InstrumentEnds, InstrumentTask)> {
        let instruments = self.wiring.instrument_ids();
        let at = |instrument| {
            let wired = self.wiring.instrument(instrument);
            let address = other(&wired.name).unwrap_or_else(|| wired.link.clone());
            let opener = Opener::At(address.clone(), wired.profile.flow);
            self.open(instrument, &address, opener)
        };
        instruments.map(at).collect()
    }

    /// Starts the task of an instrument; `opener` opens the stream, and again whenever a reply is in doubt. `address`
    /// says whether a serial port or a GPIB adapter lies on the way to the instrument.
    pub fn open(
        &self,
        instrument: Instrument,
        address: &LinkAddress,
        opener: Opener,
    ) -> (InstrumentEnds, InstrumentTask) {
        let wired = self.wiring.instrument(instrument);
        let profile = &wired.profile;
        let seed = self.seed.wrapping_add(instrument.index() as u64);
        let link = Link::new(opener, profile.link_settings(address), *self.pace, seed);
        let log = InstrumentLog {
            name: wired.name.clone(),
            profile: profile.name.clone(),
            link: address.to_string(),
            log: link.log(),
        };
        let (requests, requested) = mpsc::channel(1);
        let (answer, answers) = mpsc::channel(1);
        let serving = serve(link, *self.pace, requested, answer, profile.safe());
        let task = InstrumentTask {
            name: wired.name.clone(),
            log,
            task: self.keeper.spawn(serving),
        };
        let ends = InstrumentEnds {
            instrument,
            requests,
            answers,
        };
        (ends, task)
    }
}
