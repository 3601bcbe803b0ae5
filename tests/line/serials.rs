//! Serial numbers of parts: counted, read by the simulated reader, found again.

use crate::program::{ATTEMPTS, Said, Workshop, objects};
use serde_json::Value;

const RUN: &str = "run --sim --seed 1 --recipe jzc-22f-012 --json";

/// Makes a plant whose lots take their serial numbers from `source`.
fn plant(name: &str, source: &str) -> Workshop {
    let workshop = Workshop::new(name);
    let lot = workshop.read("config/lot.toml");
    workshop.write(
        "config/lot.toml",
        &format!("{lot}[serial]\nsource = \"{source}\"\n"),
    );
    let rig = workshop.read("config/rig.toml");
    let reader = "[serial_reader]\nport = \"/dev/none\"\nbaud = 9600\nno_code = \"NOREAD\"\n";
    workshop.write("config/rig.toml", &format!("{rig}\n{reader}"));
    workshop
}

fn parts(said: &Said) -> Vec<Value> {
    let all = said.objects().into_iter();
    all.filter(|it| it["type"] == "part").collect()
}

#[test]
fn every_part_keeps_the_code_that_the_reader_saw() {
    let workshop = plant("serials_read", "reader");
    let faults = "--fault unreadable_code=3 --fault duplicate_code=5 --fault golden_every=50";
    let run = format!("{RUN} --lot A --count 8 --truth truth.jsonl {faults}");
    let parts = parts(&workshop.run(&run).with_status(0));
    let truth = objects(&workshop.read("truth.jsonl"));
    assert_eq!((parts.len(), truth.len()), (8, 8));
    for (part, truth) in parts.iter().zip(&truth) {
        let code = match part["seq"].as_u64() {
            Some(3) => "serial_missing",
            Some(5) => "serial_repeated",
            _ => {
                assert_eq!(part["serial"], truth["serial"], "{part}");
                assert_ne!(part["verdict"], "void", "{part}");
                continue;
            }
        };
        assert_eq!(part["reason_codes"][0]["code"], code, "{part}");
        assert_eq!(
            (&part["verdict"], &part["bin"]),
            (&"void".into(), &"retest".into())
        );
        assert_eq!(truth["landed_in"], "retest", "{truth}");
    }
    assert_eq!(truth[3]["serial"], truth[4]["serial"]);
    let serial = truth[7]["serial"].as_str().unwrap();
    let shown = workshop.run(&format!("history part --serial {serial} --json"));
    assert_eq!(shown.with_status(0).objects()[0]["seq"], 8);
    let queried = workshop.run(&format!("history query --serial {serial} --format csv"));
    assert!(
        queried
            .with_status(0)
            .stdout
            .contains(&format!(",{serial},"))
    );
    let paper = workshop
        .run("history report --lot A --part 8")
        .with_status(0);
    assert!(paper.stdout.contains("class=\"symbol\"") && paper.stdout.contains(serial));
}

#[test]
fn a_lot_goes_on_counting_in_its_next_run() {
    let workshop = plant("serials_counted", "counted");
    let mut numbers = Vec::new();
    for more in ["", "--retest li"] {
        let run = workshop.run(&format!("{RUN} --lot A --count 2 {more}"));
        numbers.extend(
            parts(&run.with_status(0))
                .iter()
                .map(|it| it["serial"].clone()),
        );
    }
    assert_eq!(numbers, ["A-000001", "A-000002", "A-000003", "A-000004"]);
}

#[test]
fn a_reader_at_real_pace_gives_the_numbers() {
    let run = format!("{RUN} --pace real --lot A --count 2 --truth truth.jsonl");
    let mut workshop = plant("serials_real", "reader");
    let mut said = workshop.run(&run);
    for _ in 1..ATTEMPTS {
        if said.ended_late() {
            workshop = plant("serials_real", "reader");
            said = workshop.run(&run);
        }
    }
    let parts = parts(&said.with_status(0));
    let truth = objects(&workshop.read("truth.jsonl"));
    let serials = |rows: &[Value]| {
        let all = rows.iter().map(|it| it["serial"].as_str());
        all.map(|it| it.unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(serials(&parts).len(), 2);
    assert_eq!(serials(&parts), serials(&truth));
}

#[test]
fn a_lot_of_scanned_parts_needs_the_page() {
    let workshop = plant("serials_wedge", "wedge");
    let said = workshop
        .run(&format!("{RUN} --lot A --count 1"))
        .with_status(2);
    assert!(said.stderr.contains("relayrig serve"), "{said}");
    let rig = workshop.read("config/rig.toml");
    let (without, _) = rig
        .split_once("[serial_reader]\nport = \"/dev/none\"")
        .unwrap();
    workshop.write("config/rig.toml", without);
    workshop.change(
        "config/lot.toml",
        "source = \"wedge\"",
        "source = \"reader\"",
    );
    let said = workshop.run("config check").with_status(2);
    assert!(
        said.stderr.contains("[serial].source: found \"reader\""),
        "{said}"
    );
}
