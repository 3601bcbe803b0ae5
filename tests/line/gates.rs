//! Gates of a lot: reference checks, suspect parts, reject-rate limit, first articles, fixed recipe, retests, wear.

use crate::program::{Said, Workshop};

/// Runs lot A on the simulated rig with seed 1.
fn run(workshop: &Workshop, count: u64, more: &str) -> Said {
    run_lot(workshop, "A", count, more)
}

fn run_lot(workshop: &Workshop, lot: &str, count: u64, more: &str) -> Said {
    workshop.run(&format!(
        "run --sim --pace virtual --lot {lot} --recipe jzc-22f-012 --count {count} --seed 1 --json {more}"
    ))
}

/// Opens the complete lot A again.
fn reopen(workshop: &Workshop) {
    workshop
        .run("lot reopen A --by zhao --reason late_parts")
        .with_status(0);
}

fn with_lot(name: &str, settings: &str) -> Workshop {
    let workshop = Workshop::new(name);
    workshop.write("config/lot.toml", settings);
    workshop
}

fn state(workshop: &Workshop) -> String {
    let states = workshop.texts("SELECT state FROM lot_state");
    assert_eq!(states.len(), 1);
    states[0].clone()
}

#[test]
fn reference_parts_are_measured_between_parts_without_counting() {
    let workshop = with_lot("gates_checked", "[golden_check]\nafter_parts = 3\n");
    let said = run(&workshop, 8, "--truth t.jsonl").with_status(0);
    assert_eq!(said.objects().last().unwrap()["parts"], 8, "{said}");
    let checks = workshop.texts("SELECT text FROM golden_check WHERE passed ORDER BY at_us");
    assert_eq!(checks, ["calibration", "G-12-1", "G-12-1"]);
    assert_eq!(workshop.count("SELECT count(*) FROM golden_check"), 3);
    assert_eq!(
        workshop.count("SELECT count(*) FROM part WHERE kind = 'golden'"),
        7
    );
    let slow = "SELECT min(attempt) FROM measurement JOIN part ON part.id = part_id
                WHERE kind = 'golden' AND seq > 5 AND parameter_id = 2";
    assert!(workshop.count(slow) > 1, "confirmation measurements");
    assert_eq!(state(&workshop), "complete");
    assert_eq!(workshop.read("t.jsonl").lines().count(), 8);
    let frozen = "SELECT count(*) FROM run JOIN calibration ON calibration.hash = calibration_hash";
    assert_eq!(workshop.count(frozen), 1);
}

#[test]
fn a_failed_check_holds_the_lot_with_suspect_parts() {
    let workshop = with_lot("gates_drifted", "[golden_check]\nafter_parts = 4\n");
    run(&workshop, 9, "--fault drift=20").with_status(3);
    let alarms = workshop.texts("SELECT code FROM alarm");
    assert_eq!(alarms, ["golden_check_failed"]);
    let suspects = workshop
        .run("history query --suspect --json")
        .with_status(0);
    let seqs: Vec<i64> = suspects
        .objects()
        .iter()
        .map(|it| it["seq"].as_i64().unwrap())
        .collect();
    assert_eq!(seqs, [1, 2, 3, 4]);
    let refused = run(&workshop, 9, "").with_status(2);
    assert!(
        refused.stderr.contains("held since") && refused.stderr.contains("relayrig lot release"),
        "{refused}"
    );
    workshop
        .run("lot release A --by li --reason cleaned")
        .with_status(0);
    let orders = workshop
        .run("history orders --who li --json")
        .with_status(0);
    assert_eq!(orders.objects()[0]["what"]["order"], "release_lot");
    run(&workshop, 2, "").with_status(0);
    assert_eq!(state(&workshop), "complete");
    let shown = workshop.run("lot show A").with_status(0);
    assert!(
        shown.stdout.contains("4 suspect") && shown.stdout.contains("FAILED"),
        "{shown}"
    );
}

