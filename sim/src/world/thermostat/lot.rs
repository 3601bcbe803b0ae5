//! A lot of temperature relays: a family of parts, shifted to the temperatures that the recipe asks for.

use super::defect::{Defect, Limits};
use super::part::{Thermostat, Values};
use super::table::{DefectTable, PartTable, ThermostatTable};
use crate::config::{ConfigError, Files};
use crate::table::Table;
use crate::world::defect::of_part;
use crate::world::draw::{Draw, Subject};

/// Parts of one lot.
#[derive(Debug, Clone)]
pub struct Lot {
    part: PartTable,
    defects: DefectTable,
    limits: Limits,
    seed: u64,
}

/// Distance of an assumed limit from the mean where the recipe has none, kelvin.
const OPEN_LIMIT_K: f64 = 5.0;

impl Lot {
    /// Reads the recipe of a lot. The family is the one that occurs in the name of the recipe, else the default one;
    /// its means move to the middle of the limits.
    ///
    /// # Errors
    /// Fails when the recipe cannot be read, or the table lacks the family.
    pub fn read(
        files: &Files,
        recipe: &str,
        table: &ThermostatTable,
        seed: u64,
    ) -> Result<Self, ConfigError> {
        let keys = files.recipe(recipe)?;
        let mut families = table.family.iter();
        let named = families.find(|(name, _)| recipe.contains(name.as_str()));
        let found = named.map(|(_, part)| part);
        let part = found.or_else(|| table.family.get(&table.part));
        let part = part.cloned().ok_or_else(|| ConfigError::Fault {
            path: files.path("sim.toml"),
            key: "thermostat.part".into(),
            message: format!("found {}, expected one of [thermostat.family]", table.part),
        })?;
        let (part, limits) = fitted(part, &keys)?;
        Ok(Self {
            part,
            defects: table.defects.clone(),
            limits,
            seed,
        })
    }

    /// Returns lot part `index`, from 0, at a temperature, degrees Celsius.
    pub fn part(&self, index: u64, celsius: f64) -> Thermostat {
        let draw = &mut Draw::new(self.seed, Subject::LotPart, index);
        let mut values = self.good(draw);
        let defect = of_part(Defect::ALL, self.seed, index, self.defects.rate_pct);
        if let Some(defect) = defect {
            defect.damage(&mut values, &self.limits, &self.defects, draw);
        }
        let events = Draw::new(self.seed, Subject::LotOperations, index);
        Thermostat::new(values, defect, celsius, events)
    }

    /// Draws a part without defect at random.
    fn good(&self, draw: &mut Draw) -> Values {
        let part = &self.part;
        // A part beyond three standard deviations fails the maker's own test.
        let mut within = |mean: f64, sd: f64| mean + sd * draw.normal(0.0, 1.0).clamp(-3.0, 3.0);
        let operate_c = within(part.operate_c, part.operate_sd_k);
        let differential_k = within(part.differential_k, part.differential_sd_k);
        let slower = within(1.0, part.lag_sd_pct / 100.0).max(0.2);
        let drift_k = within(0.0, part.drift_sd_k);
        Values {
            operate_c,
            reset_c: operate_c - differential_k,
            scatter_k: part.scatter_k,
            drift_k,
            lag_s: part.lag_s.map(|it| it * slower),
            breaks: true,
            contact_mohm: part.contact_mohm * within(0.0, part.contact_ln_sd).exp(),
            closure_ln_sd: part.closure_ln_sd,
            bounce_ms: part.bounce_ms,
            creep_k: 0.0,
            chatter: None,
            intermittent: None,
            stuck: None,
        }
    }
}

/// Moves the means of a family to the middle of the limits of a recipe; returns family and limits. An open limit counts
/// as [`OPEN_LIMIT_K`] from the mean.
fn fitted(mut part: PartTable, recipe: &Table) -> Result<(PartTable, Limits), ConfigError> {
    let limits: Option<Table> = recipe.get("limits")?;
    let read = |key| match &limits {
        Some(limits) => limits.get_or(key, Ends::OPEN),
        None => Ok(Ends::OPEN),
    };
    let operate = read("operate_temperature_c")?;
    let reset = read("reset_temperature_c")?;
    let differential = read("differential_k")?;
    part.operate_c = operate.middle().unwrap_or(part.operate_c);
    let by_reset = reset.middle().map(|reset_c| part.operate_c - reset_c);
    let asked_k = differential.middle().or(by_reset);
    part.differential_k = asked_k.unwrap_or(part.differential_k);
    let limits = Limits {
        operate_c: operate.about(part.operate_c),
        reset_c: reset.about(part.operate_c - part.differential_k),
        differential_k: differential.about(part.differential_k),
    };
    Ok((part, limits))
}

/// Limits of a recipe.
struct Ends {
    low: Option<f64>,
    high: Option<f64>,
}

crate::table::read_fields!(Ends { low, high });

impl Ends {
    const OPEN: Self = Self {
        low: None,
        high: None,
    };

    fn middle(&self) -> Option<f64> {
        Some(self.low?.midpoint(self.high?))
    }

    fn about(&self, mean: f64) -> [f64; 2] {
        [
            self.low.unwrap_or(mean - OPEN_LIMIT_K),
            self.high.unwrap_or(mean + OPEN_LIMIT_K),
        ]
    }
}
