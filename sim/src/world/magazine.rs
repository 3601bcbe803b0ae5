//! The magazine track and every part that has left it. It may be emptied and filled anew while the rig runs.

use std::path::Path;

use super::draw::{Draw, Subject};
use super::golden::{Certificate, read_golden, read_scale};
use super::relay::{Contact, Relay};
use super::specimen::{Scale, Specimen};
use super::table::WorldTable;
use super::{
    WorldOptions,
    fault::{Fault, Faults},
};
use crate::config::ConfigError;
use crate::truth::{BodyTruth, PartTruth, Place};

/// A part outside the magazine.
#[derive(Debug, Clone)]
pub struct Part {
    /// The relay; its coil and contacts keep their history.
    pub relay: Relay,
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
        let (spec, record) = (self.relay.specimen(), &self.relay.record);
        let coil = spec.coil_ohm;
        PartTruth {
            seq: self.seq,
            coil_resistance_ohm: coil.is_finite().then_some(coil),
            operate_voltage_v: Some(spec.operate_v),
            release_voltage_v: Some(spec.release_v),
            operate_time_ms: record.time_ms(Contact::No),
            release_time_ms: record.time_ms(Contact::Nc),
            operate_bounce_ms: record.bounce_ms(Contact::No),
            release_bounce_ms: record.bounce_ms(Contact::Nc),
            contact_resistance_no_mohm: record.mean_mohm(Contact::No),
            contact_resistance_nc_mohm: record.mean_mohm(Contact::Nc),
            defect: spec.defect.map(super::defect::Defect::name),
            landed_in: match self.path.last() {
                Some((_, Place::Bin(bin))) => Some(bin.clone()),
                _ => None,
            },
            levels: self.relay.levels(),
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
    world: WorldTable,
    scale: Scale,
    seed: u64,
    golden: Vec<Certificate>,
    lot: Option<u64>,
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
        faults: &Faults,
        track_c: f64,
        ambient_c: f64,
    ) -> Result<Self, ConfigError> {
        let dir: &Path = &options.config_dir;
        let scale = read_scale(dir, &options.recipe)?;
        let golden = match options.golden {
            true => read_golden(dir, scale.nominal_v)?,
            false => Vec::new(),
        };
        let (world, seed, lot) = (world.clone(), options.seed, options.parts);
        Ok(Self {
            world,
            scale,
            seed,
            golden,
            lot,
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
        let ahead = (self.golden.len() as u64).saturating_sub(out.0);
        let lot = |lot: u64| ahead + lot.saturating_sub(out.1);
        self.lot.map_or(u64::MAX, lot)
    }

    /// Place in the lot (from 1) of the part that leaves next; none when it is a golden one.
    pub fn next_number(&self) -> Option<u64> {
        (self.since_filled().0 >= self.golden_due()).then_some(self.out.1 + 1)
    }

    /// Golden parts that belong before the next lot part.
    fn golden_due(&self) -> u64 {
        let lot = self.since_filled().1;
        let again = self.golden_every.map_or(0, |every| lot / every);
        match self.golden.len() as u64 {
            0 => 0,
            first => first + again,
        }
    }

    /// The next part leaves; `None` from an empty track.
    pub fn take(&mut self, now_us: u64, faults: &mut Faults) -> Option<Part> {
        if self.waiting() == 0 {
            return None;
        }
        let number = self.next_number();
        let (mut specimen, draw) = match number {
            Some(n) => self.lot_part(n - 1, faults),
            None => self.golden_part(self.out.0, faults),
        };
        match number {
            Some(_) => self.out.1 += 1,
            None => self.out.0 += 1,
        }
        if faults.strikes(Fault::ProbeDirty, number) {
            specimen.kelvin[3] = false;
            specimen.pins.present[3] = false;
        }
        if faults.strikes(Fault::Turned, number) {
            specimen.turn();
        }
        let double = faults.strikes(Fault::DoublePart, number);
        let (track, air) = (self.track_c, self.ambient_c);
        let relay = Relay::new(specimen, &self.world, draw, now_us as f64, track, air);
        Some(Part {
            relay,
            seq: 0,
            number,
            double,
            path: vec![(now_us, Place::Pocket)],
        })
    }

    /// A part that is fed again is the same body, and operates anew.
    fn lot_part(&self, index: u64, faults: &Faults) -> (Specimen, Draw) {
        let asked = |fault| faults.values(fault).next().map(|it| it as u64);
        let seed = asked(Fault::PartsSeed).unwrap_or(self.seed);
        let noise = faults.noise_seed().unwrap_or(self.seed);
        let body = asked(Fault::Refeed).map_or(index, |parts| index % parts.max(1));
        let specimen = Specimen::of_lot(&self.world, self.scale, seed, body);
        (specimen, Draw::new(noise, Subject::LotOperations, index))
    }

    /// On another day a golden part is the same body with another temperature.
    fn golden_part(&self, index: u64, faults: &Faults) -> (Specimen, Draw) {
        let place = index - self.filled_at.0;
        let body = if place < self.golden.len() as u64 {
            place
        } else {
            0
        };
        let paper = &self.golden[body as usize];
        let mut specimen =
            Specimen::of_certificate(&self.world, self.scale, self.seed, body, paper);
        let noise = faults.noise_seed();
        let mut draw = Draw::new(noise.unwrap_or(self.seed), Subject::GoldenOperations, index);
        if noise.is_some() {
            let sd_k = self.world.environment.part_minus_track_sd_k;
            specimen.offset_k = draw.normal(0.0, sd_k);
        }
        (specimen, draw)
    }
}
