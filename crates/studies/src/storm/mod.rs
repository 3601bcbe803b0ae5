//! The storm: short lots under random faults of world and line, random orders of an operator, and kills of the
//! controller, in virtual time, in this process.
//!
//! A seed is one rig under several lives of the controller; a life lasts from start to end of the program. `scenario`
//! draws the faults and their instants, `life` runs the program as `run` does and kills it, `operator` gives orders. When
//! all faults are over, the controller starts again, up to [`CALM`] times, and must complete a lot. Then `judge` compares
//! the truth of the rig with the history.
//!
//! The report shows each seed that breaks a rule with the broken rules, the last lines of its trace and the command that
//! reproduces it: the same seed gives the same trace, bit for bit.

mod judge;
mod life;
mod operator;
mod scenario;
mod trace;

use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::order::Order;
use super::output::Report;
use super::pool;
use anyhow::Context;
use app::exit::Exit;
use config::{Plant, load_recipe};
use history::{Archive, Filter};
use judge::Case;
use life::{End, Runner};
use machine::dut::Calibration;
use machine::dut::Recipe;
use rigsim::{Options, SharedRig};
use scenario::{CEASES_US, Life, RIGS, Scenario};
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Instant;
use tempfile::TempDir;
use tracing::subscriber::{NoSubscriber, with_default};
use units::Span;

/// Starts after the faults, of which one must complete its lot; the first may have to discharge parts.
const CALM: u64 = 3;
/// Parts of a lot without faults.
const CALM_PARTS: u64 = 2;
/// Most seeds that the report shows; the figures count all of them.
const SHOWN: usize = 10;

/// Result of one seed: counts, and the trace only of a seed that breaks a rule, since a case is large.
struct Outcome {
    seed: u64,
    counts: Counts,
    violations: Vec<String>,
    faults: Vec<String>,
    trace: Vec<String>,
    digest: u64,
}

/// Size of a case.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    lives: u64,
    kills: u64,
    completed: u64,
    bodies: u64,
    rows: u64,
    alarms: u64,
    orders: u64,
    motions: u64,
    rig_us: u64,
}

impl Counts {
    fn of(case: &Case) -> Self {
        let ended = |end: &End| case.lives.iter().filter(|it| it.end == *end).count() as u64;
        Self {
            lives: case.lives.len() as u64,
            kills: ended(&End::Killed),
            completed: ended(&End::Exit(Exit::Done)),
            bodies: case.bodies.len() as u64,
            rows: case.rows.len() as u64,
            alarms: case.alarms.len() as u64,
            orders: case.lives.iter().map(|it| it.answers.len() as u64).sum(),
            motions: case.driven.len() as u64,
            rig_us: case.lives.last().map_or(0, |life| life.ended_us),
        }
    }
}

/// Inputs of all seeds.
struct Storm<'a> {
    order: &'a Order,
    plant: Plant,
    recipe: Arc<Recipe>,
    folder: TempDir,
    calibrations: [OnceLock<Calibration>; RIGS as usize],
}

/// Runs the seeds of the order and makes the report.
///
/// # Errors
/// A file that cannot be read or written, or a rig that cannot be built.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let began = Instant::now();
    let storm = Storm::new(order)?;
    let seeds: Vec<u64> = match order.seed {
        Some(seed) => vec![seed],
        None => (order.from..).take(order.lots as usize).collect(),
    };
    let outcomes = storm.all(&seeds)?;
    let minutes = began.elapsed().as_secs_f64() / 60.0;
    Ok(report(order, &outcomes, minutes))
}

impl<'a> Storm<'a> {
    fn new(order: &'a Order) -> anyhow::Result<Self> {
        let folder = TempDir::new()?;
        std::fs::write(folder.path().join("world.toml"), scenario::WORLD)?;
        Ok(Self {
            order,
            plant: Plant::load(&order.config)?,
            recipe: Arc::new(load_recipe(&order.config, &order.recipe)?),
            folder,
            calibrations: Default::default(),
        })
    }

