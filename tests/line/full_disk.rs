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
    let landed: Vec<_> = told
        .iter()
        .filter(|it| it["type"] == "part" && it["bin"] != "")
        .collect();
    assert!(!landed.is_empty() && landed.len() < 400, "{said}");
    for part in landed {
        let (seq, bin) = (&part["seq"], part["bin"].as_str().unwrap());
        let rows = format!(
            "SELECT count(*) FROM part WHERE kind = 'lot' AND seq = {seq} AND bin = '{bin}'"
        );
        assert_eq!(workshop.count(&rows), 1, "{part}");
    }
    workshop.run("history check").with_status(0);
}
