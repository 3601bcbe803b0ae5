//! Tests of plans for tooling: one under way, steps in their order, the end.

use super::*;
use crate::tooling::{
    Actor, PlanAction, PlanBody, PlanKind, PlanPicture, PlanRefusal, PlanStep, ToolingPlan,
};

fn step(number: usize, action: PlanAction, ids: &[&str]) -> PlanStep {
    PlanStep {
        step: number,
        action,
        elements: ids.iter().map(|it| (*it).to_owned()).collect(),
        direction: "-x".into(),
        distance_mm: 3.25,
        then: Vec::new(),
        clearance_mm: Some(0.1),
        slides_on: Vec::new(),
        clearance_to_others_mm: None,
        held_by: Vec::new(),
        tool_side: "-x".into(),
        on_bench: false,
    }
}

fn body(id: &str) -> PlanBody {
    let square = vec![vec![[0.0, 0.0], [1.5, 0.0], [1.5, 1.0]]];
    PlanBody {
        id: id.to_owned(),
        above: square.clone(),
        front: square,
    }
}

fn place(scene: usize, subassembly: Option<usize>) -> PlanPicture {
    PlanPicture { scene, subassembly }
}

/// A changeover: `b` comes off, then `c` goes on, which is put together with `d` on the bench before.
fn changeover() -> ToolingPlan {
    ToolingPlan {
        kind: PlanKind::Changeover,
        scene: "scene.toml".into(),
        to: Some("nests/other.toml".into()),
        remove: Vec::new(),
        summary: None,
        steps: vec![
            step(1, PlanAction::Remove, &["b"]),
            step(2, PlanAction::Add, &["d"]),
            step(3, PlanAction::Add, &["c", "d"]),
        ],
        scenes: vec![
            ["a", "b"].map(body).to_vec(),
            ["a", "c", "d"].map(body).to_vec(),
        ],
        pictures: vec![place(0, None), place(1, Some(2)), place(1, None)],
    }
}

fn by(who: &str, at_us: i64) -> Actor {
    Actor {
        who: who.into(),
        role: "maintainer".into(),
        at_us,
    }
}

#[test]
fn a_plan_under_way_survives_the_program() {
    let file = File::new();
    let number = file.store().start_plan(&changeover(), &by("wang", 5));
    assert_eq!(number.unwrap(), Ok(1));
    assert_eq!(file.store().tick_step(1, 1, &by("li", 6)).unwrap(), Ok(()));
    let archive = file.archive();
    assert_eq!(archive.plan_under_way().unwrap(), Some(1));
    let found = archive.plan(1).unwrap().unwrap();
    assert_eq!(found.plan, changeover());
    assert_eq!((found.entry.who.as_str(), found.entry.done), ("wang", 1));
    let ticks: Vec<_> = found
        .ticks
        .iter()
        .map(|it| (it.step, it.who.as_str(), it.at))
        .collect();
    assert_eq!(ticks, [(1, "li", Moment(6))]);
}

#[test]
fn only_one_plan_is_under_way() {
    let file = File::new();
    let mut store = file.store();
    store
        .start_plan(&changeover(), &by("wang", 5))
        .unwrap()
        .unwrap();
    let second = store.start_plan(&changeover(), &by("wang", 6)).unwrap();
    assert_eq!(second, Err(PlanRefusal::UnderWay { plan: 1 }));
    assert_eq!(
        store.abandon_plan(1, " ", &by("wang", 7)).unwrap(),
        Err(PlanRefusal::NoReason)
    );
    store
        .abandon_plan(1, "wrong nest", &by("wang", 8))
        .unwrap()
        .unwrap();
    let ended = Err(PlanRefusal::Ended { plan: 1 });
    assert_eq!(store.tick_step(1, 1, &by("wang", 9)).unwrap(), ended);
    assert_eq!(
        store.start_plan(&changeover(), &by("wang", 10)).unwrap(),
        Ok(2)
    );
    let end = file.archive().plans(10).unwrap()[1].end.clone().unwrap();
    assert_eq!(
        (end.how.as_str(), end.why.as_deref()),
        ("abandoned", Some("wrong nest"))
    );
}

#[test]
fn steps_are_done_in_their_order() {
    let file = File::new();
    let mut store = file.store();
    store
        .start_plan(&changeover(), &by("wang", 5))
        .unwrap()
        .unwrap();
    for (found, next) in [(0, 1), (2, 1), (3, 1)] {
        let refused = Err(PlanRefusal::NotNext { step: found, next });
        assert_eq!(store.tick_step(1, found, &by("wang", 6)).unwrap(), refused);
    }
    for step in 1..=3 {
        assert_eq!(store.tick_step(1, step, &by("wang", 7)).unwrap(), Ok(()));
    }
    let entry = &file.archive().plans(1).unwrap()[0];
    assert_eq!(
        (entry.done, entry.end.as_ref().unwrap().how.as_str()),
        (3, "done")
    );
    let unknown = Err(PlanRefusal::Unknown { plan: 7 });
    assert_eq!(store.tick_step(7, 1, &by("wang", 8)).unwrap(), unknown);
}

#[test]
fn pictures_show_what_stands_during_each_step() {
    let plan = changeover();
    let ids = |at: usize| -> Vec<&str> {
        let bodies = &plan.scenes[plan.pictures[at].scene];
        plan.standing(at)
            .into_iter()
            .map(|it| bodies[it].id.as_str())
            .collect()
    };
    assert_eq!(ids(0), ["a"]);
    assert_eq!(ids(1), ["c"], "on the bench, d meets c alone");
    assert_eq!(ids(2), ["a"]);
}
