//! Faults of the rig by name: each ends as `troubles.txt` says, with an alarm in the history and every row kept.

use crate::program::{Said, Workshop};

/// A line of the table.
struct Trouble {
    fault: &'static str,
    status: i32,
    alarm: Option<&'static str>,
}

fn table() -> Vec<Trouble> {
    let lines = include_str!("troubles.txt").lines();
    let rows = lines.filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let trouble = |line: &'static str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [fault, status, alarm] = words[..] else {
            panic!("troubles.txt: {line:?}")
        };
        Trouble {
            fault,
            status: status.parse().unwrap(),
            alarm: (alarm != "-").then_some(alarm),
        }
    };
    rows.map(trouble).collect()
}

/// Faults that strike together are joined by `+`.
fn each(fault: &str) -> impl Iterator<Item = &str> {
    fault.split('+')
}

fn strike(name: &str, fault: &str) -> (Workshop, Said) {
    let workshop = Workshop::new(name);
    let faults: String = each(fault).map(|one| format!(" --fault {one}")).collect();
    let said = workshop.run(&format!(
        "run --sim --pace virtual --lot A --recipe jzc-22f-012 --count 4 --seed 1 --truth t.jsonl --json{faults}"
    ));
    (workshop, said)
}

#[test]
fn every_fault_ends_as_the_table_says() {
    let table = table();
    let (first, second) = table.split_at(table.len() / 2);
    let broken = std::thread::scope(|scope| {
        let beside = scope.spawn(|| second.iter().flat_map(differences).collect::<Vec<String>>());
        let mut broken: Vec<String> = first.iter().flat_map(differences).collect();
        broken.extend(beside.join().unwrap());
        broken
    });
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
}

/// Returns every difference between a run under this fault and the table.
fn differences(trouble: &Trouble) -> Vec<String> {
    let (workshop, said) = strike(
        &format!("fault-{}", trouble.fault.replace('/', "-")),
        trouble.fault,
    );
    let alarms = workshop.texts("SELECT code FROM alarm ORDER BY id");
    let expected = (trouble.status, trouble.alarm);
    let found = (said.status, alarms.first().map(String::as_str));
    let mut broken = lost_rows(trouble.fault, &workshop, &said);
    if found != expected {
        broken.push(format!(
            "{}: expected {expected:?}, found {found:?}\n{}",
            trouble.fault, said.stderr
        ));
    }
    broken
}

/// Checks that the history has every part of stdout, that there is a summary, and that nothing touched.
fn lost_rows(fault: &str, workshop: &Workshop, said: &Said) -> Vec<String> {
    let mut lost = Vec::new();
    let told = said
        .objects()
        .iter()
        .filter(|object| object["type"] == "part")
        .count();
    let rows = workshop.count("SELECT count(*) FROM part WHERE kind = 'lot'");
    if i64::try_from(told).unwrap() > rows {
        lost.push(format!("{fault}: {told} parts on stdout, {rows} rows"));
    }
    if said
        .objects()
        .last()
        .is_none_or(|last| last["type"] != "summary")
    {
        lost.push(format!("{fault}: no summary at the end"));
    }
    if workshop.count("SELECT count(*) FROM run WHERE closed_at_us IS NULL") != 0 {
        lost.push(format!("{fault}: the run was left open"));
    }
    if let Some(wrong) = cause_otherwise(workshop, said) {
        lost.push(format!("{fault}: {wrong}"));
    }
    if said.stderr.contains("touched") {
        lost.push(format!("{fault}: {}", said.stderr));
    }
    lost
}

/// Returns a message unless summary and history name the same cause, and this cause is an alarm of the run exactly when
/// the status is 3.
fn cause_otherwise(workshop: &Workshop, said: &Said) -> Option<String> {
    let summary = said.objects().pop()?;
    let cause = summary["cause"]["code"].as_str().unwrap_or_default();
    let alarms = workshop.texts("SELECT code FROM alarm");
    if (said.status == 3) != alarms.iter().any(|code| code == cause) {
        return Some(format!(
            "status {}, cause {cause:?} of {alarms:?}",
            said.status
        ));
    }
    let listed = workshop.run("history list --json").objects().pop()?;
    let kept = listed["cause"].as_str().unwrap_or_default();
    let same = kept == cause && listed["ended"] == summary["ended"];
    (!same).then(|| format!("history {listed}, summary {summary}"))
}

#[test]
fn a_dirty_probe_makes_a_part_void() {
    let (_, said) = strike("dirty-probe", "probe_dirty=2");
    let parts = said.with_status(0).objects();
    assert_eq!(
        (parts[1]["verdict"].as_str(), parts[1]["bin"].as_str()),
        (Some("void"), Some("retest"))
    );
}

#[test]
fn a_silent_module_is_named_with_its_command() {
    for (module, line, address) in [("mech_di_b", "motion", "12"), ("board_di", "measure", "08")] {
        let fault = format!("silence={module}@10");
        let (workshop, said) = strike(&format!("silent-{module}"), &fault);
        said.with_status(3);
        let alarms = workshop.texts("SELECT text FROM alarm");
        assert_eq!(alarms.len(), 1, "{alarms:?}");
        for part in [line, address, "read the digital channels"] {
            assert!(alarms[0].contains(part), "{part} is not named: {alarms:?}");
        }
    }
}

#[test]
fn a_tripped_board_is_named_whenever_it_trips() {
    for second in [23, 29, 31] {
        let fault = format!("watchdog_trip=board_do@{second}");
        let (workshop, said) = strike(&format!("tripped-{second}"), &fault);
        said.with_status(3);
        let alarms = workshop.texts("SELECT text FROM alarm");
        assert!(
            alarms[0].contains("its host watchdog has tripped"),
            "{alarms:?}"
        );
    }
}

#[test]
fn a_module_of_another_type_is_refused() {
    let (workshop, said) = strike("wrong-type", "wrong_type=board_di");
    said.with_status(3);
    let alarms = workshop.texts("SELECT text FROM alarm");
    assert!(
        alarms[0].contains("measure") && alarms[0].contains("08"),
        "{alarms:?}"
    );
    assert_eq!(workshop.count("SELECT count(*) FROM part"), 0);
}

#[test]
fn a_fault_that_is_none_is_refused() {
    for fault in ["jam_pushr", "drop=much", "silence=no_module@1"] {
        let (workshop, said) = strike("no-such-fault", fault);
        let said = said.with_status(2);
        assert_eq!(said.stdout, "");
        assert!(!workshop.has("relayrig.db"), "{fault}: a run was opened");
    }
}

#[test]
fn the_fault_table_matches_the_list_of_the_rig() {
    let workshop = Workshop::empty("fault-list");
    // An empty folder `config`: the list of faults needs no configuration.
    std::fs::create_dir(workshop.folder.join("config")).unwrap();
    let listed = workshop.run("sim --faults").with_status(0).stdout;
    for fault in table().iter().flat_map(|trouble| each(trouble.fault)) {
        let name = fault.split('=').next().unwrap_or_default();
        assert!(
            listed.lines().any(|line| line.starts_with(name)),
            "{name} is not among\n{listed}"
        );
    }
}
