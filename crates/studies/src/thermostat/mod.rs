//! `relayrig study thermostat`: passes of batches through the simulated chamber, switching temperatures against the
//! truth, and kills of the controller of a batch.
//!
//! The study connects control and estimates of the controller to the simulated chamber and to a model of parts and
//! polled contacts; it has no line and no module. Each seed draws a chamber, its sensors, a lot and its sockets. The
//! first batch of a lot measures the lag in two passes, the next one uses it in a single pass. Chain and map are
//! calibrated. A batch begins at 45 C, right after the one before, with parts at room temperature, and ends below 54 C.
//! Loading counts for parts per hour only.

mod kill;
mod rack;
mod rig;
mod score;
#[cfg(test)]
mod tests;
mod world;

use super::chart::Chart;
use super::controllers::contender::{Contender, DEFAULT};
use super::curves::Curves;
use super::figure::{Bar, Figure, mean};
use super::output::Report;
use super::pool::{self, LOTS_AT_ONCE};
use chamber::plan::Strategy;
use rack::Batch;
use rig::{Known, Outcome, Rig};
use score::{Quantity, coverage_pct, mean_k, misses, rms_k, u_k};
use world::{Kind, OTHERS, World};

/// Numbers of sockets, each with the minutes that a person needs to load them.
const SIZES: [(usize, f64); 3] = [(10, 2.0), (40, 4.0), (120, 8.0)];
/// Number of seeds in other worlds, and with other numbers of sockets.
const FEW: u64 = 10;
/// Kills of the controller of a batch.
const KILLS: u64 = 50;
/// Coverage of the stated uncertainty in the default world, and its least in other worlds, percent.
const COVERAGE: Bar = Bar::Within(93.0, 98.0);
const LEAST_COVERAGE: f64 = 93.0;
/// Bar of the mean error over all seeds, K.
const MEAN_K: f64 = 0.05;

/// A kind of part with its bars, all for batches of 40.
struct Bars {
    kind: Kind,
    rms_52_k: f64,
    rms_51_k: f64,
    rms_one_k: f64,
    /// Longest batch of two passes and of one, min; `None` for the slow kind, which has no bar.
    minutes: Option<[f64; 2]>,
    /// Least parts per hour by number of sockets, for two passes and for one; 0 for no bar.
    hourly: [[f64; 2]; 3],
}

