//! `serve`: lots are started, refused and continued at the page while one program keeps the rig.

use crate::killed::Rig;
use crate::program::Workshop;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

const RECIPE: &str = "jzc-22f-012";
/// Longest wait for a state; far more than a busy computer needs.
const VIEW_TIMEOUT: Duration = Duration::from_secs(120);

/// The program with its page, and a session of an engineer.
pub struct Served {
    pub process: Child,
    address: String,
    token: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Returns what lies between a text and a character.
fn between(text: &str, before: &str, end: char) -> Option<String> {
    let (_, rest) = text.split_once(before)?;
    Some(rest.split(end).next()?.to_owned())
}

/// Reads the piped log of a program up to the address that comes after `before`; returns both.
pub fn address_of(process: &mut Child, before: &str) -> (String, String) {
    let mut told = BufReader::new(process.stderr.take().unwrap());
    let mut text = String::new();
    let address = loop {
        assert!(told.read_line(&mut text).unwrap() > 0, "{text}");
        if let Some(address) = between(&text, before, '/') {
            break address;
        }
    };
    std::thread::spawn(move || std::io::copy(&mut told, &mut std::io::sink()));
    (address, text)
}

impl Served {
    pub fn start(workshop: &Workshop, words: &str) -> Self {
        let line = format!("serve --listen 127.0.0.1:0 {words}");
        Self::over(workshop.start_logging(&line))
    }

    /// Logs in at the page of a program whose log is piped.
    pub fn over(mut process: Child) -> Self {
        let (address, text) = address_of(&mut process, "page at http://");
        let code = between(&text, "set-up code ", ',').unwrap();
        let mut served = Self {
            process,
            address,
            token: String::new(),
        };
        let engineer = json!({"code": code, "user": "engineer", "password": "of these tests"});
        let (status, session) = served.post("/api/setup", &engineer);
        assert_eq!(status, 200, "{session}");
        served.token = session["token"].as_str().unwrap().to_owned();
        served
    }

    fn ask(&self, head: &str, body: &str) -> (u16, Value) {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        let length = body.len();
        write!(
            stream,
            "{head} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nContent-Type: application/json\r\n\
             Authorization: Bearer {}\r\nContent-Length: {length}\r\n\r\n{body}",
            self.address, self.token
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        (status, serde_json::from_str(body).unwrap())
    }

    pub fn get(&self, path: &str) -> Value {
        let (status, body) = self.ask(&format!("GET {path}"), "");
        assert_eq!(status, 200, "{body}");
        body
    }

    pub fn post(&self, path: &str, body: &Value) -> (u16, Value) {
        self.ask(&format!("POST {path}"), &body.to_string())
    }

    /// Gives an order and checks that it is accepted.
    pub fn order(&self, order: &Value) {
        let (status, body) = self.post("/api/orders", order);
        assert_eq!(status, 200, "{order}: {body}");
    }

    /// Gives an order and returns the reason of its refusal.
    pub fn refused(&self, order: &Value) -> String {
        let (status, body) = self.post("/api/orders", order);
        assert_eq!(status, 409, "{order}: {body}");
        assert!(body["reason_zh"].is_string(), "{body}");
        body["reason"].as_str().unwrap().to_owned()
    }

    pub fn start_lot(&self, lot: &str, count: u64) {
        self.order(&json!({"order": "start", "lot": lot, "recipe": RECIPE, "count": count}));
    }

    /// Waits for a view that passes `test`.
    pub fn until(&self, what: &str, test: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let view = self.get("/api/view");
            if test(&view) {
                return view;
            }
            assert!(began.elapsed() < VIEW_TIMEOUT, "never {what}: {view}");
            std::thread::yield_now();
        }
    }

    pub fn until_state(&self, state: &str) -> Value {
        self.until(state, |view| view["machine"]["state"] == state)
    }

    /// Waits for the end of the lot and checks the number of judged parts.
    pub fn until_complete(&self, lot: &str, parts: u64) {
        let over = |view: &Value| view["lot"] == lot && view["under_way"] == false;
        let view = self.until("over", over);
        assert_eq!(view["judged"], parts, "{view}");
        let landed = view["bins"].as_object().unwrap().values();
        let landed: u64 = landed.filter_map(Value::as_u64).sum();
        assert_eq!(landed, parts, "{view}");
    }