#[test]
fn too_many_failed_parts_hold_the_lot() {
    let workshop = with_lot("gates_discarded", "discard_limit_pct = 5.0\n");
    workshop.change("config/sim.toml", "rate_pct = 4.0", "rate_pct = 75.0");
    run(&workshop, 40, "").with_status(3);
    // Two of forty are 5 %; the third failed part ends the unattended run. If this part is still on its way to the bin,
    // the alarm `bin_beam` follows.
    let told = workshop.texts("SELECT code FROM alarm WHERE code != 'bin_beam'");
    assert_eq!(told, ["lot_discard_limit"]);
    let failed = "SELECT count(*) FROM part WHERE kind = 'lot' AND verdict = 'fail'";
    assert_eq!(workshop.count(failed), 2);
    assert_eq!(state(&workshop), "held");
}

#[test]
fn only_first_articles_get_confirmation_measurements() {
    let workshop = with_lot("gates_first", "first_article_parts = 2\n");
    run(&workshop, 4, "").with_status(0);
    let attempts = |seq: u32| {
        workshop.count(&format!(
            "SELECT sum(attempt) FROM measurement JOIN part ON part.id = part_id
             WHERE kind = 'lot' AND seq = {seq}"
        ))
    };
    let each: Vec<i64> = (1..=4).map(attempts).collect();
    // Seven results four times; each contact has one result of all its closures.
    assert_eq!(each, [30, 30, 9, 9]);
}

#[test]
fn a_lot_keeps_its_recipe_for_life() {
    let workshop = Workshop::new("gates_frozen");
    run(&workshop, 4, "--fault door").with_status(3);
    assert_eq!(state(&workshop), "open");
    workshop.change(
        "config/recipes/jzc-22f-012.toml",
        "slow_repeats = 3 ",
        "slow_repeats = 4 ",
    );
    let refused = |more: &str| {
        let said = run(&workshop, 1, more).with_status(2);
        assert!(
            said.stderr.contains("--recipe") && said.stderr.contains("name another lot"),
            "{said}"
        );
    };
    refused("");
    workshop.run("lot close A --by li").with_status(0);
    refused("");
    refused("--retest li");
    reopen(&workshop);
    refused("");
    assert_eq!(workshop.count("SELECT count(*) FROM run"), 1);
}

#[test]
fn a_complete_lot_runs_again_only_after_a_reopening() {
    let workshop = Workshop::new("gates_reopened");
    run(&workshop, 2, "").with_status(0);
    let refused = run(&workshop, 1, "").with_status(2);
    assert!(
        refused.stderr.contains("is complete since")
            && refused.stderr.contains("relayrig lot reopen"),
        "{refused}"
    );
    run(&workshop, 1, "--retest li").with_status(0);
    for way in ["hold A --by li --reason label", "release A --by li"] {
        workshop.run(&format!("lot {way}")).with_status(0);
    }
    assert_eq!(state(&workshop), "complete", "a release reopens nothing");
    let without = workshop.run("lot reopen A --by zhao").with_status(2);
    assert!(
        without.stderr.contains("why the lot is reopened"),
        "{without}"
    );
    reopen(&workshop);
    let twice = workshop.run("lot reopen A --by zhao --reason again");
    assert!(
        twice.with_status(2).stderr.contains("not complete"),
        "an open lot"
    );
    run(&workshop, 1, "").with_status(0);
    assert_eq!(state(&workshop), "complete");
    for told in ["lot show A", "history report --lot A --lang en"] {
        let told = workshop.run(told).with_status(0);
        assert!(told.stdout.contains("by zhao: late_parts"), "{told}");
    }
    let orders = workshop.run("history orders --who zhao --json").objects();
    assert_eq!(orders.last().unwrap()["what"]["order"], "reopen_lot");
}

