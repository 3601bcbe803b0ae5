//! The storm: short lots under random faults of world and line, random orders of an operator, and kills of the
//! controller, in virtual time, inside this process.
//!
//! A seed is one rig under several lives of the controller; a life lasts from start to end of the program. `scenario`
//! draws the faults and their instants, `life` runs the program as `run` does and kills it, `operator` gives orders.
//! When all faults are over, up to [`CALM`] further lives start, one of which must complete a lot. Then `judge`
//! compares the truth of the rig with the history.
//!
//! For each seed that breaks a rule, the report shows the broken rules, the last lines of its trace and the command
//! that reproduces it: the same seed gives the same trace, bit for bit.

mod climate;
mod judge;
pub(crate) mod life;
mod operator;
mod report;
pub(crate) mod scenario;
mod trace;

use super::order::Order;
use super::output::Report;
use super::pool;
use anyhow::Context;
use app::exit::Exit;
use climate::Climate;
use config::Plant;
use history::{Archive, Filter};
use judge::Case;
use life::{End, Runner};
use machine::dut::Calibration;
use report::{Counts, Outcome, report};
use rigsim::{Options, SharedRig};
use scenario::{CEASES_US, LONG_US, Life, RIGS, Scenario};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;
use tempfile::TempDir;
use tracing::subscriber::{NoSubscriber, with_default};
use units::Span;

/// Greatest number of lives after the faults; one of them must complete its lot. The first may have to discharge parts
/// left inside.
const CALM: u64 = 3;
/// Number of parts in the lot of a life after the faults.
const CALM_PARTS: u64 = 2;

/// A storm: the inputs that all seeds share.
struct Storm<'a> {
    order: &'a Order,
    plant: Plant,
    climate: Climate,
    folder: TempDir,
    calibrations: [OnceLock<Calibration>; RIGS as usize],
}

/// Runs the seeds of the order and makes the report.
///
/// # Errors
/// Fails when a file cannot be read or written, or when a rig cannot be built.
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
        let climate = Climate::of(order.recipe.device.kind());
        Ok(Self {
            order,
            plant: Plant::load(&order.folder())?,
            climate,
            folder,
            calibrations: Default::default(),
        })
    }

    /// Runs every seed, on two threads for each processor core: a storm waits for the disk a third of its time.
    fn all(&self, seeds: &[u64]) -> anyhow::Result<Vec<Outcome>> {
        // The report counts the alarms of a storm; a log line for each alarm would bury the report.
        let quiet = |seed| with_default(NoSubscriber::new(), || self.one(seed));
        pool::map(seeds, 2 * pool::cores(), |seed| {
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
            hold_us: case.hold_us,
            faults: case.faults,
            trace: if is_shown { trace } else { Vec::new() },
            violations,
            digest,
        })
    }

    /// Runs all lives of a seed and returns the case for `judge`.
    fn case(&self, seed: u64, db: &Path) -> anyhow::Result<Case> {
        let wiring = &self.plant.wiring;
        let mut scenario = Scenario::of(seed, self.order.parts, wiring, &self.climate);
        if self.order.world.is_some() {
            // An ordered world has a duration of its own, by default this one.
            scenario.hold_us = LONG_US;
        }
        let rig = self.rig(
            scenario.rig,
            scenario.uncalibrated,
            &scenario.faults,
            self.world(scenario.hold_us, db)?,
        )?;
        let runner = self.runner(&rig, db);
        let needs = self.climate.calibrates;
        let mut calibration = match scenario.uncalibrated || !needs {
            true => None,
            false => Some(self.calibration(scenario.rig, db)?),
        };
        let mut operator_dice = scenario.operator_dice.clone();
        let mut lives = Vec::new();
        for life in &scenario.lives {
            let lot = format!("life-{}", lives.len() + 1);
            lives.push(runner.run_life(&lot, life, calibration.clone(), operator_dice.apart())?);
        }
        if calibration.is_none() && needs {
            calibration = Some(self.calibration(scenario.rig, db)?);
        }
        rig.cancel_faults();
        // An alarm has asked a person for this.
        rig.release_panels();
        for n in 1..=CALM {
            let pause_us = CEASES_US.saturating_sub(rig.now_us()) + 1_000_000;
            let life = Life::calm(CALM_PARTS, pause_us);
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
        Ok(Case {
            lives,
            bodies: rig.bodies(),
            driven: rig.motion_starts(),
            touched: rig.crashes(),
            overdrives: rig.overdrives(),
            contact_moves: rig.contact_moves(),
            hold_us: scenario.hold_us,
            welded_us: scenario.welded_us.clone(),
            watchdog,
            rows: archive.query(&all)?,
            alarms: archive.alarms(&Filter::default())?,
            limits: self.order.admitted(),
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
            recipe: &self.order.recipe,
            db,
            rig,
        }
    }

    /// Returns the file of the world; without one in the order, writes it beside `db`, with faults of `hold_us`.
    fn world(&self, hold_us: u64, db: &Path) -> anyhow::Result<PathBuf> {
        if let Some(ordered) = &self.order.world {
            return Ok(ordered.clone());
        }
        let world = db.with_file_name("world.toml");
        std::fs::write(&world, self.climate.world(hold_us))?;
        Ok(world)
    }

    fn rig(
        &self,
        seed: u64,
        reference_parts: bool,
        faults: &[String],
        world: PathBuf,
    ) -> anyhow::Result<SharedRig> {
        Ok(rigsim::build(&Options {
            files: self.order.config.as_path().into(),
            world: Some(world),
            seed,
            recipe: self.order.recipe.name.clone(),
            parts: None,
            reference_parts,
            faults: faults.to_vec(),
        })?)
    }

    /// Returns the calibration of a rig without faults; the first seed of a rig makes it, later seeds share it.
    fn calibration(&self, rig: u64, db: &Path) -> anyhow::Result<Calibration> {
        let place = usize::try_from(rig % RIGS)?;
        if let Some(known) = self.calibrations[place].get() {
            return Ok(known.clone());
        }
        let calm = self.rig(rig, true, &[], self.world(LONG_US, db)?)?;
        let apart = db.with_file_name("calibration.db");
        let found = self.runner(&calm, &apart).calibrated()?;
        Ok(self.calibrations[place].get_or_init(|| found).clone())
    }
}
