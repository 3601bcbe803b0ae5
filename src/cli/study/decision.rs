//! False accepts and false rejects: counted against the truth, and as the rule predicts them.
//!
//! Predicted from what the rows say: a parameter's good parts are taken as normal with the mean and standard
//! deviation of their values (less the variance of measurement), the measurement as normal with the stated
//! uncertainty. With a guard band `w` a part is accepted when its value lies inside the limit by `w`; the
//! chances are integrated over the process (JCGM 106:2012, 9.5). Within the guard band a part is measured
//! again, so a reject predicted for one measurement is an upper end.

use super::bins;
use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::fleet::Order;
use super::lot::{Lot, Reading};
use super::output::Report;
use crate::gauge::Parameter;
use crate::quality::Spread;
use statrs::distribution::{ContinuousCDF, Normal};
use std::ops::RangeInclusive;

/// Steps of the integral over +-8 standard deviations of the process.
const STEPS: u32 = 40_000;
/// Parts per million.
const PPM: f64 = 1e6;

/// A process and a measurement, in the unit of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chance {
    /// Mean of the true values.
    pub mean: f64,
    /// Their standard deviation.
    pub sd: f64,
    /// Standard uncertainty of one measurement.
    pub u: f64,
}

impl Chance {
    /// Chances of a false accept and of a false reject, with the limits moved inwards by `guard`.
    ///
    /// `None` where a spread is not positive.
    pub fn of(&self, limits: &RangeInclusive<f64>, guard: f64) -> Option<(f64, f64)> {
        let process = Normal::new(self.mean, self.sd).ok()?;
        let noise = Normal::new(0.0, self.u).ok()?;
        let width = 16.0 * self.sd / f64::from(STEPS);
        let (mut accept, mut reject) = (0.0, 0.0);
        for step in 0..STEPS {
            let from = self.mean - 8.0 * self.sd + width * f64::from(step);
            let (truth, share) = (
                from + width / 2.0,
                process.cdf(from + width) - process.cdf(from),
            );
            let taken =
                noise.cdf(limits.end() - guard - truth) - noise.cdf(limits.start() + guard - truth);
            if limits.contains(&truth) {
                reject += share * (1.0 - taken);
            } else {
                accept += share * taken.max(0.0);
            }
        }
        Some((accept, reject))
    }
}

/// Runs the lots and draws the report up.
///
/// # Errors
/// A lot that could not be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let lots = order.run_all()?;
    let rows: Vec<Figure> = order
        .admitted
        .iter()
        .map(|(parameter, limits)| predicted(*parameter, limits, &lots))
        .collect();
    let chart = Chart {
        title: format!(
            "rejects of good parts that the rule predicts: {}",
            order.about()
        ),
        unit: "ppm",
        from: 0.0,
        marks: Vec::new(),
        bars: rows
            .iter()
            .map(|row| (row.name.clone(), row.value))
            .collect(),
    };
    let expected: f64 = rows.iter().filter_map(|row| row.value).sum();
    Ok(Report {
        study: "decision",
        about: order.about(),
        groups: vec![rows, counted(&lots, expected), bins::outcome(&lots)],
        notes: Vec::new(),
        chart,
    })
}

/// What the rule predicts of one parameter, parts per million; beside it, without a guard band.
fn predicted(parameter: Parameter, limits: &RangeInclusive<f64>, lots: &[Lot]) -> Figure {
    let readings: Vec<Reading> = lots
        .iter()
        .flat_map(Lot::good)
        .filter_map(|part| part.reading(parameter))
        .collect();
    let values = Spread::of(&readings.iter().map(|it| it.value).collect::<Vec<f64>>());
    let u = Spread::of(
        &readings
            .iter()
            .filter_map(|it| it.uncertainty)
            .collect::<Vec<f64>>(),
    );
    let chance = values
        .mean()
        .zip(values.sd())
        .zip(u.mean())
        .map(|((mean, sd), expanded)| {
            let u = expanded / 2.0;
            Chance {
                mean,
                sd: (sd * sd - u * u).max(sd * sd * 0.01).sqrt(),
                u,
            }
        });
    let with = |guard: f64| chance.and_then(|it| it.of(limits, guard * 2.0 * it.u));
    let ppm = |chance: Option<f64>| chance.map(|it| it * PPM);
    Figure::new(
        parameter.name(),
        readings.len() as u64,
        ppm(with(1.0).map(|it| it.1)),
        "ppm",
    )
    .with("false_accept", ppm(with(1.0).map(|it| it.0)))
    .with("unguarded_reject", ppm(with(0.0).map(|it| it.1)))
    .with("unguarded_accept", ppm(with(0.0).map(|it| it.0)))
}

/// What happened, over good and bad parts alike.
fn counted(lots: &[Lot], expected_ppm: f64) -> Vec<Figure> {
    let all = || lots.iter().flat_map(|lot| &lot.parts);
    let n = all().count() as u64;
    let accepted = all()
        .filter(|part| !part.deserves_to_pass() && bins::has_passed(part))
        .count();
    let rejected = all()
        .filter(|part| part.deserves_to_pass() && part.verdict == "fail")
        .count();
    let expected = expected_ppm / PPM * n as f64;
    let allowed = (expected + 3.0 * expected.sqrt()).floor() + 1.0;
    vec![
        Figure::count("false accepts, counted", n, Some(accepted as u64)).bar(Bar::AtMost(0.0)),
        Figure::count("false rejects, counted", n, Some(rejected as u64))
            .with("predicted", Some(expected))
            .bar(Bar::AtMost(allowed)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ppm(chance: Chance, limit: f64, guard: f64) -> (f64, f64) {
        let (accept, reject) = chance
            .of(&(f64::NEG_INFINITY..=limit), guard)
            .expect("a process with a spread");
        (accept * PPM, reject * PPM)
    }

    #[test]
    fn a_pickup_process_of_7_88_v_has_the_risks_of_the_tables() {
        let of = |u| Chance {
            mean: 7.88,
            sd: 0.30,
            u,
        };
        let (accept, reject) = ppm(of(0.020), 9.0, 0.0);
        assert!(
            (accept - 8.60).abs() < 0.1 && (reject - 11.8).abs() < 0.1,
            "{accept} {reject}"
        );
        let (accept, reject) = ppm(of(0.050), 9.0, 0.100);
        assert!(
            (accept - 0.44).abs() < 0.02 && (reject - 305.0).abs() < 3.0,
            "{accept} {reject}"
        );
    }

    #[test]
    fn without_a_spread_there_is_no_chance() {
        let none = Chance {
            mean: 1.0,
            sd: 0.0,
            u: 0.1,
        };
        assert_eq!(none.of(&(0.0..=2.0), 0.0), None);
    }
}
