//! Shows that results do not depend on rate and controller, and that the uncertainty covers the truth in other worlds.

use super::rack::Batch;
use super::rig::{Outcome, Rig};
use super::score::{Quantity, coverage_pct, mean_k, misses, rms_k, u_k};
use super::world::{self, Kind, OTHERS, World};
use super::{FEW, LEAST_COVERAGE, Scope, batch};
use crate::figure::{Bar, Figure, mean};
use crate::pool::{self, LOTS_AT_ONCE};
use machine::dut::thermostat::recipe::Control;

/// Bar of the difference between the mean results at two rates, K.
const RATE_K: f64 = 0.1;
/// Bar of the difference between the mean results with two controllers, K.
const CONTROLLER_K: f64 = 0.05;

/// Compares the results of the same parts at different rates, and with different controllers.
///
/// # Errors
/// Fails when a chamber does not respond, or the machine ends a batch early.
pub fn independence(kind: Kind, scope: &Scope) -> anyhow::Result<Vec<Figure>> {
    let (few, sockets) = (scope.of(FEW), scope.sockets);
    let seeds: Vec<u64> = (1..=few).collect();
    let found = pool::map(&seeds, LOTS_AT_ONCE, |seed| {
        let rig = Rig::new(kind, world::DEFAULT, *seed)?;
        let two = |control| {
            let usual = batch(0, sockets, [5.0, 2.0]);
            rig.batch(&Batch { control, ..usual }, None)
        };
        let (pid, fuzzy, scheduled) = (
            two(Control::Pid)?,
            two(Control::Fuzzy)?,
            two(Control::FuzzyPid)?,
        );
        let one = |rate| rig.batch(&batch(1, sockets, [5.0, rate]), Some(&pid));
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
            Figure::new(name, few, off, "K").bar(Bar::Within(-bar, bar))
        };
        Quantity::ALL
            .into_iter()
            .enumerate()
            .map(one)
            .collect::<Vec<_>>()
    };
    Ok(names.into_iter().enumerate().flat_map(figure).collect())
}

/// Runs a batch of two passes and a batch of one pass in each of the other worlds.
///
/// # Errors
/// Fails as [`independence`] does.
pub fn worlds(kind: Kind, scope: &Scope) -> anyhow::Result<Vec<Figure>> {
    let (few, sockets) = (scope.of(FEW), scope.sockets);
    let all: Vec<(World, u64)> = OTHERS
        .iter()
        .flat_map(|world| (1..=few).map(|seed| (*world, seed)))
        .collect();
    let found = pool::map(&all, LOTS_AT_ONCE, |(world, seed)| {
        let rig = Rig::new(kind, *world, *seed)?;
        let two = rig.batch(&batch(0, sockets, [5.0, 2.0]), None)?;
        let one = rig.batch(&batch(1, sockets, [5.0, 2.0]), Some(&two))?;
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

/// Returns the least coverage of the three quantities in another world. Further columns have the coverage of each
/// quantity, the error and the minutes.
fn elsewhere(name: String, outcomes: &[&Outcome]) -> Figure {
    let of = |quantity| misses(outcomes.iter().copied(), quantity);
    let [operate, reset, differential] = Quantity::ALL.map(|it| coverage_pct(&of(it)));
    let least = [operate, reset, differential]
        .into_iter()
        .flatten()
        .reduce(f64::min);
    let all = of(Quantity::Operate);
    Figure::new(name, all.len() as u64, least, "%")
        .with("operate", operate)
        .with("reset", reset)
        .with("differential", differential)
        .with("rms_k", rms_k(&all))
        .with("mean_k", mean_k(&all))
        .with("U_k", u_k(&all))
        .with("min", mean(outcomes.iter().map(|it| it.minutes)))
        .bar(Bar::AtLeast(LEAST_COVERAGE))
}
