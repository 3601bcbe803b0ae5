//! Commands with wrong files and simple orders: exit status, output, and absence of side effects.

use crate::program::Workshop;
use serde_json::Value;

const RIG: &str = "config/rig.toml";
const RECIPE: &str = "config/recipes/jzc-22f-012.toml";
/// Commands that refuse a file before they open a port.
const COMMANDS: [&str; 2] = ["config check", "run --lot A --recipe jzc-22f-012 --count 1"];

/// A fault in a file, and the expected rest of the message.
struct Slip {
    name: &'static str,
    file: &'static str,
    from: &'static str,
    to: &'static str,
    /// Lines from the place of the change to the line that the message must name.
    offset: isize,
    says: &'static str,
}

const SLIPS: &[Slip] = &[
    Slip {
        name: "a missing key is named at its table",
        file: RECIPE,
        from: "nominal_coil_ohm = 400.0\n",
        to: "",
        offset: -2,
        says: "[part].nominal_coil_ohm: found nothing, expected",
    },
    Slip {
        name: "a wrong unit",
        file: RIG,
        from: "channel = 0, unit = \"V\", gain = 0.6",
        to: "channel = 0, unit = \"mV\", gain = 0.6",
        offset: 0,
        says: "found \"mV\", expected \"V\" or \"A\"",
    },
    Slip {
        name: "an address used twice on a line",
        file: RIG,
        from: "address = \"14\"",
        to: "address = \"13\"",
        offset: 0,
        says: "found \"13\", expected an address of its own",
    },
    Slip {
        name: "two points on one channel",
        file: RIG,
        from: "gate_1 = { module = \"timer\", channel = 1",
        to: "gate_1 = { module = \"timer\", channel = 0",
        offset: 0,
        says: "gate_0",
    },
    Slip {
        name: "a limit whose low side is above its high side",
        file: RECIPE,
        from: "{ low = 360.0, high = 440.0 }",
        to: "{ low = 460.0, high = 440.0 }",
        offset: 0,
        says: "coil_resistance_ohm",
    },
    Slip {
        name: "a mistyped key",
        file: RIG,
        from: "heartbeat_ms = 300",
        to: "hartbeat_ms = 300",
        offset: 0,
        says: "\"heartbeat_ms\"?",
    },
    Slip {
        name: "a text that is no TOML",
        file: RECIPE,
        from: "prebias_v = 5.1",
        to: "prebias_v = = 5.1",
        offset: 0,
        says: "expected",
    },
];

#[test]
fn a_wrong_file_is_refused_with_its_line() {
    for (number, slip) in SLIPS.iter().enumerate() {
        let workshop = Workshop::new(&format!("slip-{number}"));
        let line = workshop.change(slip.file, slip.from, slip.to);
        let place = format!(
            "{}:{}: ",
            slip.file,
            line.saturating_add_signed(slip.offset)
        );
        for command in COMMANDS {
            let said = workshop.run(command).with_status(2);
            assert_eq!(said.stdout, "", "{}", slip.name);
            assert!(
                said.stderr.contains(&place),
                "{}: expected {place:?}\n{said}",
                slip.name
            );
            assert!(
                said.stderr.contains(slip.says),
                "{}: expected {:?}\n{said}",
                slip.name,
                slip.says
            );
            assert_eq!(
                said.stderr.lines().count(),
                1,
                "{}: one message\n{said}",
                slip.name
            );
        }
        assert!(
            !workshop.has("relayrig.db"),
            "{}: a run was opened",
            slip.name
        );
    }
}

#[test]
fn an_unknown_recipe_is_refused_with_those_there_are() {
    let workshop = Workshop::new("unknown-recipe");
    let said = workshop
        .run("run --lot A --recipe jzc-22f-021 --count 1")
        .with_status(2);
    assert_eq!(said.stdout, "");
    for part in [
        "config/recipes",
        "jzc-22f-021",
        "jzc-22f-012",
        "jzc-22f-009",
        "jzc-22f-006",
    ] {
        assert!(said.stderr.contains(part), "{part} is not named\n{said}");
    }
    assert!(!workshop.has("relayrig.db"));
}

