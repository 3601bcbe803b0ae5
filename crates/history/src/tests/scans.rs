//! Tests: scans whose parts have not come before the end of their run.

use super::*;
use texts::Message;

#[test]
fn a_run_names_the_scans_whose_parts_never_came() {
    let expected = "S-2 (li), S-4 (wang)";
    for closes in [true, false] {
        let file = File::new();
        let mut store = file.store();
        store.begin_lot(&lot("A")).unwrap();
        let order = |what: &str, who: &str, refused: Option<&'static str>| {
            Row::Order(OrderRecord {
                lot: Some("A".into()),
                // Earlier than the start of the run, because the clock was set back during the run.
                at_us: 500_000,
                who: who.into(),
                what: what.into(),
                refused: refused.map(|code| Message::new("refusal", code)),
                ..OrderRecord::default()
            })
        };
        let scan = |n: u32| format!(r#"{{"order":"scan","serial":" S-{n}"}}"#);
        let tested = PartRecord {
            serial: Some("S-1".into()),
            ..part("A", 1, "pass", 7.0)
        };
        let rows = [
            order(&scan(1), "li", None),
            order(&scan(2), "li", None),
            order(&scan(2), "li", Some("scan_repeated")),
            order(&scan(3), "li", None),
            order(r#"{"order":"unscan"}"#, "li", None),
            order(&scan(4), "wang", None),
            Row::Part(tested),
        ];
        store.record(&rows).unwrap();
        match closes {
            true => store.close_lot("A", 9_000_000).unwrap(),
            false => drop(store),
        }
        let mut store = file.store();
        for _ in 0..2 {
            store.cut_off(true, 10_000_000).unwrap();
        }
        let alarms = store.unacknowledged_alarms(true).unwrap();
        let found: Vec<_> = alarms
            .iter()
            .map(|it| (it.args.get("serials"), it.count))
            .collect();
        assert_eq!(found, [(Some(expected), 1)], "closed: {closes}");
        assert!(alarms[0].text.contains(expected));
    }
}
