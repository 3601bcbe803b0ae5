//! Orders of screens on their way to the rig: those about lots are looked at here first.
//!
//! - `start` with a lot: the gates are asked; then it goes on to the station, which leaves its lot when the machine
//!   rests. The run that ends by that is followed by the run of the new lot.
//! - `hold_lot`, `close_lot` of the lot under way go to its station, too; of another lot they are written into the
//!   history, as `release_lot` and `replaced` are.
//! - Every other order goes straight on.
//!
//! Whatever is refused here goes to the station all the same, marked as denied: the audit has one writer while a run is
//! under way. Orders about lots are attended to one after the other; nothing else waits for them.

use super::AdmittedLot;
use crate::admission;
use crate::lot::Purpose;
use crate::lot_decision;
use crate::order::LotOrder;
use crate::source::RigSource;
use config::Plant;
use history::{Archive, Decision, Identity, Store};
use machine::view::{By, Order, OrderRequest};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use texts::{Lang, Message};
use tokio::sync::{mpsc, oneshot};

/// What follows on a run that was left by order.
#[derive(Debug)]
pub enum Next {
    /// Another lot.
    Lot(Box<AdmittedLot>),
    /// The lot that was left is held.
    Hold(Box<(Order, By)>),
}

/// The run that receives orders now.
#[derive(Debug, Default)]
struct ActiveRun {
    orders: Option<mpsc::Sender<OrderRequest>>,
    lot: Option<String>,
    next: Option<Next>,
}

/// State that all copies of the router share.
#[derive(Debug)]
struct RouterState {
    db: PathBuf,
    plant: Arc<Plant>,
    source: RigSource,
    run: Mutex<ActiveRun>,
    /// One order about lots at a time.
    turn: tokio::sync::Mutex<()>,
}

/// Where orders of screens come in; copies are the same router.
#[derive(Debug, Clone)]
pub struct OrderRouter(Arc<RouterState>);

impl OrderRouter {
    /// Over the history in `db`.
    pub fn new(db: &Path, plant: &Arc<Plant>, source: &RigSource) -> Self {
        Self(Arc::new(RouterState {
            db: db.to_owned(),
            plant: Arc::clone(plant),
            source: source.clone(),
            run: Mutex::default(),
            turn: tokio::sync::Mutex::default(),
        }))
    }

    /// From now on orders go to this run.
    pub fn route_to(&self, orders: mpsc::Sender<OrderRequest>, lot: Option<&str>) {
        *self.run() = ActiveRun {
            orders: Some(orders),
            lot: lot.map(str::to_owned),
            next: None,
        };
    }

    /// What the order wanted by which the run was left.
    pub fn next(&self) -> Option<Next> {
        self.run().next.take()
    }

    /// Until nobody can order anything any more.
    pub async fn work(self, mut asked: mpsc::Receiver<OrderRequest>) {
        while let Some(asked) = asked.recv().await {
            if asked.denied.is_some() || !is_about_lots(&asked.order) {
                self.pass(asked);
                continue;
            }
            let router = self.clone();
            tokio::spawn(async move {
                let _turn = router.0.turn.lock().await;
                router.attend(asked).await;
            });
        }
    }

    async fn attend(&self, asked: OrderRequest) {
        let (order, by) = (asked.order.clone(), asked.by.clone());
        let decision = Decision::ordered(&order.order);
        let ours = order.lot.is_some() && self.run().lot == order.lot;
        let wanted = match decision {
            None if order.order == "start" => self.admitted(&order).await.map(Some),
            Some(Decision::Hold) if ours => {
                held(&order).map(|()| Some(Next::Hold(Box::new((order, by)))))
            }
            Some(Decision::Close) if ours => Ok(None),
            Some(Decision::Release) if ours => Err(refused("lot_under_way")),
            _not_under_way => return self.write(asked).await,
        };
        if let Err(why) = wanted.and_then(|next| self.expect(next)) {
            self.refuse(asked, why);
        } else if !self.pass_on(asked).await {
            self.run().next = None;
        }
    }

    /// Noted before the station hears of it, for a run that is left ends at once. Refused while what was taken before
    /// has not begun yet.
    fn expect(&self, next: Option<Next>) -> Result<(), Message> {
        let mut run = self.run();
        if run.next.is_some() {
            return Err(not_now());
        }
        run.next = next;
        Ok(())
    }

