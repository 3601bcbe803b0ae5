//! Tests a run whose control cycle fails an assertion.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::order::LotOrder;
use crate::runtime;
use crate::source::{RigSource, Simulated};
use config::{Folder, Plant, load_recipe};
use history::{Archive, Filter, LotState};
use machine::view::{By, Order, OrderRequest};

#[test]
fn a_failed_assertion_ends_the_run_in_the_history() {
    let folder = tempfile::tempdir().unwrap();
    let (config, db) = (Folder::built_in(), folder.path().join("history.db"));
    let plant = Plant::load(&config).unwrap();
    let recipe = Arc::new(load_recipe(&config, "jzc-22f-012").unwrap());
    let order = LotOrder {
        lot: "A".into(),
        recipe: recipe.name.clone(),
        count: Some(9),
        retest: None,
    };
    let source = RigSource::Simulated(Simulated::with_seed(1));
    let controls = Controls::new(true);
    let runner = LotRunner {
        db: &db,
        context: LotContext::new(&plant, (&order, &recipe), &source, Purpose::Lot),
        controls: &controls,
    };
    let (orders, asked) = mpsc::channel(1);
    let exit = runtime(&source).unwrap().block_on(async {
        let lamp_test = Order {
            order: "lamp_test".into(),
            ..Order::default()
        };
        // The cycle calls this function, so the panic happens in the task of the cycle.
        let request = OrderRequest::new(lamp_test, By::default(), |_| {
            panic!("an assertion of the cycle")
        });
        orders.send(request).await.unwrap();
        runner.run(OrderQueue::from(asked), &mut ()).await.unwrap()
    });
    assert_eq!(exit, Exit::Trouble(Cause::assertion()));
    let archive = Archive::open(&db).unwrap();
    let runs = archive.lots(&Filter::default()).unwrap();
    let [run] = &runs[..] else { panic!("{runs:?}") };
    assert_eq!(run.ended.as_deref(), Some("alarm"));
    assert_eq!(run.cause.as_deref(), Some("assertion"));
    assert!(run.closed.is_some(), "the run stays open");
    let standing = archive.standing("A").unwrap().unwrap();
    assert_eq!(standing.state, LotState::Open);
}
