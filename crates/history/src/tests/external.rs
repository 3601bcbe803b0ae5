//! Tests: results that are measured outside of the rig.

use super::*;
use crate::inquiry::{export, paper};
use crate::report::{Lang, Paper, parameter};
use calamine::{Reader, Xlsx};
use jiff::tz::TimeZone;
use machine::dut::External;
use std::io::Cursor;

const RECIPE: &str = "name = \"ssr\"\n[external]\ndv_dt_v_us = { low = 500 }\nr_iso_ohm = { low = 1e9 }\n\
    [decision]\nrule = \"guard_band\"\nslow_repeats = 3\n";
/// Time of every entry.
const NOW: Moment = Moment(1_000_000_000);

/// Returns a history with lot A of two runs: parts 1 and 2 with serial numbers in the first, 1 to 3 without in the second.
fn history() -> File {
    let file = File::new();
    let mut store = file.store();
    let record = LotRecord {
        recipe: "ssr".into(),
        recipe_snapshot: RECIPE.into(),
        recipe_hash: snapshot_hash(RECIPE),
        ..lot("A")
    };
    for (run, count) in [(1, 2), (2, 3)] {
        store.begin_lot(&record).unwrap();
        let serial = |seq| (run == 1).then(|| format!("A-{seq}"));
        let part = |seq| PartRecord {
            serial: serial(seq),
            ..part("A", seq, "pass", 7.0)
        };
        let rows: Vec<Row> = (1..=count).map(|seq| Row::Part(part(seq))).collect();
        store.record(&rows).unwrap();
        store.close_lot("A", 9_000_000).unwrap();
    }
    store.begin_lot(&lot("without")).unwrap();
    file
}

/// Enters the lines of a file with this header into lot A.
fn enter(file: &File, header: &str, lines: &str) -> std::result::Result<Entered, ResultRefusal> {
    let text = format!("{header}\n{lines}\n");
    let results = parse_results(&csv::read(&text)?)?;
    let entered = file.store().enter_results(&EnteredResults {
        lot: "A",
        recipe: Some("ssr"),
        who: "zhao",
        at: NOW,
        file_hash: Some(&snapshot_hash(&text)),
        results: &results,
    });
    entered.unwrap()
}

fn standing(file: &File) -> ExternalStanding {
    file.archive().external_standing("A").unwrap().unwrap()
}

#[test]
fn a_bad_line_enters_no_result() {
    let head = "serial,key,value,u,at";
    let whole = "serial,run,seq,key,value,unit,u,at";
    for (header, bad, said) in [
        (
            "serial,keys,value",
            "",
            "line 1, column header: found \"keys\", expected \"serial\", ",
        ),
        (
            "key,value,key",
            "",
            "line 1, column header: found \"key\", expected each column once",
        ),
        (
            "serial,key",
            "",
            "line 1, column value: found nothing, expected this column",
        ),
        (
            head,
            "A-1,iso,1,1,",
            "line 3, column key: found \"iso\", expected \"dv_dt_v_us\", ",
        ),
        (
            head,
            "A-1,,1,1,",
            "line 3, column key: found nothing, expected \"dv_dt_v_us\", ",
        ),
        (
            head,
            "A-1,dwv_ua,1,1,",
            "line 3, column key: found \"dwv_ua\", expected a key of [external] of ssr: ",
        ),
        (
            head,
            "A-1,r_iso_ohm,4.2e10x,1,",
            "line 3, column value: found \"4.2e10x\", expected a finite number",
        ),
        (
            head,
            "A-1,r_iso_ohm,inf,1,",
            "line 3, column value: found \"inf\", expected a finite number",
        ),
        (
            head,
            "A-1,r_iso_ohm,,1,",
            "line 3, column value: found nothing, expected a finite number",
        ),
        (
            head,
            "A-1,r_iso_ohm,-5,1,",
            "line 3, column value: found \"-5\", expected a number of ohm above 0 up to ",
        ),
        (
            head,
            "A-1,dv_dt_v_us,2e5,1,",
            "line 3, column value: found \"200000\", expected a number of V/us above 0 ",
        ),
        (
            head,
            "A-1,r_iso_ohm,2e9,,",
            "line 3, column u: found nothing, expected an expanded uncertainty (k = 2), ",
        ),
        (
            head,
            "A-1,r_iso_ohm,2e9,0,",
            "line 3, column u: found \"0\", expected an expanded uncertainty (k = 2) of ohm ",
        ),
        (
            head,
            "A-1,r_iso_ohm,2e9,-1,",
            "line 3, column u: found \"-1\", expected an expanded uncertainty (k = 2) of ohm ",
        ),
        (
            head,
            "A-9,r_iso_ohm,2e9,1,",
            "line 3, column serial: found \"A-9\", expected the serial number of a part of ",
        ),
        (
            head,
            "A-1,r_iso_ohm,2e9,1,soon",
            "line 3, column at: found \"soon\", expected a time as ",
        ),
        (
            head,
            "A-1,r_iso_ohm,2e9,1,2999-01-01",
            "line 3, column at: found \"2999-",
        ),
        (
            head,
            "A-1,r_iso_ohm",
            "line 3: found 2 fields, expected 5 as in the header",
        ),
        (
            head,
            "A-2,r_iso_ohm,5e8,1e7,",
            "line 3, column key: found \"r_iso_ohm\", expected each quantity of a sample once in a file",
        ),
        (
            whole,
            "A-1,,1,r_iso_ohm,2e9,,1,",
            "line 3, column seq: found \"1\", expected nothing beside a serial number",
        ),
        (
            whole,
            "A-1,1,,r_iso_ohm,2e9,,1,",
            "line 3, column run: found \"1\", expected nothing without seq",
        ),
        (
            whole,
            ",,1,r_iso_ohm,2e9,,1,",
            "line 3, column run: found nothing, expected one of the runs with part 1: 1, 2",
        ),
        (
            whole,
            ",2,4,r_iso_ohm,2e9,,1,",
            "line 3, column seq: found \"4\", expected the number of a part of the lot",
        ),
        (
            whole,
            ",2,x,r_iso_ohm,2e9,,1,",
            "line 3, column seq: found \"x\", expected a whole number",
        ),
        (
            whole,
            ",2,1,r_iso_ohm,2e9,Mohm,1,",
            "line 3, column unit: found \"Mohm\", expected \"ohm\"",
        ),
    ] {
        let file = history();
        let good = match header.matches(',').count() {
            7 => ",2,3,r_iso_ohm,4.2e10,ohm,4e9,1970-01-01T00:10:00Z",
            4 => "A-2,r_iso_ohm,4.2e10,4e9,",
            _ => "",
        };
        let refused = enter(&file, header, &format!("{good}\n{bad}"))
            .unwrap_err()
            .to_string();
        assert!(refused.starts_with(said), "{bad}: {refused}");
        assert!(
            file.archive().external_results("A").unwrap().is_empty(),
            "{bad}"
        );
    }
}

