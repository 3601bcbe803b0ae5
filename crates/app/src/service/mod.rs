//! Controls a rig for a whole day: serves page and API, and runs one lot after another.
//!
//! At every moment one *run* (a control cycle, from its start to its end) controls the rig; the command `run` makes one
//! too. Between lots the run has no lot: the machine keeps its state until an operator resets it, the page shows inputs
//! and alarms, motions by hand are possible, and the rig discharges parts found inside. When a person orders a lot at
//! the page and the lot is admitted ([`router`]), the run between lots ends. The run of the lot then begins as every
//! lot does: it verifies the modules, homes the machine, and calibrates the rig if necessary. After the lot the rig is
//! between lots again.
//!
//! | event | the lot | the program |
//! |---|---|---|
//! | the count is reached, or a person closes the lot | is complete | goes between lots |
//! | an alarm, a stop | continues after clear, reset and start | stays with the lot |
//! | a person starts another lot, or holds this one, while the machine rests | is open, or held | runs the other lot, or goes between lots |
//! | a port or module is missing | shows an alarm that names it | tries again at every clear |
//! | Ctrl-C | finishes the parts inside, is open | ends: 4 when it stopped a lot, 3 when the lot had an active alarm, else 0 |
//! | the history cannot be written | aborts; continues after clear, reset and start | writes what is pending once it can; ends after `give_up_s`: 3 |
//! | an assertion fails | makes outputs safe, is open | ends: 3 |
//!
//! One simulated rig lives from the start of the program to its end. Before every lot the program empties the magazine
//! and loads it, reference parts first, as a person would.

mod notify;
mod page;
mod router;

use super::admission::{AdmissionError, admit};
use super::controls::Controls;
use super::exit::Exit;
use super::links;
use super::lot::{
    FOUND_LOT, HistoryRetry, LotContext, LotRunner, Purpose, Subscriber, lost, mimic, pace_of,
};
use super::lot_decision::AboutLot;
use super::order::{Files, LotOrder};
use super::order_queue::OrderQueue;
use super::source::RigSource;
#[cfg(feature = "sim")]
use super::{simulated, simulated::LiveRig};
use ::page::Listener;
use ::page::access::SetupCode;
use anyhow::bail;
use config::{Folder, Plant, load_recipe, recipe_names};
use history::{HistoryError, Store};
use machine::dut::Recipe;
use machine::station::packml::State;
use machine::view::OrderRequest;
use page::Page;
use router::{AfterRun, OrderRouter};
use std::sync::Arc;
use tokio::sync::mpsc;

/// An admitted lot with its recipe.
type AdmittedLot = (LotOrder, Arc<Recipe>);

/// A rig that this program controls for the day: everything that outlives a lot.
pub struct Service {
    files: Files,
    plant: Arc<Plant>,
    /// The rig; a simulated one lives from the start of the program to its end.
    source: RigSource,
    router: OrderRouter,
    /// Order and recipe of the run between lots.
    between: AdmittedLot,
    first: Option<AdmittedLot>,
    controls: Controls,
    page: Page,
    asked: mpsc::Receiver<OrderRequest>,
}

impl Service {
    /// Opens the rig and serves its page at `listener`; the day begins with lot `first`, if given.
    ///
    /// # Errors
    /// Fails for a faulty configuration, for a lot that the rig refuses, and when the rig cannot be opened.
    pub fn open(
        files: &Files,
        source: RigSource,
        listener: Listener,
        first: Option<LotOrder>,
    ) -> anyhow::Result<Self> {
        let plant = Arc::new(Plant::load(&files.config)?);
        match &source {
            RigSource::Serial(given) => links::check(&plant, given)?,
            #[cfg(feature = "sim")]
            RigSource::Simulated(_) => {}
        }
        history::check_rig(&files.db, source.is_simulated())?;
        let order = between(&files.config)?;
        let recipe = Arc::new(load_recipe(&files.config, &order.recipe)?);
        let admitted = |order: LotOrder| -> Result<AdmittedLot, AdmissionError> {
            let recipe = admit(&files.db, &plant, &order, Purpose::Lot)?;
            Ok((order, recipe))
        };
        let first = first.map(admitted).transpose()?;
        let controls = Controls::new(true);
        let (orders, asked) = mpsc::channel(::page::WAITING);
        let mimic = mimic(&plant, &recipe)?;
        let source = with_live_rig(source, &plant, &order)?;
        let page = Page::start(listener, files, &controls, orders, mimic)?;
        Ok(Self {
            router: OrderRouter::new(&files.db, &plant, &source),
            source,
            files: files.clone(),
            between: (order, recipe),
            first,
            plant,
            controls,
            page,
            asked,
        })
    }

    /// Returns the address of the page, `http://127.0.0.1:8080/` for example.
    pub fn url(&self) -> &str {
        &self.page.url
    }

    /// Returns the code that adds the first engineer at the page; `None` when there is an engineer.
    pub fn setup_code(&self) -> Option<&SetupCode> {
        self.page.setup.as_ref()
    }

