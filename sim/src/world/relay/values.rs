//! True values of one relay, drawn from the lot or set by a certificate.

use super::certificate::Certificate;
use super::defect::Defect;
use super::fit::{FitTarget, TimeOrigin};
use super::table::LotTable;
use crate::world::defect;
use crate::world::draw::{Draw, Subject};
use crate::world::probes::Pins;
use crate::world::table::RelayWorld;

/// Resistance of one contact, milliohm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactFilm {
    /// Scatters about a median from closure to closure.
    Steady {
        /// Median over the closures, milliohm.
        median_mohm: f64,
        /// Standard deviation of the logarithm.
        ln_sd: f64,
    },
    /// Uniform over the range at every closure, milliohm.
    Unstable([f64; 2]),
}

impl ContactFilm {
    /// Draws the resistance of the next closure, milliohm.
    pub fn close(self, draw: &mut Draw) -> f64 {
        match self {
            Self::Steady { median_mohm, ln_sd } => draw.lognormal(median_mohm, ln_sd),
            Self::Unstable(ends) => draw.between(ends),
        }
    }
}

/// True values of a relay; thresholds and coil at 23 C.
#[derive(Debug, Clone)]
pub struct RelayValues {
    /// Index in the lot, or in the list of certificates.
    pub index: u64,
    /// True for a reference part: it has a certificate and does not belong to the lot.
    pub is_reference: bool,
    /// Defect, if any.
    pub defect: Option<Defect>,
    /// Nominal coil voltage, V.
    pub nominal_v: f64,
    /// Volts of this coil per volt of the 12 V part.
    pub volt_scale: f64,
    /// Ohms of this coil's design per ohm of the 12 V part.
    pub ohm_scale: f64,
    /// Turns of this coil per turn of the 12 V part.
    pub turns: f64,
    /// Origin of the operate time and release time of this relay.
    pub time_origin: TimeOrigin,
    /// Winding resistance, ohm; infinite when open.
    pub coil_ohm: f64,
    /// Quasi-static operate threshold, V.
    pub operate_v: f64,
    /// Quasi-static release threshold, V.
    pub release_v: f64,
    /// Time from drive on to first make of NO at nominal voltage, ms.
    pub operate_ms: f64,
    /// Time from drive off to first make of NC, from nominal voltage into the zener, ms.
    pub release_ms: f64,
    /// Bounce pattern of NO, microseconds: closed, open, closed, and so on.
    pub bounce_no_us: Vec<f64>,
    /// Bounce pattern of NC, in the same form.
    pub bounce_nc_us: Vec<f64>,
    /// Resistance of the NO contact at its closures.
    pub film_no: ContactFilm,
    /// Resistance of the NC contact at its closures.
    pub film_nc: ContactFilm,
    /// Temperature of the part minus that of the track, kelvin.
    pub offset_k: f64,
    /// Thermal EMF in the contact circuit, volts.
    pub emf_v: f64,
    /// Pins that touch their probes.
    pub pins: Pins,
}

/// Scale of a recipe relative to the 12 V part.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// Nominal coil voltage of the recipe, V.
    pub nominal_v: f64,
    /// Nominal coil resistance of the recipe, ohm.
    pub nominal_coil_ohm: f64,
}

impl RelayValues {
    /// Draws the part at an index of the lot.
    pub fn of_lot(world: &RelayWorld, scale: Scale, seed: u64, index: u64) -> Self {
        let mut draw = Draw::new(seed, Subject::LotPart, index);
        let mut part = Self::good(world, scale, &mut draw);
        part.index = index;
        part.defect = defect::of_part(Defect::ALL, seed, index, world.defects.rate_pct);
        if let Some(defect) = part.defect {
            part.apply_defect(defect, world, &mut draw);
        }
        part
    }

    /// Draws a reference part: certified values within their uncertainties, typical values for everything else.
    pub fn of_certificate(
        world: &RelayWorld,
        scale: Scale,
        seed: u64,
        index: u64,
        paper: &Certificate,
    ) -> Self {
        let mut draw = Draw::new(seed, Subject::ReferencePart, index);
        let mut part = Self::good(world, scale, &mut draw);
        part.index = index;
        part.is_reference = true;
        part.operate_v = draw.normal(paper.operate_voltage_v.value, paper.operate_voltage_v.u);
        part.release_v = draw.normal(paper.release_voltage_v.value, paper.release_voltage_v.u);
        part.coil_ohm = draw.normal(paper.coil_resistance_ohm.value, paper.coil_resistance_ohm.u);
        part
    }

    fn good(world: &RelayWorld, scale: Scale, draw: &mut Draw) -> Self {
        let lot = &world.lot;
        let volt_scale = scale.nominal_v / lot.nominal_v;
        let ohm_scale = scale.nominal_coil_ohm / lot.nominal_coil_ohm;
        let operate = draw.normal(0.0, 1.0);
        let follows = lot.operate_ms_follows_v;
        let own = (1.0 - follows * follows).max(0.0).sqrt();
        let slowness = follows * operate + own * draw.normal(0.0, 1.0);
        Self {
            index: 0,
            is_reference: false,
            defect: None,
            nominal_v: scale.nominal_v,
            volt_scale,
            ohm_scale,
            turns: ohm_scale / volt_scale,
            time_origin: TimeOrigin::Lot,
            coil_ohm: ohm_scale * draw.normal(lot.coil_ohm_mean, lot.coil_ohm_sd),
            operate_v: volt_scale * (lot.operate_v_mean + lot.operate_v_sd * operate),
            release_v: volt_scale * draw.normal(lot.release_v_mean, lot.release_v_sd),
            operate_ms: lot.operate_ms_mean + lot.operate_ms_sd * slowness,
            release_ms: draw.normal(lot.release_ms_mean, lot.release_ms_sd),
            bounce_no_us: bounce(
                &world.relay.bounce_no_us,
                draw.normal(lot.bounce_no_ms_mean, lot.bounce_no_ms_sd),
            ),
            bounce_nc_us: bounce(
                &world.relay.bounce_nc_us,
                draw.normal(lot.bounce_nc_ms_mean, lot.bounce_nc_ms_sd),
            ),
            film_no: film(lot, lot.contact_no_mohm_median, draw),
            film_nc: film(lot, lot.contact_nc_mohm_median, draw),
            offset_k: draw.normal(0.0, world.environment.part_minus_track_sd_k),
            emf_v: draw.normal(0.0, lot.thermal_emf_sd_uv * 1e-6),
            pins: Pins::ALL,
        }
    }

