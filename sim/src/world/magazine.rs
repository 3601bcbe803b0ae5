//! The magazine track and its parts; an operator may empty and refill it while the rig runs.

use super::draw::{Draw, Subject};
use super::specimen::{Arrival, Lot, Specimen};
use super::table::WorldTable;
use super::{
    WorldOptions,
    fault::{Fault, WorldFaults},
};
use crate::config::ConfigError;
use crate::truth::{BodyTruth, PartTruth, Place};

/// Index of the pin that [`Fault::ProbeDirty`] affects: NO.
const DIRTY_PIN: usize = 3;

/// A part that has left the magazine.
#[derive(Debug, Clone)]
pub struct Part {
    /// Specimen; it keeps its operating history.
    pub specimen: Specimen,
    /// Order of entering the nest, from 1; 0 before that, and for every reference part.
    pub seq: u64,
    /// Number in the lot from 1, by which faults refer to the part; `None` for reference parts.
    pub number: Option<u64>,
    /// Serial number that the code on the part holds; `None` for reference parts, and on a rig without code reader.
    pub code: Option<String>,
    /// True when a second body clings to this one and travels with it.
    pub double: bool,
    /// Places with the time of arrival, microseconds.
    pub path: Vec<(u64, Place)>,
}

impl Part {
    /// Returns the true values of this part.
    pub fn truth(&self) -> PartTruth {
        PartTruth {
            seq: self.seq,
            landed_in: match self.path.last() {
                Some((_, Place::Bin(bin))) => Some(bin.clone()),
                _ => None,
            },
            serial: self.code.clone(),
            ..self.specimen.truth()
        }
    }

