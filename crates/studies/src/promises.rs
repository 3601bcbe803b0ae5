//! Study `promises`: whether a rig notices that it breaks a promise, and if not, whether the stated uncertainty still
//! covers the truth.
//!
//! A promise is a value of `rig.toml` or of the recipe on which the uncertainty rests. For each term of [`TERMS`] a
//! world multiplies one promised value by [`FACTOR`] and keeps the others. A term passes when it meets one of two bars:
//! at least [`NOTICED_PCT`] of its lots notice the broken promise, or the uncertainty of every parameter covers at
//! least [`COVERED_PCT`] of its values. When one bar is met, the report sets no bar for the other figure. A lot notices
//! the broken promise when its run raises the alarm of a promise or refuses the calibration. Worlds that keep every
//! promise give the share of lots with a false alarm.

use super::chart::Chart;
use super::error::Pooled;
use super::figure::{Bar, Figure, percent};
use super::lot::Lot;
use super::method::{self, BAUDS};
use super::order::Order;
use super::output::Report;
use super::variant::{Variant, table};
use anyhow::{Context, ensure};
use machine::dut::em_relay::Parameter;
use machine::dut::recipe::DeviceRecipe;
use quality::spread::median;
use statrs::distribution::{Beta, ContinuousCDF};
use std::collections::BTreeMap;
use toml::{Table, Value};

/// Factor by which a world multiplies the promised value that it breaks.
const FACTOR: f64 = 2.0;
/// Least share of lots that notice the broken promise, percent.
const NOTICED_PCT: f64 = 95.0;
/// Least coverage of a parameter, percent of values.
const COVERED_PCT: f64 = 92.0;
/// Greatest permitted share of lots with a false alarm, percent.
const FALSE_ALARMS_PCT: f64 = 0.5;
/// Confidence level of the upper bound of the share of false alarms, 0 to 1.
const CONFIDENCE: f64 = 0.95;

/// Each promise of `rig.toml` that a world can break by more scatter or a wider tolerance: its dotted path, whose last
/// key names the term, and the key of the world that breaks it.
const TERMS: [(&str, &str); 12] = [
    ("accuracy.ai_noise_lsb", "devices.ai_noise_lsb"),
    (
        "accuracy.operation_scatter_mv",
        "lot.threshold_scatter_sd_mv",
    ),
    (
        "accuracy.part_minus_track_k",
        "environment.part_minus_track_sd_k",
    ),
    ("accuracy.rtd_k", "environment.rtd_error_sd_k"),
    ("accuracy.ai_gain_pct", "devices.ai_gain_pct"),
    (
        "accuracy.ai_offset_pct_of_range",
        "devices.ai_offset_pct_of_range",
    ),
    ("accuracy.ao_gain_pct", "devices.ao_gain_pct"),
    ("accuracy.ao_offset_mv", "devices.ao_offset_mv"),
    ("accuracy.ao_slope_pct", "devices.ao_slope_pct"),
    ("accuracy.ao_refresh_ms", "devices.ao_refresh_ms"),
    ("accuracy.gate_delay_us", "board.gate_delay_us"),
    ("reference.counter_clock_tolerance_ppm", "devices.clock_ppm"),
];

/// Name of the term for the scatter between closures of a contact, and the key of the world that sets it. The recipe
/// states the scatter in percent, the world as a share (0.01 is 1 %).
const CLOSURES: (&str, &str) = ("closure_scatter_pct", "lot.closure_ln_sd");

/// A world that breaks a promise, and its lots.
struct BrokenWorld {
    name: &'static str,
    lots: Vec<Lot>,
}

