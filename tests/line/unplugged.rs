//! A USB converter is unplugged while a lot runs, over real pseudo-terminals.

use crate::killed::Rig;
use crate::program::{ATTEMPTS, Workshop};

#[test]
fn a_vanished_port_ends_the_lot_naming_the_line() {
    let workshop = Workshop::new("unplugged-in-real-time");
    // However late the controller starts on this machine, the port is gone while the controller works, or before.
    let _rig = Rig::start(&workshop, "--fault port_lost=motion@3..600");
    let lines = "--line measure=ports/measure --line motion=ports/motion";
    let run = format!("run --lot A --recipe jzc-22f-012 --json {lines}");
    let names_the_line =
        |alarm: &String| alarm.starts_with("bus_trouble") && alarm.contains("motion");
    let (mut first_alarm, mut known) = (String::new(), 0);
    for _ in 0..ATTEMPTS {
        let said = workshop.run(&run).with_status(3);
        let last = said.objects().pop().unwrap();
        assert_eq!(last["type"], "summary", "{last}");
        let alarms = workshop.texts("SELECT code || ' ' || text FROM alarm ORDER BY id");
        first_alarm.clone_from(&alarms[known]);
        known = alarms.len();
        // On a busy computer a line may fail before the port is gone.
        if names_the_line(&first_alarm) || !said.ended_late() {
            break;
        }
    }
    assert!(names_the_line(&first_alarm), "{first_alarm}");
    assert_eq!(
        workshop.count("SELECT count(*) FROM run WHERE closed_at_us IS NULL"),
        0
    );
}
