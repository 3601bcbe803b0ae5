//! Runs whose history cannot be written for a while, in virtual time.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::order::LotOrder;
use crate::source::Simulated;
use config::{Folder, Plant, load_recipe};
use machine::view::{By, Order, OrderRequest, View};
use rusqlite::Connection;
use std::path::PathBuf;
use texts::{Lang, Message};
use tokio::sync::oneshot;

const COUNT: u64 = 6;

/// A lot of six parts at the page, and its history file.
struct Bench {
    plant: Plant,
    order: LotOrder,
    source: RigSource,
    controls: Controls,
    db: PathBuf,
    _folder: tempfile::TempDir,
}

impl Bench {
    fn new(attended: bool) -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self {
            plant: Plant::load(&Folder::built_in()).unwrap(),
            order: LotOrder {
                lot: "A".into(),
                recipe: "jzc-22f-012".into(),
                count: Some(COUNT),
                retest: None,
            },
            source: RigSource::Simulated(Simulated::with_seed(1)),
            controls: Controls::new(attended),
            db: folder.path().join("history.db"),
            _folder: folder,
        }
    }

    /// Runs the lot; `person` acts beside it with the sender of orders.
    fn run<F: Future<Output = ()>>(
        &self,
        person: impl FnOnce(mpsc::Sender<OrderRequest>, watch::Receiver<View>) -> F,
    ) -> Exit {
        let recipe = load_recipe(&self.plant.folder, &self.order.recipe).unwrap();
        let recipe = Arc::new(recipe);
        let runner = LotRunner {
            db: &self.db,
            context: LotContext::new(
                &self.plant,
                (&self.order, &recipe),
                &self.source,
                Purpose::Lot,
            ),
            controls: &self.controls,
        };
        let mut no_subscriber = ();
        let (orders, asked) = mpsc::channel(4);
        let seen = self.controls.view.subscribe();
        let life = crate::runtime(&self.source).unwrap();
        life.block_on(async {
            let acting = async {
                person(orders, seen).await;
                std::future::pending::<()>().await;
            };
            tokio::select! {
                exit = runner.run(OrderQueue::from(asked), &mut no_subscriber) => exit.unwrap(),
                () = acting => unreachable!(),
            }
        })
    }

    /// Makes every transaction with a part fail, as a full disk does.
    fn fail(&self) {
        let by_hand = Connection::open(&self.db).unwrap();
        let refuse =
            "CREATE TRIGGER full BEFORE INSERT ON part BEGIN SELECT RAISE(ABORT, 'no room'); END";
        by_hand.execute_batch(refuse).unwrap();
    }

    fn mend(&self) {
        let by_hand = Connection::open(&self.db).unwrap();
        by_hand.execute_batch("DROP TRIGGER full").unwrap();
    }

    /// Checks that every part of the lot has one row and lies in its bin.
    fn check_rows(&self, parts: u64) {
        let archive = history::Archive::open(&self.db).unwrap();
        let runs = archive.lots(&history::Filter::default()).unwrap();
        assert_eq!(runs.len(), 1, "one run");
        assert_eq!(runs[0].counts.parts, parts);
        let rows = archive.query(&history::Filter::default()).unwrap();
        assert!(rows.iter().all(|it| it.landed_bin == it.bin), "{rows:?}");
    }
}

async fn until(view: &mut watch::Receiver<View>, test: impl Fn(&View) -> bool) {
    view.wait_for(|view| test(view)).await.unwrap();
}

async fn order(orders: &mpsc::Sender<OrderRequest>, word: &str) -> Result<(), Message> {
    let (answer, answered) = oneshot::channel();
    let order = Order {
        order: word.into(),
        ..Order::default()
    };
    let way_back = move |it| drop(answer.send(it));
    let request = OrderRequest::new(order, By::default(), way_back);
    orders.send(request).await.unwrap();
    answered.await.unwrap()
}

fn lost(view: &View) -> bool {
    let mut alarms = view.alarms.iter();
    alarms.any(|it| it.code == "history_lost" && it.state != "returned")
}

#[test]
fn a_lot_goes_on_after_an_outage_and_loses_nothing() {
    let bench = Bench::new(true);
    let exit = bench.run(async |orders, mut seen| {
        until(&mut seen, |view| view.judged >= 2).await;
        bench.fail();
        until(&mut seen, |view| {
            view.machine.state == "Aborted" && lost(view)
        })
        .await;
        let why = order(&orders, "clear").await.unwrap_err().say(Lang::En);
        assert!(
            why.contains("history.db cannot be written") && why.contains("no room"),
            "{why}"
        );
        bench.mend();
        until(&mut seen, |view| !lost(view)).await;
        for (word, state) in [
            ("clear", "Stopped"),
            ("reset", "Idle"),
            ("start", "Execute"),
        ] {
            assert_eq!(order(&orders, word).await, Ok(()), "{word}");
            until(&mut seen, |view| view.machine.state == state).await;
        }
    });
    assert_eq!(exit, Exit::Done);
    let judged = bench.controls.view.borrow().judged;
    assert!(judged >= COUNT, "{judged}");
    bench.check_rows(judged);
    let by_hand = Connection::open(&bench.db).unwrap();
    let told =
        "SELECT count(*) FROM alarm WHERE code = 'history_lost' AND cleared_at_us IS NOT NULL";
    let told: i64 = by_hand.query_row(told, [], |row| row.get(0)).unwrap();
    assert_eq!(told, 1);
}

#[test]
fn an_outage_that_is_too_long_ends_an_attended_run() {
    let bench = Bench::new(true);
    let exit = bench.run(async |_orders, mut seen| {
        until(&mut seen, |view| view.judged >= 2).await;
        bench.fail();
    });
    assert_eq!(exit.code(), 3);
    assert_eq!(
        exit.cause().map(|it| it.code.as_str()),
        Some("history_lost")
    );
}

#[test]
fn an_unattended_run_waits_for_its_history_and_completes() {
    let bench = Bench::new(false);
    let exit = bench.run(async |_orders, mut seen| {
        until(&mut seen, |view| view.judged >= 2).await;
        bench.fail();
        let pace = Pace::virtual_time();
        pace.sleep_until(units::RigTime(100_000_000)).await;
        assert!(seen.borrow().alarms.is_empty());
        assert_eq!(seen.borrow().machine.state, "Execute");
        bench.mend();
    });
    assert_eq!(exit, Exit::Done);
    bench.check_rows(COUNT);
}
