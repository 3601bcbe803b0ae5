//! A batch of temperature relays on the simulated rig with a chamber.

use crate::program::{Workshop, objects};
use serde_json::Value;

const RUN: &str = "--config config/rigs/thermostat run --sim --recipe thermostat-ksd9700 --json";

/// Returns, for each part without defect that has the characteristic, its error divided by U.
fn errors(parts: &[&Value], truth: &[Value], key: &str) -> Vec<f64> {
    let one = |part: &&Value| {
        let own = truth.iter().find(|it| it["seq"] == part["seq"])?;
        let error = part["values"][key].as_f64()? - own[key].as_f64()?;
        let u = part["uncertainty"][key].as_f64()?;
        own["defect"].is_null().then_some(error / u)
    };
    parts.iter().filter_map(one).collect()
}

/// Returns true for a part that passes, or that fails by no more than U.
fn is_good_or_near(part: &Value) -> bool {
    let mut reasons = part["reasons"].as_array().unwrap().iter();
    part["verdict"] != "void" && reasons.all(|it| it.as_str().unwrap().ends_with("not proven"))
}

#[test]
fn a_batch_of_forty_agrees_with_the_truth() {
    let workshop = Workshop::new("thermostat-batch");
    let said = workshop.run(&format!(
        "{RUN} --lot A --count 40 --seed 1 --truth t.jsonl"
    ));
    let rows = objects(&said.with_status(0).stdout);
    let parts: Vec<&Value> = rows.iter().filter(|it| it["type"] == "part").collect();
    let truth = objects(&workshop.read("t.jsonl"));
    assert_eq!((parts.len(), truth.len()), (40, 40));
    let mut sockets: Vec<u64> = parts.iter().flat_map(|it| it["socket"].as_u64()).collect();
    sockets.sort_unstable();
    assert!(sockets.into_iter().eq(1..=40));
    for part in &parts {
        assert_eq!(part["batch"], 1);
        let own = truth.iter().find(|it| it["seq"] == part["seq"]).unwrap();
        assert!(
            !own["defect"].is_null() || is_good_or_near(part),
            "{part}\n{own}"
        );
    }
    let keys = [
        "operate_temperature_c",
        "reset_temperature_c",
        "differential_k",
    ];
    for key in keys {
        let errors = errors(&parts, &truth, key);
        let covered = errors.iter().filter(|it| it.abs() <= 1.0).count();
        let least = least_covered(errors.len());
        assert!(
            errors.len() >= 30 && covered >= least,
            "{key}: {covered} of {}, expected {least} or more: {errors:?}",
            errors.len()
        );
        let squares = errors.iter().map(|it| (2.0 * it).powi(2)).sum::<f64>();
        let ratio = squares / errors.len() as f64;
        let [low, high] = chi_squared(errors.len());
        assert!(
            (low..=high).contains(&ratio),
            "{key}: {ratio}, expected {low} to {high}"
        );
    }
}

/// A line whose modules answer late, and the times that they are allowed.
const SLOW: [(&str, &str, &str); 4] = [
    (
        "sim.toml",
        "latency_ms_mean = 2.0 ",
        "latency_ms_mean = 50.0 ",
    ),
    (
        "rig.toml",
        "digital_allowance_ms = 30 ",
        "digital_allowance_ms = 105 ",
    ),
    (
        "rig.toml",
        "analog_allowance_ms = 60 ",
        "analog_allowance_ms = 135 ",
    ),
    (
        "rig.toml",
        "estop_reaction_ms = 900 ",
        "estop_reaction_ms = 1900 ",
    ),
];

#[test]
fn a_slow_line_voids_no_part() {
    let workshop = Workshop::new("thermostat-slow");
    for (file, from, to) in SLOW {
        workshop.change(&format!("config/rigs/thermostat/{file}"), from, to);
    }
    let said = workshop.run(&format!("{RUN} --lot A --count 40 --seed 1"));
    let rows = objects(&said.with_status(0).stdout);
    let parts = rows.iter().filter(|it| it["type"] == "part");
    let judged = parts.filter(|it| it["verdict"] != "void").count();
    assert_eq!(judged, 40);
}

