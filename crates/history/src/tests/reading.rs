//! Tests: filters, views, import.

use super::*;

fn parse_import(
    text: &str,
    maps: &[(String, String)],
    parameters: &[String],
) -> std::result::Result<Vec<ImportRow>, ImportError> {
    parse_records(&csv::read(text)?, maps, parameters)
}

fn seqs(archive: &Archive, filter: &Filter) -> Vec<u64> {
    archive
        .query(filter)
        .unwrap()
        .iter()
        .map(|it| it.seq)
        .collect()
}

pub(super) fn operate(min: f64, max: f64) -> Filter {
    Filter {
        param: Some("operate_voltage_v".into()),
        min: Some(min),
        max: Some(max),
        ..Filter::default()
    }
}

#[test]
fn an_import_names_the_columns_that_it_ignores() {
    let text = "lot,operate_voltage_v,uncertainty operate_voltage_v\nA,7.5,0.02\n";
    let found = ignored_columns(&csv::read(text).unwrap());
    assert_eq!(found, ["lot", "uncertainty operate_voltage_v"]);
}

#[test]
fn each_member_of_the_filter_restricts() {
    let file = File::new();
    let _store = filled(&file, 30);
    let archive = file.archive();
    let base = Filter::default;
    assert_eq!(
        seqs(
            &archive,
            &Filter {
                verdict: Some("fail".into()),
                ..base()
            }
        ),
        [10, 20, 30]
    );
    assert_eq!(
        seqs(
            &archive,
            &Filter {
                bin: Some("voltage".into()),
                limit: Some(2),
                ..base()
            }
        ),
        [10, 20]
    );
    assert_eq!(
        seqs(
            &archive,
            &Filter {
                since: Some(Moment(29_000_000)),
                ..base()
            }
        ),
        [29, 30]
    );
    assert_eq!(
        seqs(
            &archive,
            &Filter {
                until: Some(Moment(3_000_000)),
                ..base()
            }
        ),
        [1, 2]
    );
    assert_eq!(seqs(&archive, &operate(7.0045, 7.0065)), [5, 6]);
    assert_eq!(
        seqs(&archive, &operate(7.010, 7.020)),
        (10..=20).collect::<Vec<_>>()
    );
    let rejects = Filter {
        verdict: Some("fail".into()),
        lot: Some("A".into()),
        ..operate(7.011, 7.1)
    };
    assert_eq!(seqs(&archive, &rejects), [20, 30]);
    let late = Filter {
        since: Some(Moment(25_000_000)),
        bin: Some("voltage".into()),
        ..operate(7.0, 8.0)
    };
    assert_eq!(seqs(&archive, &late), [30]);
    for nothing in [
        Filter {
            lot: Some("B".into()),
            ..base()
        },
        Filter {
            run: Some(2),
            ..base()
        },
        Filter {
            recipe: Some("x".into()),
            ..operate(0.0, 9.0)
        },
    ] {
        assert_eq!(seqs(&archive, &nothing), Vec::<u64>::new());
    }
}

#[test]
fn the_yield_of_a_span_counts_verdicts() {
    let file = File::new();
    let _store = filled(&file, 30);
    let counts = file
        .archive()
        .yield_between(Moment(11_000_000), Moment(31_000_000))
        .unwrap();
    assert_eq!(
        counts,
        Yield {
            parts: 20,
            pass: 18,
            fail: 2,
            void: 0,
            unjudged: 0
        }
    );
}

#[test]
fn an_alarm_is_listed_with_what_became_of_it() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let alarm = AlarmRecord {
        lot: Some("A".into()),
        code: "late".into(),
        raised_at_us: 3,
        ..AlarmRecord::default()
    };
    store.alarm(&alarm).unwrap();
    let change = |change| {
        Row::AlarmChange(AlarmChangeRecord {
            simulated: true,
            code: Some("late".into()),
            at_us: 5,
            change,
        })
    };
    let listed = || file.archive().alarms(&Filter::default()).unwrap().remove(0);
    assert_eq!(listed().state, AlarmState::Unacknowledged);
    let shelved = AlarmChange::Shelved {
        until_us: 9,
        by: "wang".into(),
        reason: "备件".into(),
    };
    store.record(&[change(shelved)]).unwrap();
    let shelf = listed().shelf.unwrap();
    assert_eq!(
        (shelf.until, shelf.by.as_str(), shelf.reason.as_str()),
        (Moment(9), "wang", "备件")
    );
    let seen = AlarmChange::Acknowledged { by: "li".into() };
    store.record(&[change(seen)]).unwrap();
    let alarm = listed();
    assert_eq!(alarm.state, AlarmState::Acknowledged);
    assert_eq!(
        (alarm.acknowledged, alarm.acknowledged_by.as_deref()),
        (Some(Moment(5)), Some("li"))
    );
    store
        .record(&[change(AlarmChange::Returned { only: None })])
        .unwrap();
    assert_eq!(
        (listed().state, listed().cleared),
        (AlarmState::Normal, Some(Moment(5)))
    );
}

#[test]
fn limits_are_given_only_when_all_runs_agree() {
    let file = File::new();
    let mut store = filled(&file, 3);
    let limits = |param: &str| {
        file.archive()
            .values(param, &Filter::default())
            .unwrap()
            .limits
    };
    assert_eq!(
        limits("operate_voltage_v"),
        LimitsSeen::Same {
            low: None,
            high: Some(9.0)
        }
    );
    assert_eq!(limits("release_voltage_v"), LimitsSeen::None);
    store.begin_lot(&lot("B")).unwrap();
    let mut other = part("B", 1, "pass", 7.0);
    other.measurements[1].high = Some(8.0);
    store.record(&[Row::Part(other)]).unwrap();
    assert_eq!(limits("operate_voltage_v"), LimitsSeen::Differ);
}

