//! `relayrig serve`: the program of the rig for a whole day. Page and API stand over the rig; lots come and go.
//!
//! The rig is always under one *run*, as the command `run` has it. Between lots it is one without a lot: the machine
//! stays as it is until somebody resets it, inputs and alarms are shown, motions by hand are possible, and what is found
//! inside is discharged. A lot that is ordered at the page ([`office`]) and passes the gates ends that run in a turn of
//! its station; then the run of the lot begins with what every lot begins with: the modules are verified, the machine
//! is brought home, and the rig is calibrated unless it is. When the lot ends the rig is between lots again.
//!
//! | what | becomes of the lot | of the program |
//! |---|---|---|
//! | the count is reached, or it is closed | complete | between lots |
//! | an alarm, a stop | goes on after clear, reset and start | stays with the lot |
//! | another lot is started, or it is held, while the machine rests | open, or held | the other lot, or between lots |
//! | a port or module is missing | shown as an alarm that names it | tries again at every clear |
//! | Ctrl-C | finishes the parts inside, open | ends: 4 when it stopped a lot, 3 when that stood in alarm, else 0 |
//! | the history cannot be written, an assertion | outputs safe, open | ends: 3 |
//!
//! The simulated rig is one rig all the time. Its magazine is emptied and loaded for every lot, golden parts first, as
//! a person would do it.

mod office;
mod page;

use super::rig::{PaceArg, RigArgs};
use super::run::recorder::FOUND;
use super::run::{self, Controls, Orders, RunArgs, assemble};
#[cfg(feature = "sim")]
use super::run::{Stage, lines::simulated};
use super::{DONE, RIG_TROUBLE, STOPPED, lot};
use anyhow::{Context, bail};
use config::{Plant, load_recipe, recipe_names};
use history::{Decision, Identity, Store};
use machine::dut::Recipe;
use machine::station::packml::State;
use office::{Next, Office};
use page::Page;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use tokio::sync::mpsc;

/// The rig under one program.
#[derive(Debug, clap::Args)]
#[command(
    mut_arg("pace", |pace| pace.default_value("real").hide(true)),
    after_help = "Examples:
  relayrig serve --line measure=/dev/ttyUSB0 --line motion=/dev/ttyUSB1
  relayrig serve --listen 127.0.0.1:9000 --sim --speed 5

Exit status: 0 ended between lots, 2 bad input, 3 the rig has trouble, 4 a lot was stopped."
)]
pub struct ServeArgs {
    /// Where the page listens
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080")]
    pub listen: SocketAddr,
    /// The rig.
    #[command(flatten)]
    pub rig: RigArgs,
}

/// Runs the command; the result is the exit status.
pub fn run(config: &Path, db: &Path, args: &ServeArgs) -> anyhow::Result<i32> {
    day(config, db, args, None)
}

/// A day at the rig, which begins with `first` on that rig, if there is one.
pub(super) fn day(
    config: &Path,
    db: &Path,
    args: &ServeArgs,
    first: Option<RunArgs>,
) -> anyhow::Result<i32> {
    let mut rig = args.rig.clone();
    if rig.speed.is_some() {
        rig.pace = PaceArg::Virtual;
    } else if rig.is_virtual() {
        bail!(
            "--pace virtual: found without --speed, expected both: nobody could follow a rig that waits"
        );
    }
    rig.check()?;
    let listener = std::net::TcpListener::bind(args.listen)
        .with_context(|| format!("--listen {}: the page cannot listen there", args.listen))?;
    let address = listener.local_addr().context("the page's socket")?;
    let plant = Arc::new(Plant::load(config)?);
    run::lines::overrides(&plant, &rig.line)?;
    let between = between(config, &rig)?;
    let recipe = Arc::new(load_recipe(config, &between.recipe)?);
    let first = first.map(|args| RunArgs {
        rig: rig.clone(),
        ..args
    });
    let next = first.map(|args| admitted(db, &plant, args)).transpose()?;
    let controls = Controls {
        stays: true,
        ..Controls::new(false)
    };
    let (orders, asked) = mpsc::channel(::page::WAITING);
    let mimic = assemble::mimic(&plant, &recipe)?;
    let runtime = run::runtime(&rig)?;
    let house = House {
        #[cfg(feature = "sim")]
        simulated: SimulatedRig::of(&plant, config, &between)?,
        office: Office::new(db, &plant, &rig),
        config,
        db,
        plant,
        between: (between, recipe),
        controls,
    };
    let page = Page::start(listener, config, &house.controls, orders, db, mimic)?;
    eprintln!(
        "relayrig: {}page at http://{address}/, history in {}, Ctrl-C stops",
        if rig.sim {
            "simulated rig running, "
        } else {
            ""
        },
        db.display()
    );
    let status = runtime.block_on(async {
        house.controls.heed_signals();
        tokio::spawn(house.office.clone().work(asked));
        house.work(next).await
    });
    runtime.shutdown_timeout(std::time::Duration::from_secs(1));
    page.end();
    status
}