#[test]
fn lots_that_take_no_result_say_why() {
    let file = history();
    let result = NewResult {
        line: None,
        sample: ExternalSample::Lot,
        key: External::IsolationResistance,
        value: 4e10,
        u: Some(4e9),
        measured_at: None,
    };
    for (lot, recipe, said) in [
        ("B", None, "lot: found \"B\", expected a lot that was run"),
        (
            "without",
            None,
            "recipe: found \"jzc-22f-012\", expected a lot whose recipe has [external]",
        ),
        (
            "A",
            Some("ssr-2"),
            "recipe: found \"ssr-2\", expected \"ssr\", with which lot \"A\" was run",
        ),
    ] {
        let entered = file.store().enter_results(&EnteredResults {
            lot,
            recipe,
            who: "zhao",
            at: NOW,
            file_hash: None,
            results: std::slice::from_ref(&result),
        });
        assert_eq!(entered.unwrap().unwrap_err().to_string(), said);
    }
    assert_eq!(file.archive().external_standing("without").unwrap(), None);
}

#[test]
fn a_file_imported_again_changes_nothing() {
    let file = history();
    let (header, lines) = (
        "serial,key,value,u",
        "A-1,r_iso_ohm,4.2e10,4e9\nA-2,r_iso_ohm,3e10,4e9",
    );
    assert_eq!(enter(&file, header, lines).unwrap().pass, 2);
    let refused = enter(&file, header, lines).unwrap_err();
    let expected = ResultRefusal::Again {
        lot: "A".into(),
        results: 2,
    };
    assert_eq!(refused, expected);
    assert_eq!(file.archive().external_results("A").unwrap().len(), 2);
}

#[test]
fn a_correction_supersedes_and_no_row_changes() {
    let file = history();
    let header = "run,seq,serial,key,value,u";
    enter(
        &file,
        header,
        ",,A-1,r_iso_ohm,5e8,1e7\n2,1,,r_iso_ohm,5e8,1e7",
    )
    .unwrap();
    // Part 1 of run 1 is A-1; part 1 of run 2 has no serial number.
    enter(&file, header, "1,1,,r_iso_ohm,4e10,4e9").unwrap();
    let results = file.archive().external_results("A").unwrap();
    let shown: Vec<_> = results
        .iter()
        .map(|it| (it.sample().unwrap(), it.verdict.name(), it.superseded))
        .collect();
    let row = |sample: &str, verdict, superseded| (sample.to_owned(), verdict, superseded);
    let expected = [
        row("A-1", "fail", true),
        row("2 / 1", "fail", false),
        row("A-1", "pass", false),
    ];
    assert_eq!(shown, expected);
    let by_hand = file.by_hand();
    for change in [
        "UPDATE external_result SET verdict = 'pass'",
        "DELETE FROM external_result",
    ] {
        let refused = by_hand.execute_batch(change).unwrap_err().to_string();
        assert!(refused.contains("enter another one"), "{refused}");
    }
    let view = "SELECT group_concat(superseded) FROM (SELECT superseded FROM external_results ORDER BY entered, line)";
    let superseded: String = by_hand.query_row(view, [], |row| row.get(0)).unwrap();
    assert_eq!(superseded.matches('1').count(), 1);
}

