//! Lots of solid-state relays on the simulated rig of their own configuration.

use crate::program::{Workshop, objects};
use serde_json::Value;

const RUN: &str = "--config config/rigs/ssr run --sim --recipe ssr-dc-60v-3a --json";

/// Returns the bin to which a part with this defect belongs.
fn bin_of(defect: &Value) -> &'static str {
    match defect.as_str() {
        None => "pass",
        Some("open_led" | "shorted_led" | "wrong_input_current" | "aged_led") => "input",
        Some("shorted_output" | "high_drop" | "thermal" | "stuck_on") => "output",
        Some("half_wave" | "half_short" | "no_zero_cross") => "output",
        Some("slow_turn_on" | "slow_turn_off") => "time",
        Some("leaky_junction" | "open_snubber" | "wrong_snubber") => "leakage",
        Some("turned" | "missing_pin") => "retest",
        Some(other) => panic!("unknown defect {other}"),
    }
}

/// Runs a lot of 110 parts and checks the bin of each; returns the number of defects.
fn sorted(workshop: &Workshop, run: &str) -> usize {
    let said = workshop.run(&format!("{run} --count 110 --truth t.jsonl"));
    let said = said.with_status(0);
    let rows = objects(&said.stdout);
    let parts: Vec<&Value> = rows.iter().filter(|it| it["type"] == "part").collect();
    let truth = objects(&workshop.read("t.jsonl"));
    assert_eq!((parts.len(), truth.len()), (110, 110));
    let mut defects = 0;
    for (part, true_part) in parts.iter().zip(&truth) {
        assert_eq!(part["seq"], true_part["seq"]);
        let bin = bin_of(&true_part["defect"]);
        defects += usize::from(bin != "pass");
        assert_eq!(part["bin"], bin, "{run}: {part}\n{true_part}");
        assert_eq!(true_part["landed_in"], bin, "{run}: {true_part}");
    }
    defects
}

#[test]
fn every_part_lands_in_the_bin_of_its_defect() {
    let workshop = Workshop::new("ssr-lot");
    let lots = [1, 2].map(|seed| format!("{RUN} --lot S{seed} --seed {seed}"));
    let defects: usize = lots.iter().map(|it| sorted(&workshop, it)).sum();
    assert!(defects >= 4, "only {defects} defects in the lots");
}

/// A line with the distortion that EN 50160 permits, which drifts by more than any supply does.
const BAD_LINE: &str = "[mains]\nthird_pct = 5.0\nfifth_pct = 6.0\namplitude_sd_pct = 2.0\n\
    frequency_sd_hz = 0.1\nphase_sd_us = 30.0\nslow_s = 2.0\n";

/// A line of another plant: what it is, changes of the recipe, and the world.
type Line = (
    &'static str,
    &'static [(&'static str, &'static str)],
    &'static str,
);

/// Lines of other plants.
const LINES: [Line; 3] = [
    (
        "of 115 V and 60 Hz",
        &[
            ("mains_v = 230.0", "mains_v = 115.0"),
            ("mains_hz = 50.0", "mains_hz = 60.0"),
            (
                "{ low = 1000.0, high = 1900.0 }",
                "{ low = 600.0, high = 1150.0 }",
            ),
        ],
        "",
    ),
    (
        "of 60 Hz, distorted and drifting",
        &[
            ("mains_hz = 50.0", "mains_hz = 60.0"),
            (
                "{ low = 1000.0, high = 1900.0 }",
                "{ low = 1200.0, high = 2280.0 }",
            ),
            (
                "i_leak_ua = { high = 2000.0 }",
                "i_leak_ua = { high = 2400.0 }",
            ),
            (
                "i_leak_hot_ua = { high = 2000.0 }",
                "i_leak_hot_ua = { high = 2400.0 }",
            ),
        ],
        BAD_LINE,
    ),
    ("distorted and drifting", &[], BAD_LINE),
];

#[test]
fn parts_land_in_their_bins_on_any_line() {
    for (number, (line, changes, world)) in LINES.iter().enumerate() {
        for kind in ["zc", "random"] {
            let workshop = Workshop::new(&format!("ssr-line-{number}-{kind}"));
            let recipe = format!("ssr-ac-240v-5a-{kind}");
            let file = format!("config/rigs/ssr/recipes/{recipe}.toml");
            for (from, to) in *changes {
                workshop.change(&file, from, to);
            }
            workshop.write("world.toml", world);
            let run = "--config config/rigs/ssr run --sim --world world.toml --json --lot A";
            let defects = sorted(&workshop, &format!("{run} --recipe {recipe} --seed 1"));
            assert!(defects >= 2, "{line}, {kind}: only {defects} defects");
        }
    }
}

