//! The catalogue knows every alarm, in both languages, once.

use crate::handling::moves::Move;
use crate::handling::tests::wiring;
use crate::handling::trouble::Trouble;
use crate::rig::axis::AxisStation;
use crate::rig::point::DigitalIn;
use crate::station::catalogue::{entry, every};
use crate::station::trouble::Alarm;
use units::Span;

const MOVES: [Move; 13] = [
    Move::EscapementRelease,
    Move::EscapementHold,
    Move::PusherExtend,
    Move::PusherRetract,
    Move::ClampClose,
    Move::ClampOpen,
    Move::ProbesUp,
    Move::ProbesDown,
    Move::AxisTo(AxisStation::Nest),
    Move::SortDown,
    Move::SortUp,
    Move::GripperClose,
    Move::GripperOpen,
];

fn every_alarm() -> Vec<Alarm> {
    let after = Span::ms(900);
    let of_a_move = |movement: Move| {
        [
            Alarm::not_reached(movement, after),
            Alarm::left_end(movement),
            Alarm::both_ends(movement),
            Alarm::retried(movement, after),
            Alarm::refused(movement, "jaw_left"),
        ]
    };
    let others = [
        Alarm::bus("silent"),
        Alarm::history(),
        Alarm::not_safe(),
        Alarm::no_part(),
        Alarm::magazine_empty(),
        Alarm::stale(DigitalIn::AirOk),
        Alarm::nest_empty(),
        Alarm::beam("pass", 0),
        Alarm::bin_full("pass"),
        Alarm::button_stuck(DigitalIn::ButtonStop),
        Alarm::part_found("nest"),
        Alarm::part_lost("nest"),
        Alarm::fall_unseen("coil"),
        Alarm::part_dropped(),
        Alarm::part_stuck(),
        Alarm::axis_drive(),
        Alarm::step_too_long("probing", after),
        Alarm::watchdog_tripped("mech_do_a"),
        Alarm::calibration("odd"),
        Alarm::calibration_overdue(),
        Alarm::golden_check_due("G-12-1"),
        Alarm::golden_check_failed("odd"),
        Alarm::golden_repeated("G-12-1", "odd"),
        Alarm::discard_limit(3, 40, 5.0),
        Alarm::worn("probes", 8, 8),
        Alarm::probe_contact(3.2, 3.0),
        Alarm::calibration_cut_off("coil_ai"),
        Alarm::safety("emergency_stop", "", ""),
        Alarm::safety("door_open", "", ""),
        Alarm::safety("air_lost", "", ""),
    ];
    MOVES
        .into_iter()
        .flat_map(of_a_move)
        .chain(others)
        .collect()
}

#[test]
fn every_alarm_that_the_station_can_raise_is_in_the_catalogue() {
    for alarm in every_alarm() {
        assert!(entry(&alarm.code).is_some(), "{}", alarm.code);
    }
    for entry in every() {
        let raised = every_alarm();
        let used = raised.iter().any(|alarm| {
            crate::station::catalogue::entry(&alarm.code).map(|one| one.code) == Some(entry.code)
        });
        assert!(used, "nothing raises {}", entry.code);
    }
}

#[test]
fn a_stroke_that_does_not_arrive_is_told_with_its_sensors() {
    for movement in MOVES {
        let alarm = Alarm::from(Trouble::NotReached(movement, Span::ms(900)));
        let code = format!("{}_not_reached", movement.actuator_key());
        assert_eq!(alarm.code, code);
        for (point, _) in movement.arrival() {
            assert!(alarm.text_en.contains(point.name()), "{}", alarm.text_en);
            assert!(alarm.text_zh.contains(point.name()), "{}", alarm.text_zh);
        }
    }
}

#[test]
fn cause_consequence_and_action_are_told_in_both_languages() {
    let chinese = |text: &str| text.chars().any(|c| ('\u{4e00}'..='\u{9fff}').contains(&c));
    for entry in every() {
        for (en, zh) in [entry.cause, entry.consequence, entry.action] {
            assert!(en.ends_with('.') && en.is_ascii(), "{}: {en}", entry.code);
            assert!(zh.ends_with('。') && chinese(zh), "{}: {zh}", entry.code);
        }
    }
}

#[test]
fn what_a_chinese_text_is_about_is_named_in_chinese() {
    let begins_chinese = |text: &str| text.starts_with(|c| ('\u{4e00}'..='\u{9fff}').contains(&c));
    let places = ["pocket", "nest", "gripper"]
        .map(|place| [Alarm::part_found(place), Alarm::part_lost(place)]);
    let axis = &wiring().axis;
    let bins = axis
        .bins()
        .map(|bin| [Alarm::beam(bin.name(), 2), Alarm::bin_full(bin.name())]);
    let after = Span::ms(900);
    let to_bins = axis.bins().map(|bin| Move::AxisTo(AxisStation::Bin(bin)));
    let moves = MOVES.into_iter().chain(to_bins);
    let moved = moves.map(|it| {
        [
            Alarm::not_reached(it, after),
            Alarm::retried(it, after),
            Alarm::refused(it, ""),
        ]
    });
    let ended = MOVES.map(|it| [Alarm::left_end(it), Alarm::both_ends(it)]);
    let gone = [Alarm::part_gone("nest"), Alarm::fall_unseen("coil")];
    let of_two = places
        .into_iter()
        .chain(bins)
        .chain(ended)
        .chain([gone])
        .flatten();
    for alarm in of_two.chain(moved.flatten()) {
        assert!(
            begins_chinese(&alarm.text_zh),
            "{}: {}",
            alarm.code,
            alarm.text_zh
        );
    }
    assert_eq!(
        Alarm::part_lost("gripper").text_zh,
        "夹爪的工件已不在原位。请找到并报废。"
    );
}
