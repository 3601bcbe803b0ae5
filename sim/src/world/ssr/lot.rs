//! A lot of solid-state relays.

use super::Ssr;
use super::defect::{Damage, Defect};
use super::table::{SsrAcTable, SsrTable};
use super::values::{Rated, Values};
use crate::config::ConfigError;
use crate::scpi::relay::{Kind, Truth as Model};
use crate::table::Table;
use crate::world::WorldOptions;
use crate::world::defect::of_part;
use crate::world::draw::{Draw, Subject};
use crate::world::probes::Pins;
use crate::world::specimen::Arrival;
use crate::world::ssr_board::FixtureTable;
use crate::world::table::{WorldTable, present};

/// Nominal line when the recipe states none: volts rms and hertz.
const MAINS: (f64, f64) = (230.0, 50.0);

/// Parts of one recipe.
#[derive(Debug, Clone)]
pub struct Lot {
    table: Values25,
    fixture: FixtureTable,
    part_minus_track_sd_k: f64,
    rated: Rated,
}

/// Values at 25 degrees Celsius, by kind of output.
#[derive(Debug, Clone)]
enum Values25 {
    Dc(SsrTable),
    Ac(Kind, SsrAcTable),
}

impl Lot {
    /// Reads the recipe of a lot.
    ///
    /// # Errors
    /// Fails when the recipe lacks a rating, its output is unknown, or the world has no table of these parts.
    pub fn read(
        recipe: &Table,
        options: &WorldOptions,
        world: &WorldTable,
    ) -> Result<Self, ConfigError> {
        let part: Table = recipe.get("part")?;
        let files = &options.files;
        let ac = |kind| {
            Ok::<_, ConfigError>(Values25::Ac(kind, present(&world.ssr_ac, "ssr_ac", files)?))
        };
        let table = match part.get::<String>("output")?.as_str() {
            "dc" => Values25::Dc(present(&world.ssr, "ssr", files)?),
            "ac_zero_cross" => ac(Kind::AcZeroCross)?,
            "ac_random" => ac(Kind::AcRandom)?,
            _ => return Err(part.wrong("output", "dc, ac_zero_cross or ac_random")),
        };
        Ok(Self {
            rated: rated(&part, matches!(table, Values25::Ac(..)))?,
            table,
            fixture: present(&world.fixture, "fixture", files)?,
            part_minus_track_sd_k: present(&world.environment, "environment", files)?
                .part_minus_track_sd_k,
        })
    }

    /// Returns the lot part at an index under a seed.
    pub fn part(&self, seed: u64, index: u64, arrival: &Arrival) -> Ssr {
        let draw = &mut Draw::new(seed, Subject::LotPart, index);
        let offset_k = draw.normal(0.0, self.part_minus_track_sd_k);
        let celsius = arrival.track_c + offset_k;
        let (mut values, damage) = match &self.table {
            Values25::Dc(table) => (
                self.good_dc(table, celsius, draw),
                Damage::Dc(&table.defects),
            ),
            Values25::Ac(kind, table) => (
                self.good_ac(*kind, table, celsius, draw),
                Damage::Ac(&table.defects),
            ),
        };
        let kinds = Defect::of_output(values.model.kind);
        let mut found = of_part(kinds, seed, index, damage.rate_pct());
        if let Some(defect) = found {
            defect.damage(&mut values, damage, draw);
        }
        if let Some(pin) = arrival.dirty_pin {
            values.pins.lose(pin);
        }
        if arrival.misoriented {
            values.misorient();
            found = Some(Defect::Misoriented);
        }
        Ssr::new(values, found, self.fixture.loop_ohm, arrival.t_us)
    }

