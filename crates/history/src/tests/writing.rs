//! Tests: what the writer keeps, and what it refuses.

use super::*;
use machine::dut::em_relay::bins;
use machine::handling::inside::Inside;

#[test]
fn a_part_is_kept_down_to_the_raw_reply() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let mut record = part("A", 1, "fail", 9.2);
    record.serial = Some("S-1".into());
    store.record(&[Row::Part(record)]).unwrap();
    let shown = file.archive().show("A", 1, "lot").unwrap();
    let [shown] = shown.as_slice() else {
        panic!("one part, found {}", shown.len())
    };
    assert_eq!(
        (shown.lot.as_str(), shown.run, shown.recipe.as_str()),
        ("A", 1, "jzc-22f-012")
    );
    assert_eq!(
        (shown.verdict.as_str(), shown.bin.as_deref()),
        ("fail", Some("voltage"))
    );
    assert_eq!(
        (shown.reasons.as_slice(), shown.serial.as_deref()),
        (&["operate_voltage_v high".to_owned()][..], Some("S-1"))
    );
    assert_eq!(
        shown.reason_codes,
        [Reason::from_text("operate_voltage_v high")]
    );
    assert_eq!(shown.values["operate_voltage_v"], 9.2);
    let measured = &shown.measurements[1];
    assert_eq!(
        (measured.high, measured.uncertainty),
        (Some(9.0), Some(0.02))
    );
    assert_eq!(measured.budget.as_ref().unwrap()["gain"], 0.01);
    let sample = &measured.samples[0];
    assert_eq!(
        (sample.module.as_str(), sample.raw.as_str()),
        ("01", ">4C53")
    );
}

#[test]
fn an_interruption_adds_its_code_once() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let interrupted = Row::Interrupted(InterruptedRecord {
        lot: "A".into(),
        kind: "lot".into(),
        seq: 1,
        reason: Reason::interrupted("door_open"),
    });
    let rows = [Row::Part(part("A", 1, "fail", 9.2)), interrupted.clone()];
    store.record(&rows).unwrap();
    store.record(&[interrupted]).unwrap();
    let parts = file.archive().query(&Filter::default()).unwrap();
    assert_eq!(
        (parts[0].verdict.as_str(), parts[0].bin.as_deref()),
        ("void", Some("retest"))
    );
    let texts = ["operate_voltage_v high", "interrupted: door_open"];
    assert_eq!(parts[0].reasons, texts);
    assert_eq!(parts[0].reason_codes, texts.map(Reason::from_text));
}

#[test]
fn the_next_run_of_a_rig_knows_its_contents() {
    let file = File::new();
    let mut store = file.store();
    let inside = Inside {
        nest: true,
        falling: Some(bins::COIL),
        ..Inside::default()
    };
    for inside in [Inside::default(), inside] {
        let simulated = false;
        store
            .record(&[Row::Inside(InsideRecord { simulated, inside })])
            .unwrap();
    }
    drop(store);
    let store = file.store();
    assert_eq!(store.left_inside(false).unwrap(), inside);
    assert_eq!(store.left_inside(true).unwrap(), Inside::default());
}

#[test]
fn a_part_comes_back_with_its_curves_only() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let curve = CurveRecord {
        signal: "coil_voltage_fine".into(),
        unit: "V".into(),
        step: 1e-5,
        samples: vec![(2_000_000, Some(5.000_01)), (2_003_500, None)],
    };
    let seen = PartRecord {
        curves: vec![curve.clone(), CurveRecord::default()],
        ..part("A", 2, "fail", 9.5)
    };
    store
        .record(&[Row::Part(part("A", 1, "pass", 7.0)), Row::Part(seen)])
        .unwrap();
    let archive = file.archive();
    assert!(archive.show("A", 1, "lot").unwrap()[0].curves.is_empty());
    let shown = &archive.show("A", 2, "lot").unwrap()[0].curves;
    let [only] = shown.as_slice() else {
        panic!("one curve, found {}", shown.len())
    };
    assert_eq!((only.begin_us, &only.t_us), (2_000_000, &vec![0, 3_500]));
    let first = only.values[0].unwrap();
    assert!((first - 5.000_01).abs() < 1e-9 && only.values[1].is_none());
    file.by_hand()
        .execute_batch("UPDATE curve SET packed = x'00'")
        .unwrap();
    let damage = archive.show("A", 2, "lot").unwrap_err();
    assert!(matches!(damage, HistoryError::Damaged { .. }), "{damage}");
}

