//! Tests: states of lots, retests, orders, state changes of alarms, wear.

use super::*;
use machine::station::trouble::Alarm;
use texts::{Lang, Message};

#[test]
fn a_lot_has_its_last_state_and_begins_open() {
    let file = File::new();
    let mut store = file.store();
    assert_eq!(store.begin_lot(&lot("A")).unwrap(), 1);
    let standing = || file.archive().standing("A").unwrap().unwrap();
    assert_eq!(standing().state, LotState::Open);
    assert_eq!(standing().recipe, "jzc-22f-012");
    for state in [
        LotState::Running,
        LotState::Held,
        LotState::Open,
        LotState::Complete,
    ] {
        let record = LotStateRecord {
            lot: "A".into(),
            state,
            why: (state == LotState::Held).then(|| HoldReason::Person("wrong label".into())),
            at_us: 9,
        };
        store.record(&[Row::LotState(record)]).unwrap();
        assert_eq!(standing().state, state);
        assert_eq!(standing().why.is_some(), state == LotState::Held);
    }
    assert_eq!(file.archive().standing("B").unwrap(), None);
}

#[test]
fn a_hold_is_chinese_only_by_its_alarm() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let alarm = Alarm::reject_rate_limit(3, 20, 10.0);
    let text = alarm.text(Lang::En);
    let same_words = HoldReason::Person(text.clone());
    let chinese = Some(alarm.text(Lang::Zh));
    for (why, why_zh) in [(HoldReason::Alarm(alarm), chinese), (same_words, None)] {
        let record = LotStateRecord {
            lot: "A".into(),
            state: LotState::Held,
            why: Some(why),
            at_us: 9,
        };
        store.record(&[Row::LotState(record)]).unwrap();
        let standing = file.archive().standing("A").unwrap().unwrap();
        assert_eq!(
            (standing.why.as_ref(), standing.why_zh),
            (Some(&text), why_zh)
        );
    }
}

#[test]
fn the_next_program_opens_a_lot_cut_off() {
    let file = File::new();
    let mut store = file.store();
    let put = |store: &mut Store, name: &str, state| {
        store.begin_lot(&lot(name)).unwrap();
        let record = LotStateRecord {
            lot: name.into(),
            state,
            why: None,
            at_us: 9,
        };
        store.record(&[Row::LotState(record)]).unwrap();
    };
    put(&mut store, "cut off", LotState::Running);
    put(&mut store, "held", LotState::Held);
    store.cut_off(false, 10).unwrap();
    assert_eq!(
        file.archive().standing("cut off").unwrap().unwrap().state,
        LotState::Running
    );
    store.cut_off(true, 20).unwrap();
    let standing = |name: &str| file.archive().standing(name).unwrap().unwrap();
    let cut_off = standing("cut off");
    assert_eq!((cut_off.state, cut_off.since), (LotState::Open, Moment(20)));
    assert_eq!(standing("held").state, LotState::Held);
}

#[test]
fn a_complete_lot_is_open_only_after_a_reopening() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let put = |store: &mut Store, state| {
        let record = LotStateRecord {
            lot: "A".into(),
            state,
            why: None,
            at_us: 9,
        };
        store.record(&[Row::LotState(record)]).unwrap();
    };
    let state = || file.archive().standing("A").unwrap().unwrap().state;
    put(&mut store, LotState::Complete);
    for before in [LotState::Held, LotState::Running] {
        put(&mut store, before);
        assert_eq!(state(), before);
        put(&mut store, LotState::Open);
        assert_eq!(state(), LotState::Complete, "after {before:?}");
    }
    put(&mut store, LotState::Running);
    store.cut_off(true, 20).unwrap();
    assert_eq!(state(), LotState::Complete, "a retest that was cut off");
    let reopened = ReopeningRecord {
        lot: "A".into(),
        at_us: 30,
        who: "zhao".into(),
        why: "late parts".into(),
    };
    store.record(&[Row::Reopened(reopened)]).unwrap();
    assert_eq!(state(), LotState::Open);
    let [decision] = &file.archive().reopenings("A").unwrap()[..] else {
        panic!("one decision")
    };
    assert_eq!((decision.at, decision.who.as_str()), (Moment(30), "zhao"));
    put(&mut store, LotState::Running);
    put(&mut store, LotState::Open);
    assert_eq!(state(), LotState::Open);
}

#[test]
fn an_import_keeps_the_recipe_of_a_lot() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let imported = LotRecord {
        recipe: "imported".into(),
        recipe_hash: "other".into(),
        ..lot("A")
    };
    store.import(&imported, Vec::new()).unwrap();
    let standing = file.archive().standing("A").unwrap().unwrap();
    assert_eq!(standing.recipe, "jzc-22f-012");
}