    /// Runs every seed, on all cores.
    fn all(&self, seeds: &[u64]) -> anyhow::Result<Vec<Outcome>> {
        // The report counts the alarms of a storm: a log line for each would bury it.
        let quiet = |seed| with_default(NoSubscriber::new(), || self.one(seed));
        pool::map(seeds, pool::cores(), |seed| {
            quiet(*seed).with_context(|| format!("seed {seed}"))
        })
    }

    fn one(&self, seed: u64) -> anyhow::Result<Outcome> {
        let folder = self.folder.path().join(seed.to_string());
        std::fs::create_dir(&folder)?;
        let case = self.case(seed, &folder.join("history.db"))?;
        std::fs::remove_dir_all(&folder)?;
        let (violations, trace) = (case.violations(), trace::lines(&case));
        let digest = trace::digest(&trace);
        let is_shown = !violations.is_empty() || self.order.seed.is_some();
        Ok(Outcome {
            seed,
            counts: Counts::of(&case),
            faults: case.faults,
            trace: if is_shown { trace } else { Vec::new() },
            violations,
            digest,
        })
    }

    /// Runs all lives of a seed.
    fn case(&self, seed: u64, db: &Path) -> anyhow::Result<Case> {
        let scenario = Scenario::of(seed, self.order.parts, &self.plant.wiring);
        let rig = self.rig(scenario.rig, scenario.uncalibrated, &scenario.faults)?;
        let runner = self.runner(&rig, db);
        let mut calibration = match scenario.uncalibrated {
            true => None,
            false => Some(self.calibration(scenario.rig, db)?),
        };
        let mut operator_dice = scenario.operator_dice.clone();
        let mut lives = Vec::new();
        for life in &scenario.lives {
            let lot = format!("life-{}", lives.len() + 1);
            lives.push(runner.run_life(&lot, life, calibration.clone(), operator_dice.apart())?);
        }
        if calibration.is_none() {
            calibration = Some(self.calibration(scenario.rig, db)?);
        }
        rig.cancel_faults();
        for n in 1..=CALM {
            let pause_us = CEASES_US.saturating_sub(rig.now_us()) + 1_000_000;
            let life = Life {
                count: CALM_PARTS,
                attended: false,
                killed_after_us: None,
                pause_us,
            };
            let lot = format!("calm-{n}");
            lives.push(runner.run_life(&lot, &life, calibration.clone(), operator_dice.apart())?);
            let last = lives.last();
            if last.is_some_and(|life| life.end == End::Exit(Exit::Done)) {
                break;
            }
        }
        self.judged(&scenario, &rig, lives, db)
    }

    fn judged(
        &self,
        scenario: &Scenario,
        rig: &SharedRig,
        lives: Vec<life::EndedLife>,
        db: &Path,
    ) -> anyhow::Result<Case> {
        let archive = Archive::open(db)?;
        let all = Filter {
            kind: Some("all".into()),
            ..Filter::default()
        };
        let wiring = &self.plant.wiring;
        let reaction = wiring.longest_reaction();
        let watchdog = Span::ms(wiring.bus.host_watchdog_ms as u64);
        let limits = self.order.admitted.iter();
        Ok(Case {
            lives,
            bodies: rig.bodies(),
            driven: rig.motion_starts(),
            touched: rig.crashes(),
            overdrives: rig.overdrives(),
            rows: archive.query(&all)?,
            alarms: archive.alarms(&Filter::default())?,
            limits: limits
                .map(|(key, range)| (key.name(), *range.start(), *range.end()))
                .collect(),
            faults: scenario.faults.clone(),
            disturbed_us: scenario.disturbed_us.clone(),
            reaction,
            reaction_in_trouble: reaction + watchdog + watchdog,
            lines_disturbed: scenario.lines_disturbed,
        })
    }