/// Runs the lots of all worlds and makes the report.
///
/// # Errors
/// Fails when `rig.toml` lacks a promise, when `--term` is unknown, or when a lot cannot be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let mut worlds = Vec::new();
    for (name, key, value) in changes(order)? {
        let variant = Variant::erring(BAUDS[0], Vec::new()).in_world(vec![(key, value.into())]);
        worlds.push(BrokenWorld {
            name,
            lots: method::lots(&variant, order)?,
        });
    }
    let figures: Vec<[Figure; 2]> = worlds.iter().map(BrokenWorld::figures).collect();
    let (noticed, covered): (Vec<_>, Vec<_>) = figures.into_iter().map(|it| it.into()).unzip();
    let kept = Order {
        lots: order.kept,
        ..order.clone()
    }
    .run_all()?;
    let title = format!("lots that notice a broken promise: {}", order.about());
    let chart = Chart::of(title, "%", vec![NOTICED_PCT], &noticed);
    let groups = vec![noticed, covered, false_alarms(&kept)];
    let about = format!("{}, each promise broken by {FACTOR}", order.about());
    let notes = worlds
        .iter()
        .map(BrokenWorld::note)
        .chain(kept_notes(&kept));
    Ok(Report::new("promises", about, groups, chart).noted(notes.collect()))
}

/// Returns the change of the world for each term to study: name of the term, key of the world, value.
fn changes(order: &Order) -> anyhow::Result<Vec<(&'static str, &'static str, f64)>> {
    let rig = table(&order.config.join("rig.toml"))?;
    let mut all = Vec::new();
    for (path, world) in TERMS {
        let promised = number(&rig, path).context(path)?;
        let name = path.rsplit_once('.').map_or(path, |(_, key)| key);
        all.push((name, world, FACTOR * promised));
    }
    all.extend(closures(order));
    if let Some(wanted) = &order.term {
        let names: Vec<&str> = all.iter().map(|it| it.0).collect();
        let known = names.contains(&wanted.as_str());
        ensure!(known, "--term {wanted}: expected {}", names.join(", "));
        all.retain(|it| it.0 == wanted);
    }
    Ok(all)
}

/// Returns the change for a world whose closures scatter more than the recipe expects; `None` for a kind of part
/// without contacts.
fn closures(order: &Order) -> Option<(&'static str, &'static str, f64)> {
    match &order.recipe.device {
        DeviceRecipe::EmRelay(relay) => {
            let promised_pct = f64::from(relay.test.strategy.contact.closure_scatter_pct);
            Some((CLOSURES.0, CLOSURES.1, FACTOR * promised_pct / 100.0))
        }
        DeviceRecipe::Resistor(_) | DeviceRecipe::Ssr(_) | DeviceRecipe::Thermostat(_) => None,
    }
}

fn number(table: &Table, path: &str) -> Option<f64> {
    let (section, key) = path.split_once('.')?;
    match table.get(section)?.get(key)? {
        Value::Float(it) => Some(*it),
        Value::Integer(it) => Some(*it as f64),
        _ => None,
    }
}

impl BrokenWorld {
    /// Returns the share of lots that notice the broken promise, and the least coverage of a parameter.
    fn figures(&self) -> [Figure; 2] {
        let n = self.lots.len() as u64;
        let after: Vec<f64> = self.lots.iter().filter_map(noticed_after).collect();
        let noticed = percent(after.len() as u64, n);
        let (_, coverage) = self.least_covered();
        let is_noticed = noticed.is_some_and(|it| it >= NOTICED_PCT);
        let is_covered = coverage.is_some_and(|it| it >= COVERED_PCT);
        let share = Figure::new(format!("{} noticed", self.name), n, noticed, "%")
            .with("median_parts", median(&after));
        let covered = Figure::new(format!("{} covered", self.name), n, coverage, "%");
        [
            match is_covered && !is_noticed {
                true => share,
                false => share.bar(Bar::AtLeast(NOTICED_PCT)),
            },
            match is_noticed {
                true => covered,
                false => covered.bar(Bar::AtLeast(COVERED_PCT)),
            },
        ]
    }

