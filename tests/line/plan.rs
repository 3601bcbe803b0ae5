//! `relayrig plan`: tables and orders of scenes, every step tried again by `relayrig check`; refusals.

use crate::program::{Said, Workshop};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

const DEFAULT: &str = "config/scene.toml";
const OTHER: &str = "config/nests/body-18x12.toml";

/// A scene as JSON: its elements without carriers, and the pairs that run in each other.
struct Scene {
    elements: Vec<Map<String, Value>>,
    ignored: Vec<(String, String)>,
}

impl Scene {
    fn of(workshop: &Workshop, file: &str) -> Scene {
        let table: toml::Table = workshop.read(file).parse().unwrap();
        let tables = |key: &str| {
            let list = table[key].as_array().unwrap().clone();
            list.into_iter().map(|it| serde_json::to_value(it).unwrap())
        };
        let mut elements: Vec<Map<String, Value>> = Vec::new();
        for mut element in tables("elements") {
            let element = element.as_object_mut().unwrap();
            element.remove("rides");
            elements.push(element.clone());
        }
        let ignored = tables("pair").filter(|it| it["rule"] == "ignore");
        let stem = |it: &Value| it.as_str().unwrap().trim_end_matches('*').to_owned();
        Scene {
            elements,
            ignored: ignored.map(|it| (stem(&it["a"]), stem(&it["b"]))).collect(),
        }
    }

    fn ids(&self) -> BTreeSet<String> {
        let ids = self.elements.iter().map(|it| it["id"].as_str().unwrap());
        ids.map(str::to_owned).collect()
    }

    fn is_ignored(&self, one: &str, other: &str) -> bool {
        let fits = |a: &str, b: &str| {
            let mut pairs = self.ignored.iter();
            pairs.any(|it| a.starts_with(it.0.as_str()) && b.starts_with(it.1.as_str()))
        };
        fits(one, other) || fits(other, one)
    }

    /// Asks `check` about a step that leads away from the elements in place, or back to them.
    fn try_step(&self, workshop: &Workshop, step: &Value, in_place: &BTreeSet<String>) {
        let moving = ids(&step["elements"]);
        let slides_on = ids(&step["slides_on"]);
        let named = |set: &BTreeSet<String>| -> Vec<Value> {
            let of_set = |it: &&Map<String, Value>| set.contains(it["id"].as_str().unwrap());
            let found = self.elements.iter().filter(of_set);
            found.map(|it| Value::Object(it.clone())).collect()
        };
        let stays: BTreeSet<String> = in_place.difference(&moving).cloned().collect();
        let scene = json!({"elements": named(&stays), "movers": named(&moving)});
        workshop.write("step.json", &scene.to_string());
        let mut legs = vec![step.clone()];
        legs.extend(step["then"].as_array().unwrap().iter().cloned());
        let mut place = [0.0; 3];
        let mut places = vec![place];
        for leg in &legs {
            let direction = leg["direction"].as_str().unwrap();
            let axis = "xyz".find(&direction[1..]).unwrap();
            let sign = if direction.starts_with('+') {
                1.0
            } else {
                -1.0
            };
            place[axis] += sign * leg["distance_mm"].as_f64().unwrap();
            places.push(place);
        }
        // An element that comes begins outside and ends at its place.
        if step["action"] == "add" {
            let end = place;
            for at in &mut places {
                *at = [0, 1, 2].map(|axis| at[axis] - end[axis]);
            }
        }
        let mut lines = String::new();
        for mover in &moving {
            let ignore: Vec<&String> = stays
                .iter()
                .filter(|it| slides_on.contains(*it) || self.is_ignored(mover, it))
                .collect();
            for ends in places.windows(2) {
                let id = format!("{mover} {}", lines.len());
                let line = json!({"id": id, "mover": mover, "ignore": ignore,
                    "from": {"position": ends[0]}, "to": {"position": ends[1]}});
                lines += &format!("{line}\n");
            }
        }
        workshop.write("step.jsonl", &lines);
        workshop
            .run("check --scene step.json --moves step.jsonl --json")
            .with_status(0);
    }
}

fn ids(list: &Value) -> BTreeSet<String> {
    let ids = list.as_array().unwrap().iter();
    ids.map(|it| it.as_str().unwrap().to_owned()).collect()
}

fn steps(said: &Said) -> Vec<Value> {
    let objects = said.objects().into_iter();
    objects.filter(|it| it.get("step").is_some()).collect()
}

