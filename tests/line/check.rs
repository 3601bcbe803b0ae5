//! `relayrig check`: refusals, and no answer before all input is read.

use crate::program::Workshop;

const SCENE: &str = r#"{"units": "mm",
    "elements": [{"id": "pin", "kind": "cylinder", "radius": 4, "height": 30},
                 {"id": "nest", "kind": "block", "half": [9, 8, 7], "pose": {"position": [100, 0, 0]}}],
    "movers": [{"id": "jaw", "kind": "block", "half": [1, 2, 3]}]}"#;
const GOOD: &str =
    r#"{"id":"m1","mover":"jaw","from":{"position":[-20,0,0]},"to":{"position":[20,0,0]}}"#;

/// A change of the scene, with the path in the expected message.
const SCENES: &[(&str, &str, &str)] = &[
    (
        "\"half\": [9, 8, 7]",
        "\"half\": [9, 0, 7]",
        "elements[1].half[1]: found 0",
    ),
    (
        "\"half\": [9, 8, 7]",
        "\"half\": [9, -8, 7]",
        "elements[1].half[1]: found -8",
    ),
    (
        "\"half\": [9, 8, 7]",
        "\"half\": [9, NaN, 7]",
        "elements[1].half[1]: found NaN",
    ),
    (
        "\"half\": [9, 8, 7]",
        "\"half\": [9, Infinity, 7]",
        "elements[1].half[1]: found Infinity",
    ),
    (
        "\"half\": [9, 8, 7]",
        "\"half\": [9, 1e999, 7]",
        "elements[1].half[1]: found 1e999",
    ),
    (
        "\"half\": [9, 8, 7]",
        "\"half\": [9, 2e6, 7]",
        "elements[1].half[1]: found 2000000",
    ),
    (
        "\"half\": [9, 8, 7]",
        "\"half\": [9, 8]",
        "elements[1].half: found",
    ),
    (
        "\"half\": [9, 8, 7]",
        "\"half\": [9, \"8\", 7]",
        "elements[1].half[1]: found \"8\"",
    ),
    (
        ", \"half\": [9, 8, 7]",
        "",
        "elements[1].half: found nothing",
    ),
    (
        "\"radius\": 4",
        "\"radius\": 0",
        "elements[0].radius: found 0",
    ),
    (
        "\"radius\": 4",
        "\"radius\": null",
        "elements[0].radius: found null",
    ),
    (
        "\"radius\": 4",
        "\"radius\": 4, \"diameter\": 8",
        "elements[0].diameter: found an unknown key",
    ),
    (
        "\"height\": 30",
        "\"height\": -1",
        "elements[0].height: found -1",
    ),
    (
        "\"kind\": \"cylinder\"",
        "\"kind\": \"sphere\"",
        "elements[0].kind: found \"sphere\"",
    ),
    (
        "\"kind\": \"cylinder\", ",
        "",
        "elements[0].kind: found nothing",
    ),
    (
        "\"id\": \"nest\"",
        "\"id\": \"pin\"",
        "elements[1].id: found \"pin\" again",
    ),
    ("\"id\": \"pin\", ", "", "elements[0].id: found nothing"),
    (
        "\"units\": \"mm\"",
        "\"units\": \"inch\"",
        "units: found \"inch\", expected \"mm\"",
    ),
    ("\"movers\"", "\"mover\"", "mover: found an unknown key"),
    (
        "\"units\": \"mm\"",
        "\"units\": \"mm\", \"pair\": \"garbage\", \"mate\": null, \"guard\": []",
        "pair: found \"garbage\", expected a list",
    ),
    (
        "\"units\": \"mm\"",
        "\"units\": \"mm\", \"actuator\": [{\"id\": \"z\", \"axis\": [0, 0, 1], \"stroke_mm\": -5}]",
        "actuator[0].stroke_mm: found -5",
    ),
    (
        "\"units\": \"mm\"",
        "\"units\": \"mm\", \"pair\": [{\"a\": \"pin\", \"b\": \"nope\", \"rule\": \"ignore\"}]",
        "pair[0].b: found \"nope\"",
    ),
    (
        "\"units\": \"mm\"",
        "\"units\": \"mm\", \"pair\": [{\"a\": \"pin\", \"b\": \"part_*\", \"rule\": \"kiss\"}]",
        "pair[0].rule: found \"kiss\"",
    ),
    (
        "\"height\": 30",
        "\"height\": 30, \"rides\": \"zz\"",
        "elements[0].rides: found \"zz\"",
    ),
    (
        "[100, 0, 0]",
        "[100, 0]",
        "elements[1].pose.position: found",
    ),
    (
        "[100, 0, 0]",
        "[1e7, 0, 0]",
        "elements[1].pose.position[0]: found 10000000",
    ),
    (
        "[100, 0, 0]}",
        "[100, 0, 0], \"rotation\": [0, 0, 0, 0]}",
        "elements[1].pose.rotation: found",
    ),
    (
        "[100, 0, 0]}",
        "[100, 0, 0], \"turn\": 1}",
        "elements[1].pose.turn: found an unknown key",
    ),
    (
        "\"kind\": \"cylinder\", \"radius\": 4, \"height\": 30",
        "\"kind\": \"compound\", \"parts\": [{\"kind\": \"block\", \"half\": [1, 1, -1]}]",
        "elements[0].parts[0].half[2]: found -1",
    ),
    (
        "\"kind\": \"cylinder\", \"radius\": 4, \"height\": 30",
        "\"kind\": \"compound\", \"parts\": []",
        "elements[0].parts",
    ),
    (
        "\"kind\": \"cylinder\", \"radius\": 4, \"height\": 30",
        "\"kind\": \"mesh\", \"file\": \"nowhere.stl\"",
        "elements[0].file: found \"nowhere.stl\"",
    ),
    (
        "\"kind\": \"cylinder\", \"radius\": 4, \"height\": 30",
        "\"kind\": \"mesh\", \"file\": \"part.step\"",
        "elements[0].file: found \"part.step\"",
    ),
    (
        "\"kind\": \"cylinder\", \"radius\": 4, \"height\": 30",
        "\"kind\": \"mesh\", \"vertices\": [[0,0,0]], \"triangles\": [[0, 0, 1]]",
        "elements[0].triangles[0][2]: found 1",
    ),
    ("]}]}", "]}]", "not readable"),
];

