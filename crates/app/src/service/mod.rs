//! The rig under one program for a whole day. Page and API stand over the rig; lots come and go.
//!
//! The rig is always under one *run*, as the command `run` has it. Between lots it is one without a lot: the machine
//! stays as it is until an operator resets it, inputs and alarms are shown, motions by hand are possible, and what is found
//! inside is discharged. A lot that is ordered at the page ([`router`]) and passes the gates ends that run in a turn of
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

mod page;
mod router;

use super::admission::{NotAdmitted, admit};
use super::controls::Controls;
use super::exit::Exit;
use super::lot::{FOUND, LotContext, LotRunner, Purpose, Subscriber, mimic};
use super::order::{Files, LotOrder};
use super::order_queue::OrderQueue;
use super::source::RigSource;
use super::{links, lot_decision};
#[cfg(feature = "sim")]
use super::{simulated, simulated::LiveRig, source::Simulated};
use anyhow::{Context, bail};
use config::{Plant, load_recipe, recipe_names};
use history::{Decision, Identity, Store};
use machine::dut::Recipe;
use machine::station::packml::State;
use machine::view::OrderRequest;
pub use page::FirstLogin;
use page::Page;
use router::{Next, OrderRouter};
use std::net::{SocketAddr, TcpListener};
use std::path::Path;
use std::sync::Arc;
use tokio::sync::mpsc;

/// A lot that has passed the gates, with its recipe.
type AdmittedLot = (LotOrder, Arc<Recipe>);

/// The rig under one program: everything that stays from lot to lot.
pub struct Service {
    files: Files,
    plant: Arc<Plant>,
    /// The rig; a simulated one lives from the start of the program to its end.
    source: RigSource,
    router: OrderRouter,
    /// What the rig runs between lots.
    between: AdmittedLot,
    first: Option<AdmittedLot>,
    controls: Controls,
    page: Page,
    asked: mpsc::Receiver<OrderRequest>,
}

impl Service {
    /// Opens the page at `listen` and the rig behind it; the day begins with `first`, if there is one.
    ///
    /// # Errors
    /// An address that is taken, a configuration or a lot that is refused, a rig that cannot be built.
    pub fn open(
        files: &Files,
        source: RigSource,
        listen: SocketAddr,
        first: Option<LotOrder>,
    ) -> anyhow::Result<Self> {
        let listener = TcpListener::bind(listen)
            .with_context(|| format!("--listen {listen}: the page cannot listen there"))?;
        let plant = Arc::new(Plant::load(&files.config)?);
        match &source {
            RigSource::Serial(given) => links::check(&plant, given)?,
            #[cfg(feature = "sim")]
            RigSource::Simulated(_) => {}
        }
        let order = between(&files.config)?;
        let recipe = Arc::new(load_recipe(&files.config, &order.recipe)?);
        let admitted = |order: LotOrder| -> Result<AdmittedLot, NotAdmitted> {
            let recipe = admit(&files.db, &plant, &order, Purpose::Lot)?;
            Ok((order, recipe))
        };
        let first = first.map(admitted).transpose()?;
        let controls = Controls::new(true);
        let (orders, asked) = mpsc::channel(::page::WAITING);
        let mimic = mimic(&plant, &recipe)?;
        let source = living(source, &plant, &order)?;
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

    /// Where the page is served.
    pub fn address(&self) -> SocketAddr {
        self.page.address
    }

    /// The engineer that a first start has made, once.
    pub fn take_first_login(&mut self) -> Option<FirstLogin> {
        self.page.first_login.take()
    }

    /// Serves until a signal ends the program; `outer` receives the events of every run.
    ///
    /// # Errors
    /// A history that cannot be opened, or a rig that cannot be loaded.
    pub fn run(mut self, outer: &mut dyn Subscriber) -> anyhow::Result<Exit> {
        let source = self.source.clone();
        let asked = std::mem::replace(&mut self.asked, mpsc::channel(1).1);
        let exit = super::block_on(&source, async {
            self.controls.heed_signals();
            tokio::spawn(self.router.clone().work(asked));
            self.work(outer).await
        });
        self.page.end();
        exit
    }

    /// Runs one lot after the other until a signal ends the program.
    async fn work(&mut self, outer: &mut dyn Subscriber) -> anyhow::Result<Exit> {
        let mut next = self.first.take();
        let mut rests = State::Stopped;
        loop {
            let lot = next.take();
            let exit = self.one_run(lot.as_ref(), rests, outer).await?;
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
                    Some(Next::Lot(lot)) => next = Some(*lot),
                    Some(Next::Hold(held)) => {
                        let row = lot_decision::state(&held.0, &held.1, Decision::Hold);
                        Store::open(&self.files.db, &Identity::of_this_program())?
                            .record(&[row])?;
                    }
                    None => {}
                },
                Exit::Done | Exit::AnswerIsNo | Exit::BadInput => {}
            }
        }
    }

    /// The run of a lot, or the one between lots, in which the machine `rests`.
    async fn one_run(
        &self,
        lot: Option<&AdmittedLot>,
        rests: State,
        outer: &mut dyn Subscriber,
    ) -> anyhow::Result<Exit> {
        let source = self.source_now(lot.map(|(order, _)| order))?;
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

    /// The rig as it is now, a simulated one loaded for the lot: what a lot before found out about its errors is
    /// forgotten.
    fn source_now(&self, lot: Option<&LotOrder>) -> anyhow::Result<RigSource> {
        match &self.source {
            RigSource::Serial(_) => {}
            #[cfg(feature = "sim")]
            RigSource::Simulated(source) => {
                let Some(live) = &source.live else {
                    bail!("the simulated rig is not there");
                };
                if let Some(order) = lot {
                    simulated::load(&live.rig, &self.plant, source, order)?;
                }
                let now_us = i64::try_from(live.rig.now_us()).unwrap_or(i64::MAX);
                return Ok(RigSource::Simulated(Simulated {
                    live: Some(Box::new(LiveRig {
                        epoch_us: live.epoch_us + now_us,
                        ..LiveRig::clone(live)
                    })),
                    ..source.clone()
                }));
            }
        }
        let _ = lot;
        Ok(self.source.clone())
    }
}

/// The source with a simulated rig that lives from now on, its magazine empty.
fn living(source: RigSource, plant: &Plant, order: &LotOrder) -> anyhow::Result<RigSource> {
    let _ = (plant, order);
    Ok(match source {
        RigSource::Serial(given) => RigSource::Serial(given),
        #[cfg(feature = "sim")]
        RigSource::Simulated(source) => {
            let live = LiveRig {
                rig: simulated::build_empty(plant, &source, order)?,
                epoch_us: jiff::Timestamp::now().as_microsecond(),
                calibration: None,
            };
            RigSource::Simulated(Simulated {
                live: Some(Box::new(live)),
                ..source
            })
        }
    })
}

/// What the rig runs between lots. The size of a part that is found inside is that of the first recipe there is.
fn between(config: &Path) -> anyhow::Result<LotOrder> {
    let Some(recipe) = recipe_names(config).into_iter().next() else {
        bail!(
            "{}: found no recipe, expected at least one",
            config.join("recipes").display()
        );
    };
    Ok(LotOrder {
        lot: FOUND.into(),
        recipe,
        count: Some(0),
        retest: None,
    })
}

#[cfg(all(test, feature = "sim"))]
mod tests;