#[test]
fn the_parts_view_has_parameter_columns_and_local_time() {
    let file = File::new();
    let mut store = filled(&file, 1);
    let mut more = part("A", 2, "pass", 7.0);
    more.measurements
        .push(measurement("coil_temperature_c", 31.5, 1));
    store.record(&[Row::Part(more)]).unwrap();
    let row: (String, String, f64, Option<f64>, f64) = file
        .by_hand()
        .query_row(
            "SELECT lot, judged, coil_resistance_ohm, release_voltage_v, coil_temperature_c
             FROM parts WHERE seq = 2",
            [],
            |row| {
                Ok((
                    row.get(0)?,
                    row.get(1)?,
                    row.get(2)?,
                    row.get(3)?,
                    row.get(4)?,
                ))
            },
        )
        .unwrap();
    assert_eq!(
        (row.0.as_str(), row.2, row.3, row.4),
        ("A", 402.0, None, 31.5)
    );
    assert!(row.1.ends_with("02.000"), "{}", row.1);
}

#[test]
fn the_other_views_can_be_read() {
    let file = File::new();
    let _store = filled(&file, 20);
    let by_hand = file.by_hand();
    let rows =
        ["lots", "measurements", "samples", "curves", "alarms"].map(|view| count(&by_hand, view));
    assert_eq!(rows, [1, 40, 40, 0, 0]);
    let percent: f64 = by_hand
        .query_row("SELECT yield_percent FROM lots", [], |row| row.get(0))
        .unwrap();
    assert_eq!(percent, 90.0);
}

#[test]
fn an_import_reads_keys_time_verdict_and_serial() {
    let known = [
        "operate_voltage_v".to_owned(),
        "release_voltage_v".to_owned(),
    ];
    let text = "\u{feff}time,serial,operate_voltage_v,release_voltage_v,verdict\r\n\
                1970-01-01T00:00:02Z,S1,7.5,,PASS\r\n,,7.6,1.5,\r\n";
    let rows = parse_import(text, &[], &known).unwrap();
    assert_eq!(
        (rows[0].part.judged_at_us, rows[0].timed, rows[1].timed),
        (2_000_000, true, false)
    );
    assert_eq!(
        (rows[0].part.verdict.as_str(), rows[1].part.verdict.as_str()),
        ("pass", "unjudged")
    );
    assert_eq!(
        (
            rows[0].part.measurements.len(),
            rows[1].part.measurements.len()
        ),
        (1, 2)
    );
}

#[test]
fn an_import_refuses_by_line_and_column() {
    let known = ["operate_voltage_v".to_owned()];
    let refusal = |text: &str| parse_import(text, &[], &known).unwrap_err().to_string();
    let misspelt = refusal("operate_voltage\n7\n");
    assert!(
        misspelt.starts_with("line 1: unknown column \"operate_voltage\""),
        "{misspelt}"
    );
    assert_eq!(
        refusal("operate_voltage_v\n7\nseven\n"),
        "line 3, column operate_voltage_v: found \"seven\", expected a finite number"
    );
    assert!(refusal("operate_voltage_v,time\n7,yesterday\n").contains("an RFC 3339 time"));
    assert!(refusal("operate_voltage_v\nNaN\n").contains("a finite number"));
    assert!(refusal("time\n").contains("at least one parameter key"));
    assert!(refusal("time,time,operate_voltage_v\n").contains("twice"));
}

#[test]
fn an_import_maps_the_columns_of_an_older_system() {
    let known = ["operate_voltage_v".to_owned()];
    let map = |from: &str| [(from.to_owned(), "operate_voltage_v".to_owned())];
    let rows = parse_import("Uop\n7.5\n", &map("Uop"), &known).unwrap();
    assert_eq!(rows[0].part.measurements[0].value, Some(7.5));
    let refusal = parse_import("operate_time\n7.5\n", &map("Uop"), &known).unwrap_err();
    assert_eq!(
        refusal.to_string(),
        "line 1: there is no column \"Uop\" to map"
    );
}

#[test]
fn an_import_is_one_closed_run_or_nothing() {
    let file = File::new();
    let mut store = file.store();
    let parts = vec![part("old", 1, "pass", 7.0), part("old", 2, "unjudged", 8.0)];
    assert_eq!(store.import(&lot("old"), parts.clone()).unwrap(), 1);
    let clash = vec![
        parts[0].clone(),
        PartRecord {
            verdict: "fail".into(),
            ..parts[0].clone()
        },
    ];
    assert!(store.import(&lot("old"), clash).is_err());
    let lots = file.archive().lots(&Filter::default()).unwrap();
    let [only] = lots.as_slice() else {
        panic!("one run, found {}", lots.len())
    };
    assert_eq!(
        (
            only.source.as_str(),
            only.counts.parts,
            only.counts.unjudged
        ),
        ("import", 2, 1)
    );
    assert!(only.closed.is_some());
    let timeless = PartRecord {
        test_s: f64::NAN,
        ..part("old", 1, "pass", 7.0)
    };
    store
        .import(
            &lot("timeless"),
            vec![PartRecord {
                lot: "timeless".into(),
                ..timeless
            }],
        )
        .unwrap();
    let filter = Filter {
        lot: Some("timeless".into()),
        ..Filter::default()
    };
    assert_eq!(file.archive().query(&filter).unwrap()[0].test_s, None);
}
