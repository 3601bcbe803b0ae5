//! Tests of plans for tooling: previews, starts, ticks, abandoning, and the permissions for them.

use super::*;
use crate::{ListedScene, PlanAnswer, PlanFault, PlanMaker, PlanQuestion};
use ::history::tooling::{PlanAction, PlanBody, PlanPicture, PlanStep, ToolingPlan};
use ::history::{Archive, Filter, OrderChoice};
use serde_json::{Value, json};

/// Answers every question with a plan of two steps, but element `stuck` is locked, and scene `none.toml` is faulty.
#[derive(Debug)]
pub(super) struct OneStep;

fn step(number: usize, id: &str) -> PlanStep {
    PlanStep {
        step: number,
        action: PlanAction::Remove,
        elements: vec![id.to_owned()],
        direction: "+z".into(),
        distance_mm: 12.5,
        then: Vec::new(),
        clearance_mm: None,
        slides_on: vec!["plate".into()],
        clearance_to_others_mm: None,
        held_by: Vec::new(),
        tool_side: "+z".into(),
        on_bench: false,
    }
}

impl PlanMaker for OneStep {
    fn scenes(&self) -> Result<Vec<ListedScene>, PlanFault> {
        Ok(vec![ListedScene {
            name: "scene.toml".into(),
            elements: ["plate", "cover", "relay"].map(str::to_owned).to_vec(),
        }])
    }

    fn make(&self, question: &PlanQuestion) -> Result<PlanAnswer, PlanFault> {
        if question.scene == "none.toml" {
            return Err(PlanFault("none.toml: not readable".into()));
        }
        if question.remove.iter().any(|it| it == "stuck") {
            return Ok(PlanAnswer::Locked(vec!["stuck".into(), "plate".into()]));
        }
        let square = |at: f64| {
            vec![vec![
                [0.0, at],
                [10.0, at],
                [10.0, at + 5.0],
                [0.0, at + 5.0],
            ]]
        };
        let body = |(id, at): (&str, f64)| PlanBody {
            id: id.to_owned(),
            above: square(0.0),
            front: square(at),
        };
        let place = PlanPicture {
            scene: 0,
            subassembly: None,
        };
        Ok(PlanAnswer::Plan(Box::new(ToolingPlan {
            kind: question.kind,
            scene: question.scene.clone(),
            to: question.to.clone(),
            remove: question.remove.clone(),
            summary: None,
            steps: vec![step(1, "cover"), step(2, "relay")],
            scenes: vec![
                [("plate", 0.0), ("relay", 5.0), ("cover", 10.0)]
                    .map(body)
                    .to_vec(),
            ],
            pictures: vec![place.clone(), place],
        })))
    }
}

impl Fixture {
    async fn plan_order(&self, role: Role, path: &str, body: Value) -> Answer {
        let token = self.session(role);
        let path = format!("/api/plans/{path}");
        self.post(&path, Some(&token), body).await
    }
}

fn question() -> Value {
    json!({"kind": "disassembly", "scene": "scene.toml", "remove": ["relay"]})
}

#[tokio::test]
async fn steps_are_ticked_off_in_their_order() {
    let fixture = Fixture::new();
    let started = fixture
        .plan_order(Role::Maintainer, "start", question())
        .await;
    assert_eq!(started.status, 200, "{}", started.text());
    assert_eq!(started.json()["plan"], 1);
    let second = fixture
        .plan_order(Role::Maintainer, "start", question())
        .await;
    assert!(second.refused(409).contains("plan 1 is under way"));
    let skipped = json!({"plan": 1, "step": 2});
    let skipped = fixture.plan_order(Role::Maintainer, "tick", skipped).await;
    assert!(skipped.refused(409).contains("expected step 1"));
    let none = json!({"plan": 1, "step": 1});
    let none = fixture.plan_order(Role::Maintainer, "untick", none).await;
    assert!(none.refused(409).contains("no step is done"));
    let first = || json!({"plan": 1, "step": 1});
    fixture.plan_order(Role::Maintainer, "tick", first()).await;
    let back = fixture
        .plan_order(Role::Maintainer, "untick", first())
        .await;
    assert!(back.json()["shown"]["steps"][0]["done"].is_null());
    for number in [1, 2] {
        let body = json!({"plan": 1, "step": number});
        let ticked = fixture.plan_order(Role::Maintainer, "tick", body).await;
        let steps = &ticked.json()["shown"]["steps"];
        assert_eq!(steps[number - 1]["done"]["who"], "maintainer");
    }
    let shown = fixture.get("/api/plans/show?plan=1").await.json();
    assert_eq!(shown["end"]["how"], "done");
    assert_eq!(fixture.get("/api/plans/list").await.json()[0]["done"], 2);
    let again = json!({"plan": 1, "step": 3});
    let again = fixture.plan_order(Role::Maintainer, "tick", again).await;
    assert!(again.refused(409).contains("has ended"));
    let paper = fixture.get("/api/plans/paper?plan=1&lang=zh").await;
    assert!(paper.text().contains("工装拆卸") && paper.text().contains("☑ maintainer"));
}

