//! A history file that reaches its size limit while a lot runs.

use crate::program::Workshop;

/// Largest file that the program may write, in blocks of the shell (512 or 1024 bytes): room for the reference parts and a
/// few dozen parts.
const BLOCKS: u32 = 2400;

#[test]
fn a_full_history_stops_feeding_and_loses_no_part() {
    let workshop = Workshop::new("full-disk");
    let lot = "run --sim --pace virtual --lot A --recipe jzc-22f-012 --count 400 --seed 1 --json";
    let said = workshop.run_with_little_room(BLOCKS, lot).with_status(3);
    assert!(said.stderr.contains("history: recording"), "{said}");
    let told = said.objects();
    assert_eq!(told.last().unwrap()["cause"]["code"], "history_lost");
    let landed = workshop.landed_parts_with_rows(&told);
    assert!((1..400).contains(&landed), "{said}");
    workshop.run("history check").with_status(0);
}