    /// The lot of a `start`, once the gates have been asked.
    async fn admitted(&self, order: &Order) -> Result<Next, Message> {
        let order = LotOrder {
            lot: order.lot.clone().unwrap_or_default(),
            recipe: order.recipe.clone().unwrap_or_default(),
            count: order.count,
            retest: order.retest.clone(),
        };
        let router = self.clone();
        let look = move || {
            let RouterState {
                db, plant, source, ..
            } = &*router.0;
            let recipe = admission::admit(db, plant, &order, Purpose::Lot)
                .map_err(|why| why.at_the_screen())?;
            match admission::uncalibrated(db, &recipe, source) {
                Ok(None) => Ok(Next::Lot(Box::new((order, recipe)))),
                Ok(Some(why)) => Err(refused("calibration_invalid").with("detail", why)),
                Err(error) => Err(trouble(&error)),
            }
        };
        beside(look).await
    }

    /// What no run has to do with goes into the history.
    async fn write(&self, asked: OrderRequest) {
        let (db, simulated) = (self.0.db.clone(), self.0.source.is_simulated());
        let (order, by) = (asked.order.clone(), asked.by.clone());
        let write = move || match Decision::ordered(&order.order) {
            Some(decision) => decided(&db, &order, &by, decision),
            None => replaced(&db, &order, &by, simulated),
        };
        match beside(write).await {
            Ok(()) => asked.answer(Ok(())),
            Err(why) => self.refuse(asked, why),
        }
    }

    /// Refused, and so told to the audit.
    fn refuse(&self, asked: OrderRequest, why: Message) {
        let (order, by) = (asked.order.clone(), asked.by.clone());
        self.pass(OrderRequest::denied(order, by, why.say(Lang::En)));
        asked.answer(Err(why));
    }

    /// To the run under way, whose answer goes back; whether it was taken.
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

    /// To the run under way.
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
    let start = order.order == "start" && order.lot.is_some();
    start || machine::view::LOT_ORDERS.contains(&order.order.as_str())
}

fn decided(db: &Path, order: &Order, by: &By, decision: Decision) -> Result<(), Message> {
    if decision == Decision::Hold {
        held(order)?;
    }
    let name = order.lot.as_deref().unwrap_or_default();
    let standing = match db.exists() {
        true => Archive::open(db).and_then(|it| it.standing(name)),
        false => Ok(None),
    };
    let Some(standing) = standing.map_err(|error| trouble(&error))? else {
        return Err(refused("no_such_lot").with("lot", name));
    };
    if let Some(why) = decision.why_not(standing.state) {
        return Err(why);
    }
    lot_decision::write(db, order, by, decision).map_err(|error| trouble(&error))
}

/// A lot is held for a reason.
fn held(order: &Order) -> Result<(), Message> {
    let reason = order.reason.as_deref().unwrap_or_default();
    if reason.trim().is_empty() {
        return Err(refused("hold_without_reason"));
    }
    Ok(())
}

fn replaced(db: &Path, order: &Order, by: &By, simulated: bool) -> Result<(), Message> {
    let name = order.counter.as_deref().unwrap_or_default();
    let at_us = jiff::Timestamp::now().as_microsecond();
    let write = |mut store: Store| {
        let known = store.replaced(simulated, name, &by.who, at_us)?;
        if known {
            store.record(&[lot_decision::audit(order, by)])?;
        }
        Ok(known)
    };
    let store = Store::open(db, &Identity::of_this_program());
    match store.and_then(write) {
        Ok(true) => Ok(()),
        Ok(false) => Err(refused("no_such_counter").with("counter", name)),
        Err(error) => Err(trouble(&error)),
    }
}

async fn beside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Message> + Send + 'static,
) -> Result<T, Message> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|error| Err(trouble(&error)))
}

fn refused(code: &'static str) -> Message {
    Message::new("refusal", code)
}

fn trouble(error: &dyn std::fmt::Display) -> Message {
    refused("program_trouble").with("detail", error)
}

fn not_now() -> Message {
    refused("between_lots")
}
