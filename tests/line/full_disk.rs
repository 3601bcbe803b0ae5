//! A history file that reaches its size limit while a lot runs.

use crate::history_taken::{all_landed, never_wait};
use crate::program::Workshop;
use crate::serve::Served;
use std::process::Command;

/// Largest file that the program may write, in blocks of the shell (512 or 1024 bytes): room for the reference parts
/// and a few dozen parts.
const BLOCKS: u32 = 2400;

#[test]
fn a_full_history_stops_feeding_and_loses_no_part() {
    let workshop = Workshop::new("full-disk");
    never_wait(&workshop);
    let lot = "run --sim --pace virtual --lot A --recipe jzc-22f-012 --count 400 --seed 1 --json";
    let said = workshop.run_with_little_room(BLOCKS, lot).with_status(3);
    assert!(said.stderr.contains("history: recording"), "{said}");
    let told = said.objects();
    assert_eq!(told.last().unwrap()["cause"]["code"], "history_lost");
    let landed = workshop.landed_parts_with_rows(&told);
    assert!((1..400).contains(&landed), "{said}");
    workshop.run("history check").with_status(0);
}

#[test]
fn freed_disk_room_lets_a_lot_continue() {
    let workshop = Workshop::new("room-again");
    let line = "serve --listen 127.0.0.1:0 --sim --speed 100";
    let served = Served::over(workshop.start_with_little_room(BLOCKS, line));
    served.until_state("Stopped");
    served.start_lot("A", 80);
    served.until_history_lost("recording");
    let id = served.process.id().to_string();
    let more = Command::new("prlimit")
        .args(["--pid", &id, "--fsize=unlimited"])
        .status();
    assert!(more.unwrap().success());
    served.resume();
    served.until_complete("A", 80);
    assert_eq!(served.interrupted(), 0);
    all_landed(&workshop, 80);
}