#[test]
fn an_unknown_word_is_bad_input() {
    let workshop = Workshop::new("unknown-words");
    for line in [
        "rum",
        "run --sim --lot A",
        "run --lot A --recipe jzc-22f-012 --pace virtual",
        "config schema rigg",
        "",
    ] {
        let said = workshop.run(line).with_status(2);
        assert_eq!(said.stdout, "", "{line}");
        assert!(
            said.stderr.contains("--help") || said.stderr.contains("Usage"),
            "{line}\n{said}"
        );
    }
}

#[test]
fn studies_without_a_lot_refuse_lot_options() {
    let workshop = Workshop::new("studies-without-lots");
    for (option, name) in [
        ("--out figures", "transient --cases -"),
        ("--seeds 2", "transient --cases -"),
        ("--parts 2", "collision"),
    ] {
        let said = workshop
            .run(&format!("study {name} {option}"))
            .with_status(2);
        let word = option.split(' ').next().unwrap();
        assert!(said.stderr.contains(word), "{said}");
        assert!(!workshop.has("figures"), "{option}");
    }
}

#[test]
fn the_default_configuration_passes_its_check() {
    let said = Workshop::new("config-check")
        .run("config check")
        .with_status(0);
    assert!(said.stdout.ends_with("ok\n"), "{said}");
    assert_eq!(said.stderr, "");
}

#[test]
fn a_recipe_is_refused_by_its_missing_point() {
    let workshop = Workshop::new("no-latch");
    let latch = "latch             = { module = \"board_di\", channel = 8, active = \"low\" }\n";
    workshop.change(RIG, latch, "");
    for command in COMMANDS {
        let said = workshop.run(command).with_status(2);
        assert!(
            said.stderr
                .contains("found no [digital_in].latch in rig.toml"),
            "{said}"
        );
        assert!(said.stderr.contains("config/recipes/jzc-22f-0"), "{said}");
    }
}

#[test]
fn a_schema_is_json() {
    let workshop = Workshop::new("schemas");
    for name in ["rig", "golden", "recipe"] {
        let said = workshop
            .run(&format!("config schema {name}"))
            .with_status(0);
        let schema: Value = serde_json::from_str(&said.stdout).unwrap();
        assert!(schema["properties"].is_object(), "{name}");
    }
}

#[test]
fn reading_a_missing_history_creates_no_file() {
    let workshop = Workshop::new("no-history");
    let said = workshop.run("history list").with_status(2);
    assert_eq!(said.stdout, "");
    assert!(said.stderr.contains("relayrig.db"), "{said}");
    assert!(!workshop.has("relayrig.db"));
}

#[test]
fn an_imported_file_comes_back_in_statistics_and_query() {
    let workshop = Workshop::new("import");
    workshop.write(
        "old.csv",
        "serial,coil_resistance_ohm\nR1,398\nR2,400\nR3,405\n",
    );
    workshop
        .run("history import old.csv --lot 2019")
        .with_status(0);
    let stats = &workshop
        .run("history stats --param coil_resistance_ohm --lot 2019 --json")
        .with_status(0)
        .objects()[0];
    assert_eq!(
        (stats["n"].as_u64(), stats["mean"].as_f64()),
        (Some(3), Some(401.0))
    );
    assert_eq!(
        (stats["min"].as_f64(), stats["max"].as_f64()),
        (Some(398.0), Some(405.0))
    );
    let found = workshop
        .run("history query --lot 2019 --param coil_resistance_ohm --min 399 --format json");
    assert_eq!(found.with_status(0).objects().len(), 2);
    workshop
        .run("history import old.csv --lot 2019")
        .with_status(2);
    workshop.run("history check").with_status(0);
}