const BARS: [Bars; 2] = [
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
/// Bar of the difference of mean results between two rates, and between two controllers, K.
const RATE_K: f64 = 0.1;
const CONTROLLER_K: f64 = 0.05;

/// Batches of one seed.
struct Lot {
    /// Passes at 5 and 2 K/min; the next field is a batch with one pass at 2 K/min that knows the lag.
    two: Outcome,
    one: Outcome,
    /// Passes at 5 and 1 K/min.
    slow: Outcome,
}

/// Runs the batches; returns the report, and the first batch of each kind as SVG.
///
/// # Errors
/// Fails when a chamber does not respond, a batch does not end, or its passes show no lag.
pub fn study(seeds: u64, sockets: usize) -> anyhow::Result<(Report, String)> {
    let mut groups = Vec::new();
    let mut curves = Vec::new();
    let mut chart = Vec::new();
    for bars in &BARS {
        let lots = lots(bars.kind, seeds, sockets)?;
        groups.push(accuracy(bars, &lots));
        groups.push(coverage(bars, &lots));
        groups.push(pace(bars, &lots, sockets)?);
        chart.extend(lots_chart(bars, &lots));
        curves.extend(
            lots.first()
                .map(|lot| (bars.kind.name.to_owned(), lot.two.curve.clone())),
        );
        groups.push(independence(bars.kind, sockets)?);
        groups.push(worlds(bars.kind, sockets)?);
    }
    groups.push(kill::figures(KILLS)?);
    let about = format!("{seeds} lots x {sockets} sockets of each kind, chain and map calibrated");
    let chart = Chart::new(
        "rms error of the operate temperature",
        "K",
        vec![0.25],
        chart,
    );
    let plot = Curves {
        title: "Reference sensor in the first batch of a lot".into(),
        x_title: "time, min".into(),
        y_title: "C".into(),
        series: curves,
    };
    Ok((Report::new("thermostat", about, groups, chart), plot.svg()))
}

/// Returns a batch with the default controller and these rates, K/min, for a learning batch and for a later one.
fn batch(number: u64, sockets: usize, learning: &[f64], known: f64) -> Batch {
    Batch {
        number,
        sockets,
        strategy: Strategy {
            learning: learning.to_vec(),
            known: vec![known],
            ..Strategy::usual()
        },
        contender: Contender::named(DEFAULT),
    }
}

fn lots(kind: Kind, seeds: u64, sockets: usize) -> anyhow::Result<Vec<Lot>> {
    let all: Vec<u64> = (1..=seeds).collect();
    pool::map(&all, LOTS_AT_ONCE, |seed| {
        let rig = Rig::new(kind, world::DEFAULT, *seed)?;
        let two = rig.batch(&batch(0, sockets, &[5.0, 2.0], 2.0), Known::RECIPE)?;
        let one = rig.batch(&batch(1, sockets, &[5.0, 2.0], 2.0), two.known)?;
        let slow = rig.batch(&batch(2, sockets, &[5.0, 1.0], 2.0), Known::RECIPE)?;
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

fn lots_chart(bars: &Bars, lots: &[Lot]) -> Vec<(String, Option<f64>)> {
    let of = |(way, outcomes): (&str, Vec<&Outcome>)| {
        let error = rms_k(&misses(outcomes, Quantity::Operate));
        (format!("{}, {way}", bars.kind.name), error)
    };
    ways(lots).map(of).into()
}

fn accuracy(bars: &Bars, lots: &[Lot]) -> Vec<Figure> {
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

fn coverage(bars: &Bars, lots: &[Lot]) -> Vec<Figure> {
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
fn pace(bars: &Bars, lots: &[Lot], sockets: usize) -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let names = ["5 then 2 K/min", "one pass at 2 K/min"];
    for ((size, loading_min), hourly) in SIZES.iter().zip(bars.hourly) {
        let few;
        let lots = if *size == sockets {
            lots
        } else {
            few = self::lots(bars.kind, FEW, *size)?;
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

/// Compares the results of the same parts between rates, and between controllers.
fn independence(kind: Kind, sockets: usize) -> anyhow::Result<Vec<Figure>> {
    let seeds: Vec<u64> = (1..=FEW).collect();
    let found = pool::map(&seeds, LOTS_AT_ONCE, |seed| {
        let rig = Rig::new(kind, world::DEFAULT, *seed)?;
        let usual = batch(0, sockets, &[5.0, 2.0], 2.0);
        let two = |name| {
            let contender = Contender::named(name);
            rig.batch(
                &Batch {
                    contender,
                    ..usual.clone()
                },
                Known::RECIPE,
            )
        };
        let (pid, fuzzy, scheduled) = (
            two(DEFAULT)?,
            two("fuzzy furnace + FF")?,
            two("fuzzy-PID even + FF")?,
        );
        let one = |rate| rig.batch(&batch(1, sockets, &[5.0, 2.0], rate), pid.known);
        let (fast, slow) = (one(3.0)?, one(1.0)?);
        let off = |a: &Outcome, b: &Outcome| {
            Quantity::ALL.map(|quantity| {
                let [a, b] = [a, b].map(|it| mean_k(&misses([it], quantity)).unwrap_or(f64::NAN));
                a - b
            })
        };
        Ok([off(&fast, &slow), off(&fuzzy, &pid), off(&scheduled, &pid)])
    })?;
    let names = [
        ("3 less 1 K/min", RATE_K),
        ("fuzzy furnace + FF less PID + FF", CONTROLLER_K),
        ("fuzzy-PID even + FF less PID + FF", CONTROLLER_K),
    ];
    let figure = |(which, (name, bar)): (usize, (&str, f64))| {
        let found = &found;
        let one = move |(place, quantity): (usize, Quantity)| {
            let off = mean(found.iter().map(|it| it[which][place]));
            let name = format!("{}, {}, {name}", kind.name, quantity.name());
            Figure::new(name, FEW, off, "K").bar(Bar::Within(-bar, bar))
        };
        Quantity::ALL
            .into_iter()
            .enumerate()
            .map(one)
            .collect::<Vec<_>>()
    };
    Ok(names.into_iter().enumerate().flat_map(figure).collect())
}

/// Runs two passes and one in other worlds.
fn worlds(kind: Kind, sockets: usize) -> anyhow::Result<Vec<Figure>> {
    let all: Vec<(World, u64)> = OTHERS
        .iter()
        .flat_map(|world| (1..=FEW).map(|seed| (*world, seed)))
        .collect();
    let found = pool::map(&all, LOTS_AT_ONCE, |(world, seed)| {
        let rig = Rig::new(kind, *world, *seed)?;
        let two = rig.batch(&batch(0, sockets, &[5.0, 2.0], 2.0), Known::RECIPE)?;
        let one = rig.batch(&batch(1, sockets, &[5.0, 2.0], 2.0), two.known)?;
        Ok([two, one])
    })?;
    let mut figures = Vec::new();
    for (world, lots) in OTHERS.iter().zip(found.chunks(all.len() / OTHERS.len())) {
        for (which, way) in ["5 then 2", "one pass at 2"].iter().enumerate() {
            let name = format!("{}, {}, {way} K/min, coverage", kind.name, world.name);
            let outcomes: Vec<&Outcome> = lots.iter().map(|it| &it[which]).collect();
            figures.push(elsewhere(name, &outcomes));
        }
    }
    Ok(figures)
}

/// Returns the coverage of the operate temperature in another world, with error and minutes.
fn elsewhere(name: String, outcomes: &[&Outcome]) -> Figure {
    let all = misses(outcomes.iter().copied(), Quantity::Operate);
    Figure::new(name, all.len() as u64, coverage_pct(&all), "%")
        .with("rms_k", rms_k(&all))
        .with("mean_k", mean_k(&all))
        .with("U_k", u_k(&all))
        .with("min", mean(outcomes.iter().map(|it| it.minutes)))
        .bar(Bar::AtLeast(LEAST_COVERAGE))
}