#[test]
fn a_retest_keeps_first_results_and_names_its_person() {
    let workshop = Workshop::new("gates_retest");
    let early = run(&workshop, 1, "--retest li").with_status(2);
    assert!(early.stderr.contains("no run of lot"), "{early}");
    workshop.change("config/sim.toml", "rate_pct = 4.0", "rate_pct = 75.0");
    run(&workshop, 6, "").with_status(0);
    let first = workshop.count("SELECT count(*) FROM part WHERE kind = 'lot' AND verdict = 'pass'");
    workshop.change("config/sim.toml", "rate_pct = 75.0", "rate_pct = 0.0");
    run(&workshop, 2, "--retest li").with_status(0);
    let shown = workshop
        .run("lot show A --json")
        .with_status(0)
        .objects()
        .remove(0);
    assert_eq!(shown["yield"]["parts"], 6);
    assert_eq!(shown["yield"]["first_pass"], first);
    assert_eq!(shown["yield"]["retest_pass"], 2);
    assert_eq!(shown["runs"][1]["retest"], "li");
    let paper = workshop
        .run("history report --lot A --lang en")
        .with_status(0);
    for passed in [first, first + 2] {
        let share = format!("{:.2} %", 100.0 * passed as f64 / 6.0);
        assert!(paper.stdout.contains(&share), "{share}");
    }
}

#[test]
fn worn_probes_alarm_once_and_the_counter_survives() {
    let workshop = with_lot("gates_worn", "[wear]\nprobe_touches = 8\n");
    run(&workshop, 3, "").with_status(0);
    assert_eq!(workshop.texts("SELECT code FROM alarm"), ["probes_worn"]);
    let touches = || workshop.count("SELECT count FROM wear WHERE name = 'probe_touches'");
    // One touch for the references in the empty nest, five for reference parts, three for parts of the lot.
    assert_eq!(touches(), 9);
    run_lot(&workshop, "B", 1, "").with_status(0);
    assert_eq!(touches(), 16);
    workshop
        .run("wear --sim replaced probe_touches --by li")
        .with_status(0);
    assert_eq!(touches(), 0);
    let wrong = workshop
        .run("wear --sim replaced pins --by li")
        .with_status(2);
    assert!(wrong.stderr.contains("probe_touches"), "{wrong}");
}

#[test]
fn fouling_probes_raise_an_alarm_before_a_pin_opens() {
    let workshop = with_lot("gates_fouled", "[wear]\nprobe_contact_ohm = 1.5\n");
    run(&workshop, 40, "").with_status(0);
    assert!(workshop.texts("SELECT code FROM alarm").is_empty());
    reopen(&workshop);
    run(&workshop, 40, "--fault probe_film=8").with_status(0);
    assert_eq!(workshop.texts("SELECT code FROM alarm"), ["probe_contact"]);
    let told = workshop.texts("SELECT text FROM alarm");
    assert!(
        told[0].contains("1.5") && told[0].contains("limit is 1.50 ohm"),
        "{told:?}"
    );
    let changed = |parameter: &str, more: &str| {
        workshop.count(&format!(
            "SELECT count(*) FROM measurements AS a JOIN measurements AS b USING (kind, seq, parameter)
             WHERE a.run = 1 AND b.run = 2 AND kind = 'lot' AND parameter = '{parameter}' {more}"
        ))
    };
    let apart = "AND abs(a.value - b.value) > a.uncertainty + b.uncertainty";
    assert!(changed("coil_resistance_ohm", "") > 30);
    assert_eq!(changed("coil_resistance_ohm", apart), 0, "four wires");
    let doubted = "AND b.uncertainty > 2 * a.uncertainty";
    assert!(changed("operate_voltage_v", doubted) > 10);
    assert_eq!(changed("operate_voltage_v", apart), 0, "the budget knows");
    let verdicts = "SELECT count(*) FROM parts WHERE verdict = 'void' AND kind = 'lot'";
    assert_eq!(workshop.count(verdicts), 0);
}

#[test]
fn gates_are_optional_and_a_wrong_key_is_named() {
    let workshop = Workshop::new("gates_file");
    std::fs::remove_file(workshop.folder.join("config/lot.toml")).unwrap();
    workshop.run("config check").with_status(0);
    workshop.write(
        "config/lot.toml",
        "discard_limit_pct = 5.0\n[golden_check]\nafter_part = 3\n",
    );
    let wrong = workshop.run("config check").with_status(2);
    assert!(
        wrong.stderr.contains("lot.toml:3") && wrong.stderr.contains("after_parts"),
        "{wrong}"
    );
}