    /// Serves until a signal ends the program; `outer` receives the events of every run.
    ///
    /// # Errors
    /// Fails when the history cannot be opened or the rig cannot be loaded.
    pub fn run(mut self, outer: &mut dyn Subscriber) -> anyhow::Result<Exit> {
        let source = self.source.clone();
        let asked = std::mem::replace(&mut self.asked, mpsc::channel(1).1);
        let _signals = self.controls.stop_on_signals()?;
        let _sending = super::sending::start(&self.files, &self.controls)?;
        let exit = super::block_on(&source, async {
            tokio::spawn(self.router.clone().work(asked));
            tokio::spawn(notify::notify_systemd(self.controls.clone()));
            self.work(outer).await
        });
        self.page.end();
        exit
    }

    /// Runs one lot after another until a signal ends the program.
    async fn work(&mut self, outer: &mut dyn Subscriber) -> anyhow::Result<Exit> {
        let mut next = self.first.take();
        let mut rests = State::Stopped;
        let mut first = true;
        loop {
            let lot = next.take();
            let mut run = async || self.run_once(lot.as_ref(), rests, &mut *outer).await;
            let exit = match std::mem::take(&mut first) {
                true => run().await?,
                false => match self.retry().until_written(run).await {
                    Err(error) if error.is::<HistoryError>() => return Ok(lost(&error)),
                    exit => exit?,
                },
            };
            rests = if exit == Exit::Done {
                State::Complete
            } else {
                State::Stopped
            };
            if self.controls.is_stopping() {
                return Ok(if lot.is_some() { exit } else { Exit::Done });
            }
            match exit {
                Exit::Trouble(_) => return Ok(exit),
                Exit::Stopped => match self.router.next() {
                    Some(AfterRun::Lot(lot)) => next = Some(*lot),
                    Some(AfterRun::Hold(held)) => {
                        let about = AboutLot::of(&held.0);
                        let rows: Vec<_> =
                            about.map(|it| it.state_row(&held.1)).into_iter().collect();
                        let hold = async || {
                            let store = Store::open(&self.files.db);
                            Ok(store.and_then(|mut store| store.record(&rows))?)
                        };
                        if let Err(error) = self.retry().until_written(hold).await {
                            return Ok(lost(&error));
                        }
                    }
                    None => {}
                },
                Exit::Done | Exit::AnswerIsNo | Exit::BadInput => {}
            }
        }
    }

    fn retry(&self) -> HistoryRetry<'_> {
        HistoryRetry {
            db: &self.files.db,
            controls: &self.controls,
            pace: pace_of(&self.source),
            give_up_s: self.plant.history.give_up_s,
        }
    }

    /// Runs a lot, or the run between lots; `rests` is the state in which the machine begins between lots.
    async fn run_once(
        &self,
        lot: Option<&AdmittedLot>,
        rests: State,
        outer: &mut dyn Subscriber,
    ) -> anyhow::Result<Exit> {
        let source = self.current_source(lot.map(|(order, _)| order))?;
        let purpose = match lot {
            Some(_) => Purpose::Lot,
            None => Purpose::BetweenLots(rests),
        };
        let (order, recipe) = lot.unwrap_or(&self.between);
        let (given, taken) = mpsc::channel(::page::WAITING);
        self.router
            .route_to(given, lot.map(|(order, _)| order.lot.as_str()));
        let runner = LotRunner {
            db: &self.files.db,
            context: LotContext::new(&self.plant, (order, recipe), &source, purpose),
            controls: &self.controls,
        };
        runner.run(OrderQueue::from(taken), outer).await
    }

    /// Returns the rig for the next run. Loads the magazine of a simulated rig for `lot`, if given; a simulated rig
    /// comes without a calibration, so the run calibrates.
    fn current_source(&self, lot: Option<&LotOrder>) -> anyhow::Result<RigSource> {
        match &self.source {
            RigSource::Serial(_) => {}
            #[cfg(feature = "sim")]
            RigSource::Simulated(source) => {
                let Some(live) = &source.live else {
                    bail!("the simulated rig was not built");
                };
                if let Some(order) = lot {
                    simulated::load(&live.rig, &self.plant, source, order)?;
                }
                let now_us = i64::try_from(live.rig.now_us()).unwrap_or(i64::MAX);
                return Ok(source.clone().on(LiveRig {
                    epoch_us: live.epoch_us + now_us,
                    ..LiveRig::clone(live)
                }));
            }
        }
        let _ = lot;
        Ok(self.source.clone())
    }
}

/// Builds a simulated rig with an empty magazine, which then serves all runs; returns a serial source unchanged.
fn with_live_rig(source: RigSource, plant: &Plant, order: &LotOrder) -> anyhow::Result<RigSource> {
    let _ = (plant, order);
    Ok(match source {
        RigSource::Serial(given) => RigSource::Serial(given),
        #[cfg(feature = "sim")]
        RigSource::Simulated(source) => {
            let rig = simulated::build_empty(plant, &source, order)?;
            source.on(LiveRig::new(rig))
        }
    })
}

/// Returns the order of the run between lots, with the first recipe, which gives the size of a part found inside.
fn between(config: &Folder) -> anyhow::Result<LotOrder> {
    let Some(recipe) = recipe_names(config).into_iter().next() else {
        bail!(
            "{}: found no recipe, expected at least one",
            config.path("recipes").display()
        );
    };
    Ok(LotOrder {
        lot: FOUND_LOT.into(),
        recipe,
        count: Some(0),
        retest: None,
    })
}

#[cfg(all(test, feature = "sim"))]
mod tests;