#[test]
fn a_line_that_dies_at_any_instant_fails_no_part() {
    let workshop = Workshop::new("ssr-line-dies");
    let run = "--config config/rigs/ssr run --sim --json --recipe ssr-ac-240v-5a-zc --seed 1";
    let mut voids = 0;
    for number in 0..16 {
        let at_s = 3.0 + 0.13 * f64::from(number);
        let said = workshop.run(&format!(
            "{run} --lot L{number} --count 3 --fault line_dead={at_s:.2}"
        ));
        let rows = objects(&said.stdout);
        for part in rows.iter().filter(|it| it["type"] == "part") {
            let verdict = part["verdict"].as_str().unwrap();
            assert!(["pass", "void"].contains(&verdict), "{at_s:.2} s: {part}");
            voids += usize::from(verdict == "void");
        }
    }
    assert!(voids >= 16, "only {voids} parts without a line");
}

/// Faults that open a circuit of the output, with the recipe of the parts and the time at which the test of the second
/// part begins, s.
const OPEN_CIRCUITS: [(&str, &str, f64); 7] = [
    ("loop_dead", "ssr-ac-240v-5a-zc", 5.2),
    ("loop_dead", "ssr-ac-240v-5a-random", 5.2),
    ("loop_contactor_broken", "ssr-ac-240v-5a-zc", 5.2),
    ("line_contactor_broken", "ssr-ac-240v-5a-zc", 5.2),
    ("line_dead", "ssr-ac-240v-5a-random", 5.2),
    ("output_lead_open", "ssr-dc-60v-3a", 3.6),
    ("socket_short", "ssr-dc-60v-3a", 3.6),
];

#[test]
fn a_circuit_that_opens_at_any_instant_fails_no_part() {
    let workshop = Workshop::new("ssr-circuit-opens");
    let run = "--config config/rigs/ssr run --sim --json --seed 1";
    for (fault, recipe, from_s) in OPEN_CIRCUITS {
        let mut voids = 0;
        for number in 0..12 {
            let at_s = from_s + 0.117 * f64::from(number);
            let said = workshop.run(&format!(
                "{run} --recipe {recipe} --lot {fault}-{recipe}-{number} --count 3 --fault {fault}={at_s:.3}"
            ));
            let rows = objects(&said.stdout);
            for part in rows.iter().filter(|it| it["type"] == "part") {
                let verdict = part["verdict"].as_str().unwrap();
                let known = ["pass", "void"].contains(&verdict);
                assert!(known, "{fault} at {at_s:.3} s: {part}");
                voids += usize::from(verdict == "void");
            }
        }
        assert!(voids >= 8, "{fault}, {recipe}: only {voids} parts are void");
    }
}

#[test]
fn a_lost_reply_makes_good_parts_void_never_failed() {
    let workshop = Workshop::new("ssr-lost-replies");
    let said = workshop.run(&format!(
        "{RUN} --lot A --count 30 --seed 3 --truth t.jsonl --fault reply_lost=0.005"
    ));
    let rows = objects(&said.stdout);
    let truth = objects(&workshop.read("t.jsonl"));
    let is_good = |part: &Value| {
        let own = truth.iter().find(|it| it["seq"] == part["seq"]);
        own.is_some_and(|it| it["defect"].is_null())
    };
    let good = rows.iter().filter(|it| it["type"] == "part" && is_good(it));
    let verdicts: Vec<&str> = good.map(|it| it["verdict"].as_str().unwrap()).collect();
    assert!(
        verdicts.contains(&"void") && verdicts.contains(&"pass"),
        "{said}"
    );
    assert!(!verdicts.contains(&"fail"), "{said}");
}

#[test]
fn jaws_stay_closed_without_the_input_that_they_need() {
    let workshop = Workshop::new("ssr-interlock");
    workshop.change(
        "config/rigs/ssr/rig.toml",
        "timeout_ms = 800, to_rest_needs = \"output_safe\" }   #",
        "timeout_ms = 800, to_rest_needs = \"short_seen\" }   #",
    );
    let said = workshop.run(&format!("{RUN} --lot A --count 1 --seed 1"));
    let cause = said.with_status(3).objects().pop().unwrap()["cause"].take();
    assert_eq!(cause["code"], "motion_refused");
    assert_eq!(
        cause["text"],
        "clamp: open refused: Left jaw: needs the signal \"Short seen\", which is off or was not read recently"
    );
    let landed = workshop.count("SELECT count(*) FROM part WHERE landed_at_us IS NOT NULL");
    assert_eq!(landed, 0);
}

