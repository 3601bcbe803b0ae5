//! Tests of spreadsheets, read back by another crate.
#![allow(clippy::unwrap_used)]

use super::{File, lot};
use crate::inquiry::export::spreadsheet;
use crate::report::sheet::{Sheet, SheetFacts};
use crate::report::{Lang, Paper};
use crate::{Filter, OrderRecord, Part, Row};
use calamine::{Data, DataType, Reader, Xlsx};
use jiff::tz::TimeZone;
use quality::Limits;
use std::io::Cursor;
use texts::Message;

const LOT: &str = "<b>批次\"1\"</b>";

fn part(operate_v: f64) -> Part {
    let mut part = Part::fixture(LOT, 7, "pass");
    part.values
        .insert("operate_voltage_v".into(), operate_v.into());
    part.serial = Some("=1+1".into());
    part
}

fn paper(simulated: bool) -> Paper {
    Paper {
        language: Lang::En,
        zone: TimeZone::UTC,
        made: String::new(),
        simulated,
    }
}

#[test]
fn a_spreadsheet_of_simulated_parts_says_so() {
    for simulated in [false, true] {
        let sheet = Sheet::new(&paper(simulated), &[], &[]).unwrap();
        let mut book = sheet.finish(&SheetFacts::default()).unwrap();
        let bytes = book.save_to_buffer().unwrap();
        let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).unwrap();
        let summary = book.worksheet_range("Summary").unwrap();
        let word = Data::String("SIMULATION".into());
        assert_eq!(summary.get((0, 12)) == Some(&word), simulated);
    }
}

#[test]
fn a_spreadsheet_of_a_lot_has_its_answers() {
    let file = File::new();
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let answer = |choice: &str, refused: Option<&'static str>| {
        Row::Order(OrderRecord {
            lot: Some("A".into()),
            who: "li".into(),
            what: format!(r#"{{"order":"answer","prompt":"nest","choice":"{choice}"}}"#),
            refused: refused.map(|code| Message::new("refusal", code)),
            ..OrderRecord::default()
        })
    };
    let rows = [
        answer("none", Some("no_such_choice")),
        answer("changed", None),
    ];
    store.record(&rows).unwrap();
    let filter = Filter {
        lot: Some("A".into()),
        ..Filter::default()
    };
    let made = spreadsheet(&file.archive(), &filter, &[], &paper(true), || {});
    let bytes = made.unwrap().save_to_buffer().unwrap();
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).unwrap();
    let summary = book.worksheet_range("Summary").unwrap();
    let told = summary
        .rows()
        .filter(|row| row[0].get_string() == Some("Prompt: nest"));
    let told: Vec<String> = told.map(|row| row[1].to_string()).collect();
    assert_eq!(told, ["changed, li, 1970-01-01 00:00:00 +00:00"]);
}

#[test]
fn a_spreadsheet_reads_back_with_charts_without_formula() {
    let keys = ["operate_voltage_v".to_owned()];
    let mut sheet = Sheet::new(&paper(false), &keys, &[]).unwrap();
    for _ in 0..3 {
        sheet.part(&part(7.704_22)).unwrap();
    }
    let mut exact = part(9.5);
    exact
        .uncertainty
        .insert("operate_voltage_v".into(), 0.into());
    sheet.part(&exact).unwrap();
    let about = SheetFacts {
        facts: vec![("Lot".into(), LOT.into())],
        limits: vec![Limits {
            low: None,
            high: Some(9.0),
        }],
    };
    let bytes = sheet.finish(&about).unwrap().save_to_buffer().unwrap();
    let chart = b"xl/charts/chart2.xml";
    assert!(bytes.windows(chart.len()).any(|it| it == chart));
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).unwrap();
    assert_eq!(book.sheet_names(), ["Summary", "Parts"]);
    let parts = book.worksheet_range("Parts").unwrap();
    assert_eq!(parts.height(), 5);
    assert_eq!(parts[(1, 1)], Data::String(LOT.into()));
    assert_eq!(parts[(1, 6)], Data::String("=1+1".into()));
    assert_eq!(parts[(1, 13)], Data::Float(7.704_22));
    assert_eq!(parts[(4, 14)], Data::Float(0.0), "an uncertainty of 0");
    assert!(book.worksheet_formula("Parts").unwrap().is_empty());
    let summary = book.worksheet_range("Summary").unwrap();
    assert_eq!(
        [1, 5, 7].map(|column| &summary[(1, column)]),
        [4.0, 9.5, 9.0].map(Data::Float).each_ref()
    );
    assert!(matches!(summary[(1, 9)], Data::Float(cpk) if cpk > 0.0));
    assert_eq!(summary[(3, 1)], Data::String(LOT.into()));
    assert_eq!(
        [(0, 7), (0, 13), (0, 14), (1, 7)].map(|at| parts[at].to_string()),
        [
            "Verdict",
            "Operate voltage / V",
            "U Operate voltage / V",
            "pass"
        ]
    );
}