#[test]
fn a_recipe_without_reference_parts_is_refused() {
    let workshop = Workshop::new("gates_no_golden");
    let text = workshop
        .read("config/golden.toml")
        .replace("nominal_v = 12.0", "nominal_v = 11.0");
    workshop.write("config/golden.toml", &text);
    let said = run(&workshop, 1, "").with_status(2);
    let refused =
        "[part].nominal_v: found 12, expected a coil voltage with at least 3 reference parts";
    assert!(said.stderr.contains(refused), "{said}");
}

#[test]
fn an_alarm_that_ended_a_run_waits_for_acknowledgement() {
    let workshop = Workshop::new("gates_alarms");
    run(&workshop, 4, "--fault door").with_status(3);
    let left = |workshop: &Workshop| workshop.run("alarm list --sim --json").objects();
    let code = left(&workshop)[0]["code"].clone();
    assert_eq!(code, "door_open");
    workshop
        .run("alarm shelve door_open --sim --minutes 5 --by li --reason hinge")
        .with_status(0);
    assert!(left(&workshop)[0]["shelved_until"].is_string());
    let unknown = workshop
        .run("alarm acknowledge no_such --sim --by li")
        .with_status(2);
    assert!(unknown.stderr.contains("door_open"), "{unknown}");
    workshop
        .run("alarm acknowledge --sim --by li")
        .with_status(0);
    assert!(left(&workshop).is_empty());
    let orders = workshop.run("history orders --who li --json").objects();
    assert_eq!(orders.len(), 2);
    assert_eq!(orders[0]["what"]["reason"], "hinge");
}

#[test]
fn a_revision_shows_who_changed_what_and_why() {
    let workshop = Workshop::new("revisions");
    let revise = "config revise jzc-22f-012 limits.operate_voltage_v.high=8.75 --by zhao --reason";
    workshop.run(&format!("{revise} tighter")).with_status(0);
    let shown = workshop.run("config revisions jzc-22f-012").with_status(0);
    assert!(shown.stdout.starts_with("revision 2, "), "{}", shown.stdout);
    let said = "zhao: tighter\n  limits.operate_voltage_v.high: 9.0 V -> 8.75 V\n";
    assert!(shown.stdout.ends_with(said), "{}", shown.stdout);
    let typed = revise.replace("voltage_v", "voltge_v");
    let typo = workshop.run(&format!("{typed} tighter")).with_status(2);
    assert!(typo.stderr.contains("\"limits.operate_voltage_v.high\"?"));
}

#[test]
fn a_lot_waits_until_two_engineers_approve() {
    let workshop = Workshop::new("approval");
    let said = |line: &str, typed: &str| {
        workshop.write("typed", typed);
        let stdin = std::fs::File::open(workshop.folder.join("typed")).unwrap();
        let done = workshop.command(line).stdin(stdin).output().unwrap();
        let stderr = String::from_utf8(done.stderr).unwrap();
        (done.status.code().unwrap(), stderr)
    };
    for (name, role) in [
        ("zhao", "engineer"),
        ("chen", "engineer"),
        ("li", "operator"),
    ] {
        let add = format!("user add {name} --role {role} --stdin");
        assert_eq!(said(&add, "open sesame\n").0, 0);
    }
    let rig = workshop.read("config/rig.toml") + "\n[recipes]\napproval = \"second_person\"\n";
    workshop.write("config/rig.toml", &rig);
    let new = "config revise jzc-22f-012 --save-as new --by zhao --reason order";
    workshop.run(new).with_status(0);
    let lot = "run --sim --lot A --recipe new --count 1";
    let refused = workshop.run(lot).with_status(2);
    let expected = "found new with 0 of 2 engineers who saved or approved it";
    assert!(refused.stderr.contains(expected), "{}", refused.stderr);
    for (by, password, status, expected) in [
        ("zhao", "guessed wrong", 2, "password is wrong"),
        ("li", "open sesame", 2, "role engineer"),
        ("zhao", "open sesame", 0, ""),
        ("zhao", "open sesame", 2, "another engineer approves it"),
        ("chen", "open sesame", 0, ""),
    ] {
        assert_eq!(workshop.run(lot).with_status(2).stdout, "");
        let answer = said(
            &format!("config approve new --by {by}"),
            &format!("{password}\n"),
        );
        assert_eq!(answer.0, status, "{by}: {}", answer.1);
        assert!(answer.1.contains(expected), "{by}: {}", answer.1);
    }
    workshop.run(lot).with_status(0);
    let audit = workshop
        .run("history orders --order approve --json")
        .objects();
    let accepted = audit.iter().filter(|it| it["refused"].is_null());
    let names: Vec<_> = accepted.map(|it| it["who"].clone()).collect();
    assert_eq!(names, ["zhao", "chen"]);
}

