//! Printing, export, rejudging and pruning of one lot of the simulated rig.

use crate::program::Workshop;

const LOT: &str = "run --sim --pace virtual --lot A --recipe jzc-22f-012 --count 6 --seed 1 --json";

#[test]
fn every_page_of_a_lot_exists_in_both_languages() {
    let workshop = Workshop::new("paper");
    workshop.run(LOT).with_status(0);
    for (language, not_tested) in [("zh", "绝缘电阻"), ("en", "insulation")] {
        for page in [
            "history report --lot A",
            "history report --lot A --part 2",
            "card --recipe jzc-22f-012",
        ] {
            let said = workshop
                .run(&format!("{page} --lang {language}"))
                .with_status(0);
            assert!(said.stdout.starts_with("<!DOCTYPE html>"), "{page}");
            assert!(said.stdout.contains(not_tested), "{page} {language}");
            let across = said.stdout.contains("class=\"simulation\"");
            assert_eq!(across, !page.starts_with("card"), "{page}");
        }
        let charts =
            format!("history spc --param operate_voltage_v --page --lang {language} --out c.html");
        workshop.run(&charts).with_status(0);
        let chart = workshop.read("c.html");
        assert!(chart.contains("<svg") && chart.contains("class=\"simulation\""));
    }
    let said = workshop.run("history report --lot B").with_status(2);
    assert!(said.stderr.contains("history list"), "{}", said.stderr);
}

#[test]
fn lots_compare_and_rejects_are_ranked() {
    let workshop = Workshop::new("compared");
    let lots = "history generate --parts 40000 --until 2026-01-01T00:00:00Z";
    workshop.run(lots).with_status(0);
    let compare = "history compare G1-00001 G1-00002 --param operate_voltage_v";
    let said = workshop.run(&format!("{compare} --json")).with_status(0);
    let compared = &said.objects()[0];
    let of = |lot: usize, key: &str| compared["lots"][lot][key].as_f64().unwrap();
    let [first, second] = [0, 1].map(|lot| of(lot, "sd").powi(2) / of(lot, "n"));
    let squared_t = (of(0, "mean") - of(1, "mean")).powi(2) / (first + second);
    let f = compared["means"]["f"].as_f64().unwrap();
    assert!((f / squared_t - 1.0).abs() < 1e-6, "{said}");
    assert_eq!(compared["spreads"]["df1"], 1.0, "{said}");
    let shares = compared["lots"][1]["shares"].as_array().unwrap();
    let all: f64 = shares.iter().map(|it| it.as_f64().unwrap()).sum();
    assert!((all - 1.0).abs() < 1e-9, "{said}");
    assert!(workshop.run(compare).stdout.contains("Welch"));
    workshop
        .run(&format!("{compare} --page --out compared.html"))
        .with_status(0);
    assert_eq!(
        workshop.read("compared.html").matches("<polyline").count(),
        2
    );
    let twice = compare.replace("G1-00002", "G1-00001");
    let said = workshop.run(&twice).with_status(2);
    assert!(
        said.stderr
            .ends_with("found \"G1-00001\" twice, expected different lots\n"),
        "{said}"
    );
    let nothing = compare.replace("G1-00002", "nothing");
    workshop.run(&nothing).with_status(2);
    let ranked = workshop.run("history pareto --json").with_status(0);
    let ranked = ranked.objects();
    assert!(ranked.len() > 1 && ranked[0]["n"].as_u64() >= ranked[1]["n"].as_u64());
    assert_eq!(ranked.last().unwrap()["cumulative"], 1.0);
    workshop
        .run("history pareto --alarms --since -8h")
        .with_status(0);
    workshop
        .run("history query --since tomorrow")
        .with_status(2);
}