/// Returns the least number of values out of `all` whose U must cover the truth: an honest U, which covers 93 % or
/// more, falls below this number in less than one lot of a hundred.
fn least_covered(all: usize) -> usize {
    let (mut chance, mut below) = (0.93_f64.powi(all as i32), 1.0);
    for missed in 0..=all {
        below -= chance;
        if below < 0.01 {
            return all - missed;
        }
        chance *= (all - missed) as f64 / (missed + 1) as f64 * 0.07 / 0.93;
    }
    0
}

/// Returns the range of the mean square of `all` normal values, three standard deviations to either side (Wilson and
/// Hilferty). If the errors, in units of their standard uncertainty, have a mean square outside this range, U is stated
/// too small or too large.
fn chi_squared(all: usize) -> [f64; 2] {
    let share = 2.0 / (9.0 * all as f64);
    [-3.0, 3.0].map(|z| (1.0 - share + z * share.sqrt()).powi(3))
}

#[test]
fn the_bounds_of_a_lot_are_those_of_the_tables() {
    // Binomial with 38 values: 8 or more misses at 7 % each have a chance of 0.4 %, 7 or more of 1.5 %.
    assert_eq!(least_covered(38), 31);
    let [low, high] = chi_squared(38);
    assert!((low - 0.447).abs() < 0.01 && (high - 1.832).abs() < 0.01);
}

const RECIPE: &str = "config/rigs/thermostat/recipes/thermostat-ksd9700.toml";
const RIG: &str = "config/rigs/thermostat/rig.toml";
const CERTIFIED: &str = "rack = \"rack.toml\"";

/// Runs a lot of one part; returns the reason for which the program refuses the configuration.
fn refused(workshop: &Workshop) -> String {
    let said = workshop.run(&format!("{RUN} --lot A --count 1 --seed 1"));
    said.with_status(2).stderr.clone()
}

#[test]
fn limits_without_room_for_u_are_refused() {
    let workshop = Workshop::new("thermostat-limits");
    let usual = "operate_temperature_c = { low = 80.0, high = 90.0 }";
    let narrow = "operate_temperature_c = { low = 84.8, high = 85.2 }";
    workshop.change(RECIPE, usual, narrow);
    let said = refused(&workshop);
    assert!(
        said.contains("[limits].operate_temperature_c: found 84.8 to 85.2"),
        "{said}"
    );
}