#[test]
fn a_lot_opened_again_gets_the_next_run() {
    let file = File::new();
    let mut store = file.store();
    assert_eq!(store.begin_lot(&lot("A")).unwrap(), 1);
    store
        .record(&[Row::Part(part("A", 1, "pass", 7.0))])
        .unwrap();
    store.close_lot("A", 5_000_000).unwrap();
    assert_eq!(store.begin_lot(&lot("A")).unwrap(), 2);
    store
        .record(&[Row::Part(part("A", 1, "fail", 9.5))])
        .unwrap();
    let archive = file.archive();
    let parts = archive
        .query(&Filter {
            lot: Some("A".into()),
            ..Filter::default()
        })
        .unwrap();
    let seen: Vec<_> = parts
        .iter()
        .map(|it| (it.run, it.seq, it.verdict.as_str()))
        .collect();
    assert_eq!(seen, [(1, 1, "pass"), (2, 1, "fail")]);
    let lots = archive.lots(&Filter::default()).unwrap();
    assert_eq!(
        (lots[0].closed, lots[1].closed),
        (Some(Moment(5_000_000)), None)
    );
    assert_eq!(lots[0].seed.as_deref(), Some("18446744073709551615"));
}

#[test]
fn a_batch_sent_again_makes_no_second_row() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let landing = LandingRecord {
        lot: "A".into(),
        kind: "lot".into(),
        seq: 1,
        bin: "pass".into(),
        at_us: 1_000_009,
        cycle_s: Some(1.4),
    };
    let alarm = AlarmRecord {
        lot: Some("A".into()),
        code: "clamp".into(),
        raised_at_us: 3,
        ..AlarmRecord::default()
    };
    let batch = [
        Row::Part(part("A", 1, "pass", 7.0)),
        Row::Landed(landing),
        Row::Alarm(alarm),
    ];
    store.record(&batch).unwrap();
    store.record(&batch).unwrap();
    let by_hand = file.by_hand();
    let rows = ["part", "measurement", "sample", "alarm"].map(|table| count(&by_hand, table));
    assert_eq!(rows, [1, 2, 2, 1]);
}

#[test]
fn a_contradicting_part_refuses_its_whole_batch() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    store
        .record(&[Row::Part(part("A", 1, "pass", 7.0))])
        .unwrap();
    let batch = [
        Row::Part(part("A", 2, "pass", 7.0)),
        Row::Part(part("A", 1, "fail", 9.5)),
    ];
    assert!(matches!(
        store.record(&batch),
        Err(HistoryError::PartTwice { seq: 1, .. })
    ));
    assert_eq!(count(&file.by_hand(), "part"), 1);
    store.record(&batch[..1]).unwrap();
    assert_eq!(count(&file.by_hand(), "part"), 2);
}

#[test]
fn a_part_lands_once_and_in_one_bin() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    assert!(matches!(
        store.landed("A", 1, "pass", 5, None),
        Err(HistoryError::NoSuchPart { .. })
    ));
    store
        .record(&[Row::Part(part("A", 1, "pass", 7.0))])
        .unwrap();
    store.landed("A", 1, "pass", 1_000_005, Some(1.42)).unwrap();
    store.landed("A", 1, "pass", 1_000_005, Some(1.42)).unwrap();
    let refusal = store.landed("A", 1, "coil", 1_000_006, None).unwrap_err();
    assert!(
        matches!(refusal, HistoryError::LandedTwice { .. }),
        "{refusal}"
    );
    let parts = file.archive().query(&Filter::default()).unwrap();
    assert_eq!(
        (parts[0].landed_bin.as_deref(), parts[0].cycle_s),
        (Some("pass"), Some(1.42))
    );
}

#[test]
fn reference_parts_count_apart_from_the_lot() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let golden = PartRecord {
        kind: "golden".into(),
        ..part("A", 1, "pass", 8.0)
    };
    store
        .record(&[Row::Part(golden), Row::Part(part("A", 1, "pass", 7.0))])
        .unwrap();
    let archive = file.archive();
    let of = |kind: Option<&str>| {
        let filter = Filter {
            kind: kind.map(str::to_owned),
            ..Filter::default()
        };
        let values = archive.values("operate_voltage_v", &filter).unwrap().values;
        (archive.query(&filter).unwrap().len(), values)
    };
    assert_eq!(of(None), (1, vec![7.0]));
    assert_eq!(of(Some("golden")), (1, vec![8.0]));
    assert_eq!(of(Some("all")), (2, vec![8.0, 7.0]));
    let lots = archive.lots(&Filter::default()).unwrap();
    assert_eq!((lots[0].counts.parts, lots[0].golden), (1, 1));
}