/// A second line of a move file, with the expected message after `line 2: `.
const MOVES: &[(&str, &str)] = &[
    (GOOD, "id: found \"m1\" again"),
    ("{", "not readable"),
    (
        r#"{"id":"m2","mover":"claw","from":{},"to":{}}"#,
        "mover: found \"claw\", expected the id of a mover",
    ),
    (r#"{"id":"m2","from":{},"to":{}}"#, "mover: found nothing"),
    (r#"{"mover":"jaw","from":{},"to":{}}"#, "id: found nothing"),
    (
        r#"{"id":"m2","mover":"jaw","from":{}}"#,
        "to: found nothing",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{},"to":{"position":[0,NaN,0]}}"#,
        "to.position[1]: found NaN",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{},"to":{"position":[0,0,1000001]}}"#,
        "to.position[2]: found 1000001",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{"rotation":[0,0,0,0]},"to":{}}"#,
        "from.rotation: found",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{"rotation":[1,0,0]},"to":{}}"#,
        "from.rotation: found",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{},"to":{},"margin_mm":-0.5}"#,
        "margin_mm: found -0.5",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{},"to":{},"margin_mm":Infinity}"#,
        "margin_mm: found Infinity",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{},"to":{},"ignore":["nost"]}"#,
        "ignore[0]: found \"nost\", expected the id of an element",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{},"to":{},"ignore":"nest"}"#,
        "ignore: found \"nest\"",
    ),
    (
        r#"{"id":"m2","mover":"jaw","from":{},"to":{},"margin":1}"#,
        "margin: found an unknown key",
    ),
    (r#"["m2"]"#, "found"),
];

fn refused(workshop: &Workshop, scene: &str, moves: &str, says: &[&str]) {
    workshop.write("scene.json", scene);
    workshop.write("moves.jsonl", moves);
    let said = workshop.run("check --scene scene.json --moves moves.jsonl --json");
    let about = says.join(" ");
    assert_eq!(
        (said.status, said.stdout.as_str()),
        (2, ""),
        "{about}\n{said}"
    );
    assert_eq!(
        said.stderr.lines().count(),
        1,
        "{about}: one message\n{said}"
    );
    for part in says {
        assert!(said.stderr.contains(part), "expected {part:?}\n{said}");
    }
}

#[test]
fn a_bad_scene_is_refused_by_field_without_answers() {
    let workshop = Workshop::new("bad-scenes");
    for (from, to, says) in SCENES {
        let scene = SCENE.replacen(from, to, 1);
        assert_ne!(scene, SCENE, "{from:?} is not in the scene");
        refused(&workshop, &scene, GOOD, &["scene.json: ", says]);
    }
}

#[test]
fn a_bad_move_among_good_ones_is_refused() {
    let workshop = Workshop::new("bad-moves");
    for (line, says) in MOVES {
        let moves = format!("{GOOD}\n{line}\n");
        refused(&workshop, SCENE, &moves, &["moves.jsonl: line 2: ", says]);
    }
}

#[test]
fn a_bad_scene_in_toml_is_refused_alike() {
    let workshop = Workshop::new("bad-toml");
    workshop.write("moves.jsonl", GOOD);
    for (scene, says) in [
        ("units = \"m\"", "units: found \"m\""),
        (
            "[[elements]]\nid = \"a\"\nkind = \"block\"\nhalf = [1.0, nan, 1.0]",
            "elements[0].half[1]: found",
        ),
        (
            "[[elements]]\nid = \"a\"\nkind = \"block\"\nhalf = [1.0, inf, 1.0]",
            "elements[0].half[1]: found",
        ),
        ("[[elements]\n", "not readable"),
    ] {
        workshop.write("scene.toml", scene);
        let said = workshop
            .run("check --scene scene.toml --moves moves.jsonl")
            .with_status(2);
        assert_eq!(said.stdout, "");
        assert!(
            said.stderr.contains("scene.toml") && said.stderr.contains(says),
            "{says}\n{said}"
        );
    }
}

