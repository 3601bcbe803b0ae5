//! `relayrig instrument` on the simulated instruments of `tests/instruments/bench.toml`, in real time.

use crate::program::{Said, Workshop, objects};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::Child;

/// Served instruments; dropping this value ends them.
struct Bench {
    shop: Workshop,
    sim: Child,
    links: Value,
}

impl Bench {
    fn new(name: &str) -> Self {
        let shop = Workshop::new(name);
        shop.write("bench.toml", include_str!("../../instruments/bench.toml"));
        let mut sim = shop.start("sim --instruments bench.toml");
        let mut first = String::new();
        BufReader::new(sim.stdout.take().unwrap())
            .read_line(&mut first)
            .unwrap();
        let links = serde_json::from_str::<Value>(&first).unwrap()["instruments"].take();
        Self { shop, sim, links }
    }

    fn link(&self, name: &str) -> &str {
        self.links[name].as_str().unwrap()
    }

    /// Runs `instrument VERB --link` with the link of an instrument, and further words.
    fn run(&self, verb: &str, name: &str, words: &str) -> Said {
        let link = self.link(name);
        let line = format!("instrument {verb} --link {link} {words}");
        self.shop.run(&line)
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.sim.kill();
        let _ = self.sim.wait();
    }
}

/// Instrument, its profile, and the programs to run.
const CHECKS: [(&str, &str, &str); 7] = [
    (
        "smu",
        "smu-2450",
        "--run source_range,range_v=20,limit_a=0.05 --run current_range,range_a=0.01,periods=1 \
         --run ramp,from_v=1,to_v=2,step_v=0.25,dwell_s=0.001,points=5 --run current_at_level,level_v=4",
    ),
    (
        "dmm",
        "dmm-34461a",
        "--run current --run current_range,range_a=0.001,periods=1 --run voltage_range,range_v=10,periods=1",
    ),
    (
        "second_dmm",
        "dmm-34461a",
        "--run current_range,range_a=0.001,periods=1 --run current",
    ),
    (
        "ac_source",
        "ac-source-61500",
        "--run set,level_v=230,frequency_hz=50,limit_a=1 --run measure --run off",
    ),
    (
        "pulses",
        "pulse-source",
        "--run train,level_v=5,period_s=0.02,width_s=0.01,pulses=3 --run start --run off",
    ),
    (
        "rigol",
        "digitizer-rigol",
        "--run arm --run force_trigger --run state --run state --run waveform,channel=1,points=200",
    ),
    (
        "keysight",
        "digitizer-keysight",
        "--run arm --run force_trigger --run state --run state --run waveform,channel=1,points=200",
    ),
];

#[test]
fn every_profile_passes_its_check_with_its_programs() {
    let bench = Bench::new("instrument_check");
    for scope in ["rigol", "keysight"] {
        // Noise triggers at 0 V, and the first record is long.
        for command in [":TRIG:LEV 5", ":ACQ:MDEP 1000"] {
            let mut send = bench.shop.command("instrument send --link");
            let sent = send.args([bench.link(scope), command]).output().unwrap();
            assert!(sent.status.success(), "{scope}: {sent:?}");
        }
    }
    for (name, profile, programs) in CHECKS {
        let words = format!("--profile {profile} --timeout 5000 {programs} --json");
        let said = bench.run("check", name, &words);
        let rows = objects(&said.stdout);
        let failed: Vec<&Value> = rows.iter().filter(|it| it["ok"] != true).collect();
        // A busy computer may fail the check of the latency, and no other check.
        let slow = failed.iter().all(|it| it["check"] == "latency");
        assert!(slow && said.status <= 1, "{name}: {said:?}");
        let programs = programs.matches("--run").count();
        assert_eq!(rows.len(), 5 + programs, "{name}: {said:?}");
    }
    let words = "--profile smu-2450 --run current_at_level,level_v=4 --json";
    let rows = objects(&bench.run("check", "smu", words).stdout);
    let row = rows.iter().find(|it| it["check"] == "current_at_level");
    let amps: f64 = row.unwrap()["found"].as_str().unwrap().parse().unwrap();
    assert!((amps - 4e-3).abs() < 4e-5, "{amps} A");
}

#[test]
fn an_interrupted_check_makes_the_instrument_safe() {
    let bench = Bench::new("instrument_interrupted");
    let ramp = "ramp,from_v=1,to_v=9,step_v=1,dwell_s=1,points=9";
    let line = format!(
        "instrument check --link {} --profile smu-2450 --run {ramp} --json",
        bench.link("smu")
    );
    let said = bench.shop.run_interrupted("4", &line).with_status(4);
    let last = &said.objects().pop().unwrap();
    assert_eq!(
        (&last["check"], &last["ok"]),
        (&"safe".into(), &true.into())
    );
}