#[test]
fn without_a_certificate_a_tight_claim_is_refused() {
    let workshop = Workshop::new("thermostat-claim");
    workshop.change(
        RECIPE,
        "control = \"pid\"",
        "claimed_u_k = 0.6\ncontrol = \"pid\"",
    );
    let check = "--config config/rigs/thermostat config check";
    workshop.run(check).with_status(0);
    workshop.change(RIG, CERTIFIED, "# none");
    let said = refused(&workshop);
    let expected = "[test].claimed_u_k: found 0.6, expected at least 0.8";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn a_certificate_for_other_sockets_is_refused() {
    let workshop = Workshop::new("thermostat-certificate");
    workshop.change(
        "config/rigs/thermostat/rack.toml",
        "offset_k = [",
        "offset_k = [0.1,",
    );
    let said = refused(&workshop);
    let expected = "[map].offset_k: found 41 offsets, expected one for each of the 40 sockets";
    assert!(said.contains(expected), "{said}");
}

const REFEREE: &str = "config/rigs/thermostat/recipes/thermostat-referee.toml";
const RACK: &str = "config/rigs/thermostat/rack.toml";
/// Response of a chamber with a weak heater, before the map of the sockets.
const WEAK: &str = "[chamber]
gain_k = 10.0
time_constant_s = 22.0
delay_s = 6.7
slope_k_per_s = 0.08
loss_per_k = 0.0018
fan = 0.03
vent_per_k = 0.008
first_order = { gain_k = 22.0, time_constant_s = 52.0, delay_s = 4.5 }

[map]";

/// Bad input: file, text in the file, text that replaces it, and the message of the program.
const BAD: [[&str; 4]; 11] = [
    [
        RIG,
        "02 = { module = \"socket_di_a\", channel = 1,",
        "02 = { module = \"socket_di_a\", channel = 0,",
        "[socket].02: found socket_di_a channel 0, expected a terminal of its own",
    ],
    [
        RIG,
        "select = 1, row",
        "select = 0, row",
        "[socket].02.select: found 0, expected a number of its own",
    ],
    [
        RIG,
        "model = \"I-7033\"\ntype = \"22\"",
        "model = \"I-7033\"\ntype = \"0F\"",
        "[module.rtd].type: found \"0F\", expected 20, 21, 22, 23, 24, 25, 26, 27 for an I-7033",
    ],
    [
        RIG,
        "model = \"I-7033\"",
        "model = \"I-7018\"",
        "[module.rtd].type: found \"22\", expected 0E, 0F, 10, 11 for an I-7018",
    ],
    [
        RECIPE,
        "{ low = 80.0, high = 90.0 }",
        "{ low = 84.8, high = 85.2 }",
        "[limits].operate_temperature_c: found 84.8 to 85.2, expected limits more than 0.71 K apart",
    ],
    [
        RECIPE,
        "{ low = 80.0, high = 90.0 }",
        "{ low = 180.0, high = 196.0 }",
        "[limits].operate_temperature_c.high: found 196, expected a window that ends below 195 C",
    ],
    [
        RECIPE,
        "{ low = 57.0, high = 73.0 }",
        "{ low = 42.0, high = 73.0 }",
        "[limits].reset_temperature_c.low: found 42, expected a window that ends above 40 C",
    ],
    [
        RECIPE,
        "learning_k_per_min = 5.0",
        "learning_k_per_min = 12.0",
        "[test].learning_k_per_min: found 12.0, expected a number of K/min from 0.1 to 10",
    ],
    [
        RECIPE,
        "scatter_passes = 3",
        "scatter_passes = 1",
        "[test].scatter_passes: found 1, expected at least 2: with a limit of repeatability_k",
    ],
    [
        REFEREE,
        "rate_k_per_min = 0.5",
        "rate_k_per_min = 0.55",
        "[test].rate_k_per_min: found 0.55, expected at most 0.51",
    ],
    [
        RACK,
        "[map]",
        WEAK,
        "[test].learning_k_per_min: found 5, expected at most 3.6 K/min",
    ],
];

#[test]
fn bad_input_is_refused_with_key_found_and_expected() {
    for (number, [file, usual, bad, expected]) in BAD.into_iter().enumerate() {
        let workshop = Workshop::new(&format!("thermostat-bad-{number}"));
        workshop.change(file, usual, bad);
        let said = workshop.run("--config config/rigs/thermostat config check");
        let said = said.with_status(2).stderr.clone();
        assert!(said.contains(expected), "{expected}\n{said}");
    }
}

#[test]
fn the_history_keeps_the_certificate_as_a_calibration() {
    let workshop = Workshop::new("thermostat-calibrate");
    let own = "--config config/rigs/thermostat calibrate --sim --recipe thermostat-ksd9700 --json";
    let stored = objects(&workshop.run(own).with_status(0).stdout);
    let names: Vec<&str> = stored.iter().flat_map(|it| it["factor"].as_str()).collect();
    assert_eq!(names, ["thermometer_error", "socket_offset"]);
    assert_eq!(workshop.count("SELECT count(*) FROM calibration"), 1);
    let verified = objects(
        &workshop
            .run(&format!("{own} --verify"))
            .with_status(0)
            .stdout,
    );
    assert_eq!(verified.last().unwrap()["verified"], true);
    workshop.change("config/rigs/thermostat/rack.toml", "40.06", "41.56");
    let failed = workshop
        .run(&format!("{own} --verify"))
        .with_status(1)
        .stdout
        .clone();
    assert_eq!(objects(&failed).last().unwrap()["verified"], false);
}

#[test]
fn lots_follow_the_date_and_text_of_the_certificate() {
    let workshop = Workshop::new("thermostat-issued");
    let rack = "config/rigs/thermostat/rack.toml";
    let run = "--config config/rigs/thermostat run --lot A --recipe thermostat-ksd9700 --count 1";
    let calibrate = "--config config/rigs/thermostat calibrate --recipe thermostat-ksd9700";
    let said = |line: &str, status| workshop.run(line).with_status(status).stderr.clone();
    let doctor_differs = || {
        let said = workshop.run("--config config/rigs/thermostat doctor");
        said.stdout.contains("from another certificate")
    };
    assert!(said(run, 3).contains("the calibration ran out at 2025-01-14T00:00:00Z"));
    assert!(said(calibrate, 2).contains("issued: found 2024-01-15T00:00:00Z"));
    let today = jiff::Timestamp::now().strftime("%Y-%m-%d").to_string();
    workshop.change(rack, "2024-01-15", &today);
    said(calibrate, 0);
    said(calibrate, 0);
    assert!(!doctor_differs());
    workshop.change(rack, "40.06", "41.56");
    assert!(doctor_differs());
    assert!(said(run, 3).contains("the certificate differs from the stored one"));
    workshop.change(rack, &today, "2999-01-15");
    assert!(said(calibrate, 2).contains("expected a date that has come"));
}

/// A fault of the chamber, and the alarms of which one must come first.
const FAULTS: [(&str, &[&str]); 14] = [
    ("limiter", &["limiter_tripped"]),
    ("control_open", &["thermometer_broken"]),
    ("control_short", &["thermometer_broken", "thermometer_jump"]),
    (
        "control_stuck",
        &["thermometers_differ", "thermometer_stuck"],
    ),
    ("reference_open", &["thermometer_broken"]),
    (
        "reference_short",
        &["thermometer_broken", "thermometer_jump"],
    ),
    (
        "reference_stuck",
        &["thermometers_differ", "thermometer_stuck"],
    ),
    (
        "heater_open",
        &[
            "energy_balance",
            "ramp_not_reached",
            "heating_not_identified",
        ],
    ),
    (
        "ssr_stuck",
        &[
            "heat_without_command",
            "over_set_point",
            "energy_balance",
            "heating_not_identified",
        ],
    ),
    ("fan_stopped", &["airflow_lost"]),
    ("mains_off", &["mains_lost"]),
    ("door", &["door_open"]),
    ("estop", &["emergency_stop"]),
    ("silence=rtd", &["bus_trouble"]),
];

#[test]
fn a_fault_at_any_instant_raises_its_alarm_and_fails_no_part() {
    let mut dice = 20_261_128_u64;
    let mut drawn = || {
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        // From the first heat of the identification to the first fall.
        420 + (dice >> 33) % 1_100
    };
    let all = FAULTS.map(|(fault, alarms)| (fault, alarms, drawn()));
    let (first, second) = all.split_at(all.len() / 2);
    std::thread::scope(|scope| {
        scope.spawn(|| second.iter().for_each(strike));
        first.iter().for_each(strike);
    });
}

/// Runs a batch under a fault and checks its first alarm and its parts.
fn strike((fault, alarms, at_s): &(&str, &[&str], u64)) {
    let struck = match fault.contains('=') {
        true => format!("{fault}@{at_s}"),
        false => format!("{fault}={at_s}"),
    };
    let workshop = Workshop::new(&format!("thermostat-{}", fault.replace('=', "-")));
    let said = workshop.run(&format!(
        "{RUN} --lot A --count 3 --seed 1 --fault {struck}"
    ));
    let rows = objects(&said.with_status(3).stdout);
    let mut parts = rows.iter().filter(|it| it["type"] == "part");
    assert!(
        parts.all(|it| it["verdict"] == "void"),
        "{struck}: {rows:?}"
    );
    let raised = workshop.texts("SELECT code FROM alarm ORDER BY id");
    let first = raised.iter().find(|it| *it != "sockets_open");
    let known = first.is_some_and(|it| alarms.contains(&it.as_str()));
    assert!(known, "{struck}: {raised:?}");
}
