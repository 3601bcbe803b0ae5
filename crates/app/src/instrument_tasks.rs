//! Starts the tasks of the instruments of a run.

use bus::Pace;
use bus::instrument::{Link, Opener, serve};
use cycle::InstrumentEnds;
use machine::instrument::query::Instrument;
use machine::rig::wiring::Wiring;
use scpi::LinkAddress;
use tokio::runtime::Handle;
use tokio::sync::mpsc;

/// What the tasks of all instruments of a run share.
pub(super) struct InstrumentTasks<'a> {
    /// Runs the tasks.
    pub handle: &'a Handle,
    /// Profiles and links.
    pub wiring: &'a Wiring,
    /// Clock of the rig.
    pub pace: &'a Pace,
    /// Number that differs from run to run; the links prove with it that replies belong to their queries.
    pub seed: u64,
}

impl InstrumentTasks<'_> {
    /// Starts a task for each instrument, at the link of `rig.toml` or the one that `other` returns for its name.
    pub fn open_all(&self, other: impl Fn(&str) -> Option<LinkAddress>) -> Vec<InstrumentEnds> {
        let instruments = self.wiring.instrument_ids();
        let at = |instrument| {
            let wired = self.wiring.instrument(instrument);
            let address = other(&wired.name).unwrap_or_else(|| wired.link.clone());
            let opener = Opener::At(address.clone(), wired.profile.flow);
            self.open(instrument, &address, opener)
        };
        instruments.map(at).collect()
    }

    /// Starts the task of an instrument; `opener` opens its stream, again after every doubt. `address` says what stands
    /// between the stream and the instrument.
    pub fn open(
        &self,
        instrument: Instrument,
        address: &LinkAddress,
        opener: Opener,
    ) -> InstrumentEnds {
        let profile = &self.wiring.instrument(instrument).profile;
        let seed = self.seed.wrapping_add(instrument.index() as u64);
        let link = Link::new(opener, profile.link_settings(address), *self.pace, seed);
        let (requests, requested) = mpsc::channel(1);
        let (answer, answers) = mpsc::channel(1);
        self.handle
            .spawn(serve(link, *self.pace, requested, answer));
        InstrumentEnds {
            instrument,
            requests,
            answers,
        }
    }
}