#[test]
fn a_wrong_profile_or_argument_is_named() {
    let bench = Bench::new("instrument_refused");
    let said = bench.run("check", "smu", "--profile dmm-34461a --json");
    let row = &objects(&said.stdout)[0];
    assert_eq!(
        (said.status, &row["failure"]["code"]),
        (1, &"wrong_identity".into()),
        "{said:?}"
    );
    let words = "--profile smu-2450 --config nowhere";
    let said = bench.run("check", "smu", words).with_status(2);
    assert!(said.stderr.contains("nowhere"), "{said:?}");
    let wrong = [
        (
            "current_at_level",
            "argument level_v: found nothing, expected a number from -200 to 200",
        ),
        ("current_at_level,level_v=x", "expected ARGUMENT=NUMBER"),
        (
            "leakage",
            "found program \"leakage\", expected one of current_at_level,",
        ),
    ];
    for (program, message) in wrong {
        let words = format!("--profile smu-2450 --run {program}");
        let said = bench.run("check", "smu", &words).with_status(2);
        assert!(said.stderr.contains(message), "{said:?}");
    }
}

#[test]
fn scan_names_every_instrument_and_its_profile() {
    let bench = Bench::new("instrument_scan");
    let links = CHECKS.map(|(name, ..)| format!("--link {}", bench.link(name)));
    let line = format!("instrument scan --timeout 3000 {} --json", links.join(" "));
    let found = bench.shop.run(&line).with_status(0).objects();
    assert_eq!(found.len(), CHECKS.len(), "{found:?}");
    for (it, (name, profile, _)) in found.iter().zip(CHECKS) {
        assert_eq!(it["link"], bench.link(name));
        assert_eq!(it["profiles"], serde_json::json!([profile]), "{it}");
    }
    let broken = "config/instruments/dmm-34461a.toml";
    bench
        .shop
        .change(broken, "class = \"dmm\"", "class = \"meter\"");
    let nobody = bench.shop.run("instrument scan --link tcp:127.0.0.1:1");
    let nobody = nobody.with_status(1);
    assert_eq!(nobody.stdout, "no instrument answered\n");
    for warning in ["127.0.0.1:1: connection refused", "class: found \"meter\""] {
        assert!(nobody.stderr.contains(warning), "{nobody}");
    }
}

#[test]
fn send_shows_reply_and_error_queue() {
    let bench = Bench::new("instrument_send");
    let said = bench.run("send", "ac_source", "*IDN?").with_status(0);
    assert!(said.stdout.contains("< Chroma ATE,61503,"), "{said:?}");
    let said = bench.run("send", "smu", "NONSENSE").with_status(1);
    assert!(
        said.stdout.contains("error -113: Undefined header"),
        "{said:?}"
    );
    for name in ["smu", "ac_source"] {
        let said = bench.run("send", name, "NONSENSE? --timeout 500 --json");
        let object = &said.with_status(1).objects()[0];
        assert_eq!(object["failure"]["code"], "timeout", "{object}");
        assert_eq!(object["errors"][0]["code"], -113, "{object}");
    }
    let said = bench.run("send", "rigol", ":WAV:PRE?").with_status(0);
    assert!(said.stdout.contains("  10 numbers\n"), "{said:?}");
}

#[test]
fn a_command_that_nobody_takes_is_no_success() {
    let bench = Bench::new("instrument_absent");
    let (adapter, _) = bench.link("ac_source").rsplit_once(':').unwrap();
    let mut send = bench.shop.command("instrument send --timeout 300 --link");
    let sent = send.args([&format!("{adapter}:10"), "*CLS"]).output();
    let said = sent.unwrap();
    let stdout = String::from_utf8(said.stdout).unwrap();
    assert_eq!(said.status.code(), Some(1), "{stdout}");
    assert!(
        stdout.contains("the error queue cannot be read: SYST:ERR?"),
        "{stdout}"
    );
}

#[test]
fn monitor_repeats_a_query() {
    let bench = Bench::new("instrument_monitor");
    let words = "--query *ESR? --every 50 --seconds 2";
    let said = bench.run("monitor", "second_dmm", words).with_status(0);
    assert!(said.stdout.lines().count() > 3, "{said:?}");
    let words = "--query *IDN? --every 50 --seconds 2 --traffic";
    let said = bench.run("monitor", "smu", words).with_status(0);
    assert!(said.stdout.contains("> *IDN?\\n"), "{said:?}");
}

#[test]
fn monitor_of_a_missing_instrument_backs_off() {
    let shop = Workshop::new("instrument_monitor_missing");
    let words = "instrument monitor --link tcp:127.0.0.1:1 --query *STB? --every 1 --seconds 2";
    let said = shop.run(words).with_status(0);
    // If the pauses did not grow, the command would print hundreds of rows.
    assert!((1..=3).contains(&said.stdout.lines().count()), "{said}");
    assert!(
        said.stdout.contains("The link is down after 3 attempts"),
        "{said}"
    );
}