#[test]
fn a_host_check_answers_and_leaves_no_file() {
    let workshop = Workshop::new("host-check");
    for seconds in ["0", "3601", "ten"] {
        let said = workshop.run(&format!("host check --seconds {seconds}"));
        assert_eq!(said.with_status(2).stdout, "");
    }
    let said = workshop.run("host check --seconds 1 --plot late.svg --json");
    let (phases, others): (Vec<Value>, Vec<Value>) = said
        .objects()
        .into_iter()
        .partition(|it| it["type"] == "phase");
    let names: Vec<&Value> = phases.iter().map(|it| &it["phase"]).collect();
    assert_eq!(names, ["as_it_is", "loaded"]);
    assert!(
        phases
            .iter()
            .all(|it| it["lateness"]["waits"].as_u64() > Some(0))
    );
    let verdict = others.last().unwrap();
    let is_kept = verdict["is_kept"].as_bool().unwrap();
    assert_eq!(said.status, i32::from(!is_kept), "{said}");
    let left = std::fs::read_dir(&workshop.folder).unwrap();
    let mut left: Vec<_> = left.map(|it| it.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["config", "late.svg"]);
}

#[test]
fn a_move_is_answered_by_the_exit_status() {
    let workshop = Workshop::new("check");
    let cylinder = r#"{"units": "mm",
        "elements": [{"id": "pin", "kind": "cylinder", "radius": 4, "height": 30}],
        "movers": [{"id": "box", "kind": "block", "half": [1, 1, 1]}]}"#;
    workshop.write("scene.json", cylinder);
    let way = |y: f64| {
        format!(
            r#"{{"id":"m","mover":"box","from":{{"position":[-20,{y},0]}},"to":{{"position":[20,{y},0]}}}}"#
        )
    };
    workshop.write("beside.jsonl", &way(6.0));
    workshop.write("through.jsonl", &way(0.0));
    workshop.write("touching.jsonl", &way(5.0));
    let clear = &workshop
        .run("check --scene scene.json --moves beside.jsonl --json")
        .with_status(0)
        .objects()[0];
    assert_eq!(
        (clear["verdict"].as_str(), clear["t_stop"].is_null()),
        (Some("clear"), true)
    );
    let blocked = &workshop
        .run("check --scene scene.json --moves through.jsonl --json")
        .with_status(1)
        .objects()[0];
    assert_eq!(blocked["blocker"].as_str(), Some("pin"));
    let t_stop = blocked["t_stop"].as_f64().unwrap();
    assert!(
        t_stop <= 0.375 && t_stop > 0.375 - 1e-9,
        "rounded down, never later: {t_stop}"
    );
    workshop
        .run("check --scene scene.json --moves touching.jsonl --json")
        .with_status(1);
    let bad = workshop
        .run("check --scene scene.json --moves scene.json --json")
        .with_status(2);
    assert_eq!(bad.stdout, "");
}

/// Checks that every command or its parent shows an example, and that README.md lists existing commands only.
#[cfg(feature = "sim")]
#[test]
fn every_command_has_help_with_an_example() {
    let workshop = Workshop::new("help");
    let mut open = vec![(String::new(), false)];
    let mut commands = Vec::new();
    while let Some((words, shown_above)) = open.pop() {
        let help = workshop
            .run(&format!("{words} --help"))
            .with_status(0)
            .stdout;
        let shown = help.contains("Example");
        let below: Vec<&str> = subcommands(&help).collect();
        assert!(shown || shown_above || !below.is_empty(), "{words}\n{help}");
        open.extend(below.iter().map(|name| (format!("{words} {name}"), shown)));
        commands.push(words);
    }
    let readme = include_str!("../../README.md");
    let rows: Vec<&str> = readme
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next())
        .collect();
    assert!(rows.len() >= 5, "README.md lists only {rows:?}");
    for row in rows {
        let words = row
            .split_whitespace()
            .take_while(|word| word.bytes().all(|c| c.is_ascii_lowercase()));
        let command: String = words.map(|word| format!(" {word}")).collect();
        assert!(
            commands.contains(&command),
            "README.md: there is no `{row}`"
        );
    }
}

/// Returns the names under `Commands:` of a help text.
#[cfg(feature = "sim")]
fn subcommands(help: &str) -> impl Iterator<Item = &str> {
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = lines
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help")
}
