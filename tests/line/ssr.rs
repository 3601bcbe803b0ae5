//! Lots of solid-state relays on the simulated rig of their own configuration.

use crate::program::{Workshop, objects};
use serde_json::Value;

const RUN: &str = "--config config/rigs/ssr run --sim --recipe ssr-dc-60v-3a --json";

/// Returns the bin to which a part with this defect belongs.
fn bin_of(defect: &Value) -> &'static str {
    match defect.as_str() {
        None => "pass",
        Some("open_led" | "shorted_led" | "wrong_input_current" | "aged_led") => "input",
        Some("shorted_output" | "high_drop" | "thermal" | "stuck_on") => "output",
        Some("slow_turn_on" | "slow_turn_off") => "time",
        Some("leaky_junction") => "leakage",
        Some("turned" | "missing_pin") => "retest",
        Some(other) => panic!("unknown defect {other}"),
    }
}

#[test]
fn every_part_lands_in_the_bin_of_its_defect() {
    let workshop = Workshop::new("ssr-lot");
    let mut defects = 0;
    for seed in [1, 2] {
        let said = workshop.run(&format!(
            "{RUN} --lot S{seed} --count 110 --seed {seed} --truth t.jsonl"
        ));
        let said = said.with_status(0);
        let rows = objects(&said.stdout);
        let parts: Vec<&Value> = rows.iter().filter(|it| it["type"] == "part").collect();
        let truth = objects(&workshop.read("t.jsonl"));
        assert_eq!((parts.len(), truth.len()), (110, 110));
        for (part, true_part) in parts.iter().zip(&truth) {
            assert_eq!(part["seq"], true_part["seq"]);
            let bin = bin_of(&true_part["defect"]);
            defects += usize::from(bin != "pass");
            assert_eq!(part["bin"], bin, "{part}\n{true_part}");
            assert_eq!(true_part["landed_in"], bin, "{true_part}");
        }
    }
    assert!(defects >= 4, "only {defects} defects in the lots");
}

#[test]
fn a_lost_reply_makes_good_parts_void_never_failed() {
    let workshop = Workshop::new("ssr-lost-replies");
    let said = workshop.run(&format!(
        "{RUN} --lot A --count 30 --seed 3 --truth t.jsonl --fault reply_lost=0.005"
    ));
    let rows = objects(&said.stdout);
    let truth = objects(&workshop.read("t.jsonl"));
    let is_good = |part: &Value| {
        let own = truth.iter().find(|it| it["seq"] == part["seq"]);
        own.is_some_and(|it| it["defect"].is_null())
    };
    let good = rows.iter().filter(|it| it["type"] == "part" && is_good(it));
    let verdicts: Vec<&str> = good.map(|it| it["verdict"].as_str().unwrap()).collect();
    assert!(
        verdicts.contains(&"void") && verdicts.contains(&"pass"),
        "{said}"
    );
    assert!(!verdicts.contains(&"fail"), "{said}");
}
