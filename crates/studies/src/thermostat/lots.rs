//! Batches of a lot in the default world, of two passes and of one: errors, coverage, minutes and parts per hour.

use super::batch;
use super::rig::{Outcome, Rig};
use super::score::{Quantity, coverage_pct, mean_k, misses, rms_k, u_k};
use super::world::{DEFAULT, Kind};
use super::{FEW, Scope};
use crate::figure::{Bar, Figure, mean};
use crate::pool::{self, LOTS_AT_ONCE};

/// Numbers of sockets, each with the minutes that a person needs to load that many.
const SIZES: [(usize, f64); 3] = [(10, 2.0), (40, 4.0), (120, 8.0)];
/// Bar of the coverage of the stated uncertainty in the default world, percent.
const COVERAGE: Bar = Bar::Within(93.0, 98.0);
/// Bar of the mean error over all seeds, K.
const MEAN_K: f64 = 0.05;

/// A kind of part with its bars. Those of errors and minutes hold for batches of 40.
pub struct Bars {
    pub kind: Kind,
    rms_52_k: f64,
    rms_51_k: f64,
    rms_one_k: f64,
    /// Greatest permitted time of a batch of two passes and of one, min; `None` for the slow kind, which has no bar.
    minutes: Option<[f64; 2]>,
    /// Least parts per hour by number of sockets, for two passes and for one; 0 for no bar.
    hourly: [[f64; 2]; 3],
}

/// Both kinds of parts.
pub const BARS: [Bars; 2] = [
    Bars {
        kind: Kind::KSD9700,
        rms_52_k: 0.25,
        rms_51_k: 0.22,
        rms_one_k: 0.32,
        minutes: Some([45.0, 30.0]),
        hourly: [[0.0, 0.0], [48.0, 70.0], [135.0, 190.0]],
    },
    Bars {
        kind: Kind::KSD301,
        rms_52_k: 0.36,
        rms_51_k: 0.24,
        rms_one_k: 0.70,
        minutes: None,
        hourly: [[0.0; 2]; 3],
    },
];
/// Bar of the rms error of the differential after passes at 5 and 1 K/min, K.
const DIFFERENTIAL_K: f64 = 0.32;

/// Batches of one seed.
pub struct Lot {
    /// Batch with two temperature passes, at 5 and then 2 K/min.
    pub two: Outcome,
    /// Batch with one pass at 2 K/min, which uses the lag learned in [`Lot::two`].
    one: Outcome,
    /// Batch with two passes, at 5 and then 1 K/min.
    slow: Outcome,
}

/// Runs the batches of all seeds.
///
/// # Errors
/// Fails when a chamber does not respond, or the machine ends a batch early.
pub fn lots(kind: Kind, seeds: u64, sockets: usize) -> anyhow::Result<Vec<Lot>> {
    let all: Vec<u64> = (1..=seeds).collect();
    pool::map(&all, LOTS_AT_ONCE, |seed| {
        let rig = Rig::new(kind, DEFAULT, *seed)?;
        let two = rig.batch(&batch(0, sockets, [5.0, 2.0]), None)?;
        let one = rig.batch(&batch(1, sockets, [5.0, 2.0]), Some(&two))?;
        let slow = rig.batch(&batch(2, sockets, [5.0, 1.0]), None)?;
        Ok(Lot { two, one, slow })
    })
}

/// Ways to run a batch, with their outcomes.
fn ways(lots: &[Lot]) -> [(&'static str, Vec<&Outcome>); 3] {
    [
        ("5 then 2 K/min", lots.iter().map(|it| &it.two).collect()),
        ("5 then 1 K/min", lots.iter().map(|it| &it.slow).collect()),
        (
            "one pass at 2 K/min",
            lots.iter().map(|it| &it.one).collect(),
        ),
    ]
}

/// Returns the rms error of each way, for the chart of the report.
pub fn chart(bars: &Bars, lots: &[Lot]) -> Vec<(String, Option<f64>)> {
    let of = |(way, outcomes): (&str, Vec<&Outcome>)| {
        let error = rms_k(&misses(outcomes, Quantity::Operate));
        (format!("{}, {way}", bars.kind.name), error)
    };
    ways(lots).map(of).into()
}

/// Returns rms and mean of the errors.
pub fn accuracy(bars: &Bars, lots: &[Lot]) -> Vec<Figure> {
    let limits = [bars.rms_52_k, bars.rms_51_k, bars.rms_one_k];
    let mut figures = Vec::new();
    for ((way, outcomes), limit) in ways(lots).into_iter().zip(limits) {
        for quantity in Quantity::ALL {
            let all = misses(outcomes.iter().copied(), quantity);
            let (name, n) = (
                format!("{}, {way}, {}", bars.kind.name, quantity.name()),
                all.len() as u64,
            );
            let error = Figure::new(name.clone(), n, rms_k(&all), "K").with("U", u_k(&all));
            let slow = way == "5 then 1 K/min";
            figures.push(match quantity {
                Quantity::Operate => error.bar(Bar::AtMost(limit)),
                Quantity::Differential if slow => error.bar(Bar::AtMost(DIFFERENTIAL_K)),
                Quantity::Reset | Quantity::Differential => error,
            });
            let mean = Figure::new(format!("{name}, mean error"), n, mean_k(&all), "K");
            figures.push(mean.bar(Bar::Within(-MEAN_K, MEAN_K)));
        }
    }
    figures
}

/// Returns how often the stated uncertainty covers the truth.
pub fn coverage(bars: &Bars, lots: &[Lot]) -> Vec<Figure> {
    let one = |(way, outcomes): (&str, Vec<&Outcome>)| {
        Quantity::ALL.map(|quantity| {
            let all = misses(outcomes.iter().copied(), quantity);
            let name = format!("{}, {way}, {}, coverage", bars.kind.name, quantity.name());
            Figure::new(name, all.len() as u64, coverage_pct(&all), "%").bar(COVERAGE)
        })
    };
    ways(lots).into_iter().flat_map(one).collect()
}

/// Returns minutes per batch and parts per hour, for two passes and for one.
///
/// # Errors
/// Fails as [`lots`] does.
pub fn pace(bars: &Bars, lots: &[Lot], scope: &Scope) -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let names = ["5 then 2 K/min", "one pass at 2 K/min"];
    for ((size, loading_min), hourly) in SIZES.iter().zip(bars.hourly) {
        let few;
        let lots = if *size == scope.sockets {
            lots
        } else {
            few = self::lots(bars.kind, scope.of(FEW), *size)?;
            &few
        };
        let minutes = [
            mean(lots.iter().map(|it| it.two.minutes)),
            mean(lots.iter().map(|it| it.one.minutes)),
        ];
        for (which, (way, bar)) in names.iter().zip(hourly).enumerate() {
            let about = format!("{}, {size} sockets, {way}", bars.kind.name);
            let n = lots.len() as u64;
            let figure = Figure::new(format!("{about}, batch"), n, minutes[which], "min");
            let longest = bars
                .minutes
                .filter(|_| *size == 40)
                .map(|it| Bar::AtMost(it[which]));
            figures.push(longest.map_or(figure.clone(), |bar| figure.bar(bar)));
            let parts = minutes[which].map(|it| 60.0 * *size as f64 / (it + loading_min));
            let figure = Figure::new(format!("{about}, parts"), n, parts, "1/h");
            figures.push(if bar > 0.0 {
                figure.bar(Bar::AtLeast(bar))
            } else {
                figure
            });
        }
    }
    Ok(figures)
}