#[test]
fn the_first_run_decides_the_rig_of_a_file() {
    for simulated in [false, true] {
        let file = File::new();
        assert!(check_rig(&file.path, simulated).is_ok(), "no file");
        let mut store = file.store();
        store.import(&lot("old"), Vec::new()).unwrap();
        assert!(check_rig(&file.path, simulated).is_ok(), "an import");
        let of = |simulated| LotRecord {
            simulated,
            ..lot("A")
        };
        store.begin_lot(&of(simulated)).unwrap();
        assert!(store.claim(simulated).is_ok() && check_rig(&file.path, simulated).is_ok());
        store.close_lot("A", 2_000_000).unwrap();
        let refused = [
            store.begin_lot(&of(!simulated)).map(drop),
            store.claim(!simulated),
            check_rig(&file.path, !simulated),
        ];
        for error in refused.map(Result::unwrap_err) {
            let text = error.to_string();
            let holds = ["a real rig", "the simulated rig"][usize::from(simulated)];
            assert!(text.contains(&format!("history.db is the history of {holds}")));
            assert!(text.contains("--db"), "{text}");
        }
        assert_eq!(count(&file.by_hand(), "run"), 2);
    }
}

#[test]
fn a_retest_raises_only_the_final_yield() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let rows = [part("A", 1, "pass", 7.0), part("A", 2, "fail", 9.5)].map(Row::Part);
    store.record(&rows).unwrap();
    store.close_lot("A", 10).unwrap();
    let again = LotRecord {
        retest: Some("Li Na".into()),
        ..lot("A")
    };
    assert_eq!(store.begin_lot(&again).unwrap(), 2);
    store
        .record(&[Row::Part(part("A", 1, "pass", 8.9))])
        .unwrap();
    let archive = file.archive();
    let expected = LotYield {
        parts: 2,
        first_pass: 1,
        retest_pass: 1,
        suspect: 0,
    };
    assert_eq!(archive.lot_yield(&Filter::default()).unwrap(), expected);
    assert_eq!(archive.lot_book(9, 0).unwrap()[0].counts, expected);
    let consents: Vec<_> = archive.lots(&Filter::default()).unwrap();
    assert_eq!(consents[1].retest.as_deref(), Some("Li Na"));
    assert_eq!(consents[0].retest, None);
}

#[test]
fn a_run_keeps_its_calibration() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let of = |lot: &str| {
        Row::Calibrated(CalibratedRecord {
            lot: lot.into(),
            calibration: CalibrationRecord {
                hash: "0123".into(),
                body: "{}".into(),
                ..CalibrationRecord::default()
            },
        })
    };
    store.record(&[of("A")]).unwrap();
    let lots = file.archive().lots(&Filter::default()).unwrap();
    assert_eq!(lots[0].calibration_hash.as_deref(), Some("0123"));
    assert!(store.record(&[of("B")]).is_err());
    assert_eq!(count(&file.by_hand(), "calibration"), 1);
}

#[test]
fn an_order_keeps_person_origin_content_and_refusal() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let order = |at_us, who: &str, refused: Option<Message>| {
        Row::Order(OrderRecord {
            lot: (at_us > 1).then(|| "A".into()),
            at_us,
            who: who.into(),
            role: "operator".into(),
            origin: "127.0.0.1".into(),
            what: r#"{"order":"start"}"#.into(),
            refused,
        })
    };
    let rows = [
        order(1, "", Some(Message::new("refusal", "not_logged_in"))),
        order(2, "li'na", None),
        order(3, "li'na", None),
    ];
    store.record(&rows).unwrap();
    let archive = file.archive();
    let all = archive
        .orders(&Filter::default(), &OrderChoice::default())
        .unwrap();
    assert_eq!(all.len(), 3);
    assert_eq!(
        (all[0].run, all[0].refused.as_deref()),
        (None, Some("log in first"))
    );
    assert_eq!(all[0].refused_zh.as_deref(), Some("请先登录"));
    assert_eq!((all[1].lot.as_deref(), all[1].at), (Some("A"), Moment(2)));
    assert_eq!(all[1].what["order"], "start");
    let late = Filter {
        since: Some(Moment(3)),
        lot: Some("A".into()),
        ..Filter::default()
    };
    let found = |who: Option<&str>, order: Option<&str>| {
        let choice = OrderChoice {
            who: who.map(str::to_owned),
            order: order.map(str::to_owned),
            without_people: false,
        };
        archive.orders(&late, &choice).unwrap().len()
    };
    assert_eq!(found(Some("li'na"), None), 1);
    assert_eq!(found(None, Some("login")), 0);
    assert_eq!(found(Some("somebody else"), None), 0);
}

fn change(code: Option<&str>, change: AlarmChange) -> Row {
    Row::AlarmChange(AlarmChangeRecord {
        simulated: true,
        code: code.map(str::to_owned),
        at_us: 50,
        change,
    })
}

