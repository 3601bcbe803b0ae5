//! `relayrig bus` on the modules of a bench file, and the trace that an alarm leaves.

use crate::program::Workshop;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::Child;

const BENCH: &str = r#"
baud = 115200
latency_ms = 2.0
[[module]]
address = 1
model = "I-7017"
checksum = true
format = "engineering"
range = "08"
inputs = [5.0, 4.0, 3.0, 2.0, 1.0, 0.0, -1.0, -2.0]
[[module]]
address = 18
model = "I-7043"
checksum = true
[[module]]
address = 4
model = "I-7021"
init = true
"#;

/// Modules on a pseudo-terminal; dropping this value ends them.
struct Bench {
    shop: Workshop,
    sim: Child,
    port: String,
}

impl Bench {
    fn new(name: &str) -> Self {
        Self::with(name, "")
    }

    /// Starts the modules; `words` are further arguments.
    fn with(name: &str, words: &str) -> Self {
        let shop = Workshop::new(name);
        std::fs::write(shop.folder.join("bench.toml"), BENCH).unwrap();
        let mut sim = shop.start(&format!("sim --bench bench.toml {words}"));
        let mut first = String::new();
        BufReader::new(sim.stdout.take().unwrap())
            .read_line(&mut first)
            .unwrap();
        let lines: Value = serde_json::from_str(&first).unwrap();
        let port = lines["lines"]["bench"].as_str().unwrap().to_owned();
        Self { shop, sim, port }
    }

    fn bus(&self, what: &str) -> (i32, String, String) {
        let (verb, rest) = what.split_once(' ').unwrap_or((what, ""));
        let said = self
            .shop
            .run(&format!("bus {verb} --port {} {rest}", self.port));
        (said.status, said.stdout, said.stderr)
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.sim.kill();
        let _ = self.sim.wait();
    }
}

/// Time-out for a busy machine, ms; a silent address costs twice as much.
const ALLOWANCE: u32 = 400;

#[test]
fn scan_finds_exactly_the_modules_of_the_line() {
    let bench = Bench::new("bus_scan");
    let found = |addresses: &str| {
        let (status, out, err) = bench.bus(&format!(
            "scan --baud 115200 --addresses {addresses} --checksum on --allowance {ALLOWANCE} --json"
        ));
        let rows = out.lines().map(|line| serde_json::from_str(line).unwrap());
        (status, rows.collect::<Vec<Value>>(), err)
    };
    let (status, rows, err) = found("11-13");
    assert_eq!((status, rows.len()), (0, 1), "{rows:?} {err}");
    let module = &rows[0];
    assert_eq!(
        (&module["address"], &module["type"]),
        (&"12".into(), &"40".into())
    );
    assert!(
        module["name"].as_str().unwrap().contains("7043"),
        "{module}"
    );
    assert!(module["p99_ms"].as_f64().unwrap() >= 1.0, "{module}");
    assert_eq!(found("20-21").0, 1);
}

#[test]
fn scan_finds_modules_at_any_rate_and_checksum() {
    let bench = Bench::with("bus_scan_rates", "--heed-baud");
    let (status, out, err) = bench.bus(&format!(
        "scan --baud 115200 --baud 9600 --addresses 00-01 --allowance {ALLOWANCE} --json"
    ));
    let found = out.lines().map(|line| {
        let it: Value = serde_json::from_str(line).unwrap();
        let word = |key| it[key].as_str().unwrap().to_owned();
        format!(
            "{} {} {} {}",
            word("address"),
            word("name"),
            it["baud"],
            it["checksum"]
        )
    });
    assert_eq!(status, 0, "{err}");
    assert_eq!(
        found.collect::<Vec<_>>(),
        ["00 7021 9600 false", "01 7017 115200 true"],
        "{out}"
    );
    assert!(out.contains("INIT* mode, stored address 04"), "{out}");
}

#[test]
fn a_closed_pipe_ends_a_tool_silently() {
    let bench = Bench::new("bus_unread");
    let send = format!(
        "bus send --port {} --allowance 900 --checksum $01M",
        bench.port
    );
    for line in [&*send, "sim --faults"] {
        let said = bench.shop.run_unread(line);
        assert_eq!((said.status, &*said.stderr), (0, ""), "{line}");
    }
}

