//! Tests the time between lots, on a rig in which an earlier run left a part.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::runtime;
use crate::source::Simulated;
use machine::view::{By, Order, View};
use std::sync::atomic::Ordering;
use tokio::sync::{oneshot, watch};

async fn until(view: &mut watch::Receiver<View>, test: impl Fn(&View) -> bool) {
    view.wait_for(|view| test(view)).await.unwrap();
}

async fn reset(orders: &mpsc::Sender<OrderRequest>) {
    let (answer, answered) = oneshot::channel();
    let way_back = move |it| drop(answer.send(it));
    let request = OrderRequest::new(Order::Reset {}, By::default(), way_back);
    orders.send(request).await.unwrap();
    assert_eq!(answered.await.unwrap(), Ok(None));
}

#[test]
fn a_part_found_between_lots_gets_its_own_lot() {
    let mut ignored = ();
    let folder = tempfile::tempdir().unwrap();
    let (config, db) = (Folder::built_in(), folder.path().join("history.db"));
    let plant = Plant::load(&config).unwrap();
    let drawn = Simulated::with_seed(1);
    let idle = between(&config).unwrap();
    let recipe = Arc::new(load_recipe(&config, "jzc-22f-012").unwrap());
    let lot = LotOrder {
        lot: "A".into(),
        recipe: recipe.name.clone(),
        count: Some(9),
        ..idle.clone()
    };
    let rig = simulated::build(&plant, &drawn, &lot).unwrap();
    let source = || {
        drawn.clone().on(LiveRig {
            epoch_us: i64::try_from(rig.now_us()).unwrap(),
            ..LiveRig::new(rig.clone())
        })
    };

    let (first, rig_of_first) = (Controls::new(true), source());
    let run = LotRunner {
        db: &db,
        context: LotContext::new(&plant, (&lot, &recipe), &rig_of_first, Purpose::Lot),
        controls: &first,
    };
    let (_orders, asked) = mpsc::channel(1);
    let life = runtime(&source()).unwrap();
    life.block_on(async {
        let mut seen = first.view.subscribe();
        let testing = |view: &View| view.judged == 1 && view.state.starts_with("testing");
        tokio::select! {
            _ = run.run(OrderQueue::from(asked), &mut ignored) => panic!("it ended"),
            () = until(&mut seen, testing) => {}
        }
    });
    life.shutdown_background();

    let (second, rig_of_second) = (Controls::new(true), source());
    let rests = Purpose::BetweenLots(State::Stopped);
    let run = LotRunner {
        db: &db,
        context: LotContext::new(&plant, (&idle, &recipe), &rig_of_second, rests),
        controls: &second,
    };
    let (orders, asked) = mpsc::channel(1);
    let life = runtime(&source()).unwrap();
    let exit = life.block_on(async {
        let mut seen = second.view.subscribe();
        let person = async {
            // The outputs went safe at the start: the spring has raised z.
            until(&mut seen, |view| {
                let is_on = |input| view.machine.inputs.get(input) == Some(&Some(true));
                is_on("nest_present") && is_on("sort_z_up")
            })
            .await;
            reset(&orders).await;
            until(&mut seen, |view| {
                assert!(view.machine.state != "Aborted", "{:?}", view.alarms);
                view.machine.state == "Idle"
            })
            .await;
            second.stop.store(true, Ordering::Release);
            std::future::pending::<()>().await;
        };
        tokio::select! {
            exit = run.run(OrderQueue::from(asked), &mut ignored) => exit.unwrap(),
            () = person => unreachable!(),
        }
    });
    assert_eq!(exit, Exit::Stopped);
    let archive = history::Archive::open(&db).unwrap();
    let found = archive.show(FOUND_LOT, 1, "lot").unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].verdict, "void");
    assert_eq!(found[0].landed_bin.as_deref(), Some("retest"));
    assert!(archive.standing(FOUND_LOT).unwrap().is_some());
}
