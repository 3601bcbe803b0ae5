//! Routes orders from screens to the rig; checks orders about lots first.
//!
//! - `start` with a lot goes to the station once the lot is admitted. The station ends the present run when the machine
//!   rests; the run of the new lot follows.
//! - `hold_lot` and `close_lot` for the lot under way go to the station; the router refuses `release_lot` and
//!   `reopen_lot` for this lot.
//! - The router writes these four orders for any other lot, and `replaced`, into the history.
//! - Every other order goes straight to the station.
//!
//! The router sends refused orders to the station too, marked as denied, because the audit has one writer during a run.
//! It handles orders about lots one after another; other orders do not wait for them.

use super::AdmittedLot;
use crate::admission;
use crate::lot::Purpose;
use crate::lot_decision::{self, AboutLot};
use crate::order::LotOrder;
use crate::source::RigSource;
use config::Plant;
use history::{Decision, Store};
use machine::view::{By, Order, OrderRequest};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use texts::Message;
use tokio::sync::{mpsc, oneshot};

/// Consequence of an order that ends a run: another lot, or a hold.
#[derive(Debug)]
pub enum AfterRun {
    /// Another lot.
    Lot(Box<AdmittedLot>),
    /// This order by this person puts the lot on hold.
    Hold(Box<(Order, By)>),
}

/// The run that receives orders now.
#[derive(Debug, Default)]
struct ActiveRun {
    orders: Option<mpsc::Sender<OrderRequest>>,
    lot: Option<String>,
    next: Option<AfterRun>,
}

/// State that all clones of the router share.
#[derive(Debug)]
struct RouterState {
    db: PathBuf,
    plant: Arc<Plant>,
    source: RigSource,
    run: Mutex<ActiveRun>,
    /// Lock that a task holds while it handles an order about lots: only one such order is handled at a time.
    turn: tokio::sync::Mutex<()>,
}

/// Entry point for orders from screens; clones share their state.
#[derive(Debug, Clone)]
pub struct OrderRouter(Arc<RouterState>);

impl OrderRouter {
    /// Creates a router that writes to the history in `db`.
    pub fn new(db: &Path, plant: &Arc<Plant>, source: &RigSource) -> Self {
        Self(Arc::new(RouterState {
            db: db.to_owned(),
            plant: Arc::clone(plant),
            source: source.clone(),
            run: Mutex::default(),
            turn: tokio::sync::Mutex::default(),
        }))
    }

    /// Routes orders to this run from now on.
    pub fn route_to(&self, orders: mpsc::Sender<OrderRequest>, lot: Option<&str>) {
        *self.run() = ActiveRun {
            orders: Some(orders),
            lot: lot.map(str::to_owned),
            next: None,
        };
    }

    /// Removes and returns the note of what follows the ended run: a lot or a hold.
    pub fn next(&self) -> Option<AfterRun> {
        self.run().next.take()
    }

    /// Routes orders until all their senders are gone.
    pub async fn work(self, mut asked: mpsc::Receiver<OrderRequest>) {
        while let Some(asked) = asked.recv().await {
            if asked.denied.is_some() || !is_about_lots(&asked.order) {
                self.pass(asked);
                continue;
            }
            let router = self.clone();
            tokio::spawn(async move {
                let _turn = router.0.turn.lock().await;
                router.handle(asked).await;
            });
        }
    }

    async fn handle(&self, asked: OrderRequest) {
        let (order, by) = (asked.order.clone(), asked.by.clone());
        let about = AboutLot::of(&order);
        let ours = about.is_some_and(|it| self.run().lot.as_deref() == Some(it.lot));
        let wanted = match (&order, about.filter(|_| ours)) {
            (Order::Start { .. }, _) => self.admitted(&order).await.map(Some),
            (_, None) => return self.write(asked).await,
            (_, Some(about)) => match about.decision {
                Decision::Hold => about
                    .decision
                    .check_reason(about.reason)
                    .map(|()| Some(AfterRun::Hold(Box::new((order.clone(), by))))),
                Decision::Close => Ok(None),
                Decision::Release => Err(refused("lot_under_way")),
                Decision::Reopen => Err(refused("lot_not_complete")),
            },
        };
        if let Err(why) = wanted.and_then(|next| self.set_next(next)) {
            self.refuse(asked, why);
        } else if !self.pass_on(asked).await {
            self.run().next = None;
        }
    }

    /// Notes what follows the run; fails while an earlier note is pending. The caller notes this before it passes the
    /// order on, because the station may end the run as soon as it has the order.
    fn set_next(&self, next: Option<AfterRun>) -> Result<(), Message> {
        let mut run = self.run();
        if run.next.is_some() {
            return Err(not_now());
        }
        run.next = next;
        Ok(())
    }