#[test]
fn every_step_of_the_default_fixture_is_clear_again() {
    let workshop = Workshop::new("plan-default");
    let scene = Scene::of(&workshop, DEFAULT);
    let all = scene.ids();
    let kept: BTreeSet<String> = all
        .iter()
        .filter(|id| id.starts_with("baseplate"))
        .cloned()
        .collect();
    for (question, action) in [("disassembly", "remove"), ("assembly", "add")] {
        let line = format!("plan {question} --stay baseplate* --json");
        let said = workshop.run(&line).with_status(0);
        let mut in_place = if action == "remove" {
            all.clone()
        } else {
            kept.clone()
        };
        for step in steps(&said) {
            assert_eq!(step["action"], action);
            scene.try_step(&workshop, &step, &in_place);
            for id in ids(&step["elements"]) {
                let is_new = match action {
                    "remove" => in_place.remove(&id),
                    _ => in_place.insert(id.clone()),
                };
                assert!(is_new, "{id} twice");
            }
        }
        let wanted = if action == "remove" { &kept } else { &all };
        assert_eq!(&in_place, wanted);
    }
}

#[test]
fn a_changeover_leads_from_one_nest_to_the_other() {
    let workshop = Workshop::new("plan-changeover");
    let (before, after) = (Scene::of(&workshop, DEFAULT), Scene::of(&workshop, OTHER));
    for (from, to, scenes) in [
        (DEFAULT, OTHER, [&before, &after]),
        (OTHER, DEFAULT, [&after, &before]),
    ] {
        let line =
            format!("plan changeover --from {from} --to {to} --stay baseplate* --forbid=-y --json");
        let said = workshop.run(&line).with_status(0);
        let summary = &said.objects()[0];
        let stays = ids(&summary["stays"]);
        assert!(ids(&summary["goes"]).contains("rail_left"), "{summary}");
        let mut in_place = scenes[0].ids();
        for step in steps(&said) {
            let is_off = step["action"] == "remove";
            scenes[usize::from(!is_off)].try_step(&workshop, &step, &in_place);
            let forbidden = if is_off { "-y" } else { "+y" };
            assert_ne!(step["direction"], forbidden);
            for id in ids(&step["elements"]) {
                assert!(!stays.contains(&id), "{id} stays");
                let is_new = if is_off {
                    in_place.remove(&id)
                } else {
                    in_place.insert(id.clone())
                };
                assert!(is_new, "{id} twice");
            }
        }
        assert_eq!(in_place, scenes[1].ids());
    }
}

#[test]
fn printed_answers_are_in_the_language_asked_for() {
    const LOCKED_AWAY: &str = "disassembly --scene scene.json --stay left --stay right --forbid=+y --forbid=-y \
                               --forbid=+z --forbid=-z";
    let workshop = Workshop::new("plan-printed");
    workshop.write("scene.json", LOCKED);
    for (question, word, status) in [
        ("interference", "towards", 0),
        ("disassembly --stay baseplate*", "Take off", 0),
        ("assembly --stay baseplate*", "Put on", 0),
        (
            &format!("changeover --from {DEFAULT} --to {OTHER}"),
            "Comes off for good",
            0,
        ),
        (LOCKED_AWAY, "lock each other", 1),
    ] {
        let said = |lang: &str| workshop.run(&format!("plan {question} --lang {lang}"));
        let english = said("en").with_status(status);
        assert!(
            english.stdout.contains(word) && english.stdout.is_ascii(),
            "{english}"
        );
        let chinese = said("zh").with_status(status);
        assert!(!chinese.stdout.is_ascii(), "{chinese}");
    }
}

#[test]
fn a_printed_plan_draws_every_step_in_both_languages() {
    let workshop = Workshop::new("plan-paper");
    let line = format!("plan changeover --from {DEFAULT} --to {OTHER} --stay baseplate*");
    let count = steps(&workshop.run(&format!("{line} --json")).with_status(0)).len();
    for (lang, word) in [("en", "Changeover of tooling"), ("zh", "工装换型")] {
        let page = workshop
            .run(&format!("{line} --lang {lang} --out -"))
            .with_status(0)
            .stdout;
        assert!(page.starts_with("<!DOCTYPE html>") && page.contains(word));
        assert_eq!(page.matches("class=\"plan_picture above\"").count(), count);
        assert_eq!(page.matches("class=\"plan_picture front\"").count(), count);
        assert!(page.matches("class=\"moves\"").count() >= 2 * count);
        assert!(page.contains("class=\"holds\""));
    }
}

