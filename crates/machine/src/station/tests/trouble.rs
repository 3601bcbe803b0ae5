//! Every alarm has a code, and its arguments are those of its texts.

#![allow(clippy::unwrap_used)]

use crate::dut::Reason;
use crate::dut::batch::BatchTrouble;
use crate::dut::promise::{Broken, Promise};
use crate::handling::Place;
use crate::handling::moves::Move;
use crate::handling::tests::wiring;
use crate::handling::trouble::Trouble;
use crate::handling::wear::Wearing;
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use crate::rig::supply::RangeMismatch;
use crate::station::catalogue::{AlarmCode, Reaction};
use crate::station::orders::JOGS;
use crate::station::trouble::Alarm;
use std::collections::BTreeSet;
use texts::{Lang, Message};
use units::Span;

fn every_alarm() -> Vec<Alarm> {
    let after = Span::ms(900);
    let of_a_move = |movement: Move| {
        [
            Alarm::not_reached(movement, after),
            Alarm::left_end(movement),
            Alarm::both_ends(movement),
            Alarm::retried(movement, after),
            Alarm::refused(movement, &odd("not_driven")),
        ]
    };
    let places = [Place::Pocket, Place::NEST, Place::Gripper];
    let of_a_place = |it| {
        [
            Alarm::part_found(it),
            Alarm::part_lost(it),
            Alarm::part_gone(it),
        ]
    };
    let of_a_bin = |bin| {
        [
            Alarm::beam(bin, 0),
            Alarm::beam(bin, 2),
            Alarm::beam_unread(bin),
            Alarm::bin_full(bin),
            Alarm::fall_unseen(bin),
        ]
    };
    let foreign = Message::new("transaction", "foreign_reply")
        .with("said", "odd")
        .with("line", "motion");
    let tried = Message::new("detail", "tried")
        .with_inner("transaction", &foreign)
        .with("used", 1)
        .with("tries", 3);
    let failure = Message::new("instrument", "disconnected").with("said", "closed");
    let query = Message::new("detail", "query_failed")
        .with("instrument", "smu_in")
        .with("program", "ramp")
        .with_inner("failure", &failure);
    let few = Message::new("fault", "too_few").with("measured", 2);
    let others = [
        Alarm::bus(&tried),
        Alarm::instrument("smu_in", &query),
        Alarm::instrument_not_safe("smu_in"),
        Alarm::history_lost("relayrig.db", "history_locked", "recording: locked"),
        Alarm::stale(DigitalIn::AirOk),
        Alarm::serial_reader_lost("gone"),
        Alarm::fleet_late("postgres://rig_07@db.plant/relayrig", 3600),
        Alarm::host_late(&tried, Span::ms(312)),
        Alarm::button_stuck(DigitalIn::ButtonStop),
        Alarm::part_sticks(),
        Alarm::scans_dropped(&[("S-1".into(), "li".into())]),
        Alarm::step_too_long("probing", after),
        Alarm::watchdog_tripped("mech_do_a"),
        Alarm::calibration(&Message::new("fault", "line").with_inner("detail", &odd("unread"))),
        Alarm::calibration_invalid(&odd("calibration_out").with("at", "now")),
        Trouble::SupplyRange(RangeMismatch {
            selected: "x3".into(),
            found: "x6".into(),
        })
        .into(),
        Alarm::reference_check_due("G-12-1"),
        Alarm::reference_check_failed(&few),
        Alarm::reference_repeated("G-12-1", &Reason::rig_trouble(odd("unread"))),
        Alarm::reject_rate_limit(3, 40, 5.0),
        Alarm::worn(Wearing::Probes, 8, 8),
        Alarm::worn(Wearing::Jaws, 8, 8),
        Alarm::probe_contact(3.2, 3.0),
        Alarm::promise_broken(&broken(Promise::AiNoise)),
        Alarm::promise_broken(&broken(Promise::OperationScatter)),
        Alarm::promise_broken(&broken(Promise::ClosureScatter)),
        Alarm::promise_broken(&broken(Promise::PartMinusTrack)),
        Alarm::calibration_cut_off("coil_ai"),
        Alarm::from(Trouble::CoolsSlowly(Span::ms(3_600_000))),
        Alarm::from(BatchTrouble::SocketsOpen("3, 7".into())),
        Alarm::from(BatchTrouble::LagUnexpected(96, 39)),
    ];
    let bins: Vec<Bin> = wiring().axis().bins().collect();
    let to_bins = bins.iter().map(|bin| Move::AxisTo(AxisStation::Bin(*bin)));
    let moved = JOGS.into_iter().chain(to_bins).flat_map(of_a_move);
    let known: Vec<Alarm> = moved
        .chain(places.into_iter().flat_map(of_a_place))
        .chain(bins.iter().copied().flat_map(of_a_bin))
        .chain(others)
        .collect();
    let codes: BTreeSet<AlarmCode> = known.iter().map(|it| it.code).collect();
    let bare = AlarmCode::all()
        .filter(|it| !codes.contains(it))
        .map(Alarm::from);
    bare.chain(known.iter().cloned()).collect()
}