    fn apply_defect(&mut self, defect: Defect, world: &RelayWorld, draw: &mut Draw) {
        let table = &world.defects;
        let volts = |draw: &mut Draw, ends, scale: f64| scale * draw.between(ends);
        match defect {
            Defect::OpenCoil => self.coil_ohm = f64::INFINITY,
            Defect::ShortedTurns => {
                let left = draw.between(table.shorted_turns_coil_factor);
                self.coil_ohm = self.nominal_ohm(world) * left;
                self.turns *= left;
                self.time_origin = TimeOrigin::Follows;
            }
            Defect::WrongCoil => self.change_winding(draw.between(table.wrong_coil_factor), world),
            Defect::WeakSpring => {
                self.release_v = volts(draw, table.weak_spring_release_v, self.volt_scale);
                self.operate_v = volts(draw, table.weak_spring_operate_v, self.volt_scale);
            }
            Defect::StiffSpring => {
                self.operate_v = volts(draw, table.stiff_spring_operate_v, self.volt_scale);
                self.release_v = volts(draw, table.stiff_spring_release_v, self.volt_scale);
            }
            Defect::Slow if draw.uniform() < 0.5 => {
                self.operate_ms = draw.between(table.slow_operate_ms);
                self.time_origin = TimeOrigin::Hinge;
            }
            Defect::Slow => {
                self.release_ms = draw.between(table.slow_release_ms);
                self.time_origin = TimeOrigin::Iron;
            }
            Defect::Bouncing if draw.uniform() < 0.5 => {
                self.bounce_no_us =
                    bounce(&world.relay.bounce_no_us, draw.between(table.bouncing_ms));
            }
            Defect::Bouncing => {
                self.bounce_nc_us =
                    bounce(&world.relay.bounce_nc_us, draw.between(table.bouncing_ms));
            }
            Defect::StuckNc | Defect::StuckNo => {}
            Defect::HighContact => {
                let median_mohm = match draw.uniform() < 0.25 {
                    true => 1000.0 * draw.between(table.far_too_high_ohm),
                    false => draw.between(table.high_contact_mohm),
                };
                self.spoil_contact(
                    ContactFilm::Steady {
                        median_mohm,
                        ln_sd: 0.02,
                    },
                    draw,
                );
            }
            Defect::UnstableContact => {
                self.spoil_contact(ContactFilm::Unstable(table.unstable_contact_mohm), draw);
            }
            Defect::Misoriented => self.misorient(),
            Defect::MissingPin => self.pins.lose(draw.below(5) as usize),
        }
    }

    /// Makes the part misoriented.
    pub fn misorient(&mut self) {
        self.defect = Some(Defect::Misoriented);
        self.pins = Pins::MISORIENTED;
    }

    fn nominal_ohm(&self, world: &RelayWorld) -> f64 {
        self.ohm_scale * world.lot.nominal_coil_ohm
    }

    /// Changes the winding at constant power: volts scale with the square root of the ohms.
    fn change_winding(&mut self, factor: f64, world: &RelayWorld) {
        self.coil_ohm = self.nominal_ohm(world) * factor;
        self.turns *= factor.sqrt();
        self.time_origin = TimeOrigin::Follows;
        self.operate_v *= factor.sqrt();
        self.release_v *= factor.sqrt();
    }

    fn spoil_contact(&mut self, film: ContactFilm, draw: &mut Draw) {
        match draw.uniform() < 0.5 {
            true => self.film_no = film,
            false => self.film_nc = film,
        }
    }

    /// Returns the results that a relay with these values must show; an open coil counts as intact.
    pub fn fit_target(&self, world: &RelayWorld) -> FitTarget {
        let wound = self.nominal_ohm(world);
        FitTarget {
            coil_ohm: if self.coil_ohm.is_finite() {
                self.coil_ohm
            } else {
                wound
            },
            turns: self.turns,
            volts: [self.operate_v, self.release_v],
            seconds: [self.operate_ms * 1e-3, self.release_ms * 1e-3],
            nominal_v: self.nominal_v,
            zener_v: world.board.zener_v * self.volt_scale,
            time_origin: self.time_origin,
        }
    }
}

/// Stretches a bounce pattern to a total open time, milliseconds.
fn bounce(pattern: &[f64], open_ms: f64) -> Vec<f64> {
    let open: f64 = pattern.iter().skip(1).step_by(2).sum();
    let stretch = open_ms.max(0.0) * 1000.0 / open.max(1.0);
    pattern
        .iter()
        .enumerate()
        .map(|(i, &us)| if i % 2 == 1 { us * stretch } else { us })
        .collect()
}

fn film(lot: &LotTable, median: f64, draw: &mut Draw) -> ContactFilm {
    ContactFilm::Steady {
        median_mohm: draw.lognormal(median, lot.contact_ln_sd),
        ln_sd: lot.closure_ln_sd,
    }
}
