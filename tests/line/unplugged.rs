//! A USB converter is unplugged while a lot runs, over real pseudo-terminals.

use crate::killed::Rig;
use crate::program::Workshop;

#[test]
fn a_vanished_port_ends_the_lot_naming_the_line() {
    let workshop = Workshop::new("unplugged-in-real-time");
    // However late the controller starts on this machine, the port is gone while it works, or before.
    let _rig = Rig::start(&workshop, "--fault port_lost=motion@3..600");
    let said = workshop
        .run("run --lot A --recipe jzc-22f-012 --json --line measure=ports/measure --line motion=ports/motion")
        .with_status(3);
    let last = said.objects().pop().unwrap();
    assert_eq!(last["type"], "summary", "{last}");
    let alarms = workshop.texts("SELECT code || ' ' || text FROM alarm ORDER BY id");
    assert!(
        alarms[0].starts_with("bus_trouble") && alarms[0].contains("motion"),
        "{alarms:?}"
    );
    assert_eq!(
        workshop.count("SELECT count(*) FROM run WHERE closed_at_us IS NULL"),
        0
    );
}
