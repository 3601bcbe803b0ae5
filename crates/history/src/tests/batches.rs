//! Tests: batches keep the curves of their chamber.

use super::*;

fn signal(name: &str, seq: Option<u64>, samples: &[(i64, Option<f64>)]) -> BatchSignal {
    BatchSignal {
        seq,
        curve: CurveRecord {
            signal: name.into(),
            unit: "C".into(),
            step: 0.01,
            samples: samples.to_vec(),
        },
    }
}

/// Batch `number` of lot A: from second 1 to second 11, in socket 7 the part `seq`.
fn batch(number: u64, seq: u64) -> BatchRecord {
    let at_us = |s: i64| 1_000_000 * s;
    BatchRecord {
        lot: "A".into(),
        number,
        begin_us: at_us(1),
        ended_us: at_us(11),
        signals: vec![
            signal("set_point", None, &[(at_us(1), None), (at_us(6), Some(60.0))]),
            signal("reference", None, &[(at_us(1), Some(40.25)), (at_us(6), Some(-3.5))]),
            signal("rate", None, &[(at_us(1), None), (at_us(6), Some(5.0))]),
            signal("socket_7", Some(seq), &[(at_us(2), Some(1.0)), (at_us(9), Some(0.0))]),
            signal("socket_8", Some(seq + 1), &[]),
        ],
    }
}

#[test]
fn a_batch_comes_back_with_curves_and_switchings() {
    let file = File::new();
    let mut store = filled(&file, 12);
    store.record(&[Row::Batch(batch(1, 3))]).unwrap();
    let [found] = &file.archive().batches(&Filter::default()).unwrap()[..] else {
        panic!("expected one batch");
    };
    assert_eq!((found.run, found.number), (1, 1));
    assert_eq!(found.curve.t_s, [0.0, 5.0]);
    assert_eq!(found.curve.set_c, [None, Some(60.0)]);
    assert_eq!(found.curve.reference_c, [Some(40.25), Some(-3.5)]);
    assert_eq!(found.curve.rate_k_per_min, [None, Some(5.0)]);
    let [own] = &found.switched[..] else {
        panic!("a socket without switchings is kept");
    };
    assert_eq!((own.socket, own.seq), (7, Some(3)));
    assert_eq!((&own.opened_s[..], &own.closed_s[..]), (&[1.0][..], &[8.0][..]));
}

#[test]
fn a_batch_sent_again_is_stored_once() {
    let file = File::new();
    let mut store = filled(&file, 3);
    store.record(&[Row::Batch(batch(1, 3))]).unwrap();
    store.record(&[Row::Batch(batch(1, 3)), Row::Batch(batch(2, 9))]).unwrap();
    let by_hand = file.by_hand();
    assert_eq!((count(&by_hand, "batch"), count(&by_hand, "batch_curve")), (2, 8));
}

#[test]
fn a_part_finds_its_batch_by_its_time() {
    let file = File::new();
    let mut store = filled(&file, 12);
    store.record(&[Row::Batch(batch(1, 3))]).unwrap();
    let archive = file.archive();
    let of = |seq| {
        let parts = archive.show("A", seq, "lot").unwrap();
        archive.batch_of(&parts[0]).unwrap().map(|it| it.number)
    };
    assert_eq!((of(11), of(12)), (Some(1), None));
}

#[test]
fn a_pruned_run_loses_its_batches() {
    let file = File::new();
    let mut store = filled(&file, 3);
    store.record(&[Row::Batch(batch(1, 3))]).unwrap();
    store.close_lot("A", 20_000_000).unwrap();
    store.record_export(&Filter::default(), "copy.csv", 21_000_000).unwrap();
    store.prune(30_000_000, 31_000_000, |_| {}).unwrap();
    let by_hand = file.by_hand();
    assert_eq!((count(&by_hand, "batch"), count(&by_hand, "batch_curve")), (0, 0));
    file.archive().check().unwrap();
}