#[test]
fn send_decodes_replies_and_refuses_factory_commands() {
    let bench = Bench::new("bus_send");
    let (status, out, _) = bench.bus("send --allowance 900 --checksum #010 --model 7017");
    assert!(
        status == 0 && out.contains("module 01, read analog input 0: "),
        "{out}"
    );
    assert!(
        out.contains("> #010B4\\r") && out.contains("< >+0"),
        "{out}"
    );
    let (status, out, _) = bench.bus("send --allowance 900 --checksum @12BEEF");
    assert!(
        status == 0
            && out.contains("module 12, switch on the outputs 0 1 2 3 5 6 7 9 10 11 12 13 15, all others off: done"),
        "{out}"
    );
    let (status, out, _) = bench.bus("send --checksum #**");
    assert!(
        status == 0 && out.contains("all modules: sample all inputs now; no module answers"),
        "{out}"
    );
    let (status, out, _) = bench.bus("send --allowance 900 --checksum $015FF --model 7017");
    assert!(status == 0 && out.contains("not written again"), "{out}");
    let (status, out, _) = bench.bus("send --allowance 900 --checksum $552");
    assert!(status == 1 && out.contains("no reply"), "{out}");
    for factory in ["$010", "~01E1"] {
        let (status, _, err) = bench.bus(&format!("send --checksum {factory}"));
        assert!(status == 2 && err.contains("factory"), "{err}");
    }
    for address in ["$0zM", "$0aM", "$1"] {
        let (status, _, err) = bench.bus(&format!("send --checksum {address}"));
        assert!(status == 2 && err.contains("capitals"), "{err}");
    }
    let (status, _, err) = bench.bus("send --baud 12345 $012");
    assert!(status == 2 && err.contains("12345"), "{err}");
}

#[test]
fn an_alarm_leaves_a_trace_named_in_the_log() {
    let shop = Workshop::new("bus_trace");
    let said = shop
        .run("run --sim --lot T --recipe jzc-22f-012 --count 2 --fault silence=board_di@0 --json");
    assert_eq!(said.status, 3, "{}", said.stderr);
    let log = said.stderr.split_whitespace();
    let named: Vec<&str> = log.filter(|word| word.ends_with(".trace")).collect();
    assert_eq!(named.len(), 2, "{}", said.stderr);
    for path in named {
        let bytes = shop.run(&format!("bus monitor --trace {path} --level bytes"));
        let meaning = shop.run(&format!("bus monitor --trace {path}"));
        assert_eq!((bytes.status, meaning.status), (0, 0), "{}", meaning.stderr);
        assert!(
            bytes.stdout.contains(" > ") && bytes.stdout.contains(" 0D"),
            "{path}"
        );
        assert!(
            meaning.stdout.contains("read the configuration: address "),
            "{}",
            meaning.stdout
        );
    }
    let missing = shop.run("bus monitor --trace nothing.trace");
    assert!(missing.status == 2 && missing.stderr.contains("nothing.trace"));
}

/// A process; dropping this value ends it.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn another_shell_monitors_a_running_controller() {
    let shop = Workshop::new("bus_follow");
    let mut demo = Running(shop.start_logging("demo --listen 127.0.0.1:0 --speed 1"));
    // Keeps the log open to the end, so that the program never writes to a closed pipe.
    let mut log = BufReader::new(demo.0.stderr.take().unwrap()).lines();
    let page = log.by_ref().map_while(Result::ok).find_map(|row| {
        let (_, rest) = row.split_once("page at ")?;
        Some(rest.split_once("/,")?.0.to_owned())
    });
    let page = page.unwrap();
    let mut monitor = Running(shop.start(&format!("bus monitor --from {page} --seconds 100")));
    let mut rows = BufReader::new(monitor.0.stdout.take().unwrap()).lines();
    let mut told = |line: &str, what: &str| {
        rows.any(|row| row.is_ok_and(|row| row.contains(line) && row.contains(what)))
    };
    assert!(told(" measure > ", "$"));
    assert!(told(" motion < ", "read the digital channels: first byte"));
    let wrong = shop.run("bus monitor --from http://127.0.0.1:1 --seconds 5");
    assert!(
        wrong.status == 2 && wrong.stderr.contains("127.0.0.1:1"),
        "{wrong:?}"
    );
}
