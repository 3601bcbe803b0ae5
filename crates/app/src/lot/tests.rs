//! Tests of whole runs in virtual time: a failed assertion of the cycle, a history that cannot be written for a while.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::order::LotOrder;
use crate::source::Simulated;
use config::{Folder, Plant, load_recipe};
use history::{Archive, Filter, LotState, OrderChoice};
use machine::view::{By, Order, OrderRequest, View};
use rusqlite::Connection;
use serde_json::{Value, json};
use std::path::PathBuf;
use texts::{Lang, Message};
use tokio::sync::oneshot;

const COUNT: u64 = 6;

/// A lot of six parts on a simulated rig, and its history file.
struct TestLot {
    plant: Plant,
    order: LotOrder,
    source: RigSource,
    controls: Controls,
    db: PathBuf,
    _folder: tempfile::TempDir,
}

impl TestLot {
    fn new(attended: bool) -> Self {
        Self::of(&Folder::built_in(), "jzc-22f-012", attended)
    }

    fn of(config: &Folder, recipe: &str, attended: bool) -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self {
            plant: Plant::load(config).unwrap(),
            order: LotOrder {
                lot: "A".into(),
                recipe: recipe.into(),
                count: Some(COUNT),
                retest: None,
            },
            source: RigSource::Simulated(Simulated::with_seed(1)),
            controls: Controls::new(attended),
            db: folder.path().join("history.db"),
            _folder: folder,
        }
    }

    /// Runs the lot, and beside it `person`, with the sender of orders and the view.
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
        let runtime = crate::runtime(&self.source).unwrap();
        runtime.block_on(async {
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

    /// Checks that the lot has one run with this many parts, each in its bin.
    fn check_rows(&self, parts: u64) {
        let archive = Archive::open(&self.db).unwrap();
        let runs = archive.lots(&Filter::default()).unwrap();
        assert_eq!(runs.len(), 1, "one run");
        assert_eq!(runs[0].counts.parts, parts);
        let rows = archive.query(&Filter::default()).unwrap();
        assert!(rows.iter().all(|it| it.landed_bin == it.bin), "{rows:?}");
    }
}

async fn until(view: &mut watch::Receiver<View>, test: impl Fn(&View) -> bool) {
    view.wait_for(|view| test(view)).await.unwrap();
}

async fn order(orders: &mpsc::Sender<OrderRequest>, word: &str) -> Result<(), Message> {
    give(orders, json!({"order": word})).await
}

async fn give(orders: &mpsc::Sender<OrderRequest>, order: Value) -> Result<(), Message> {
    let (answer, answered) = oneshot::channel();
    let order = serde_json::from_value(order).unwrap();
    let way_back = move |it| drop(answer.send(it));
    let request = OrderRequest::new(order, By::default(), way_back);
    orders.send(request).await.unwrap();
    answered.await.unwrap().map(drop)
}

fn lost(view: &View) -> bool {
    let mut alarms = view.alarms.iter();
    alarms.any(|it| it.code == "history_lost" && it.state != "returned")
}

#[test]
fn a_failed_assertion_ends_the_run_in_the_history() {
    let test = TestLot::new(true);
    let exit = test.run(async |orders, _seen| {
        // The cycle calls this function, so the panic happens in the task of the cycle.
        let request = OrderRequest::new(Order::LampTest {}, By::default(), |_| {
            panic!("an assertion of the cycle")
        });
        orders.send(request).await.unwrap();
    });
    assert_eq!(exit, Exit::Trouble(Cause::assertion()));
    let archive = Archive::open(&test.db).unwrap();
    let runs = archive.lots(&Filter::default()).unwrap();
    let [run] = &runs[..] else { panic!("{runs:?}") };
    assert_eq!(run.ended.as_deref(), Some("alarm"));
    assert_eq!(run.cause.as_deref(), Some("assertion"));
    assert!(run.closed.is_some(), "the run stays open");
    let standing = archive.standing("A").unwrap().unwrap();
    assert_eq!(standing.state, LotState::Open);
}

#[test]
fn a_failed_assertion_leaves_no_source_on() {
    let config = Folder::built_in_rig("ssr").unwrap();
    let test = TestLot::of(&config, "ssr-dc-60v-3a", true);
    let exit = test.run(async |orders, mut seen| {
        until(&mut seen, |view| view.stage == Some("OnResistance")).await;
        let request = OrderRequest::new(Order::LampTest {}, By::default(), |_| {
            panic!("an assertion of the cycle")
        });
        orders.send(request).await.unwrap();
    });
    assert_eq!(exit, Exit::Trouble(Cause::assertion()));
    let traffic = test.controls.traffic()(1000);
    for name in ["smu_in", "smu_out"] {
        let link = traffic.iter().find(|it| it.line == name).unwrap();
        let sent = link.entries.iter().filter(|it| it.way == ">");
        let switched: Vec<&str> = sent
            .filter_map(|it| it.text.strip_prefix(":OUTP ")?.strip_suffix("\\n"))
            .collect();
        assert!(switched.contains(&"ON"), "{name}: {switched:?}");
        assert_eq!(switched.last(), Some(&"OFF"), "{name}: {switched:?}");
    }
}

#[test]
fn the_end_of_a_run_leaves_no_order_unanswered() {
    let test = TestLot::new(true);
    test.run(async |orders, mut seen| {
        until(&mut seen, |view| view.judged >= 1).await;
        for (word, state) in [("stop", "Stopped"), ("reset", "Idle")] {
            assert_eq!(order(&orders, word).await, Ok(()), "{word}");
            until(&mut seen, |view| view.machine.state == state).await;
        }
        let mode = |mode| json!({"order": "mode", "mode": mode});
        assert_eq!(give(&orders, mode("manual")).await, Ok(()));
        let close = async {
            assert_eq!(give(&orders, mode("production")).await, Ok(()));
            give(&orders, json!({"order": "close_lot", "lot": "A"})).await
        };
        let jog = json!({"order": "jog", "motion": "pusher_extend"});
        let (jogged, closed) = tokio::join!(give(&orders, jog), close);
        assert_eq!(
            (jogged.unwrap_err().code(), closed),
            ("not_arrived", Ok(()))
        );
        // The cycle still writes the safe outputs.
        let late = order(&orders, "lamp_test").await.unwrap_err();
        assert_eq!(late.code(), "run_ended");
    });
    let archive = Archive::open(&test.db).unwrap();
    for word in ["jog", "lamp_test"] {
        let recorded = archive
            .orders(
                &Filter::default(),
                &OrderChoice {
                    order: Some(word.to_owned()),
                    ..OrderChoice::default()
                },
            )
            .unwrap();
        assert!(
            recorded.len() == 1 && recorded[0].refused.is_some(),
            "{word}"
        );
    }
}

#[test]
fn a_lot_continues_after_an_outage_without_loss() {
    let test = TestLot::new(true);
    let exit = test.run(async |orders, mut seen| {
        until(&mut seen, |view| view.judged >= 2).await;
        test.fail();
        until(&mut seen, |view| {
            view.machine.state == "Aborted" && lost(view)
        })
        .await;
        let why = order(&orders, "clear").await.unwrap_err().say(Lang::En);
        assert_eq!(why, "make the history file writable first");
        test.mend();
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
    let judged = test.controls.view.borrow().judged;
    assert!(judged >= COUNT, "{judged}");
    test.check_rows(judged);
    let by_hand = Connection::open(&test.db).unwrap();
    let cleared =
        "SELECT count(*) FROM alarm WHERE code = 'history_lost' AND cleared_at_us IS NOT NULL";
    let cleared: i64 = by_hand.query_row(cleared, [], |row| row.get(0)).unwrap();
    assert_eq!(cleared, 1);
}

#[test]
fn too_long_an_outage_ends_an_attended_run() {
    let test = TestLot::new(true);
    let exit = test.run(async |_orders, mut seen| {
        until(&mut seen, |view| view.judged >= 2).await;
        test.fail();
    });
    assert_eq!(exit.code(), 3);
    assert_eq!(
        exit.cause().map(|it| it.code.as_str()),
        Some("history_lost")
    );
}

#[test]
fn an_unattended_run_waits_for_its_history_and_completes() {
    let test = TestLot::new(false);
    let exit = test.run(async |_orders, mut seen| {
        until(&mut seen, |view| view.judged >= 2).await;
        test.fail();
        let pace = Pace::virtual_time();
        pace.sleep_until(units::RigTime(100_000_000)).await;
        assert!(seen.borrow().alarms.is_empty());
        assert_eq!(seen.borrow().machine.state, "Execute");
        test.mend();
    });
    assert_eq!(exit, Exit::Done);
    test.check_rows(COUNT);
}