#[test]
fn a_lot_needs_every_demanded_result_to_pass() {
    let file = history();
    assert_eq!(standing(&file).missing, ["dv_dt_v_us", "r_iso_ohm"]);
    let header = "serial,key,value,u";
    for (line, acceptable, fail, undecided, missing) in [
        ("A-1,r_iso_ohm,4e10,4e9", false, 0, 0, 1),
        ("A-1,dv_dt_v_us,505,20", false, 0, 1, 0),
        ("A-1,dv_dt_v_us,300,20", false, 1, 0, 0),
        ("A-1,dv_dt_v_us,900,20", true, 0, 0, 0),
        (",dv_dt_v_us,510,20", false, 0, 1, 0),
    ] {
        enter(&file, header, line).unwrap();
        let found = standing(&file);
        let shown = (
            found.acceptable,
            found.fail,
            found.undecided,
            found.missing.len(),
        );
        assert_eq!(shown, (acceptable, fail, undecided, missing), "{line}");
        assert_eq!(
            file.archive().lots(&Filter::default()).unwrap()[0].external,
            Some(found)
        );
    }
}

#[test]
fn an_export_carries_results_and_can_be_imported() {
    let file = history();
    enter(
        &file,
        "serial,key,value,u",
        "A-1,r_iso_ohm,4e10,4e9\nA-2,dv_dt_v_us,300,20",
    )
    .unwrap();
    let of_lot = Filter {
        lot: Some("A".into()),
        ..Filter::default()
    };
    let mut out = Vec::new();
    let archive = file.archive();
    let parameters = archive.parameters().unwrap();
    export::csv_lines(&archive, &of_lot, &parameters, &mut out).unwrap();
    let records = csv::read(std::str::from_utf8(&out).unwrap()).unwrap();
    let names = [
        "dv_dt_v_us",
        "uncertainty dv_dt_v_us",
        "verdict dv_dt_v_us",
        "r_iso_ohm",
        "uncertainty r_iso_ohm",
        "verdict r_iso_ohm",
    ];
    assert!(records[0].fields.ends_with(&names.map(str::to_owned)));
    assert!(
        records[1]
            .fields
            .ends_with(&["", "", "", "40000000000", "4000000000", "pass"].map(str::to_owned))
    );
    assert!(
        records[2]
            .fields
            .ends_with(&["300", "20", "fail", "", "", ""].map(str::to_owned))
    );
    assert_eq!(parse_records(&records, &[], &parameters).unwrap().len(), 5);
    let paper = Paper {
        language: Lang::En,
        zone: TimeZone::UTC,
        made: String::new(),
        simulated: false,
    };
    let made = export::spreadsheet(&archive, &of_lot, &parameters, &paper, || {});
    let bytes = made.unwrap().save_to_buffer().unwrap();
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).unwrap();
    let parts = book.worksheet_range("Parts").unwrap();
    let ends = |row: u32| -> Vec<String> {
        let cells = (parts.width() as u32 - 6..).map_while(|it| parts.get_value((row, it)));
        cells.map(ToString::to_string).collect()
    };
    let [dv_dt, r_iso] = ["dv_dt_v_us", "r_iso_ohm"].map(|it| parameter(Lang::En, it));
    let header =
        [&dv_dt, &r_iso].map(|it| [it.clone(), format!("U {it}"), format!("Verdict: {it}")]);
    assert_eq!(ends(0), header.concat());
    assert_eq!(ends(1), ["", "", "", "40000000000", "4000000000", "pass"]);
    assert_eq!(ends(2), ["300", "20", "fail", "", "", ""]);
}

#[test]
fn papers_say_that_a_lot_is_not_acceptable() {
    let file = history();
    let of_lot = Filter {
        lot: Some("A".into()),
        run: Some(1),
        ..Filter::default()
    };
    let printed = |language| {
        let (archive, paper) = (file.archive(), paper::paper(language));
        let certificate = paper::part_certificate(&archive, &of_lot, 1, &paper).unwrap();
        [
            paper::lot_report(&archive, &of_lot, None, &paper).unwrap(),
            certificate,
        ]
    };
    enter(
        &file,
        "serial,key,value,u",
        "A-1,r_iso_ohm,4e10,4e9\nA-2,dv_dt_v_us,300,20",
    )
    .unwrap();
    for page in printed(Lang::En) {
        assert!(
            page.contains("NOT ACCEPTABLE (1 failed, 0 undecided, missing: –)"),
            "{page}"
        );
        assert!(
            page.contains("Isolation resistance / Ω") && page.contains("Not tested by the rig")
        );
    }
    let [report, record] = printed(Lang::En);
    assert!(report.contains("Static dv/dt / V/µs") && !record.contains("Static dv/dt / V/µs"));
    assert!(
        record.contains("Test record")
            && printed(Lang::Zh).iter().all(|it| it.contains("不可接收"))
    );
    enter(&file, "serial,key,value,u", "A-2,dv_dt_v_us,900,20").unwrap();
    let [report, certificate] = printed(Lang::En);
    assert!(report.contains("superseded") && certificate.contains("Test certificate"));
}