#[test]
fn an_alarm_file_has_the_last_exchanges_of_each_instrument() {
    let workshop = Workshop::new("ssr-alarm-files");
    let said = workshop.run(&format!(
        "{RUN} --lot A --count 9 --seed 1 --fault reply_lost=smu_in:0.4@3"
    ));
    said.with_status(3);
    let of = |name: &str| {
        let files = std::fs::read_dir(&workshop.folder).unwrap();
        let mut names = files.map(|it| it.unwrap().file_name().into_string().unwrap());
        let end = format!("-{name}.trace");
        let file = names.find(|it| it.ends_with(&end));
        workshop.read(&file.unwrap_or_else(|| panic!("no trace of {name}")))
    };
    for name in ["smu_in", "smu_out", "digitizer", "pulse_source"] {
        let text = of(name);
        let head = text.lines().next().unwrap();
        assert!(head.starts_with(&format!("# instrument {name} ")), "{head}");
        assert!(text.contains(" > *IDN?"), "{name}: {head}");
    }
    let head = of("smu_in");
    assert!(
        head.starts_with("# instrument smu_in smu-2450 tcp:192.168.10.11:5025 KEITHLEY"),
        "{head}"
    );
}

/// Faults of an instrument that begin in the third second, and words of the message that names each.
const INSTRUMENT_FAULTS: [(&str, &str); 8] = [
    (
        "--fault over_range=smu_in:1@3",
        ":READ?: the result is over the range of the instrument.",
    ),
    (
        "--fault not_a_number=smu_in:0.1@3",
        ":READ?: the instrument has no number for the result.",
    ),
    (
        "--fault block_cut=digitizer:1@3",
        ":WAV:DATA?: the reply is damaged or of another form: 1012 bytes received, then nothing.",
    ),
    (
        "--fault errors_overflow=smu_in:0.05@3",
        "The error queue of the instrument has overflowed",
    ),
    (
        "--fault local=smu_in:0.05@3",
        "The instrument is in local mode",
    ),
    (
        "--fault power_cycle=smu_in:0.05@3",
        "The instrument was switched off and on",
    ),
    (
        "--fault wrong_identity=smu_in:1@3 --fault closed_before=smu_in:0.05@3",
        "Another instrument answers: found RELAYRIG,OTHER",
    ),
    (
        "--fault port_busy=smu_in:1@3 --fault closed_before=smu_in:0.05@3",
        "The link is down after 3 attempts",
    ),
];

#[test]
fn an_instrument_in_trouble_is_named_and_fails_no_part() {
    for (number, (faults, message)) in INSTRUMENT_FAULTS.iter().enumerate() {
        let workshop = Workshop::new(&format!("ssr-trouble-{number}"));
        let said = workshop.run(&format!("{RUN} --lot A --count 9 --seed 3 {faults}"));
        assert!([0, 3].contains(&said.status), "{faults}: {said}");
        let rows = objects(&said.stdout);
        let parts = rows.iter().filter(|it| it["type"] == "part");
        let verdicts: Vec<&str> = parts.map(|it| it["verdict"].as_str().unwrap()).collect();
        assert!(verdicts.contains(&"void"), "{faults}: {said}");
        assert!(!verdicts.contains(&"fail"), "{faults}: {said}");
        assert!(said.stdout.contains(message), "{faults}: {said}");
        let alarms = workshop.texts("SELECT DISTINCT code FROM alarm");
        let is_raised = alarms.iter().any(|it| it == "instrument_trouble");
        assert_eq!(is_raised, said.status == 3, "{faults}: {alarms:?}");
    }
}

#[test]
fn a_silent_module_with_an_interlock_input_is_named() {
    for from_s in [3.0, 4.1, 5.3] {
        let workshop = Workshop::new(&format!("ssr-silent-{from_s}"));
        let said = workshop.run(&format!(
            "{RUN} --lot A --count 9 --seed 3 --fault silence=board_di@{from_s}"
        ));
        let cause = said.with_status(3).objects().pop().unwrap()["cause"].take();
        let text = cause["text"].as_str().unwrap();
        assert!(
            text.starts_with("line measure, module 08, "),
            "from {from_s} s: {text}"
        );
    }
}