fn odd(code: &'static str) -> Message {
    Message::detail(code, "odd")
}

fn broken(promise: Promise) -> Broken {
    Broken {
        promise,
        promised: 2.0,
        seen: 4.0,
        interval: (3.5, 4.6),
        freedom: 60.0,
        used: 4.1,
    }
}

#[test]
fn every_alarm_has_both_texts_with_its_arguments() {
    for alarm in every_alarm() {
        let message = alarm.code.message(alarm.args.clone());
        let [en, zh] = Lang::ALL.map(|lang| message.try_say(lang));
        assert!(en.is_some_and(|it| it.is_ascii()), "{alarm:?}");
        assert!(zh.is_some(), "{alarm:?}");
        let of_inner = [
            ("fault", "fault"),
            ("detail", "detail"),
            ("failure", "instrument"),
            ("missed", "detail"),
            ("reason", "reason"),
            ("transaction", "transaction"),
        ]
        .into_iter()
        .filter_map(|(name, family)| Some(format!("{family}-{}", alarm.args.get(name)?)));
        let mut wanted = BTreeSet::new();
        for id in of_inner.chain([message.id()]) {
            for lang in Lang::ALL {
                let of = |case| texts::arguments(lang, &id, case).unwrap_or_default();
                wanted.extend(of(None).into_iter().chain(of(alarm.args.get("case"))));
            }
        }
        // No text shows these: programs read them, and the last one selects a text.
        wanted.extend(["bin", "param", "case"]);
        let given: BTreeSet<&str> = alarm.args.names().collect();
        let unused: Vec<_> = given.difference(&wanted).collect();
        assert!(unused.is_empty(), "{alarm:?}: {unused:?}");
    }
}

#[test]
fn every_code_is_read_back_from_its_name() {
    let names: BTreeSet<String> = AlarmCode::all().map(AlarmCode::name).collect();
    assert_eq!(names.len(), AlarmCode::all().count());
    for code in AlarmCode::all() {
        assert_eq!(AlarmCode::from_name(&code.name()), Some(code));
    }
    assert_eq!(AlarmCode::from_name("of_tomorrow"), None);
}

#[test]
fn every_alarm_that_ends_a_test_names_the_interruption() {
    let ends = |it: &AlarmCode| matches!(it.entry().reaction, Reaction::Abort | Reaction::Hold);
    for code in AlarmCode::all().filter(ends) {
        let name = code.name();
        for lang in Lang::ALL {
            assert_ne!(lang.name("interruption", &name), name, "{lang:?}");
        }
    }
}

#[test]
fn a_missed_stroke_is_reported_with_its_sensors() {
    for movement in JOGS {
        let alarm = Alarm::from(Trouble::NotReached(movement, Span::ms(900)));
        let code = format!("{}_not_reached", movement.actuator_key());
        assert_eq!(alarm.code.name(), code);
        for (point, _) in movement.arrival() {
            let says = |lang: Lang| alarm.text(lang).contains(lang.name("signal", point.name()));
            assert!(Lang::ALL.into_iter().all(says), "{}", alarm.text(Lang::Zh));
        }
    }
}

#[test]
fn cause_consequence_and_action_have_both_languages() {
    for code in AlarmCode::all() {
        for (en, zh) in code.help(Lang::En).into_iter().zip(code.help(Lang::Zh)) {
            assert!(en.ends_with('.') && en.is_ascii(), "{code}: {en}");
            assert!(
                zh.ends_with('。') && zh.chars().any(is_chinese),
                "{code}: {zh}"
            );
        }
    }
}

fn is_chinese(c: char) -> bool {
    ('\u{4e00}'..='\u{9fff}').contains(&c)
}

#[test]
fn chinese_texts_have_chinese_names() {
    for alarm in every_alarm() {
        let names = ["place", "bin", "motion"];
        if names.iter().any(|it| alarm.args.get(it).is_some()) {
            let text = alarm.text(Lang::Zh);
            assert!(text.starts_with(is_chinese), "{text}");
        }
    }
    assert_eq!(
        Alarm::part_lost(Place::Gripper).text(Lang::Zh),
        "夹爪的工件已不在原位。请找到并报废。"
    );
}

#[test]
fn an_alarm_without_arguments_shows_its_cause() {
    let left = Alarm::from(AlarmCode::BinBeam);
    assert_eq!(left.text(Lang::Zh), left.code.help(Lang::Zh)[0]);
}