#[test]
fn only_parts_that_did_not_pass_keep_curves() {
    let workshop = Workshop::new("curves");
    workshop.run(LOT).with_status(0);
    let passed_with =
        "SELECT count(*) FROM part WHERE verdict = 'pass' AND id IN (SELECT part_id FROM curve)";
    assert_eq!(workshop.count(passed_with), 0);
    let others = "SELECT count(*) FROM part WHERE verdict <> 'pass'";
    let with = "SELECT count(DISTINCT part_id) FROM curve";
    assert!(
        workshop.count(others) > 0,
        "reference parts are never judged"
    );
    assert_eq!(workshop.count(with), workshop.count(others));
    let most = "SELECT max(n) FROM (SELECT sum(length(packed)) AS n FROM curve GROUP BY part_id)";
    let bytes = workshop.count(most);
    assert!((100..12_000).contains(&bytes), "{bytes} bytes");
    let shown = workshop.run("history show A 1 --golden").with_status(0);
    for signal in ["board", "contact_drop", "gate_0", "supply_level"] {
        let curve = format!("curve {signal}, ");
        assert!(shown.stdout.contains(&curve), "{signal}: {shown}");
    }
}

#[test]
fn rejudging_leaves_old_verdicts_untouched() {
    let workshop = Workshop::new("rejudge");
    workshop.run(LOT).with_status(0);
    let before = workshop.texts("SELECT verdict || bin || reasons FROM part ORDER BY id");
    let same = workshop
        .run("history rejudge --lot A --recipe jzc-22f-012 --json")
        .with_status(0);
    for part in same.objects().iter().filter(|it| it["type"] == "part") {
        assert_eq!(part["verdict"], part["verdict_was"], "{part}");
    }
    workshop.change(
        "config/recipes/jzc-22f-012.toml",
        "operate_voltage_v = { high = 9.0 }",
        "operate_voltage_v = { high = 1.0 }",
    );
    let strict = workshop
        .run("history rejudge --lot A --recipe jzc-22f-012 --json")
        .with_status(0);
    let failed = strict
        .objects()
        .iter()
        .filter(|it| it["verdict"] == "fail")
        .count();
    assert_eq!(failed, 6, "{}", strict.stdout);
    assert_eq!(
        workshop.texts("SELECT verdict || bin || reasons FROM part ORDER BY id"),
        before
    );
}

#[test]
fn only_what_a_backup_holds_is_pruned() {
    let workshop = Workshop::new("prune");
    workshop
        .run("history generate --parts 20 --until 2020-01-01T00:00:00Z")
        .with_status(0);
    let parts = "SELECT count(*) FROM part";
    let prune = "history prune --older-than-days 30";
    workshop
        .run("history export --lot G1-00001 a.xlsx")
        .with_status(0);
    workshop.run(&format!("{prune} --yes")).with_status(0);
    assert_eq!(workshop.count(parts), 20, "the sheet lacks reference parts");
    workshop.run("history backup copy.db").with_status(0);
    workshop.run(prune).with_status(0);
    assert_eq!(workshop.count(parts), 20, "without --yes");
    workshop.run(&format!("{prune} --yes")).with_status(0);
    assert_eq!(workshop.count(parts), 0);
    let kept = workshop
        .run("--db copy.db history list --json")
        .with_status(0);
    assert_eq!(kept.objects()[0]["parts"], 20);
}

#[test]
fn a_gauge_study_feeds_the_same_parts_again() {
    let workshop = Workshop::new("grr");
    let study = "run --sim --study grr --lot G --recipe jzc-22f-012 --count 3 --json";
    let said = workshop.run(study).with_status(0);
    let operate = said
        .objects()
        .into_iter()
        .find(|it| it["param"] == "operate_voltage_v")
        .unwrap();
    let sd = |source: &str| operate["anova"][source].as_f64().unwrap();
    assert!(
        sd("repeatability") < 0.05 && sd("repeatability") > 0.0,
        "{operate}"
    );
    assert!(
        sd("part") > 2.0 * sd("grr"),
        "parts of a lot differ more than the gauge errs: {operate}"
    );
    assert_eq!(
        workshop.count("SELECT count(*) FROM part WHERE kind = 'lot'"),
        27
    );
}
