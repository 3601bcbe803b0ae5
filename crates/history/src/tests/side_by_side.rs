//! Tests: packed values equal those of the index, in the same order.

use super::*;

/// Returns a filter that reads the index: a range that contains every value rules out packed values.
fn of_the_index(filter: &Filter) -> Filter {
    Filter {
        min: Some(f64::MIN),
        ..filter.clone()
    }
}

fn record(store: &mut Store, lot: &str, seqs: impl Iterator<Item = u64>) {
    let rows: Vec<Row> = seqs
        .map(|seq| {
            let verdict = if seq % 3 == 0 { "fail" } else { "pass" };
            let value = 7.0 + (seq * 7919 % 101) as f64 / 100.0;
            Row::Part(part(lot, seq, verdict, value))
        })
        .collect();
    store.record(&rows).unwrap();
}

/// Checks that packed values agree with those of the index, over all runs, one run, and a page.
fn agree(file: &File) {
    let archive = file.archive();
    let of_b = Filter {
        lot: Some("B".into()),
        ..Filter::default()
    };
    let page = Filter {
        limit: Some(4),
        offset: Some(3),
        ..Filter::default()
    };
    let beyond = Filter {
        offset: Some(1_000),
        ..Filter::default()
    };
    for filter in [Filter::default(), of_b, page, beyond] {
        let values = |filter: &Filter| archive.values("operate_voltage_v", filter).unwrap();
        assert_eq!(
            values(&filter),
            values(&of_the_index(&filter)),
            "{filter:?}"
        );
    }
    let unknown = archive.values("nobody_measures_this", &Filter::default());
    assert!(unknown.unwrap().values.is_empty());
}

#[test]
fn packed_values_equal_the_values_of_the_index() {
    let file = File::new();
    let mut store = file.store();
    for name in ["A", "B", "C"] {
        store.begin_lot(&lot(name)).unwrap();
        record(&mut store, name, 1..=8);
        if name != "C" {
            store.close_lot(name, 20).unwrap();
        }
    }
    assert_eq!(count(&file.by_hand(), "series"), 4, "two of A, two of B");
    let archive = file.archive();
    let packed = archive.side_by_side("operate_voltage_v", &Filter::default());
    assert_eq!(packed.unwrap().unwrap().len(), 24);
    agree(&file);
}

#[test]
fn alternating_runs_come_in_order_of_judgement() {
    let file = File::new();
    let mut store = file.store();
    for name in ["A", "B"] {
        store.begin_lot(&lot(name)).unwrap();
    }
    for seq in 1..=6 {
        record(&mut store, "A", seq..=seq);
        record(&mut store, "B", seq..=seq);
    }
    for name in ["A", "B"] {
        store.close_lot(name, 20).unwrap();
    }
    let together = file
        .archive()
        .side_by_side("operate_voltage_v", &Filter::default());
    assert_eq!(together.unwrap(), None);
    agree(&file);
}

#[test]
fn a_filter_within_runs_skips_packed_values() {
    let base = Filter::default;
    let some = |text: &str| Some(text.to_owned());
    let narrower = [
        Filter {
            verdict: some("pass"),
            ..base()
        },
        Filter {
            kind: some("all"),
            ..base()
        },
        Filter {
            bin: some("coil"),
            ..base()
        },
        Filter {
            since: Some(Moment(5)),
            ..base()
        },
        Filter {
            until: Some(Moment(5)),
            ..base()
        },
        Filter {
            min: Some(1.0),
            ..base()
        },
        Filter {
            max: Some(1.0),
            ..base()
        },
        Filter {
            suspect: true,
            ..base()
        },
    ];
    assert!(base().selects_whole_runs());
    assert!(!narrower.iter().any(Filter::selects_whole_runs));
}
