//! One life of the controller: the program as `run` starts it, in virtual time, inside this process, on a rig that
//! keeps its state from life to life. A kill drops the program with all its tasks in the middle of their work.

use super::operator::{Answered, Operator};
use super::scenario::Life;
use crate::dice::Dice;
use anyhow::Context;
use app::controls::Controls;
use app::exit::Exit;
use app::lot::{LotContext, LotRunner, Purpose, Subscriber};
use app::order::LotOrder;
use app::order_queue::OrderQueue;
use app::simulated::LiveRig;
use app::source::{RigSource, Simulated};
use bus::Pace;
use config::Plant;
use machine::dut::{Calibration, Recipe};
use rigsim::SharedRig;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use tokio::sync::mpsc;
use units::RigTime;

/// Wall clock at rig time zero, microseconds since 1970 UTC: 2027-01-15, the same for every seed.
pub const EPOCH_US: i64 = 1_800_000_000_000_000;
/// Longest life of the controller, microseconds: enough for a lot of a few parts with all waits of operator and
/// station.
const LONGEST_US: u64 = 300_000_000;

/// How a life of the controller ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// The study killed the program.
    Killed,
    /// The program ended with this status.
    Exit(Exit),
    /// The program failed with this error.
    Failed(String),
    /// The program did not end within [`LONGEST_US`].
    Hung,
}

/// Record of a life of the controller that has ended.
#[derive(Debug, Clone)]
pub struct EndedLife {
    /// Name of the lot that the life ran.
    pub lot: String,
    /// Rig time at the start of the life, microseconds.
    pub began_us: u64,
    /// Rig time at the end of the life, microseconds.
    pub ended_us: u64,
    /// End of the life.
    pub end: End,
    /// Orders of the operator with their answers.
    pub answers: Vec<Answered>,
}

/// Runs lives on one rig; holds the inputs that they share.
pub struct Runner<'a> {
    /// Configuration.
    pub plant: &'a Plant,
    /// Recipe of every lot.
    pub recipe: &'a Arc<Recipe>,
    /// File of the history that all lives write.
    pub db: &'a Path,
    /// Simulated rig, which keeps its state between lives.
    pub rig: &'a SharedRig,
}

impl Runner<'_> {
    fn source(&self, calibration: Option<Calibration>) -> RigSource {
        let began_us = i64::try_from(self.rig.now_us()).unwrap_or(i64::MAX);
        Simulated::with_seed(1).on(LiveRig {
            rig: self.rig.clone(),
            epoch_us: EPOCH_US + began_us,
            calibration,
        })
    }

    /// Calibrates the rig with references and reference parts.
    ///
    /// # Errors
    /// Fails when the calibration fails although the rig has no faults.
    pub fn calibrated(&self) -> anyhow::Result<Calibration> {
        let life = Life::calm(0, 0);
        let mut found = OnceLock::new();
        let run = ("calibration", Purpose::Calibration, self.source(None));
        let end = self.play(run, &life, None, &mut found)?.0;
        found
            .into_inner()
            .with_context(|| format!("a calm rig was not calibrated: {end:?}"))
    }

    /// Runs one life; with an operator, `operator_dice` draws the operator's orders.
    ///
    /// # Errors
    /// Fails when the runtime cannot be built.
    pub fn run_life(
        &self,
        lot: &str,
        life: &Life,
        calibration: Option<Calibration>,
        operator_dice: Dice,
    ) -> anyhow::Result<EndedLife> {
        self.rig.advance(self.rig.now_us() + life.pause_us);
        let began_us = self.rig.now_us();
        let (end, ended_us, answers) = {
            let run = (lot, Purpose::Lot, self.source(calibration));
            let operator_dice = life.attended.then_some(operator_dice);
            let (end, after, answers) = self.play(run, life, operator_dice, &mut ())?;
            (end, began_us + after.0, answers)
        };
        self.rig.advance(ended_us);
        Ok(EndedLife {
            lot: lot.to_owned(),
            began_us,
            ended_us: ended_us.max(self.rig.now_us()),
            end,
            answers,
        })
    }

    fn play(
        &self,
        (lot, purpose, source): (&str, Purpose, RigSource),
        life: &Life,
        operator_dice: Option<Dice>,
        outer: &mut dyn Subscriber,
    ) -> anyhow::Result<(End, RigTime, Vec<Answered>)> {
        let runtime = app::runtime(&source)?;
        let order = LotOrder {
            lot: lot.to_owned(),
            recipe: self.recipe.name.clone(),
            count: Some(life.count),
            retest: None,
        };
        let controls = Controls::new(life.attended);
        let runner = LotRunner {
            db: self.db,
            context: LotContext::new(self.plant, (&order, self.recipe), &source, purpose),
            controls: &controls,
        };
        let (answers, mut heard) = mpsc::unbounded_channel();
        let (end, after) = runtime.block_on(async {
            let pace = Pace::virtual_time();
            let (orders, asked) = mpsc::channel(1);
            let operator = operator_dice.map(|dice| Operator {
                view: controls.view.subscribe(),
                orders,
                pace,
                stop: Arc::clone(&controls.stop),
                abort: Arc::clone(&controls.abort),
                dice,
                answers,
            });
            if let Some(operator) = operator {
                tokio::spawn(operator.operate());
            }
            let run = runner.run(OrderQueue::from(asked), outer);
            let until = RigTime(life.killed_after_us.unwrap_or(LONGEST_US));
            let end = tokio::select! {
                biased;
                exit = run => match exit {
                    Ok(exit) => End::Exit(exit),
                    Err(error) => End::Failed(format!("{error:#}")),
                },
                () = pace.sleep_until(until) => match life.killed_after_us {
                    Some(_) => End::Killed,
                    None => End::Hung,
                },
            };
            (end, pace.now())
        });
        // The runtime drops all tasks without waiting, as a kill would.
        runtime.shutdown_background();
        let mut all = Vec::new();
        while let Ok(one) = heard.try_recv() {
            all.push(one);
        }
        Ok((end, after, all))
    }
}
