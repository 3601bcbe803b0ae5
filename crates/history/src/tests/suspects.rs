//! Tests: reference checks and suspect parts.

use super::*;
use machine::station::trouble::Alarm;
use texts::{Lang, Message};

fn disagreement() -> Alarm {
    Alarm::reference_check_failed(&Message::new("fault", "line").with("detail", "silent"))
}

fn check(lot: &str, at_us: i64, passed: bool) -> Row {
    Row::ReferenceCheck(ReferenceCheckRecord {
        lot: lot.into(),
        at_us,
        text: "G-12-1".into(),
        failure: (!passed).then(disagreement),
    })
}

fn suspects(file: &File) -> Vec<(String, u64)> {
    let filter = Filter {
        suspect: true,
        ..Filter::default()
    };
    let parts = file.archive().query(&filter).unwrap();
    parts.into_iter().map(|it| (it.lot, it.seq)).collect()
}

#[test]
fn parts_between_passed_and_failed_check_are_suspect() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    store.record(&parts("A", 6)).unwrap();
    store.record(&[check("A", 2_500_000, true)]).unwrap();
    assert!(suspects(&file).is_empty());
    store.record(&[check("A", 5_000_000, false)]).unwrap();
    let expected = [
        ("A".to_owned(), 3),
        ("A".to_owned(), 4),
        ("A".to_owned(), 5),
    ];
    assert_eq!(suspects(&file), expected);
    let by_value = Filter {
        suspect: true,
        ..Filter::default()
    };
    let values = file
        .archive()
        .values("operate_voltage_v", &by_value)
        .unwrap();
    assert_eq!(values.values.len(), 3);
    let checks = file.archive().reference_checks(&Filter::default()).unwrap();
    assert_eq!(checks[0].suspect_since, None);
    assert_eq!(checks[1].suspect_since, Some(Moment(2_500_000)));
    let chinese = [None, Some(disagreement().text(Lang::Zh))];
    assert_eq!([&checks[0].text_zh, &checks[1].text_zh], chinese.each_ref());
}

#[test]
fn a_clock_set_back_hides_no_suspect_part() {
    let file = File::new();
    let mut store = file.store();
    let run = |name: &str| LotRecord {
        simulated: false,
        ..lot(name)
    };
    store.begin_lot(&run("before")).unwrap();
    store.record(&parts("before", 6)).unwrap();
    store.record(&[check("before", 4_500_000, true)]).unwrap();
    // The clock goes back by more than the run took: the next check fails "before" the one that passed.
    store.begin_lot(&run("after")).unwrap();
    store.record(&parts("after", 1)).unwrap();
    store.record(&[check("after", 2_000_000, false)]).unwrap();
    let expected = [("before", 5), ("before", 6), ("after", 1)];
    assert_eq!(
        suspects(&file),
        expected.map(|(lot, seq)| (lot.to_owned(), seq))
    );
    let last = file.archive().last_reference_check(false).unwrap().unwrap();
    assert!(!last.passed);
    assert_eq!(last.suspect_since, Some(Moment(4_500_000)));
}

#[test]
fn a_check_sent_again_is_one_check() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    store.record(&[check("A", 7, true)]).unwrap();
    store.record(&[check("A", 7, true)]).unwrap();
    assert_eq!(count(&file.by_hand(), "golden_check"), 1);
}

#[test]
fn failed_check_reaches_earlier_lots_on_a_rig_only() {
    for (simulated, expected) in [(false, 4), (true, 2)] {
        let file = File::new();
        let mut store = file.store();
        for name in ["first", "second"] {
            let run = LotRecord {
                simulated,
                ..lot(name)
            };
            store.begin_lot(&run).unwrap();
            store.record(&parts(name, 2)).unwrap();
        }
        store.record(&[check("second", 9_000_000, false)]).unwrap();
        assert_eq!(suspects(&file).len(), expected);
    }
}