#[test]
fn an_alarm_stays_listed_until_it_is_acknowledged() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    for (code, at_us) in [("door_open", 10), ("air_lost", 20), ("door_open", 30)] {
        let alarm = AlarmRecord {
            lot: Some("A".into()),
            code: code.into(),
            text: "text".into(),
            raised_at_us: at_us,
            ..AlarmRecord::default()
        };
        store.alarm(&alarm).unwrap();
    }
    store
        .record(&[change(
            Some("door_open"),
            AlarmChange::Returned { only: None },
        )])
        .unwrap();
    let shelved = AlarmChange::Shelved {
        until_us: 99,
        by: "li".into(),
        reason: "sensor ordered".into(),
    };
    store.record(&[change(Some("air_lost"), shelved)]).unwrap();
    let left = store.unacknowledged_alarms(true).unwrap();
    let seen: Vec<_> = left
        .iter()
        .map(|it| (it.code.as_str(), it.count, it.shelved_until_us))
        .collect();
    assert_eq!(seen, [("air_lost", 1, Some(99)), ("door_open", 2, None)]);
    assert!(
        store.unacknowledged_alarms(false).unwrap().is_empty(),
        "another rig"
    );
    let by = || AlarmChange::Acknowledged { by: "li".into() };
    store.record(&[change(Some("door_open"), by())]).unwrap();
    assert_eq!(store.unacknowledged_alarms(true).unwrap().len(), 1);
    store.record(&[change(None, by())]).unwrap();
    assert!(store.unacknowledged_alarms(true).unwrap().is_empty());
    let query =
        "SELECT count(*) FROM alarm_state WHERE acknowledged_by = 'li' AND acknowledged_at_us = 50";
    assert_eq!(
        file.by_hand()
            .query_row(query, [], |row| row.get::<_, i64>(0))
            .unwrap(),
        3
    );
    assert_eq!(count(&file.by_hand(), "alarm WHERE cleared_at_us = 50"), 2);
}

#[test]
fn wear_adds_up_until_the_replacement() {
    let file = File::new();
    let mut store = file.store();
    let more = |more| {
        Row::Wear(WearRecord {
            simulated: false,
            name: "probe_touches".into(),
            more,
        })
    };
    store.record(&[more(3)]).unwrap();
    store.record(&[more(4)]).unwrap();
    assert_eq!(store.wear(false).unwrap()[0].count, 7);
    assert!(store.wear(true).unwrap().is_empty());
    assert!(store.replaced(false, "probe_touches", "li", 60).unwrap());
    assert!(!store.replaced(false, "pins", "li", 60).unwrap());
    let wear = &store.wear(false).unwrap()[0];
    assert_eq!(
        (wear.count, wear.replaced, wear.replaced_by.as_deref()),
        (0, Some(Moment(60)), Some("li"))
    );
}

#[test]
fn the_book_of_lots_counts_runs_without_imports() {
    let file = File::new();
    let mut store = file.store();
    for (name, opened_at_us) in [("A", 1), ("B", 2), ("A", 3)] {
        let run = LotRecord {
            opened_at_us,
            ..lot(name)
        };
        store.begin_lot(&run).unwrap();
        store.record(&parts(name, 2)).unwrap();
        store.close_lot(name, opened_at_us).unwrap();
    }
    store
        .import(&lot("C"), vec![part("C", 1, "pass", 7.0)])
        .unwrap();
    let book = file.archive().lot_book(10, 0).unwrap();
    let counted: Vec<_> = book
        .iter()
        .map(|it| (it.lot.as_str(), it.runs, it.counts.parts, it.opened.0))
        .collect();
    assert_eq!(counted, [("A", 2, 4, 3), ("B", 1, 2, 2)]);
    assert_eq!(file.archive().lot_book(1, 1).unwrap()[0].lot, "B");
}

#[test]
fn a_clock_set_back_keeps_the_order_of_runs() {
    let file = File::new();
    let mut store = file.store();
    for (name, opened_at_us) in [("A", 3_000), ("B", 1_000)] {
        let run = LotRecord {
            opened_at_us,
            ..lot(name)
        };
        store.begin_lot(&run).unwrap();
        store.close_lot(name, opened_at_us).unwrap();
    }
    let archive = file.archive();
    let runs = archive.lots(&Filter::default()).unwrap();
    let book = archive.lot_book(10, 0).unwrap();
    assert_eq!((runs[0].lot.as_str(), runs[1].lot.as_str()), ("A", "B"));
    assert_eq!((book[0].lot.as_str(), book[1].lot.as_str()), ("B", "A"));
}

#[test]
fn a_repeated_decision_is_refused() {
    for decision in Decision::ALL {
        let again = decision.refusal(decision.becomes());
        let texts = again.map(|why| texts::Lang::ALL.map(|lang| why.say(lang)));
        assert!(texts.is_some_and(|[en, zh]| en != zh));
    }
}