    fn runner<'b>(&'b self, rig: &'b SharedRig, db: &'b Path) -> Runner<'b> {
        Runner {
            plant: &self.plant,
            recipe: &self.recipe,
            db,
            rig,
        }
    }

    fn rig(&self, seed: u64, golden: bool, faults: &[String]) -> anyhow::Result<SharedRig> {
        let storms = self.folder.path().join("world.toml");
        Ok(rigsim::build(&Options {
            config_dir: self.order.config.clone(),
            world: Some(self.order.world.clone().unwrap_or(storms)),
            seed,
            recipe: self.order.recipe.clone(),
            parts: None,
            reference_parts: golden,
            faults: faults.to_vec(),
        })?)
    }

    /// Returns the calibration of a rig without faults, from the first seed that needed it.
    fn calibration(&self, rig: u64, db: &Path) -> anyhow::Result<Calibration> {
        let place = usize::try_from(rig % RIGS)?;
        if let Some(known) = self.calibrations[place].get() {
            return Ok(known.clone());
        }
        let calm = self.rig(rig, true, &[])?;
        let apart = db.with_file_name("calibration.db");
        let found = self.runner(&calm, &apart).calibrated()?;
        Ok(self.calibrations[place].get_or_init(|| found).clone())
    }
}

fn report(order: &Order, outcomes: &[Outcome], minutes: f64) -> Report {
    let n = outcomes.len() as u64;
    let violations = outcomes
        .iter()
        .filter(|it| !it.violations.is_empty())
        .count() as u64;
    let sum = |of: fn(&Counts) -> u64| outcomes.iter().map(|it| of(&it.counts)).sum::<u64>();
    let hours = sum(|it| it.rig_us) as f64 / 3.6e9;
    let lives = sum(|it| it.lives);
    let about = |name: &str, of: u64, count: u64| Figure::count(name, of, Some(count));
    let rule = Figure::count("seeds that broke a rule", n, Some(violations));
    let counts = vec![
        about("kills of the controller", lives, sum(|it| it.kills)),
        about("lots completed", lives, sum(|it| it.completed)),
        about("bodies", n, sum(|it| it.bodies)),
        about("rows", n, sum(|it| it.rows)),
        about("alarms", n, sum(|it| it.alarms)),
        about("orders", n, sum(|it| it.orders)),
        about("motions", n, sum(|it| it.motions)),
    ];
    let per_minute = Some(hours / minutes);
    let pace = Figure::new("virtual hours per minute of wall time", n, per_minute, "h");
    let digests = outcomes.iter().map(|it| format!("{:016x}", it.digest));
    let digest = trace::digest(digests);
    let mut notes = vec![format!("digest of all traces: {digest:016x}")];
    let shows = |it: &&Outcome| order.seed.is_some() || !it.violations.is_empty();
    let worth = outcomes.iter().filter(shows).take(SHOWN);
    notes.extend(worth.map(|it| shown(order, it)));
    let alarms = |it: &Outcome| (format!("seed {}", it.seed), Some(it.counts.alarms as f64));
    let title = format!("alarms by seed: {}", order.about());
    let chart = Chart::new(title, "", Vec::new(), outcomes.iter().take(40).map(alarms));
    let groups = vec![vec![rule.bar(Bar::AtMost(0.0))], counts, vec![pace]];
    Report::new("storm", order.about(), groups, chart).noted(notes)
}

fn shown(order: &Order, it: &Outcome) -> String {
    let seed = it.seed;
    // A report of one seed shows the whole trace.
    let last = match order.seed {
        Some(_) => it.trace.join("\n  "),
        None => trace::last(&it.trace).join("\n  "),
    };
    let what = match it.violations.as_slice() {
        [] => "no rule broken".to_owned(),
        some => some.join("; "),
    };
    format!(
        "seed {seed}: {what}\n  faults: {}\n  {last}\n  again: relayrig study storm --seed {seed} --parts {}",
        it.faults.join(" "),
        order.parts,
    )
}
