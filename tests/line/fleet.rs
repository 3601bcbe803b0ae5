//! The page of all rigs: from a lot on a rig over PostgreSQL to the raw reply, and through the death of the server.

use crate::program::Workshop;
use crate::serve::address_of;
use fleet::trial::Trial;
use serde_json::Value;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Child;
use std::time::{Duration, Instant};

/// Longest wait for an answer of the database; far more than a busy computer needs.
const TIMEOUT: Duration = Duration::from_secs(120);

/// The page server; it ends when this value is dropped.
struct Page {
    process: Child,
    address: String,
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Page {
    fn start(workshop: &Workshop) -> Self {
        let mut process = workshop.start_logging("fleet serve --listen 127.0.0.1:0");
        let (address, _) = address_of(&mut process, "page of all rigs at http://");
        Self { process, address }
    }

    fn get(&self, path: &str) -> (u16, Value) {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        let host = &self.address;
        write!(
            stream,
            "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        // A list comes in chunks (HTTP chunked encoding), each after a line with its length.
        let body = match head.contains("chunked") {
            true => body.lines().skip(1).filter(|it| !is_length(it)).collect(),
            false => body.to_owned(),
        };
        (
            status,
            serde_json::from_str(&body).unwrap_or_else(|_| panic!("{answer}")),
        )
    }

    /// Waits for an overview that passes `test`.
    fn until(&self, what: &str, test: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let (_, overview) = self.get("/api/fleet");
            if test(&overview) {
                return overview;
            }
            assert!(began.elapsed() < TIMEOUT, "never {what}: {overview}");
            std::thread::yield_now();
        }
    }
}

fn is_length(line: &str) -> bool {
    !line.is_empty() && line.len() < 8 && line.bytes().all(|it| it.is_ascii_hexdigit())
}

/// Tests a lot of three parts on the simulated rig and sends it to the server.
fn filled(name: &str) -> (Trial, Workshop) {
    let (trial, workshop) = (Trial::start().unwrap(), Workshop::new(name));
    let target = trial.owner().url;
    let settings = format!(
        "site = \"suzhou\"\nrig = \"rig-07\"\n[[target]]\nurl = \"{target}\"\ntls = \"off\"\nsamples = \"all\"\n\
         [[shift]]\nname = \"day\"\nstart = \"00:00\"\nend = \"12:00\"\n\
         [[shift]]\nname = \"night\"\nstart = \"12:00\"\nend = \"00:00\"\n"
    );
    std::fs::write(workshop.folder.join("config/fleet.toml"), settings).unwrap();
    for line in [
        "fleet init",
        "run --sim --lot A --recipe jzc-22f-012 --count 3 --seed 1",
        "fleet push",
    ] {
        let said = workshop.run(line);
        assert_eq!(said.status, 0, "{line}: {}", said.stderr);
    }
    (trial, workshop)
}

#[test]
fn a_rig_is_followed_down_to_the_raw_reply() {
    let (_trial, workshop) = filled("fleet_page");
    let page = Page::start(&workshop);
    let seen = page.until("asked", |it| it["day"].is_object());
    let (now, day) = (&seen["now"]["rigs"][0], &seen["day"]["rigs"][0]);
    assert_eq!(
        (&now["site"], &now["rig"]),
        (&"suzhou".into(), &"rig-07".into())
    );
    assert_eq!(
        (&now["run"]["lot"], &now["parts_per_hour"]),
        (&"A".into(), &3.into()),
        "{seen}"
    );
    assert_eq!(day["counts"]["parts"], 3, "{seen}");
    let shifts = day["shifts"].as_array().unwrap();
    let parts: u64 = shifts.iter().filter_map(|it| it["parts"].as_u64()).sum();
    assert_eq!(parts, 3, "{seen}");
    let (_, parts) = page.get("/rigs/suzhou/rig-07/api/history/query?lot=A");
    let seq = &parts[2]["seq"];
    let (status, part) = page.get(&format!(
        "/rigs/suzhou/rig-07/api/history/show?lot=A&seq={seq}"
    ));
    assert_eq!(status, 200, "{part}");
    let raw = part[0]["measurements"].as_array().unwrap().iter();
    let raw = raw.flat_map(|it| it["samples"].as_array().unwrap());
    assert!(raw.clone().count() > 10, "{part}");
    assert!(raw.clone().all(|it| it["raw"].is_string()), "{part}");
    let (status, other) = page.get("/rigs/suzhou/rig-08/api/history/count");
    let reason = other["reason"].as_str().unwrap();
    assert!(
        status >= 400 && reason.contains("expected one of suzhou/rig-07"),
        "{other}"
    );
}

#[test]
fn a_page_outlives_its_database() {
    let (trial, workshop) = filled("fleet_page_lost");
    let page = Page::start(&workshop);
    page.until("asked", |it| it["now"].is_object());
    trial.kill().unwrap();
    let lost = page.until("lost", |it| it["trouble"].is_object());
    let text = lost["trouble"]["text"].as_str().unwrap();
    assert!(text.starts_with(&trial.owner().url), "{text}");
    assert!(text.contains(". ") && !text.contains("queue"), "{text}");
    assert_eq!(
        lost["now"]["rigs"][0]["rig"], "rig-07",
        "the last answer stays"
    );
    let (status, refused) = page.get("/rigs/suzhou/rig-07/api/history/count");
    let reason = refused["reason"].as_str().unwrap();
    assert_eq!(status, 503, "{refused}");
    assert!(
        reason.contains("Check address, network and server"),
        "{reason}"
    );
    trial.begin().unwrap();
    page.until("back", |it| it["trouble"].is_null());
}
