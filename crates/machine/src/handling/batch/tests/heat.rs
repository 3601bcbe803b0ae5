//! Tests of heat, lock and cooling when readings, writes or the lock fail.

use super::Scenario;
use crate::dut::batch::{BatchTrouble, HeatTrouble};
use crate::handling::batch::Phase;
use crate::handling::trouble::Trouble;

/// Returns a scenario whose outputs are made safe in the test, once the rack is hot.
fn cut_off() -> Scenario {
    cut_off_above(60.0)
}

/// Returns a scenario whose outputs are made safe in the test, once the rack is warmer than this, C.
fn cut_off_above(rack_c: f64) -> Scenario {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.until("warm", |it| it.rig.rack_c > rack_c);
    for part in it.rig.ledger.held_mut() {
        part.interrupt("emergency_stop");
        part.bin = Some(crate::rig::bin::Bin::RETEST);
    }
    it.recorded = 3;
    it.rig.everything_off();
    it.batch.cut_off(it.rig.now);
    it
}

#[test]
fn cooling_acts_survive_a_failed_write() {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.until("judged", |it| it.parts.judged.len() == 3);
    it.rig.failing_sets = 2;
    it.run(5_000);
    assert_eq!(it.rig.failing_sets, 0);
    assert!(it.rig.is_on(it.rig.fan()), "the fan was never switched on");
    it.until_unlocked();
    it.rig.failing_sets = 1;
    it.run(5_000);
    assert!(
        !it.rig.is_on(it.rig.fan()),
        "the fan was never switched off"
    );
}

#[test]
fn a_rack_cut_off_hot_needs_a_closed_door() {
    let mut it = cut_off();
    assert!(it.batch.needs_closed_door(), "safe outputs");
    it.batch.cut_off(it.rig.now);
    assert!(it.batch.needs_closed_door(), "safe outputs again");
    it.batch.begin_home(it.rig.now, &it.rig.device);
    it.homing = true;
    it.run(1_000);
    assert!(it.batch.needs_closed_door(), "homing");
    it.until_unlocked();
    assert!(!it.batch.needs_closed_door(), "cool");
}

#[test]
fn a_cool_rack_cut_off_may_stay_open() {
    let mut it = Scenario::ready();
    it.rig.open().unwrap();
    it.run(1_000);
    it.rig.everything_off();
    it.batch.cut_off(it.rig.now);
    assert!(!it.batch.needs_closed_door());
}

#[test]
fn an_unread_rack_counts_as_hot() {
    let mut it = Scenario::new();
    it.rig.is_thermometer_broken = true;
    assert!(!it.batch.needs_closed_door(), "a reading is awaited");
    it.run(6_000);
    assert!(it.batch.needs_closed_door());
    it.rig.is_thermometer_broken = false;
    it.run(2_000);
    assert!(!it.batch.needs_closed_door());
}

#[test]
fn an_unlocked_hot_rack_is_trouble() {
    let mut it = cut_off();
    it.batch.begin_home(it.rig.now, &it.rig.device);
    it.homing = true;
    it.rig.lock_works = false;
    it.run(10_000);
    assert!(it.rig.rack_c > 50.0);
    assert!(it.trouble.contains(&Trouble::DoorNotLocked));
}

#[test]
fn a_broken_thermometer_is_trouble_while_loading() {
    let mut it = Scenario::ready();
    it.rig.is_thermometer_broken = true;
    it.run(10_000);
    assert!(!it.rig.is_unlocked() && it.trouble.is_empty());
    it.run(20_000);
    assert!(matches!(it.batch.phase(), Phase::Loading(_)));
    assert!(it.trouble.contains(&Trouble::RackUnread));
}

#[test]
fn a_pause_is_no_broken_thermometer() {
    let mut it = Scenario::ready();
    it.rig.pass(units::Span::ms(600_000));
    it.run(2_000);
    assert_eq!(it.trouble, []);
}

#[test]
fn a_rack_thermometer_that_stands_still_unlocks_nothing() {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.until_testing();
    it.rig.stuck_c = Some(25.0);
    it.until("judged", |it| it.parts.judged.len() == 3);
    it.until("cool air", |it| it.rig.rack_c < 50.0);
    for _ in 0..3_500 {
        it.run(1_000);
        assert!(!it.rig.is_unlocked() && it.batch.needs_closed_door());
    }
    assert!(it.trouble.contains(&Trouble::RackStuck));
    it.until_unlocked();
}

#[test]
fn a_stop_early_in_the_heat_locks_no_cool_rack() {
    let mut it = cut_off_above(32.0);
    it.rig.pass(units::Span::ms(600_000));
    it.batch.begin_home(it.rig.now, &it.rig.device);
    it.homing = true;
    it.run(20_000);
    assert!(it.rig.is_unlocked() && it.trouble.is_empty());
}

#[test]
fn a_thermometer_that_moves_again_unlocks_the_door() {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.rig.stuck_c = Some(45.0);
    it.until("judged", |it| it.parts.judged.len() == 3);
    it.until("cooler air", |it| it.rig.rack_c < 60.0);
    it.rig.stuck_c = None;
    it.until_unlocked();
    assert!(it.rig.rack_c > 45.0 && it.trouble.is_empty());
}

#[test]
fn a_hot_heater_keeps_fan_on_and_door_locked() {
    let mut it = Scenario::ready();
    it.rig.surface_c = Some(70.0);
    it.load(&[1, 2, 3]);
    it.until("judged", |it| it.parts.judged.len() == 3);
    it.until("cool rack", |it| it.rig.rack_c < 45.0);
    it.run(20_000);
    assert!(!it.rig.is_unlocked() && it.rig.is_on(it.rig.fan()));
    it.rig.surface_c = None;
    it.until_unlocked();
}

#[test]
fn a_test_reports_its_trouble_and_the_rack_cools() {
    let mut it = Scenario::ready();
    it.rig
        .meets(BatchTrouble::Heat(HeatTrouble::LimiterTripped));
    it.load(&[1, 2, 3]);
    it.until("judged", |it| it.parts.judged.len() == 3);
    assert_eq!(
        it.trouble,
        [Trouble::Batch(BatchTrouble::Heat(
            HeatTrouble::LimiterTripped
        ))]
    );
    it.until_unlocked();
}
