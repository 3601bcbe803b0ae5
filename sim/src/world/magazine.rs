//! The magazine track and every part that has left it. It may be emptied and filled anew while the rig runs.

use super::draw::{Draw, Subject};
use super::specimen::{Arrival, Lot, Specimen};
use super::table::WorldTable;
use super::{
    WorldOptions,
    fault::{Fault, WorldFaults},
};
use crate::config::ConfigError;
use crate::truth::{BodyTruth, PartTruth, Place};

/// The pin that [`Fault::ProbeDirty`] takes: NO.
const DIRTY_PIN: usize = 3;

/// A part outside the magazine.
#[derive(Debug, Clone)]
pub struct Part {
    /// What the probes find; it keeps its history.
    pub specimen: Specimen,
    /// Order of entering the nest, from 1; 0 before, and for golden parts always.
    pub seq: u64,
    /// Place in the lot from 1, none for golden parts: what `--fault` counts by.
    pub number: Option<u64>,
    /// A second body clings to it.
    pub double: bool,
    /// Where it has been, and since when, microseconds.
    pub path: Vec<(u64, Place)>,
}

impl Part {
    /// What this part was.
    pub fn truth(&self) -> PartTruth {
        PartTruth {
            seq: self.seq,
            landed_in: match self.path.last() {
                Some((_, Place::Bin(bin))) => Some(bin.clone()),
                _ => None,
            },
            ..self.specimen.truth()
        }
    }

    /// The same with its way, and the body that clings to it.
    pub fn bodies(&self) -> impl Iterator<Item = BodyTruth> {
        let own = BodyTruth {
            golden: self.number.is_none(),
            clung: false,
            path: self.path.clone(),
            part: self.truth(),
        };
        let second = self.double.then(|| BodyTruth {
            clung: true,
            part: PartTruth {
                landed_in: own.part.landed_in.clone(),
                ..PartTruth::default()
            },
            ..own.clone()
        });
        std::iter::once(own).chain(second)
    }

    /// It comes to a place.
    pub fn goes(&mut self, now_us: u64, place: Place) {
        self.path.push((now_us, place));
    }
}

/// Parts in the order in which they leave: golden ones first.
#[derive(Debug, Clone)]
pub struct Magazine {
    lot: Lot,
    seed: u64,
    /// Lot parts that lie in it, none for no end.
    parts: Option<u64>,
    /// Lot parts between two golden ones, once the lot has begun.
    golden_every: Option<u64>,
    /// Golden and lot parts that have left.
    out: (u64, u64),
    /// How many of each had left when the magazine was filled.
    filled_at: (u64, u64),
    track_c: f64,
    ambient_c: f64,
}

impl Magazine {
    /// A full magazine; temperatures are those of the track and of the air.
    ///
    /// # Errors
    /// The recipe or the certificates cannot be read.
    pub fn load(
        options: &WorldOptions,
        world: &WorldTable,
        faults: &WorldFaults,
        track_c: f64,
        ambient_c: f64,
    ) -> Result<Self, ConfigError> {
        Ok(Self {
            lot: Lot::read(options, world)?,
            seed: options.seed,
            parts: options.parts,
            golden_every: faults
                .values(Fault::GoldenEvery)
                .next()
                .map(|it| it.max(1.0) as u64),
            out: (0, 0),
            filled_at: (0, 0),
            track_c,
            ambient_c,
        })
    }

    /// The same after another one was emptied: parts are counted on, so that none of them comes twice.
    pub fn in_place_of(mut self, before: &Self) -> Self {
        (self.out, self.filled_at) = (before.out, before.out);
        self
    }

    /// Golden and lot parts that have left since it was filled.
    fn since_filled(&self) -> (u64, u64) {
        (self.out.0 - self.filled_at.0, self.out.1 - self.filled_at.1)
    }

    /// Parts that still wait, `u64::MAX` for an endless lot.
    pub fn waiting(&self) -> u64 {
        let out = self.since_filled();
        let ahead = self.lot.golden().saturating_sub(out.0);
        let lot = |parts: u64| ahead + parts.saturating_sub(out.1);
        self.parts.map_or(u64::MAX, lot)
    }

    /// Place in the lot (from 1) of the part that leaves next; none when it is a golden one.
    pub fn next_number(&self) -> Option<u64> {
        (self.since_filled().0 >= self.golden_due()).then_some(self.out.1 + 1)
    }

    /// Golden parts that belong before the next lot part.
    fn golden_due(&self) -> u64 {
        let lot = self.since_filled().1;
        let again = self.golden_every.map_or(0, |every| lot / every);
        match self.lot.golden() {
            0 => 0,
            first => first + again,
        }
    }

    /// The next part leaves; `None` from an empty track.
    pub fn take(&mut self, now_us: u64, faults: &mut WorldFaults) -> Option<Part> {
        if self.waiting() == 0 {
            return None;
        }
        let number = self.next_number();
        let specimen = match number {
            Some(n) => self.lot_part(n - 1, now_us, faults),
            None => self.golden_part(self.out.0, now_us, faults)?,
        };
        match number {
            Some(_) => self.out.1 += 1,
            None => self.out.0 += 1,
        }
        Some(Part {
            specimen,
            seq: 0,
            number,
            double: faults.strikes(Fault::DoublePart, number),
            path: vec![(now_us, Place::Pocket)],
        })
    }

    /// A part that is fed again is the same body, and operates anew.
    fn lot_part(&self, index: u64, now_us: u64, faults: &mut WorldFaults) -> Specimen {
        let asked = |fault| faults.values(fault).next().map(|it| it as u64);
        let seed = asked(Fault::PartsSeed).unwrap_or(self.seed);
        let noise = faults.noise_seed().unwrap_or(self.seed);
        let body = asked(Fault::Refeed).map_or(index, |parts| index % parts.max(1));
        let draw = Draw::new(noise, Subject::LotOperations, index);
        let number = Some(index + 1);
        let arrival = Arrival {
            dirty_pin: faults
                .strikes(Fault::ProbeDirty, number)
                .then_some(DIRTY_PIN),
            turned: faults.strikes(Fault::Turned, number),
            ..self.arrival(now_us, draw)
        };
        self.lot.part(seed, body, arrival)
    }

    /// After the last one the first golden part comes again.
    fn golden_part(&self, index: u64, now_us: u64, faults: &WorldFaults) -> Option<Specimen> {
        let place = index - self.filled_at.0;
        let body = if place < self.lot.golden() { place } else { 0 };
        let noise = faults.noise_seed();
        let draw = Draw::new(noise.unwrap_or(self.seed), Subject::GoldenOperations, index);
        let arrival = self.arrival(now_us, draw);
        self.lot
            .golden_part(self.seed, body, noise.is_some(), arrival)
    }

    fn arrival(&self, now_us: u64, draw: Draw) -> Arrival {
        Arrival {
            t_us: now_us as f64,
            track_c: self.track_c,
            ambient_c: self.ambient_c,
            draw,
            dirty_pin: None,
            turned: false,
        }
    }
}