#[tokio::test]
async fn a_plan_is_abandoned_with_a_reason() {
    let fixture = Fixture::new();
    fixture
        .plan_order(Role::Maintainer, "start", question())
        .await;
    let empty = json!({"plan": 1, "reason": " "});
    let empty = fixture.plan_order(Role::Maintainer, "abandon", empty).await;
    assert!(empty.refused(400).contains("reason"));
    let body = json!({"plan": 1, "reason": "wrong nest"});
    let ended = fixture.plan_order(Role::Maintainer, "abandon", body).await;
    assert_eq!(ended.json()["end"]["why"], "wrong nest");
    let next = fixture
        .plan_order(Role::Maintainer, "start", question())
        .await;
    assert_eq!(next.json()["plan"], 2);
    fixture.get("/api/plans/show?plan=3").await.refused(404);
}

#[tokio::test]
async fn an_operator_changes_no_plan_and_leaves_a_line() {
    let fixture = Fixture::new();
    for (path, body) in [
        ("start", question()),
        ("tick", json!({"plan": 1, "step": 1})),
        ("untick", json!({"plan": 1, "step": 1})),
        ("abandon", json!({"plan": 1, "reason": "x"})),
    ] {
        let answer = fixture.plan_order(Role::Operator, path, body).await;
        assert!(answer.refused(403).contains("maintainer"));
    }
    let archive = Archive::open(&fixture.db).unwrap();
    assert_eq!(archive.plans(10).unwrap(), []);
    let orders = archive.orders(&Filter::default(), &OrderChoice::default());
    let lines = orders.unwrap();
    let words: Vec<&str> = lines
        .iter()
        .map(|it| it.what["order"].as_str().unwrap())
        .collect();
    assert_eq!(
        words,
        ["plan_start", "plan_step", "plan_step_back", "plan_abandon"]
    );
    assert!(lines.iter().all(|it| it.refused.is_some()));
}

#[tokio::test]
async fn a_preview_stores_nothing_and_names_what_is_locked() {
    let fixture = Fixture::new();
    let preview = |body: Value| fixture.post("/api/plans/preview", None, body);
    let shown = preview(question()).await.json();
    assert!(shown["shapes"].as_str().unwrap().contains("plan-above-0-1"));
    let front = shown["steps"][0]["front"].as_str().unwrap();
    assert!(front.contains("class=\"moves\"") && front.contains("class=\"holds\""));
    let second = shown["steps"][1]["front"].as_str().unwrap();
    assert!(
        !second.contains("#plan-front-0-2"),
        "the cover has left: {second}"
    );
    let mut locked = question();
    locked["remove"] = json!(["stuck"]);
    assert!(preview(locked).await.refused(409).contains("stuck, plate"));
    let mut faulty = question();
    faulty["scene"] = json!("none.toml");
    assert!(preview(faulty).await.refused(400).contains("none.toml"));
    let mut nothing = question();
    nothing["remove"] = json!([]);
    preview(nothing).await.refused(400);
    assert!(
        !fixture.db.exists()
            || Archive::open(&fixture.db)
                .unwrap()
                .plans(1)
                .unwrap()
                .is_empty()
    );
}