    /// Draws a DC part without defect at random.
    fn good_dc(&self, table: &SsrTable, celsius: f64, draw: &mut Draw) -> Values {
        let mut within = within(draw);
        let capacitance_f = table.output_pf * 1e-12;
        let model = Model {
            forward_v: within(table.forward_v_mean, table.forward_v_sd),
            series_ohm: within(table.input_ohm_mean, table.input_ohm_sd),
            threshold_a: within(table.threshold_ma_mean, table.threshold_ma_sd) * 1e-3,
            hysteresis: within(table.hysteresis_mean, table.hysteresis_sd),
            on_tau_s: within(table.on_tau_us_mean, table.on_tau_us_sd) * 1e-6,
            off_tau_s: within(table.off_tau_us_mean, table.off_tau_us_sd) * 1e-6,
            on_ohm: within(table.on_mohm_mean, table.on_mohm_sd) * 1e-3,
            junction_k_per_w: within(table.junction_k_per_w_mean, table.junction_k_per_w_sd),
            leakage_a: table.leakage_na_median * 1e-9 * within(0.0, table.leakage_ln_sd).exp(),
            leakage_ohm: table.insulation_mohm * 1e6,
            capacitance_f,
            ..Model::draw(Kind::Dc, None, 0)
        };
        let farads = self.fixture.capacitance_nf * 1e-9 + capacitance_f;
        let recharge_s = 10f64.ln() * self.fixture.series_ohm * farads;
        self.values(model, celsius, table.shorted_mohm, recharge_s)
    }

    /// Draws an AC part without defect at random.
    fn good_ac(&self, kind: Kind, table: &SsrAcTable, celsius: f64, draw: &mut Draw) -> Values {
        let mut within = within(draw);
        let knee_v = within(table.knee_v_mean, table.knee_v_sd);
        let differs_v = 0.5 * within(0.0, table.knee_difference_v_sd);
        let inhibit_v = within(table.inhibit_v_mean, table.inhibit_v_sd);
        let model = Model {
            forward_v: within(table.forward_v_mean, table.forward_v_sd),
            series_ohm: within(table.input_ohm_mean, table.input_ohm_sd),
            threshold_a: within(table.threshold_ma_mean, table.threshold_ma_sd) * 1e-3,
            hysteresis: within(table.hysteresis_mean, table.hysteresis_sd),
            on_tau_s: within(table.on_tau_us_mean, table.on_tau_us_sd) * 1e-6,
            off_tau_s: within(table.off_tau_us_mean, table.off_tau_us_sd) * 1e-6,
            on_ohm: within(table.slope_mohm_mean, table.slope_mohm_sd) * 1e-3,
            knee_v: [knee_v + differs_v, knee_v - differs_v],
            latching_a: table.latching_ma * 1e-3,
            holding_a: table.holding_ma * 1e-3,
            inhibit_v: match kind {
                Kind::AcZeroCross => inhibit_v,
                Kind::AcRandom | Kind::Dc | Kind::Passive => f64::INFINITY,
            },
            retrigger_v: within(table.retrigger_v_mean, table.retrigger_v_sd),
            junction_k_per_w: within(table.junction_k_per_w_mean, table.junction_k_per_w_sd),
            commutation_v_per_us: within(
                table.commutation_v_per_us_mean,
                table.commutation_v_per_us_sd,
            ),
            capacitance_f: within(table.snubber_nf_mean, table.snubber_nf_sd) * 1e-9,
            leakage_a: table.leakage_na_median * 1e-9 * within(0.0, table.leakage_ln_sd).exp(),
            leakage_ohm: table.insulation_mohm * 1e6,
            ..Model::draw(kind, None, 0)
        };
        self.values(model, celsius, table.shorted_mohm, 0.0)
    }

    fn values(&self, model: Model, celsius: f64, shorted_mohm: f64, recharge_s: f64) -> Values {
        Values {
            model,
            celsius,
            rated: self.rated,
            shorted_ohm: shorted_mohm * 1e-3,
            recharge_s,
            half_short: 0.0,
            pins: Pins::ALL,
        }
    }
}

/// Returns a function that draws from a normal distribution (mean, standard deviation) within three standard
/// deviations: parts beyond fail the maker's own test.
fn within(draw: &mut Draw) -> impl FnMut(f64, f64) -> f64 {
    |mean: f64, sd: f64| {
        let drawn = draw.normal(mean, sd);
        drawn.clamp(mean - 3.0 * sd, mean + 3.0 * sd)
    }
}

/// Reads the ratings of the part; those of an AC part hold at its nominal line.
fn rated(part: &Table, is_ac: bool) -> Result<Rated, ConfigError> {
    let (volts, hz) = match is_ac {
        true => (
            part.get::<Option<f64>>("mains_v")?.unwrap_or(MAINS.0),
            part.get::<Option<f64>>("mains_hz")?.unwrap_or(MAINS.1),
        ),
        false => (part.get("rated_v")?, 0.0),
    };
    Ok(Rated {
        control_v: part.get("control_v")?,
        blocked_v: volts,
        load_a: part.get("rated_a")?,
        hz,
    })
}