#[test]
fn the_second_nest_makes_a_rig() {
    let workshop = Workshop::new("plan-nest");
    workshop.write(DEFAULT, &workshop.read(OTHER));
    workshop.run("config check").with_status(0);
}

#[test]
fn a_row_per_element_and_direction_names_its_blockers() {
    let workshop = Workshop::new("plan-table");
    let rows = workshop
        .run("plan interference --json")
        .with_status(0)
        .objects();
    assert_eq!(rows.len(), 6 * Scene::of(&workshop, DEFAULT).ids().len());
    let row = |element: &str, direction: &str| {
        let mut rows = rows.iter();
        let found = rows.find(|it| it["element"] == element && it["direction"] == direction);
        ids(&found.unwrap()["blockers"])
    };
    assert!(row("probe_housing", "+z").contains("gripper_palm"));
    assert!(row("gripper_palm", "-z").contains("probe_housing"));
    assert!(row("probe_housing", "-z").is_empty());
    // The rod runs in the carriage: along z it comes out, across it does not.
    assert!(!row("sort_z_rod", "+z").contains("axis_carriage"));
    assert!(row("sort_z_rod", "+x").contains("axis_carriage"));
}

const LOCKED: &str = r#"{"elements": [
    {"id": "cube", "kind": "block", "half": [1, 1, 1]},
    {"id": "left", "kind": "block", "half": [1, 9, 9], "pose": {"position": [-3, 0, 0]}},
    {"id": "right", "kind": "block", "half": [1, 9, 9], "pose": {"position": [3, 0, 0]}}]}"#;

#[test]
fn a_locked_element_ends_with_its_holders() {
    let workshop = Workshop::new("plan-locked");
    workshop.write("scene.json", LOCKED);
    let line = "plan disassembly --scene scene.json --stay left --stay right --json";
    let locked = format!("{line} --forbid=+y --forbid=-y --forbid=+z --forbid=-z");
    let said = workshop.run(&locked).with_status(1).objects();
    assert_eq!(
        said,
        [json!({"locked": ["cube"], "by": {"cube": ["left", "right"]}})]
    );
    assert_eq!(workshop.run(line).with_status(0).objects().len(), 1);
}

#[test]
fn bad_demands_and_scenes_are_named() {
    let workshop = Workshop::new("plan-refused");
    workshop.write("scene.json", LOCKED);
    let pressed = LOCKED.replace("[3, 0, 0]", "[1.5, 0, 0]");
    workshop.write("overlap.json", &pressed);
    let apart = |mate: &str| LOCKED.replace("{\"elements\"", &format!("{{{mate}, \"elements\""));
    let mate = r#""mate": [{"a": "cube", "b": "left", "kind": "plane"}]"#;
    workshop.write("mate.json", &apart(mate));
    let kind = r#""mate": [{"a": "cube", "b": "left", "kind": "glue"}]"#;
    workshop.write("kind.json", &apart(kind));
    for (line, says) in [
        (
            "disassembly --scene scene.json --remove ball",
            "remove: found \"ball\"",
        ),
        (
            "disassembly --scene scene.json --remove cube --stay cu*",
            "both remove and stay",
        ),
        (
            "disassembly --scene scene.json --remove cube --stay left --group cube,left",
            "\"left\"",
        ),
        (
            "assembly --scene scene.json --stay ball",
            "stay: found \"ball\"",
        ),
        (
            "interference --scene scene.json --omega -2,-2,-2,2,2,2",
            "\"left\": found from",
        ),
        (
            "interference --scene scene.json --omega 2,-2,-2,2,2,2",
            "--omega: found",
        ),
        (
            "interference --scene overlap.json",
            "\"cube\" and \"right\": found overlapping",
        ),
        ("interference --scene mate.json", "mate[0]"),
        ("interference --scene kind.json", "glue"),
        ("interference --scene none.json", "none.json: not readable"),
        ("disassembly --scene scene.json --forbid up", "found \"up\""),
    ] {
        let said = workshop.run(&format!("plan {line}")).with_status(2);
        assert_eq!(said.stdout, "", "{line}");
        assert!(said.stderr.contains(says), "{line}: {says}\n{said}");
    }
}