#[cfg(unix)]
#[test]
fn a_password_typed_at_a_terminal_stays_unseen() {
    use std::io::{Read, Write};
    let workshop = Workshop::new("typed_password");
    workshop.run("user add zhao --role engineer").with_status(0);
    let approve = format!(
        "tty > tty; exec {} config approve jzc-22f-012 --by zhao",
        env!("CARGO_BIN_EXE_relayrig")
    );
    let mut child = std::process::Command::new("script")
        .args(["--quiet", "--return", "--command", &approve, "/dev/null"])
        .current_dir(&workshop.folder)
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut terminal = child.stdout.take().unwrap();
    let mut shown = String::new();
    let mut byte = [0];
    while !shown.ends_with("Password of zhao: ") {
        assert_eq!(terminal.read(&mut byte).unwrap(), 1, "{shown}");
        shown.push(byte[0].into());
    }
    let echo_is_off = || {
        let tty = workshop.read("tty");
        let stty = std::process::Command::new("stty")
            .args(["--all", "--file", tty.trim()])
            .output();
        String::from_utf8(stty.unwrap().stdout)
            .unwrap()
            .contains("-echo ")
    };
    while !echo_is_off() {
        assert!(child.try_wait().unwrap().is_none(), "{shown}");
    }
    let mut keys = child.stdin.take().unwrap();
    keys.write_all(b"open sesame\n").unwrap();
    terminal.read_to_string(&mut shown).unwrap();
    assert!(shown.contains("password is wrong"), "{shown}");
    assert!(!shown.contains("sesame"), "{shown}");
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

#[cfg(unix)]
#[test]
fn a_revised_recipe_applies_to_the_next_lot_only() {
    use std::io::BufRead;
    let workshop = Workshop::new("revised");
    let lot = |name: &str, count: u32| {
        format!(
            "run --sim --pace virtual --lot {name} --recipe jzc-22f-012 --seed 1 --json --count {count}"
        )
    };
    let mut running = workshop.start(&lot("A", 12));
    let mut out = std::io::BufReader::new(running.stdout.take().unwrap());
    let mut told = String::new();
    assert!(out.read_line(&mut told).unwrap() > 0);
    workshop.change(
        "config/recipes/jzc-22f-012.toml",
        "operate_voltage_v = { high = 9.0 }",
        "operate_voltage_v = { high = 8.9 }",
    );
    while out.read_line(&mut told).unwrap() > 0 {}
    assert_eq!(running.wait().unwrap().code(), Some(0));
    workshop.run(&lot("B", 1)).with_status(0);
    let limits = "SELECT DISTINCT lot.name || ' ' || measurement.high FROM measurement
        JOIN parameter ON parameter.id = parameter_id JOIN run ON run.id = run_id JOIN lot ON lot.id = lot_id
        WHERE key = 'operate_voltage_v' AND population = 'lot' ORDER BY 1";
    assert_eq!(workshop.texts(limits), ["A 9.0", "B 8.9"]);
}
