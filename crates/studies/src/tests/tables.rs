//! Tests of bars, tables and charts.

use super::super::chart::Chart;
use super::super::figure::{Bar, Figure, shown};
use super::super::output::Report;
use serde_json::{Value, json};

fn report() -> Report {
    let groups = vec![
        vec![
            Figure::new("a, \"b\"", 3, Some(1.25), "mV")
                .with("max", Some(2.0))
                .bar(Bar::AtMost(1.0)),
        ],
        vec![
            Figure::count("c", 1, Some(0)).bar(Bar::AtMost(0.0)),
            Figure::count("d", 1, None),
        ],
    ];
    Report {
        study: "x",
        about: "1 x 3 parts".into(),
        groups,
        notes: Vec::new(),
        chart: Chart::default(),
    }
}

#[test]
fn a_bar_includes_its_ends_except_below() {
    assert!(Bar::AtMost(1.0).is_met(1.0) && Bar::AtLeast(1.0).is_met(1.0));
    assert!(Bar::Within(93.0, 99.5).is_met(99.5) && !Bar::Within(93.0, 99.5).is_met(99.6));
    assert!(!Bar::Below(0.5).is_met(0.5));
    for bar in [
        Bar::AtMost(1.0),
        Bar::Below(1.0),
        Bar::AtLeast(1.0),
        Bar::Within(0.0, 1.0),
    ] {
        assert!(!bar.is_met(f64::NAN), "{bar:?}");
    }
}

#[test]
fn the_table_names_the_missed_bars() {
    let text = report().text();
    assert!(text.ends_with("1 of 2 bars missed: a, \"b\"\n"), "{text}");
    let rows: Vec<&str> = text
        .lines()
        .filter(|line| line.starts_with(['c', 'd']))
        .collect();
    assert!(
        rows[0].ends_with("<= 0  yes") && !rows[1].contains("NO"),
        "{text}"
    );
    assert!(!report().all_met());
}

#[test]
fn json_lines_carry_every_figure_and_then_a_summary() {
    let lines: Vec<Value> = report()
        .json()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 4);
    assert_eq!(
        (&lines[0]["max"], &lines[0]["bar"], &lines[0]["met"]),
        (&json!(2.0), &json!("<= 1"), &json!(false))
    );
    assert!(lines[2]["value"].is_null() && lines[2]["met"].is_null());
    assert_eq!(
        (&lines[3]["type"], &lines[3]["met"]),
        (&json!("summary"), &json!(false))
    );
}

#[test]
fn csv_has_one_header_for_all_groups() {
    let csv = report().csv();
    let lines: Vec<&str> = csv.split("\r\n").collect();
    assert_eq!(lines[0], "figure,n,value,unit,max,bar,met");
    assert_eq!(lines[1], "\"a, \"\"b\"\"\",3,1.25,mV,2,<= 1,NO");
    assert_eq!(lines[2], "c,1,0,,,<= 0,yes");
}

#[test]
fn a_chart_keeps_bars_inside_and_escapes_its_text() {
    let chart = Chart {
        title: "a < b".into(),
        unit: "%",
        from: 80.0,
        marks: vec![93.0],
        bars: vec![
            ("low".into(), Some(20.0)),
            ("top".into(), Some(100.0)),
            ("none".into(), None),
        ],
        ..Chart::default()
    };
    let svg = chart.svg();
    assert!(svg.contains("a &lt; b") && svg.ends_with("</svg>\n"));
    assert!(
        svg.contains("width=\"0.0\""),
        "a bar below the left end has no length: {svg}"
    );
    assert_eq!(svg.matches("fill=\"#4a7ba6\"").count(), 2);
}

#[test]
fn a_wide_span_of_values_gets_a_logarithmic_axis() {
    let bars = |greatest| {
        [
            ("a".to_owned(), Some(0.02)),
            ("b".to_owned(), Some(greatest)),
        ]
    };
    let chart = |greatest| Chart::new("t", "ms", vec![0.1], bars(greatest)).with_axis_of_its_span();
    assert!(!chart(0.5).is_logarithmic);
    let wide = chart(20.0);
    assert!(wide.is_logarithmic && wide.from == 0.01);
    // 0.02 lies log 2 / log 2200 = 9 % from the left end of an axis from 0.01 to 22.
    let width = 480.0 * 2.0_f64.ln() / 2200.0_f64.ln();
    assert!(wide.svg().contains(&format!("width=\"{width:.1}\"")));
}

#[test]
fn numbers_are_shown_to_five_digits() {
    let found = [0.0, 12.0, 5.50321, 0.0118249, 93.127, 123_456.7].map(shown);
    assert_eq!(found, ["0", "12", "5.5032", "0.011825", "93.127", "123457"]);
}