    /// Returns the lot of a `start` order; fails when the lot is not admitted.
    async fn admitted(&self, order: &Order) -> Result<AfterRun, Message> {
        let Order::Start {
            lot: Some(lot),
            recipe,
            count,
            retest,
        } = order.clone()
        else {
            return Err(not_now());
        };
        let router = self.clone();
        let check = move || {
            let RouterState {
                db, plant, source, ..
            } = &*router.0;
            let order = LotOrder {
                recipe: recipe.map_or_else(|| recipe_of(db, &lot), Ok)?,
                lot,
                count,
                retest,
            };
            let recipe = admission::admit(db, plant, &order, Purpose::Lot)
                .map_err(|why| why.screen_message())?;
            match admission::calibration_refusal((db, plant), &recipe, source) {
                Ok(None) => Ok(AfterRun::Lot(Box::new((order, recipe)))),
                Ok(Some(why)) => Err(refused("calibration_invalid").with_inner("detail", &why)),
                Err(error) => Err(trouble(&error)),
            }
        };
        blocking(check).await
    }

    /// Carries out an order that no run handles, and writes it into the history.
    async fn write(&self, asked: OrderRequest) {
        let (db, simulated) = (self.0.db.clone(), self.0.source.is_simulated());
        let (order, by) = (asked.order.clone(), asked.by.clone());
        let write = move || match (AboutLot::of(&order), &order) {
            (Some(about), _) => lot_decision::write(&db, &order, &by, about),
            (None, Order::Replaced { counter }) => {
                write_replacement(&db, (&order, counter), &by, simulated)
            }
            (None, _other) => Err(not_now()),
        };
        match blocking(write).await {
            Ok(()) => asked.answer(Ok(None)),
            Err(why) => self.refuse(asked, why),
        }
    }

    /// Answers with the refusal and records it in the audit.
    fn refuse(&self, asked: OrderRequest, why: Message) {
        let (order, by) = (asked.order.clone(), asked.by.clone());
        self.pass(OrderRequest::denied(order, by, why.clone()));
        asked.answer(Err(why));
    }

    /// Passes the order to the current run, and the run's answer back; returns true when the run accepts the order.
    async fn pass_on(&self, asked: OrderRequest) -> bool {
        let (answer, answered) = oneshot::channel();
        let (order, by) = (asked.order.clone(), asked.by.clone());
        let way_back = move |it| drop(answer.send(it));
        self.pass(OrderRequest::new(order, by, way_back));
        let answer = answered.await.unwrap_or_else(|_| Err(not_now()));
        let taken = answer.is_ok();
        asked.answer(answer);
        taken
    }

    fn pass(&self, asked: OrderRequest) {
        let orders = self.run().orders.clone();
        let given = match orders {
            Some(orders) => orders.try_send(asked).map_err(|it| it.into_inner()),
            None => Err(asked),
        };
        if let Err(asked) = given {
            asked.answer(Err(not_now()));
        }
    }

    fn run(&self) -> MutexGuard<'_, ActiveRun> {
        self.0.run.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn is_about_lots(order: &Order) -> bool {
    match order {
        Order::Start { lot, .. } => lot.is_some(),
        Order::Replaced { .. } => true,
        other => AboutLot::of(other).is_some(),
    }
}

fn write_replacement(
    db: &Path,
    (order, name): (&Order, &str),
    by: &By,
    simulated: bool,
) -> Result<(), Message> {
    let at_us = jiff::Timestamp::now().as_microsecond();
    let write = |mut store: Store| {
        let known = store.replaced(simulated, name, &by.who, at_us)?;
        if known {
            store.record(&[lot_decision::audit(order, by)])?;
        }
        Ok(known)
    };
    let store = Store::open(db);
    match store.and_then(write) {
        Ok(true) => Ok(()),
        Ok(false) => Err(refused("no_such_counter").with("counter", name)),
        Err(error) => Err(trouble(&error)),
    }
}

async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Message> + Send + 'static,
) -> Result<T, Message> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|error| Err(trouble(&error)))
}

/// Returns the name of the recipe with which a lot began; fails for a lot that never began.
fn recipe_of(db: &Path, lot: &str) -> Result<String, Message> {
    let standing = admission::standing(db, lot).map_err(|error| trouble(&error))?;
    let named = standing.map(|it| it.recipe);
    named.ok_or_else(|| refused("start_without_recipe").with("lot", lot))
}

fn refused(code: &'static str) -> Message {
    Message::new("refusal", code)
}

fn trouble(error: &dyn std::fmt::Display) -> Message {
    refused("program_trouble").with("said", error)
}

fn not_now() -> Message {
    refused("between_lots")
}
