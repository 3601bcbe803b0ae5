//! `relayrig instrument` on servers of other makers: scpipy, with a status system of its own, and sinstruments.

use super::{file, python, turn};
use serde_json::Value;
use std::io::{BufRead, BufReader, Lines};
use std::process::{Child, ChildStdout, Command, Stdio};

/// A running program; dropping this value kills it.
struct Running(Child);

impl Running {
    /// Starts a program; returns it with the lines that it prints.
    fn new(command: &mut Command) -> (Self, Lines<BufReader<ChildStdout>>) {
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let stdout = child.stdout.take().unwrap();
        (Self(child), BufReader::new(stdout).lines())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Serves an instrument; returns its server and its port.
fn served(command: &mut Command) -> (Running, String) {
    let (server, mut lines) = Running::new(command);
    let port = lines.next().expect("the server has a port").unwrap();
    (server, port)
}

fn scpipy(port: &str) -> (Running, String) {
    served(python().arg(file("serve.py")).arg(port))
}

fn sinstruments() -> (Running, String) {
    let mut python = python();
    python.env("PYTHONPATH", file("")).arg("-B");
    python.args(["-m", "sinstruments", "-c"]);
    served(python.arg(file("plain.json")))
}

fn instrument(verb: &str, port: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_relayrig"));
    command.arg("--config").arg(file("config"));
    command.args(["instrument", verb, "--timeout", "500", "--link"]);
    command.arg(format!("tcp:127.0.0.1:{port}"));
    command
}

/// Runs `relayrig instrument VERB` to its end; returns exit status and JSON lines.
fn run(verb: &str, port: &str, words: &str) -> (i32, Vec<Value>) {
    let mut command = instrument(verb, port);
    let done = command.args(words.split(' ')).output().unwrap();
    let lines = String::from_utf8(done.stdout).unwrap();
    let objects = lines.lines().map(|it| serde_json::from_str(it).unwrap());
    (done.status.code().unwrap(), objects.collect())
}

/// Returns the row of a check.
fn row<'a>(rows: &'a [Value], check: &str) -> &'a Value {
    let row = rows.iter().find(|it| it["check"] == check);
    row.unwrap_or_else(|| panic!("{check} in {rows:?}"))
}

#[test]
fn another_server_passes_the_check() {
    let _turn = turn();
    let (_server, port) = scpipy("0");
    let (status, found) = run("scan", &port, "--json");
    assert_eq!((status, found.len()), (0, 1), "{found:?}");
    let fields = ["maker", "model", "serial", "firmware"].map(|it| found[0][it].as_str().unwrap());
    assert_eq!(fields, ["ACME", "Counter", "7", "1.0"]);
    assert_eq!(found[0]["profiles"], serde_json::json!(["counter"]));
    for expected in ["1, 2", "3, 4"] {
        let (status, rows) = run("check", &port, "--json --profile counter --run two");
        assert_eq!(status, 0, "{rows:?}");
        assert_eq!(row(&rows, "identity")["found"], "ACME,Counter,7,1.0");
        assert_eq!(row(&rows, "two")["found"], expected);
    }
    let (status, sent) = run("send", &port, "--json READ?");
    assert_eq!((status, &sent[0]["reply"]), (0, &"5".into()), "{sent:?}");
}

#[test]
fn an_unknown_command_fails_with_the_servers_own_error() {
    let _turn = turn();
    let (_server, port) = scpipy("0");
    for (command, failure) in [("NONSENSE", None), ("NONSENSE?", Some("timeout"))] {
        let (status, sent) = run("send", &port, &format!("--json {command}"));
        let code = &sent[0]["errors"][0]["code"];
        assert_eq!((status, code), (1, &(-110).into()), "{sent:?}");
        assert_eq!(sent[0]["failure"]["code"].as_str(), failure, "{sent:?}");
    }
    let words = "--json --profile counter --run unknown --run word --run two";
    let (status, rows) = run("check", &port, words);
    let failure = |check: &str| row(&rows, check)["failure"].clone();
    assert_eq!(status, 1, "{rows:?}");
    assert_eq!(failure("unknown")["code"], "instrument");
    assert_eq!(failure("unknown")["args"]["number"], "-110");
    assert_eq!(failure("word")["code"], "malformed");
    // The failed program takes no reply from the program after it.
    assert_eq!(row(&rows, "two")["found"], "1, 2");
}

#[test]
fn a_check_names_what_a_plain_server_lacks() {
    let _turn = turn();
    let (_server, port) = sinstruments();
    let (status, rows) = run("check", &port, "--json --profile counter");
    let failure = &row(&rows, "identity")["failure"];
    assert_eq!((status, rows.len()), (1, 1), "{rows:?}");
    assert_eq!(failure["code"], "link_down");
    assert_eq!(failure["args"]["detail"], "*ESE?: no reply within 500 ms");
    // The profile `plain` asks for the identity instead of *ESE, so the link stays in step with the server.
    let words = "--json --profile plain --run two --run unknown --run two";
    let (status, rows) = run("check", &port, words);
    assert_eq!(status, 1, "{rows:?}");
    assert_eq!(row(&rows, "unknown")["failure"]["code"], "timeout");
    let two: Vec<_> = rows.iter().filter(|it| it["check"] == "two").collect();
    assert_eq!([&two[0]["found"], &two[1]["found"]], ["1, 2", "3, 4"]);
}

#[test]
fn monitor_outlives_the_server_and_finds_the_next() {
    let _turn = turn();
    let (server, port) = scpipy("0");
    let words = ["--query", "READ?", "--every", "10", "--seconds", "60"];
    let (_monitor, lines) = Running::new(instrument("monitor", &port).args(words));
    // The text after the time in each line.
    let mut found = lines.map(|it| it.unwrap().trim().split_once(' ').unwrap().1.to_owned());
    for due in 1..=3 {
        assert_eq!(found.next(), Some(due.to_string()));
    }
    drop(server);
    let mut counted = 4..;
    let lost = found.find(|it| *it != counted.next().unwrap().to_string());
    let lost = lost.unwrap();
    assert!(lost.starts_with("No connection"), "{lost}");
    let (status, sent) = run("send", &port, "--json READ?");
    assert_eq!((status, sent.len()), (1, 1));
    assert_eq!(sent[0]["failure"]["code"], "disconnected");

    let (_server, _) = scpipy(&port);
    // The new server has the registers of an instrument that was switched off and on.
    let again = found.find(|it| !it.starts_with("The link is down"));
    let again = again.unwrap();
    assert!(again.contains("switched off and on"), "{again}");
    for due in 1..=3 {
        assert_eq!(found.next(), Some(due.to_string()));
    }
}