/// What the rig runs between lots. The size of a part that is found inside is that of the first recipe there is.
fn between(config: &Path, rig: &RigArgs) -> anyhow::Result<RunArgs> {
    let Some(recipe) = recipe_names(config).into_iter().next() else {
        bail!(
            "{}: found no recipe, expected at least one",
            config.join("recipes").display()
        );
    };
    Ok(RunArgs {
        rig: rig.clone(),
        lot: FOUND.into(),
        recipe,
        count: Some(0),
        truth: None,
        json: false,
        retest: None,
        study: None,
    })
}

/// A lot that may be run, with its recipe.
type Lot = (RunArgs, Arc<Recipe>);

fn admitted(db: &Path, plant: &Plant, args: RunArgs) -> anyhow::Result<Lot> {
    let recipe = run::gate::admit(db, plant, &args, false)?;
    Ok((args, recipe))
}

/// Everything that stays from lot to lot.
struct House<'a> {
    config: &'a Path,
    db: &'a Path,
    plant: Arc<Plant>,
    office: Office,
    between: Lot,
    controls: Controls,
    #[cfg(feature = "sim")]
    simulated: Option<SimulatedRig>,
}

impl House<'_> {
    /// Lot after lot, until somebody ends the program.
    async fn work(&self, mut next: Option<Lot>) -> anyhow::Result<i32> {
        let mut rests = State::Stopped;
        loop {
            let lot = next.take();
            let status = self.one_run(lot.as_ref(), rests).await?;
            rests = if status == DONE {
                State::Complete
            } else {
                State::Stopped
            };
            let flags = [&self.controls.stop, &self.controls.abort];
            if flags.iter().any(|flag| flag.load(Ordering::Acquire)) {
                return Ok(if lot.is_some() { status } else { DONE });
            }
            match status {
                RIG_TROUBLE => return Ok(status),
                STOPPED => match self.office.next() {
                    Some(Next::Lot(lot)) => next = Some(*lot),
                    Some(Next::Hold(held)) => {
                        let row = lot::state(&held.0, &held.1, Decision::Hold);
                        Store::open(self.db, &Identity::of_this_program())?.record(&[row])?;
                    }
                    None => {}
                },
                _done => {}
            }
        }
    }

    /// The run of a lot, or the one between lots, in which the machine `rests`.
    async fn one_run(&self, lot: Option<&Lot>, rests: State) -> anyhow::Result<i32> {
        let controls = Controls {
            between_lots: lot.is_none().then_some(rests),
            quiet: lot.is_none(),
            #[cfg(feature = "sim")]
            stage: self.simulated.as_ref().map(SimulatedRig::stage),
            ..self.controls.clone()
        };
        let (args, recipe) = lot.unwrap_or(&self.between);
        #[cfg(feature = "sim")]
        if let (Some(simulated), Some((args, _))) = (&self.simulated, lot) {
            simulated::load(&simulated.rig, &self.plant, self.config, args)?;
        }
        let (given, taken) = mpsc::channel(::page::WAITING);
        self.office
            .sits_at(given, lot.map(|(args, _)| args.lot.as_str()));
        let bench = (&*self.plant, recipe);
        let orders = Orders::Screens(taken);
        run::run_lot(bench, self.config, self.db, args, &controls, orders).await
    }
}

/// The simulated rig, which lives from the start of the program to its end.
#[cfg(feature = "sim")]
struct SimulatedRig {
    rig: rigsim::SharedRig,
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    epoch_us: i64,
}

#[cfg(feature = "sim")]
impl SimulatedRig {
    /// None on a rig.
    fn of(plant: &Plant, config: &Path, args: &RunArgs) -> anyhow::Result<Option<Self>> {
        if !args.rig.sim {
            return Ok(None);
        }
        Ok(Some(Self {
            rig: simulated::build_empty(plant, config, args)?,
            epoch_us: jiff::Timestamp::now().as_microsecond(),
        }))
    }

    /// As it stands now; what a lot before found out about its errors is forgotten.
    fn stage(&self) -> Stage {
        let now_us = i64::try_from(self.rig.now_us()).unwrap_or(i64::MAX);
        Stage {
            rig: self.rig.clone(),
            epoch_us: self.epoch_us + now_us,
            calibration: None,
        }
    }
}

#[cfg(all(test, feature = "sim"))]
mod tests;