    /// Waits until the history cannot be written: the alarm names `reason`, and a clear is refused with the next step.
    pub fn until_history_lost(&self, reason: &str) {
        let lost = |view: &Value| {
            let alarms = view["alarms"].as_array().unwrap();
            view["machine"]["state"] == "Aborted"
                && alarms.iter().any(|it| it["code"] == "history_lost")
        };
        let view = self.until("lost", lost);
        let text = view["alarms"][0]["text_en"].as_str().unwrap();
        assert!(
            text.contains("relayrig.db") && text.contains(reason),
            "{text}"
        );
        let why = self.refused(&json!({"order": "clear"}));
        assert!(why.contains("history file writable"), "{why}");
    }

    /// Clears, resets and starts once the history is written again.
    pub fn resume(&self) {
        self.until("written again", |view| {
            view["alarms"]
                .as_array()
                .unwrap()
                .iter()
                .all(|it| it["code"] != "history_lost" || it["state"] == "returned")
        });
        for (word, state) in [
            ("clear", "Stopped"),
            ("reset", "Idle"),
            ("start", "Execute"),
        ] {
            self.order(&json!({"order": word}));
            self.until_state(state);
        }
    }

    /// Sends Ctrl-C and returns the exit status.
    pub fn interrupted(mut self) -> i32 {
        let id = self.process.id().to_string();
        Command::new("kill").args(["-INT", &id]).status().unwrap();
        self.process.wait().unwrap().code().unwrap()
    }
}

#[test]
fn the_page_starts_one_lot_after_another() {
    let workshop = Workshop::new("serve-lots");
    let served = Served::start(&workshop, "--sim --speed 100");
    let view = served.until_state("Stopped");
    assert_eq!(
        (&view["under_way"], &view["simulated"]),
        (&json!(false), &json!(true))
    );
    let why = served.refused(&json!({"order": "start"}));
    assert!(why.contains("reset first"), "{why}");
    served.order(&json!({"order": "reset"}));
    served.until_state("Idle");
    let why = served.refused(&json!({"order": "start"}));
    assert!(why.contains("choose a lot on the page Lots first"), "{why}");

    served.start_lot("A", 2);
    served.until("under way", |view| {
        view["lot"] == "A" && view["under_way"] == true
    });
    served.until_state("Execute");
    let why = served.refused(&json!({"order": "start", "lot": "B", "recipe": RECIPE}));
    assert!(why.contains("stop first"), "{why}");
    served.until_complete("A", 2);
    served.until_state("Complete");
    served.start_lot("B", 1);
    served.until_complete("B", 1);
    assert_eq!(served.interrupted(), 0, "no lot was stopped");

    let states =
        "SELECT name || ' ' || state FROM lot JOIN lot_state ON lot_id = lot.id ORDER BY name";
    assert_eq!(workshop.texts(states), ["A complete", "B complete"]);
    let bodies = "SELECT count(*) FROM part WHERE kind = 'lot' AND landed_bin IS NOT NULL";
    assert_eq!(workshop.count(bodies), 3);
    let orders = workshop.run("history orders --json").with_status(0);
    let orders = orders.objects();
    let starts = |refused: bool| {
        let starts = orders.iter().filter(|it| it["what"]["order"] == "start");
        starts
            .filter(|it| it["refused"].is_null() != refused)
            .count()
    };
    assert_eq!((starts(false), starts(true)), (2, 3), "{orders:?}");
    assert!(orders.iter().all(|it| it["who"] == "engineer"));
}

#[test]
fn a_refused_start_names_the_gate_and_lots_continue() {
    let workshop = Workshop::new("serve-gates");
    let served = Served::start(&workshop, "--sim --speed 100");
    served.until_state("Stopped");
    let start = |lot: &str, recipe: &str| json!({"order": "start", "lot": lot, "recipe": recipe, "count": 40});
    let why = served.refused(&start("A", "jzc-99"));
    assert!(why.contains("jzc-99") && why.contains(RECIPE), "{why}");
    let why = served.refused(&json!({"order": "start", "lot": "A"}));
    assert!(why.contains("the recipe of the new lot A"), "{why}");
    let why = served.refused(&json!({"order": "start", "lot": "", "recipe": RECIPE}));
    assert!(why.contains("1 to 200"), "{why}");
    let why = served.refused(
        &json!({"order": "start", "lot": "A", "recipe": RECIPE, "count": 1, "retest": "Li Na"}),
    );
    assert!(why.contains("tested again"), "{why}");
    let why = served.refused(&json!({"order": "hold_lot", "lot": "A", "reason": "label"}));
    assert!(why.contains("there is no lot"), "{why}");

    served.order(&start("A", RECIPE));
    served.until("judged", |view| view["judged"].as_u64() >= Some(1));
    served.order(&json!({"order": "stop"}));
    served.until_state("Stopped");
    let why = served.refused(&json!({"order": "hold_lot", "lot": "A", "reason": " "}));
    assert!(why.contains("expected why"), "{why}");
    served.order(&json!({"order": "hold_lot", "lot": "A", "reason": "wrong label"}));
    served.until("left", |view| view["under_way"] == false);
    let held = |served: &Served| served.refused(&start("A", RECIPE));
    let why = held(&served);
    assert!(why.contains("held: wrong label (engineer)"), "{why}");
    served.order(&json!({"order": "release_lot", "lot": "A"}));
    let why = served.refused(&start("A", "jzc-22f-009"));
    assert!(why.contains("cannot change to another"), "{why}");

    served.order(&json!({"order": "start", "lot": "A", "count": 40}));
    served.until("goes on", |view| view["under_way"] == true);
    served.until("judged", |view| view["judged"].as_u64() >= Some(1));
    assert_eq!(served.interrupted(), 4, "a lot was stopped");
    assert_eq!(workshop.count("SELECT count(*) FROM run"), 2);
    let open = "SELECT state FROM lot_state";
    assert_eq!(workshop.texts(open), ["open"]);
}

#[test]
fn after_an_alarm_the_lot_continues_and_closes() {
    let workshop = Workshop::new("serve-alarm");
    let served = Served::start(&workshop, "--sim --speed 100 --fault fall=2");
    served.until_state("Stopped");
    served.start_lot("A", 500);
    let view = served.until_state("Aborted");
    assert_eq!(view["alarms"][0]["code"], "part_dropped", "{view}");
    let other = json!({"order": "start", "lot": "B", "recipe": RECIPE, "count": 1});
    let why = served.refused(&other);
    assert!(why.contains("clear the alarm first"), "{why}");
    served.order(&json!({"order": "clear"}));
    served.until_state("Stopped");
    served.order(&json!({"order": "reset"}));
    served.until_state("Idle");
    served.order(&json!({"order": "start"}));
    served.until("goes on", |view| view["judged"].as_u64() >= Some(3));
    served.order(&json!({"order": "close_lot", "lot": "A"}));
    served.until("over", |view| view["under_way"] == false);
    served.order(&other);
    served.until_complete("B", 1);
    assert_eq!(served.interrupted(), 0);
    let states =
        "SELECT name || ' ' || state FROM lot JOIN lot_state ON lot_id = lot.id ORDER BY name";
    assert_eq!(workshop.texts(states), ["A complete", "B complete"]);
}

#[test]
fn a_line_missing_at_start_is_named_and_awaited() {
    let workshop = Workshop::new("serve-unplugged");
    let served = Served::start(
        &workshop,
        "--line measure=ports/measure --line motion=ports/motion",
    );
    let view = served.until_state("Aborted");
    let text = view["alarms"][0]["text_en"].as_str().unwrap();
    assert!(
        text.contains("line m") && text.contains("ports/m"),
        "{text}"
    );
    let _rig = Rig::start(&workshop, "");
    let began = Instant::now();
    while served.get("/api/view")["machine"]["state"] != "Stopped" {
        assert!(began.elapsed() < VIEW_TIMEOUT, "it never came back");
        // On a machine that is busy a module may be late once more.
        let _ = served.post("/api/orders", &json!({"order": "clear"}));
    }
    assert_eq!(served.interrupted(), 0);
}

#[test]
fn an_unwired_line_is_refused_before_any_file_exists() {
    let workshop = Workshop::new("serve_unwired");
    let said = workshop
        .run("--db day.db serve --listen 127.0.0.1:0 --line nope=/dev/null")
        .with_status(2);
    assert!(said.stderr.contains("nope"), "{said}");
    assert!(!workshop.has("day.db") && !workshop.has("day-access.db"));
}
