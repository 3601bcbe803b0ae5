//! One life of the controller on a rig that lived before it and lives on after it: the program as `run` has it, in
//! virtual time, in this process. A kill drops everything that the program is in the middle of a turn.

use super::operator::{Operator, Said};
use super::weather::Life;
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
use machine::dut::Calibration;
use machine::dut::Recipe;
use rigsim::SharedRig;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use tokio::sync::mpsc;
use units::RigTime;

/// Wall clock at rig time zero, microseconds since 1970 UTC: 2027-01-15. The same for every seed.
pub const EPOCH_US: i64 = 1_800_000_000_000_000;
/// A life of a few parts is over by then, patience of the operator and of the station included, microseconds.
const LONGEST_US: u64 = 300_000_000;

/// How a life ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// By force.
    Killed,
    /// By itself.
    Exit(Exit),
    /// It could not go on.
    Failed(String),
    /// It never ended by itself.
    Hung,
}

/// A life that is over.
#[derive(Debug, Clone)]
pub struct Lived {
    /// Its lot.
    pub lot: String,
    /// Rig time at its begin, microseconds.
    pub began_us: u64,
    /// And at its end.
    pub ended_us: u64,
    /// Why it ended.
    pub end: End,
    /// What the operator said.
    pub said: Vec<Said>,
}

/// Inputs that all lives share.
pub struct Shop<'a> {
    /// Configuration.
    pub plant: &'a Plant,
    /// Recipe of every lot.
    pub recipe: &'a Arc<Recipe>,
    /// The history that all lives write.
    pub db: &'a Path,
    /// The rig.
    pub rig: &'a SharedRig,
}

impl Shop<'_> {
    fn source(&self, calibration: Option<Calibration>) -> RigSource {
        let began_us = i64::try_from(self.rig.now_us()).unwrap_or(i64::MAX);
        RigSource::Simulated(Simulated {
            live: Some(Box::new(LiveRig {
                rig: self.rig.clone(),
                epoch_us: EPOCH_US + began_us,
                calibration,
            })),
            ..Simulated::with_seed(1)
        })
    }

    /// References and golden parts of a rig, and what they give.
    ///
    /// # Errors
    /// A rig without troubles that cannot be calibrated.
    pub fn calibrated(&self) -> anyhow::Result<Calibration> {
        let life = Life {
            count: 0,
            attended: false,
            killed_after_us: None,
            pause_us: 0,
        };
        let mut found = OnceLock::new();
        let run = ("calibration", Purpose::Calibration, self.source(None));
        let end = self.play(run, &life, None, &mut found)?.0;
        found
            .into_inner()
            .with_context(|| format!("a calm rig was not calibrated: {end:?}"))
    }

    /// Lives once. `whims` moves the operator of an attended life.
    ///
    /// # Errors
    /// A runtime that could not be made.
    pub fn live(
        &self,
        lot: &str,
        life: &Life,
        calibration: Option<Calibration>,
        whims: super::dice::Dice,
    ) -> anyhow::Result<Lived> {
        self.rig.advance(self.rig.now_us() + life.pause_us);
        let began_us = self.rig.now_us();
        let (end, ended_us, said) = {
            let run = (lot, Purpose::Lot, self.source(calibration));
            let whims = life.attended.then_some(whims);
            let (end, after, said) = self.play(run, life, whims, &mut ())?;
            (end, began_us + after.0, said)
        };
        self.rig.advance(ended_us);
        Ok(Lived {
            lot: lot.to_owned(),
            began_us,
            ended_us: ended_us.max(self.rig.now_us()),
            end,
            said,
        })
    }

    fn play(
        &self,
        (lot, purpose, source): (&str, Purpose, RigSource),
        life: &Life,
        whims: Option<super::dice::Dice>,
        outer: &mut dyn Subscriber,
    ) -> anyhow::Result<(End, RigTime, Vec<Said>)> {
        let mut builder = tokio::runtime::Builder::new_current_thread();
        let runtime = builder.enable_time().start_paused(true).build()?;
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
        let (said, mut heard) = mpsc::unbounded_channel();
        let (end, after) = runtime.block_on(async {
            let pace = Pace::virtual_time();
            let (orders, asked) = mpsc::channel(1);
            let operator = whims.map(|dice| Operator {
                view: controls.view.subscribe(),
                orders,
                pace,
                stop: Arc::clone(&controls.stop),
                abort: Arc::clone(&controls.abort),
                dice,
                said,
            });
            if let Some(operator) = operator {
                tokio::spawn(operator.rage());
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
        // Nothing runs on: what the program was in the middle of is gone with it.
        runtime.shutdown_background();
        let mut all = Vec::new();
        while let Ok(one) = heard.try_recv() {
            all.push(one);
        }
        Ok((end, after, all))
    }
}