#[test]
fn missing_files_and_empty_ranges_are_bad_input() {
    let workshop = Workshop::new("check-files");
    workshop.write("scene.json", SCENE);
    workshop.write("scene.yaml", SCENE);
    workshop.write("moves.jsonl", GOOD);
    for (line, says) in [
        ("--scene nowhere.json --moves moves.jsonl", "nowhere.json"),
        ("--scene scene.json --moves nowhere.jsonl", "nowhere.jsonl"),
        ("--scene scene.yaml --moves moves.jsonl", "scene.yaml"),
        (
            "--scene scene.json --moves moves.jsonl --range NaN",
            "--range",
        ),
        (
            "--scene scene.json --moves moves.jsonl --range=-1",
            "--range",
        ),
        ("--scene scene.json", "--moves"),
    ] {
        let said = workshop.run(&format!("check {line}")).with_status(2);
        assert_eq!(said.stdout, "");
        assert!(said.stderr.contains(says), "{says}\n{said}");
    }
}

#[test]
fn an_answer_has_every_key_in_both_verdicts() {
    let workshop = Workshop::new("check-keys");
    workshop.write("scene.json", SCENE);
    let beside =
        r#"{"id":"m2","mover":"jaw","from":{"position":[0,40,0]},"to":{"position":[1,40,0]}}"#;
    let near = r#"{"id":"m3","mover":"jaw","from":{"position":[0,10,0]},"to":{"position":[1,10,0]},"margin_mm":4,"ignore":["nest"]}"#;
    workshop.write("moves.jsonl", &format!("{GOOD}\n\n{beside}\n{near}\n"));
    let said = workshop
        .run("check --scene scene.json --moves moves.jsonl --json")
        .with_status(1);
    let answers = said.objects();
    let ids: Vec<_> = answers.iter().filter_map(|it| it["id"].as_str()).collect();
    assert_eq!(ids, ["m1", "m2", "m3"]);
    let mut keys = [
        "id",
        "verdict",
        "t_stop",
        "blocker",
        "clearance_mm",
        "at",
        "normal",
    ];
    keys.sort_unstable();
    for answer in &answers {
        let mut found: Vec<&str> = answer
            .as_object()
            .unwrap()
            .keys()
            .map(String::as_str)
            .collect();
        found.sort_unstable();
        assert_eq!(found, keys);
    }
    // Beyond the range of 25 mm there is no number; a distance of 4 mm violates a margin of 4 mm.
    assert!(answers[1]["clearance_mm"].is_null() && answers[1]["t_stop"].is_null());
    assert_eq!(answers[2]["verdict"].as_str(), Some("blocked"));
    assert!((answers[2]["clearance_mm"].as_f64().unwrap() - 4.0).abs() < 1e-9);
}

#[test]
fn the_examples_of_the_help_work_as_they_stand() {
    let workshop = Workshop::new("check-help");
    let help = workshop.run("check --help").with_status(0).stdout;
    // echo 'TEXT' > FILE
    for example in help.split("echo '").skip(1) {
        let (text, rest) = example.split_once("' > ").unwrap();
        workshop.write(rest.lines().next().unwrap(), text);
    }
    let said = workshop.run("check --scene scene.json --moves moves.jsonl");
    assert!(help.contains("relayrig check --scene scene.json --moves moves.jsonl\n"));
    assert_eq!((said.status, said.stderr.as_str()), (1, ""), "{said}");
    assert!(
        said.stdout.starts_with("m1  blocked by pin at 0.75"),
        "{said}"
    );
}

#[test]
fn check_accepts_the_scene_of_the_rig() {
    let workshop = Workshop::new("check-rig");
    let rig = include_str!("../../config/scene.toml");
    // Some systems write file names in capitals, and some editors a byte order mark.
    workshop.write(
        "SCENE.TOML",
        &format!("\u{feff}{rig}\n[[movers]]\nid = \"jaw\"\nkind = \"block\"\nhalf = [1, 2, 3]\n"),
    );
    workshop.write("moves.jsonl", &format!("\u{feff}{GOOD}"));
    let said = workshop
        .run("check --scene SCENE.TOML --moves moves.jsonl")
        .with_status(1);
    assert!(said.stdout.starts_with("m1  blocked by "), "{said}");
    // A scene may name actuators of its rig without describing them.
    let riding = SCENE.replacen(
        "\"height\": 30",
        "\"height\": 30, \"rides\": \"clamp_left\"",
        1,
    );
    workshop.write("scene.json", &riding);
    workshop
        .run("check --scene scene.json --moves moves.jsonl")
        .with_status(1);
}