#[test]
fn ramps_find_the_thresholds_within_their_uncertainty() {
    let workshop = Workshop::new("ssr-ramp");
    workshop.change(
        "config/rigs/ssr/recipes/ssr-dc-60v-3a.toml",
        "method = \"bisect\"",
        "method = \"ramp\"  ",
    );
    let said = workshop.run(&format!(
        "{RUN} --lot R --count 40 --seed 5 --truth t.jsonl"
    ));
    let rows = objects(&said.with_status(0).stdout);
    let truth = objects(&workshop.read("t.jsonl"));
    let parts = rows.iter().filter(|it| it["type"] == "part");
    let (mut found, mut beyond) = (0, 0);
    for (part, truth) in parts
        .zip(&truth)
        .filter(|(_, truth)| truth["defect"].is_null())
    {
        assert_eq!(part["verdict"], "pass", "{part}");
        for key in ["v_on_v", "v_off_v"] {
            let of = |it: &Value| it[key].as_f64().unwrap_or_else(|| panic!("{key}: {it}"));
            let error = (of(&part["values"]) - of(truth)).abs();
            found += 1;
            beyond += usize::from(error > of(&part["uncertainty"]));
        }
    }
    assert!(found >= 60 && beyond * 10 <= found, "{beyond} of {found}");
}

/// Results of parts 1 and 2 of a lot with serial numbers, as a hipot tester and a pulse generator give them.
const MEASURED: &str = "serial,key,value,unit,u,at\n\
    X-000001,dv_dt_v_us,620,V/us,30,2026-01-02T08:00:00+08:00\n\
    X-000001,r_iso_ohm,4.2e10,ohm,4e9,2026-01-02T08:05:00+08:00\n\
    X-000002,r_iso_ohm,6e8,ohm,6e7,2026-01-02T08:10:00+08:00\n";

#[test]
fn a_lot_waits_for_good_results_from_outside() {
    let workshop = Workshop::new("ssr-external");
    let recipe = "config/rigs/ssr/recipes/ssr-dc-60v-3a.toml";
    let demand =
        "[external]\ndv_dt_v_us = { low = 500.0 }\nr_iso_ohm = { low = 1e9 }\n\n[decision]";
    workshop.change(recipe, "[decision]", demand);
    let serials = "[serial]\nsource = \"counted\"\ntemplate = \"{lot}-{number:06}\"\n";
    workshop.write("config/rigs/ssr/lot.toml", serials);
    workshop
        .run(&format!("{RUN} --lot X --count 3 --seed 1"))
        .with_status(0);
    let shown = || workshop.run("history show X").with_status(0).stdout;
    let report = || {
        workshop
            .run("history report --lot X --lang en")
            .with_status(0)
            .stdout
    };
    assert!(shown().contains("NOT ACCEPTABLE (0 failed, 0 undecided, missing: Static dv/dt"));
    assert!(report().contains("NOT ACCEPTABLE"));

    workshop.write("measured.csv", MEASURED);
    let import = "history import-results measured.csv --lot X --by zhao";
    let said = workshop.run(import).with_status(0);
    assert!(
        said.stderr
            .contains("2 passed, 1 failed, 0 undecided, into lot \"X\""),
        "{said}"
    );
    assert!(said.stdout.contains("NOT ACCEPTABLE (1 failed"), "{said}");
    let again = workshop.run(import).with_status(2);
    assert!(
        again
            .stderr
            .contains("measured.csv: this very file is in lot \"X\" already, with 3 results"),
        "{again}"
    );
    workshop.write("bad.csv", &MEASURED.replace("6e8", "6e8 ohm"));
    let bad = workshop
        .run(&import.replace("measured", "bad"))
        .with_status(2);
    let named = "bad.csv: line 4, column value: found \"6e8 ohm\", expected a finite number";
    assert!(bad.stderr.contains(named), "{bad}");
    assert_eq!(workshop.count("SELECT count(*) FROM external_result"), 3);

    let certificate = "history report --lot X --part 2 --lang en";
    assert!(workshop.run(certificate).stdout.contains("Test record"));
    workshop.write(
        "repaired.csv",
        "serial,key,value,u\nX-000002,r_iso_ohm,3.1e10,3e9\n",
    );
    workshop
        .run(&import.replace("measured", "repaired"))
        .with_status(0);
    assert!(shown().contains("acceptable (3 passed)") && report().contains("superseded"));
    assert!(
        workshop
            .run(certificate)
            .stdout
            .contains("Test certificate")
    );
    let results = workshop
        .run("history results X --json")
        .with_status(0)
        .objects();
    assert_eq!(
        (results.len(), &results[2]["superseded"]),
        (4, &Value::Bool(true))
    );
    let exported = workshop.run("history export --lot X").with_status(0).stdout;
    assert!(
        exported
            .lines()
            .nth(2)
            .is_some_and(|it| it.ends_with("31000000000,3000000000,pass")),
        "{exported}"
    );
}
