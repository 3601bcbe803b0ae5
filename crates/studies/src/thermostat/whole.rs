//! Whole batches by the program on the simulated rig. Shows whether the stated uncertainties cover the truth, whether
//! the verdicts are right, how long a batch takes on this computer, and whether a slow bus changes anything.

use super::Scope;
use super::program::{Change, Lot, Ran, run};
use crate::figure::{Bar, Figure, mean, percent, rms};
use crate::pool::{self, LOTS_AT_ONCE};
use crate::storm::life::End;
use app::exit::Exit;

/// Recipes, with their names in reports.
const RECIPES: [(&str, &str); 2] = [
    ("thermostat-ksd9700", "KSD9700"),
    ("thermostat-ksd301", "KSD301"),
];
/// Latencies of the bus, ms, beside the usual one. The configuration refuses a slower bus, on which the emergency stop
/// would take more than 2 s.
const LATENCIES_MS: [f64; 3] = [5.0, 20.0, 50.0];
/// Lots of each kind.
const LOTS: u64 = 6;
/// Parts of a lot: one batch.
const PARTS: u64 = 40;
/// Keys of the temperatures.
const KEYS: [&str; 3] = [
    "operate_temperature_c",
    "reset_temperature_c",
    "differential_k",
];
/// Least coverage of some hundred values, percent: if U covers 95 % of all values, a sample falls below this once in a
/// hundred times.
const COVERED: f64 = 91.0;
/// Longest wall time of a batch on a quiet machine, s.
const WALL_S: f64 = 10.0;

/// Returns the figures of all lots.
///
/// # Errors
/// Fails when the rig cannot be built, or its configuration does not load.
pub fn figures(scope: &Scope) -> anyhow::Result<Vec<Vec<Figure>>> {
    let mut groups = Vec::new();
    for (recipe, name) in RECIPES {
        let worlds = std::iter::once(None).chain(LATENCIES_MS.map(Some));
        for latency_ms in worlds {
            let usual = if latency_ms.is_none() { LOTS } else { LOTS / 2 };
            let seeds: Vec<u64> = (1..=scope.of(usual)).collect();
            let lots = pool::map(&seeds, LOTS_AT_ONCE, |seed| {
                run(&lot(recipe, *seed, latency_ms))
            })?;
            let about = latency_ms.map_or(name.to_owned(), |it| format!("{name}, bus {it} ms"));
            groups.push(group(&about, &lots));
        }
    }
    groups.push(vec![wall()?]);
    Ok(groups)
}

/// Returns a lot. On a bus that is slower than usual, the configuration allows the modules more time.
fn lot(recipe: &'static str, seed: u64, latency_ms: Option<f64>) -> Lot {
    let changes = latency_ms.map(|it| {
        let change = |file, from, to| Change { file, from, to };
        let allowed = |name: &str, usual: f64| format!("{name} = {}", usual + 1.5 * it);
        vec![
            change(
                "sim.toml",
                "latency_ms_mean = 2.0",
                format!("latency_ms_mean = {it:.1}"),
            ),
            change(
                "rig.toml",
                "estop_reaction_ms = 900",
                allowed("estop_reaction_ms", 900.0 + 20.0 * it),
            ),
            change(
                "rig.toml",
                "digital_allowance_ms = 30",
                allowed("digital_allowance_ms", 30.0),
            ),
            change(
                "rig.toml",
                "analog_allowance_ms = 60",
                allowed("analog_allowance_ms", 60.0),
            ),
        ]
    });
    Lot {
        recipe,
        parts: PARTS,
        seed,
        faults: Vec::new(),
        changes: changes.unwrap_or_default(),
    }
}

/// Returns error and expanded uncertainty of the value `key` for every good part that has this value.
fn errors(lots: &[Ran], key: &str) -> Vec<(f64, f64)> {
    let of = |lot: &Ran| {
        let good = lot.parts.iter().filter(|it| lot.is_good(it));
        let one = good.filter_map(|part| {
            let error = part.values.get(key)?.as_f64()? - lot.truth_of(part)?[key].as_f64()?;
            Some((error, part.uncertainty.get(key)?.as_f64()?))
        });
        one.collect::<Vec<_>>()
    };
    lots.iter().flat_map(of).collect()
}

fn group(about: &str, lots: &[Ran]) -> Vec<Figure> {
    let mut figures: Vec<Figure> = KEYS.map(|key| covered(about, lots, key)).into();
    let n = lots.len() as u64;
    let ended = lots.iter().filter(|it| it.end == End::Exit(Exit::Done));
    figures.push(Figure::none(
        format!("{about}, lots that did not end well"),
        n,
        n - ended.count() as u64,
    ));
    figures.extend(verdicts(about, lots));
    figures
}

fn covered(about: &str, lots: &[Ran], key: &str) -> Figure {
    let all = errors(lots, key);
    let covered = all.iter().filter(|(error, u)| error.abs() <= *u).count();
    let name = format!("{about}, {key}, coverage");
    let share = percent(covered as u64, all.len() as u64);
    Figure::new(name, all.len() as u64, share, "%")
        .with("rms_k", rms(all.iter().map(|it| it.0)))
        .with("mean_k", mean(all.iter().map(|it| it.0)))
        .with("U_k", mean(all.iter().map(|it| it.1)))
        .with("min", mean(lots.iter().map(|it| it.minutes)))
        .bar(Bar::AtLeast(COVERED))
}

/// Returns three counts: good parts that failed beyond their guard band, defective parts that passed, EEPROM writes.
fn verdicts(about: &str, lots: &[Ran]) -> [Figure; 3] {
    let (mut good, mut wrong, mut defects, mut missed) = (0, 0, 0, 0);
    for lot in lots {
        for part in &lot.parts {
            let near = |it: &String| it.ends_with("not proven");
            if lot.is_good(part) {
                good += 1;
                let is_wrong = part.verdict != "pass" && !part.reasons.iter().all(near);
                wrong += u64::from(is_wrong);
            } else {
                defects += 1;
                missed += u64::from(part.verdict == "pass");
            }
        }
    }
    let writes = lots.iter().map(|it| it.eeprom_writes).sum();
    [
        Figure::none(format!("{about}, good parts failed beyond U"), good, wrong),
        Figure::none(format!("{about}, defective parts passed"), defects, missed),
        Figure::none(format!("{about}, EEPROM writes"), lots.len() as u64, writes),
    ]
}

/// Returns the wall time of a batch that runs alone.
fn wall() -> anyhow::Result<Figure> {
    let ran = run(&lot(RECIPES[0].0, 1, None))?;
    let name = "batch of 40 in virtual time, wall time of this computer";
    let figure = Figure::new(name, 1, Some(ran.wall_s), "s").with("min", Some(ran.minutes));
    Ok(figure.bar(Bar::AtMost(WALL_S)))
}