    /// Returns this body with its path, and the body that clings to it.
    pub fn bodies(&self) -> impl Iterator<Item = BodyTruth> {
        let own = BodyTruth {
            is_reference: self.number.is_none(),
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

    /// Records the arrival at a place.
    pub fn arrive(&mut self, now_us: u64, place: Place) {
        self.path.push((now_us, place));
    }
}

/// Parts in the order in which they leave: reference parts first, then the lot.
#[derive(Debug, Clone)]
pub struct Magazine {
    lot: Lot,
    seed: u64,
    /// Number of lot parts; `None` for an endless lot.
    parts: Option<u64>,
    /// Number of lot parts between two reference parts, once the lot has begun.
    reference_every: Option<u64>,
    /// Numbers of reference parts and of lot parts that have left.
    out: (u64, u64),
    /// Value of `out` when the magazine was last filled.
    filled_at: (u64, u64),
    track_c: f64,
    ambient_c: f64,
    /// True when lot parts have a code.
    codes: bool,
}

impl Magazine {
    /// Loads a full magazine, with the temperatures of its track and of the air.
    ///
    /// # Errors
    /// Fails when the recipe or the certificates cannot be read.
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
            reference_every: faults
                .values(Fault::ReferenceEvery)
                .next()
                .map(|it| it.max(1.0) as u64),
            out: (0, 0),
            filled_at: (0, 0),
            track_c,
            ambient_c,
            codes: false,
        })
    }

    /// Enables codes on the lot parts, for a rig with a code reader.
    pub fn with_codes(self, codes: bool) -> Self {
        Self { codes, ..self }
    }

    /// Continues the counts of the magazine `before`, so that no lot part comes twice.
    pub fn continuing(mut self, before: &Self) -> Self {
        (self.out, self.filled_at) = (before.out, before.out);
        self.codes = before.codes;
        self
    }

    /// Returns the numbers of reference parts and of lot parts that have left since the magazine was filled.
    fn since_filled(&self) -> (u64, u64) {
        (self.out.0 - self.filled_at.0, self.out.1 - self.filled_at.1)
    }

    /// Returns the number of remaining parts; `u64::MAX` for an endless lot.
    pub fn waiting(&self) -> u64 {
        let out = self.since_filled();
        let ahead = self.lot.reference_parts().saturating_sub(out.0);
        let lot = |parts: u64| ahead + parts.saturating_sub(out.1);
        self.parts.map_or(u64::MAX, lot)
    }

    /// Returns the number in the lot (from 1) of the next part; `None` for a reference part.
    pub fn next_number(&self) -> Option<u64> {
        (self.since_filled().0 >= self.reference_parts_due()).then_some(self.out.1 + 1)
    }

    /// Returns the number of reference parts that leave before the next lot part.
    fn reference_parts_due(&self) -> u64 {
        let lot = self.since_filled().1;
        let again = self.reference_every.map_or(0, |every| lot / every);
        match self.lot.reference_parts() {
            0 => 0,
            first => first + again,
        }
    }

    /// Removes and returns the next part; `None` when the track is empty.
    pub fn take(&mut self, now_us: u64, faults: &mut WorldFaults) -> Option<Part> {
        if self.waiting() == 0 {
            return None;
        }
        let number = self.next_number();
        let specimen = match number {
            Some(n) => self.lot_part(n - 1, now_us, faults),
            None => self.reference_part(self.out.0, now_us, faults)?,
        };
        match number {
            Some(_) => self.out.1 += 1,
            None => self.out.0 += 1,
        }
        Some(Part {
            specimen,
            seq: 0,
            number,
            code: number
                .filter(|_| self.codes)
                .map(|n| self.code(n - 1, faults)),
            double: faults.strikes(Fault::DoublePart, number),
            path: vec![(now_us, Place::Pocket)],
        })
    }

    /// Creates lot part `index`, counted from 0. Under the fault `refeed` the same bodies come again and again, each
    /// time with a new draw of the scatter of its operations.
    fn lot_part(&self, index: u64, now_us: u64, faults: &mut WorldFaults) -> Specimen {
        let noise = faults.noise_seed().unwrap_or(self.seed);
        let (seed, body) = self.body(index, faults);
        let draw = Draw::new(noise, Subject::LotOperations, index);
        let number = Some(index + 1);
        let arrival = Arrival {
            dirty_pin: faults
                .strikes(Fault::ProbeDirty, number)
                .then_some(DIRTY_PIN),
            misoriented: faults.strikes(Fault::Misoriented, number),
            ..self.arrival(now_us, draw)
        };
        self.lot.part(seed, body, arrival)
    }

    /// Returns seed and number (from 0) of the body that appears as lot part `index`.
    fn body(&self, index: u64, faults: &WorldFaults) -> (u64, u64) {
        let asked = |fault| faults.values(fault).next().map(|it| it as u64);
        let seed = asked(Fault::PartsSeed).unwrap_or(self.seed);
        let body = asked(Fault::Refeed).map_or(index, |parts| index % parts.max(1));
        (seed, body)
    }

    /// Returns the serial number in the code of lot part `index`.
    fn code(&self, index: u64, faults: &mut WorldFaults) -> String {
        let copied = faults.strikes(Fault::DuplicateCode, Some(index + 1));
        let (seed, body) = self.body(index - u64::from(copied).min(index), faults);
        format!("R{seed:04X}-{:06}", body + 1)
    }

    /// Creates reference part `index`; every one past the last is the first one again.
    fn reference_part(&self, index: u64, now_us: u64, faults: &WorldFaults) -> Option<Specimen> {
        let place = index - self.filled_at.0;
        let body = if place < self.lot.reference_parts() {
            place
        } else {
            0
        };
        let noise = faults.noise_seed();
        let draw = Draw::new(
            noise.unwrap_or(self.seed),
            Subject::ReferenceOperations,
            index,
        );
        let arrival = self.arrival(now_us, draw);
        self.lot
            .reference_part(self.seed, body, noise.is_some(), arrival)
    }

    fn arrival(&self, now_us: u64, draw: Draw) -> Arrival {
        Arrival {
            t_us: now_us as f64,
            track_c: self.track_c,
            ambient_c: self.ambient_c,
            draw,
            dirty_pin: None,
            misoriented: false,
        }
    }
}