#[test]
fn only_the_last_attempt_with_a_judged_value_counts() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let mut again = part("A", 1, "pass", 7.0);
    again
        .measurements
        .push(measurement("operate_voltage_v", 7.5, 2));
    let mut void = part("A", 2, "void", 6.0);
    void.measurements[1].verdict = "void".into();
    let mut lost = part("A", 3, "void", 6.0);
    lost.measurements[1].value = Some(f64::NAN);
    store
        .record(&[Row::Part(again), Row::Part(void), Row::Part(lost)])
        .unwrap();
    let archive = file.archive();
    let values = archive
        .values("operate_voltage_v", &Filter::default())
        .unwrap();
    assert_eq!(values.values, [7.5]);
    let parts = archive.query(&Filter::default()).unwrap();
    assert_eq!(parts[0].values["operate_voltage_v"], 7.5);
    assert!(parts[2].values["operate_voltage_v"].is_null());
}

#[test]
fn rows_of_a_closed_lot_are_refused() {
    let file = File::new();
    let mut store = file.store();
    let refusal = store
        .record(&[Row::Part(part("B", 1, "pass", 7.0))])
        .unwrap_err();
    assert_eq!(refusal.to_string(), "lot \"B\" is not open");
    store.begin_lot(&lot("B")).unwrap();
    store.close_lot("B", 1).unwrap();
    assert!(matches!(
        store.close_lot("B", 2),
        Err(HistoryError::LotNotOpen { .. })
    ));
}

#[test]
fn an_alarm_is_one_row_from_raised_to_cleared() {
    let file = File::new();
    let mut store = file.store();
    let raised = AlarmRecord {
        code: "silent".into(),
        line: Some("measure".into()),
        text: "module 01 silent".into(),
        raised_at_us: 5,
        ..AlarmRecord::default()
    };
    store.alarm(&raised).unwrap();
    store
        .alarm(&AlarmRecord {
            cleared_at_us: Some(9),
            ..raised.clone()
        })
        .unwrap();
    store.alarm(&raised).unwrap();
    let by_hand = file.by_hand();
    let cleared: i64 = by_hand
        .query_row("SELECT cleared_at_us FROM alarm", [], |row| row.get(0))
        .unwrap();
    assert_eq!((count(&by_hand, "alarm"), cleared), (1, 9));
}

#[test]
fn the_latest_calibration_is_per_rig_and_coil() {
    let file = File::new();
    let mut store = file.store();
    let latest = |store: &Store| store.latest_calibration_of(false, 12.0).unwrap();
    assert_eq!(latest(&store), None);
    let of = |made_at_us: i64, simulated: bool, nominal_v: f64| {
        let body = format!(
            "{{\"made\":{made_at_us},\"simulated\":{simulated},\"nominal_v\":{nominal_v:.1}}}"
        );
        CalibrationRecord {
            made_at_us,
            due_at_us: made_at_us + 100,
            hash: snapshot_hash(&body),
            body,
            verified: false,
        }
    };
    let made = |made_at_us: i64| of(made_at_us, false, 12.0);
    store.save_calibration(&made(20)).unwrap();
    // The clock was set back.
    store.save_calibration(&made(10)).unwrap();
    // A calibration of the simulated rig, or for another coil voltage, does not take its place.
    store.save_calibration(&of(30, true, 12.0)).unwrap();
    store.save_calibration(&of(40, false, 6.0)).unwrap();
    assert_eq!(latest(&store), Some(made(10)));
    let verified = CalibrationRecord {
        verified: true,
        ..made(10)
    };
    store.save_calibration(&verified).unwrap();
    assert_eq!(latest(&store), Some(verified));
}

#[test]
fn quotes_chinese_and_sql_in_texts_are_harmless() {
    let file = File::new();
    let mut store = file.store();
    let nasty = "批次'; DROP TABLE part; --\"\n";
    store
        .begin_lot(&LotRecord {
            recipe: nasty.into(),
            ..lot(nasty)
        })
        .unwrap();
    let mut record = part(nasty, 1, "fail", 7.0);
    record.serial = Some(nasty.into());
    record.bin = nasty.into();
    record.reasons = vec![Reason::unclassified(nasty)];
    record.measurements[0].key = format!("{nasty}_ohm");
    record.measurements[0].samples[0].raw = nasty.into();
    store.record(&[Row::Part(record)]).unwrap();
    let archive = file.archive();
    let filter = Filter {
        lot: Some(nasty.into()),
        recipe: Some(nasty.into()),
        bin: Some(nasty.into()),
        param: Some(format!("{nasty}_ohm")),
        ..Filter::default()
    };
    assert_eq!(archive.query(&filter).unwrap()[0].reasons, [nasty]);
    let column: f64 = file
        .by_hand()
        .query_row(
            &format!("SELECT \"{}_ohm\" FROM parts", nasty.replace('"', "\"\"")),
            [],
            |row| row.get(0),
        )
        .unwrap();
    assert_eq!(column, 401.0);
}
