//! `relayrig calibrate` stores and verifies factors; a rig with invalid factors refuses lots.

use crate::program::Workshop;

/// Marks the history of `workshop` and its calibration as those of a real rig.
fn as_if_of_a_rig(workshop: &Workshop, change: &str) {
    let history = rusqlite::Connection::open(workshop.folder.join("relayrig.db")).unwrap();
    let query = format!(
        "UPDATE calibration SET body = json_set(body, '$.simulated', json('false')){change}"
    );
    assert_eq!(history.execute(&query, []).unwrap(), 1);
    history
        .execute("UPDATE rig SET source = 'rig'", [])
        .unwrap();
}

const RUN_ON_A_RIG: &str = "run --lot A --recipe jzc-22f-012 --count 1";

#[test]
fn a_rig_that_has_not_changed_is_verified() {
    let workshop = Workshop::new("calibrate_verified");
    let made = workshop.run("calibrate --sim --json").with_status(0);
    let factors = made.objects();
    assert_eq!(factors.len(), 17, "{made}");
    assert!(
        factors[..16]
            .iter()
            .all(|it| it["expanded_u"].as_f64().unwrap() > 0.0)
    );
    assert_eq!(workshop.count("SELECT count(*) FROM calibration"), 1);
    let again = workshop
        .run("calibrate --sim --verify --json")
        .with_status(0);
    assert_eq!(again.objects().last().unwrap()["verified"], true, "{again}");
    assert_eq!(workshop.count("SELECT sum(verified) FROM calibration"), 1);
}

#[test]
fn a_drifted_source_fails_verification_and_refuses_lots() {
    let workshop = Workshop::new("calibrate_drifted");
    workshop.run("calibrate --sim").with_status(0);
    workshop.change(
        "config/sim.toml",
        "source_current_a = 1.0",
        "source_current_a = 1.05",
    );
    let failed = workshop
        .run("calibrate --sim --verify --json")
        .with_status(1);
    let contact = failed
        .objects()
        .into_iter()
        .find(|it| it["factor"] == "contact")
        .unwrap();
    assert_eq!(contact["holds"], false, "{failed}");
    as_if_of_a_rig(&workshop, "");
    let refused = workshop.run(RUN_ON_A_RIG).with_status(3);
    assert!(
        refused.stderr.contains("failed its last verification"),
        "{refused}"
    );
}

#[test]
fn an_overdue_calibration_refuses_lots_with_its_date() {
    let workshop = Workshop::new("calibrate_overdue");
    workshop.run("calibrate --sim").with_status(0);
    as_if_of_a_rig(&workshop, ", due_at_us = 1000000000000000");
    let refused = workshop.run(RUN_ON_A_RIG).with_status(3);
    assert!(
        refused.stderr.contains("ran out at 2001-09-09T01:46:40Z"),
        "{refused}"
    );
    assert!(refused.stderr.contains("relayrig calibrate"), "{refused}");
    let alarms = workshop.texts("SELECT code FROM alarm");
    assert_eq!(alarms, ["calibration_invalid"], "the history has the alarm");
    let causes = workshop.texts("SELECT coalesce(cause, 'none') FROM run_end ORDER BY rowid");
    assert_eq!(
        causes,
        ["none", "calibration_invalid"],
        "of calibration and lot"
    );
}

#[test]
fn nothing_to_verify_is_bad_input() {
    let workshop = Workshop::new("calibrate_nothing");
    let said = workshop.run("calibrate --sim --verify").with_status(2);
    assert!(said.stderr.contains("no calibration for 12 V"), "{said}");
}
