//! Tests of figures over a lot.

use super::*;
use crate::inquiry::figures::figures;
use crate::inquiry::paper::{lot_report, paper};
use texts::Lang;

fn of_lot() -> Filter {
    Filter {
        lot: Some("A".into()),
        ..Filter::default()
    }
}

#[test]
fn a_test_without_a_value_counts_beside_n() {
    let file = File::new();
    let mut store = filled(&file, 2);
    let mut over_range = part("A", 3, "fail", 7.0);
    over_range.measurements.remove(0);
    store.record(&[Row::Part(over_range)]).unwrap();
    let archive = file.archive();
    let of = |param, filter: &Filter| {
        let found = figures(&archive, param, filter, None).unwrap().summary;
        (found.n, found.without_value)
    };
    assert_eq!(of("coil_resistance_ohm", &of_lot()), (2, Some(1)));
    assert_eq!(of("operate_voltage_v", &of_lot()), (3, Some(0)));
    assert_eq!(of("operate_voltage_v", &Filter::default()), (3, None));
    let report = lot_report(&archive, &of_lot(), None, &paper(Lang::En)).unwrap();
    assert!(report.contains("2\u{a0}/\u{a0}3"));
}

/// The run opens at 1 s and closes at 41 s. Set-up: 1 s to 21 s, and the two seconds of the later reference part.
#[test]
fn calibration_and_reference_parts_are_setup() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let at = |kind: &str, seq, judged_at_us| {
        Row::Part(PartRecord {
            kind: kind.into(),
            judged_at_us,
            test_s: 0.5,
            cycle_s: Some(2.0),
            ..part("A", seq, "pass", 7.0)
        })
    };
    let rows = [
        at("golden", 1, 11_000_000),
        at("lot", 1, 21_500_000),
        at("golden", 2, 31_000_000),
        at("lot", 2, 33_000_000),
    ];
    store.record(&rows).unwrap();
    store.close_lot("A", 41_000_000).unwrap();
    let archive = file.archive();
    let report = lot_report(&archive, &of_lot(), Some(2.0), &paper(Lang::En)).unwrap();
    // Of 40 s: 22 s of set-up; of the 18 s that remain, 4 s for two parts.
    for shown in ["0:00:22", "0:00:14", "45.0 %", "22.2 %", "10.0 %"] {
        assert!(report.contains(shown), "{shown}");
    }
}