    /// Returns the parameter with the least coverage over all lots, and that coverage in percent.
    fn least_covered(&self) -> (Option<Parameter>, Option<f64>) {
        let of = |parameter: &Parameter| {
            let coverage = Pooled::of(*parameter, &self.lots).coverage_pct()?;
            Some((*parameter, coverage))
        };
        let each = Parameter::ALL.iter().filter_map(of);
        each.min_by(|a, b| a.1.total_cmp(&b.1)).unzip()
    }

    /// Returns a note with the least covered parameter and the number of alarms for each promise.
    fn note(&self) -> String {
        let least = self
            .least_covered()
            .0
            .map_or("no parameter", Parameter::name);
        format!(
            "{}: covers {least} least; {}",
            self.name,
            alarms(&self.lots)
        )
    }
}

/// Returns the number of parts judged before the run noticed the broken promise; `None` when it did not.
fn noticed_after(lot: &Lot) -> Option<f64> {
    let broken = lot.summary.broken_promises.iter();
    let after = broken.map(|it| it.after_parts).min();
    let refused = (lot.summary.ended == "alarm").then_some(lot.parts.len() as u64);
    after.or(refused).map(|parts| parts as f64)
}

/// Returns, for each promise, the number of lots that found it broken, as text.
fn alarms(lots: &[Lot]) -> String {
    let mut counts: BTreeMap<&str, u64> = BTreeMap::new();
    for lot in lots {
        let broken = &lot.summary.broken_promises;
        let refused = (lot.summary.ended == "alarm").then_some("ended by an alarm");
        for it in broken.iter().map(|it| it.promise.as_str()).chain(refused) {
            *counts.entry(it).or_default() += 1;
        }
    }
    let counted = counts.iter().map(|(name, n)| format!("{name} in {n}"));
    let counted: Vec<String> = counted.collect();
    match counted.is_empty() {
        true => "no alarm".into(),
        false => counted.join(", "),
    }
}

/// Counts the lots with a false alarm; adds an upper bound of their share.
fn false_alarms(lots: &[Lot]) -> Vec<Figure> {
    let n = lots.len() as u64;
    let false_alarms = lots.iter().filter(|lot| noticed_after(lot).is_some());
    let count = false_alarms.count() as u64;
    let share = Figure::new("lots with a false alarm", n, percent(count, n), "%");
    match n {
        0 => Vec::new(),
        _ => vec![
            share
                .with("upper_bound", Some(100.0 * upper_bound(count, n)))
                .bar(Bar::AtMost(FALSE_ALARMS_PCT)),
        ],
    }
}

/// Returns the one-sided upper confidence bound (Clopper and Pearson) of a share, from `count` of `n`.
fn upper_bound(count: u64, n: u64) -> f64 {
    let beta = Beta::new(count as f64 + 1.0, n.saturating_sub(count) as f64);
    beta.map_or(1.0, |it| it.inverse_cdf(CONFIDENCE))
}

fn kept_notes(lots: &[Lot]) -> Option<String> {
    (!lots.is_empty()).then(|| format!("promises kept: {}", alarms(lots)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn upper_bound_of_no_alarm_in_600_lots() {
        assert!((upper_bound(0, 600) - 0.00498).abs() < 1e-4);
        assert!((upper_bound(1, 600) - 0.00788).abs() < 1e-4);
        assert_eq!(upper_bound(3, 3), 1.0);
    }

    #[test]
    fn a_term_needs_notice_or_coverage() {
        let unnoticed = BrokenWorld {
            name: "a",
            lots: vec![Lot::default()],
        };
        let met = unnoticed.figures().map(|figure| figure.met());
        assert_eq!(met, [Some(false), Some(false)]);
        let mut lot = Lot::default();
        lot.summary.ended = "alarm".into();
        let refused = BrokenWorld {
            name: "a",
            lots: vec![lot],
        };
        let met = refused.figures().map(|figure| figure.met());
        assert_eq!(met, [Some(true), None]);
    }
}
