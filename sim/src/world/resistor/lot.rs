//! A lot of resistor dummies.

use super::{Defect, Resistor, ResistorTable};
use crate::config::{ConfigError, Files};
use crate::world::defect;
use crate::world::draw::{Draw, Subject};
use crate::world::probes::Pins;
use crate::world::specimen::Arrival;
use crate::world::table::{WorldTable, present};

/// Least resistance of a dummy, ohm; the board divides by this resistance.
const LEAST_OHM: f64 = 1e-3;

/// Lot of dummies of the world file.
#[derive(Debug, Clone)]
pub struct Lot {
    table: ResistorTable,
    part_minus_track_sd_k: f64,
}

impl Lot {
    /// Creates the lot of a world.
    ///
    /// # Errors
    /// Fails when the world has no table of dummies.
    pub fn new(world: &WorldTable, files: &Files) -> Result<Self, ConfigError> {
        Ok(Self {
            table: present(&world.resistor, "resistor", files)?,
            part_minus_track_sd_k: present(&world.environment, "environment", files)?
                .part_minus_track_sd_k,
        })
    }

    /// Returns the lot part at an index under a seed.
    pub fn part(&self, seed: u64, index: u64, arrival: &Arrival) -> Resistor {
        let table = &self.table;
        let mut draw = Draw::new(seed, Subject::LotPart, index);
        let sd_ohm = table.nominal_ohm * table.tolerance_sd_pct / 100.0;
        let good_ohm = draw.normal(table.nominal_ohm, sd_ohm);
        let offset_k = draw.normal(0.0, self.part_minus_track_sd_k);
        let defect = defect::of_part(Defect::OF_A_LOT, seed, index, table.defects_pct);
        let mut part = Resistor {
            resistance_ohm: defect.map_or(good_ohm, |it| self.spoilt_ohm(it, good_ohm, &mut draw)),
            tcr_per_k: table.tcr_ppm_per_k * 1e-6,
            celsius: arrival.track_c + offset_k,
            defect,
            pins: Pins::ALL,
            supply_v: 0.0,
        };
        if let Some(pin) = arrival.dirty_pin {
            part.pins.lose(pin);
        }
        if arrival.misoriented {
            part.pins = Pins::MISORIENTED;
            part.defect = Some(Defect::Misoriented);
        }
        part
    }

    /// Draws the resistance of a part with a defect, ohm.
    fn spoilt_ohm(&self, defect: Defect, good_ohm: f64, draw: &mut Draw) -> f64 {
        match defect {
            Defect::Open => f64::INFINITY,
            Defect::Short => draw.between(self.table.short_ohm).max(LEAST_OHM),
            Defect::WrongValue => {
                let factor = draw.between(self.table.wrong_value_factor);
                match draw.uniform() < 0.5 {
                    true => good_ohm * factor,
                    false => good_ohm / factor,
                }
            }
            Defect::Misoriented => good_ohm,
        }
    }
}
