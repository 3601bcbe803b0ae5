//! A lot of solid-state relays.

use super::defect::Defect;
use super::table::SsrTable;
use super::values::{Rated, Values};
use super::{Ssr, defect};
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

/// Parts of one recipe.
#[derive(Debug, Clone)]
pub struct Lot {
    table: SsrTable,
    fixture: FixtureTable,
    part_minus_track_sd_k: f64,
    rated: Rated,
}

impl Lot {
    /// Reads the parts of a recipe.
    ///
    /// # Errors
    /// Fails when the recipe lacks a rating, its output is not `dc`, or the world has no table of these parts.
    pub fn read(
        recipe: &Table,
        options: &WorldOptions,
        world: &WorldTable,
    ) -> Result<Self, ConfigError> {
        let part: Table = recipe.get("part")?;
        if part.get::<String>("output")? != "dc" {
            return Err(part.wrong("output", "dc"));
        }
        Ok(Self {
            table: present(&world.ssr, "ssr", &options.files)?,
            fixture: present(&world.fixture, "fixture", &options.files)?,
            part_minus_track_sd_k: world.environment.part_minus_track_sd_k,
            rated: Rated {
                control_v: part.get("control_v")?,
                blocked_v: part.get("rated_v")?,
                load_a: part.get("rated_a")?,
            },
        })
    }

    /// Returns the lot part at an index under a seed.
    pub fn part(&self, seed: u64, index: u64, arrival: &Arrival) -> Ssr {
        let draw = &mut Draw::new(seed, Subject::LotPart, index);
        let offset_k = draw.normal(0.0, self.part_minus_track_sd_k);
        let mut values = self.good(arrival.track_c + offset_k, draw);
        let mut found = of_part(
            defect::Defect::ALL,
            seed,
            index,
            self.table.defects.rate_pct,
        );
        if let Some(defect) = found {
            defect.damage(&mut values, &self.table.defects, draw);
        }
        if let Some(pin) = arrival.dirty_pin {
            values.pins.lose(pin);
        }
        if arrival.misoriented {
            values.misorient();
            found = Some(Defect::Misoriented);
        }
        Ssr::new(values, found, arrival.t_us)
    }

    /// Draws a part without defect.
    fn good(&self, celsius: f64, draw: &mut Draw) -> Values {
        let table = &self.table;
        // A part beyond three standard deviations fails the maker's own test.
        let mut within = |mean: f64, sd: f64| {
            let drawn = draw.normal(mean, sd);
            drawn.clamp(mean - 3.0 * sd, mean + 3.0 * sd)
        };
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
        Values {
            model,
            celsius,
            rated: self.rated,
            shorted_ohm: table.shorted_mohm * 1e-3,
            recharge_s: 10f64.ln() * self.fixture.series_ohm * farads,
            pins: Pins::ALL,
        }
    }
}
