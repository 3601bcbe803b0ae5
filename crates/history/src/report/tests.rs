//! Tests of the printable pages.
#![allow(clippy::unwrap_used)]

use super::card::card;
use super::certificate::certificate;
use super::comparison::comparison;
use super::lot::{LotReport, ParameterValues};
use super::spc::{NamedChart, spc};
use super::*;
use crate::inquiry::comparison::{ComparedLot, Comparison};
use crate::inquiry::pareto::{Ranked, Rejects};
use crate::{
    Alarm, AlarmState, Batch, BatchAir, BatchSocket, LotSummary, LotYield, Measurement, Part,
    PromptAnswer, Reopening, Shelf, Yield,
};
use crate::{ExternalResult, ExternalStanding};
use config::{Folder, load_recipe};
use machine::dut::card::{CardSettings, Quota, STEPS};
use machine::dut::{Reason, Recipe};
use quality::chart::{individuals, shares};
use quality::equality::Equality;
use quality::rules::Rules;
use quality::{Limits, Summary};

const LANGUAGES: [Lang; 2] = [Lang::En, Lang::Zh];
/// Text that an operator might type to inject a script.
const EVIL: &str = "</td><script>alert('批次')</script>";

fn paper(language: Lang) -> Paper {
    Paper {
        language,
        zone: TimeZone::UTC,
        made: "2026-03-01 08:00 relayrig".into(),
        simulated: false,
    }
}

/// A lot without results from outside of the rig.
const NO_RESULTS: (&[ExternalResult], Option<&ExternalStanding>) = (&[], None);

fn run() -> LotSummary {
    LotSummary {
        lot: EVIL.into(),
        rig: None,
        run: 1,
        recipe: "jzc-22f-012".into(),
        recipe_hash: "738012c9fcaf4919aa".into(),
        calibration_hash: None,
        source: "simulated".into(),
        seed: None,
        retest: None,
        ended: None,
        cause: None,
        cause_text: None,
        opened: Moment(0),
        closed: Some(Moment(60_000_000)),
        counts: Yield {
            parts: 3,
            pass: 2,
            fail: 1,
            ..Yield::default()
        },
        golden: 0,
        alarms: 1,
        external: None,
        bins: [("pass".to_owned(), 2), ("voltage".to_owned(), 1)].into(),
    }
}

fn part(verdict: &str) -> Part {
    let measurement = |attempt, value| Measurement {
        parameter: "operate_voltage_v".into(),
        attempt,
        value: Some(value),
        uncertainty: Some(0.010_871),
        low: None,
        high: Some(9.0),
        verdict: verdict.into(),
        budget: None,
        samples: Vec::new(),
    };
    let mut part = Part::fixture(EVIL, 7, verdict);
    part.measurements = vec![measurement(1, 8.123_456), measurement(2, 7.704_22)];
    part.values
        .insert("operate_voltage_v".into(), 7.704_22.into());
    part.serial = Some("=1+1".into());
    part
}

fn lot_report(language: Lang) -> String {
    lot_report_on(&paper(language))
}

fn lot_report_on(paper: &Paper) -> String {
    let alarms = [Alarm {
        lot: Some(EVIL.into()),
        run: Some(1),
        code: "late".into(),
        line: None,
        text: EVIL.into(),
        args: Default::default(),
        text_zh: None,
        cause_zh: None,
        raised: Moment(5_000_000),
        cleared: Some(Moment(65_000_000)),
        acknowledged: Some(Moment(6_000_000)),
        acknowledged_by: Some(EVIL.into()),
        shelf: Some(Shelf {
            until: Moment(7_000_000),
            by: EVIL.into(),
            reason: EVIL.into(),
        }),
        state: AlarmState::Normal,
    }];
    let values = ParameterValues {
        key: "operate_voltage_v".into(),
        limits: Limits {
            low: None,
            high: Some(9.0),
        },
        values: vec![7.7, 7.8, 7.9, 7.6, 7.8],
    };
    let report = LotReport {
        lot: EVIL,
        runs: &[run()],
        reopenings: &[Reopening {
            at: Moment(90_000_000),
            who: "zhao".into(),
            why: EVIL.into(),
        }],
        counts: LotYield {
            parts: 3,
            first_pass: 1,
            retest_pass: 1,
            suspect: 0,
        },
        parameters: vec![values],
        effectiveness: None,
        batches: &[some_batch()],
        rejects: some_rejects(),
        external: &[],
        standing: None,
        alarms: &alarms,
        answers: &[PromptAnswer {
            at: Moment(1_000_000),
            run: Some(1),
            prompt: "nest".into(),
            choice: "changed".into(),
            who: EVIL.into(),
        }],
    };
    report.html(paper)
}

/// A batch of two sockets: part 7 switches twice, part 8 once.
fn some_batch() -> Batch {
    let socket = |socket, seq, opened_s: &[f64], closed_s: &[f64]| BatchSocket {
        socket,
        seq: Some(seq),
        opened_s: opened_s.into(),
        closed_s: closed_s.into(),
    };
    Batch {
        lot: EVIL.into(),
        run: 1,
        number: 2,
        begin: Moment(0),
        ended: Moment(120_000_000),
        curve: BatchAir {
            t_s: vec![0.0, 60.0, 120.0],
            set_c: vec![None, Some(60.0), Some(80.0)],
            reference_c: vec![Some(40.0), Some(59.5), Some(79.5)],
            rate_k_per_min: vec![None, Some(19.5), Some(20.0)],
        },
        switched: vec![socket(1, 7, &[61.0], &[119.0]), socket(2, 8, &[100.0], &[])],
    }
}

#[test]
fn papers_of_a_batch_draw_its_curve_and_switchings() {
    let marks = |page: &str| page.matches("stroke=\"#a11212\"/>").count();
    for language in LANGUAGES {
        let own = Part {
            seq: 7,
            ..part("pass")
        };
        let bare = certificate(&paper(language), &own, &run(), None, NO_RESULTS);
        let page = certificate(
            &paper(language),
            &own,
            &run(),
            Some(&some_batch()),
            NO_RESULTS,
        );
        assert_eq!(marks(&page), marks(&bare) + 2);
        assert!(page.contains("20 min") == bare.contains("20 min") && page.contains("K/min"));
        let words = language.text("paper-batch_note");
        assert!(page.contains(words) && lot_report(language).contains(words));
        assert!(!bare.contains(words));
    }
}

fn some_rejects() -> Rejects {
    let why = ["operate_voltage_v high", "coil open"].map(Reason::from_text);
    Rejects {
        reasons: vec![Ranked {
            en: EVIL.into(),
            zh: EVIL.into(),
            n: 2,
            cumulative: 1.0,
            active_s: None,
        }],
        rejects: 3,
        parts: 8,
        first: vec![part("fail").with_reasons(why.into())],
    }
}

#[test]
fn a_lot_report_ranks_reasons_and_lists_rejects() {
    for (language, words) in [
        (
            Lang::En,
            [
                "2 · 25.00 %",
                "above the upper limit: 7.7042",
                "2 more rejects",
            ],
        ),
        (Lang::Zh, ["2 · 25.00 %", "超出上限：7.7042", "另有 2 件"]),
    ] {
        let page = lot_report(language);
        for word in words {
            assert!(page.contains(word), "{word}: {page}");
        }
    }
}

#[test]
fn a_comparison_draws_every_lot() {
    let lot = |shares: [f64; 2]| ComparedLot {
        lot: EVIL.into(),
        limits: Limits::default(),
        summary: Summary::of("operate_voltage_v", &[7.1, 7.3], Limits::default()),
        shares: shares.into(),
    };
    let test = Equality {
        f: 4.2,
        df1: 1.0,
        df2: 9.0,
        p: 0.07,
    };
    let compared = Comparison {
        param: "operate_voltage_v".into(),
        lots: vec![lot([0.5, 0.5]), lot([0.25, 0.75])],
        means: Some(test),
        spreads: None,
        from: Some(7.0),
        width: Some(0.2),
    };
    let page = comparison(&paper(Lang::En), &compared);
    assert_eq!(page.matches("<polyline").count(), 2);
    assert!(page.contains("0.0700") && page.contains("no difference shown"));
    assert!(!page.contains("<script"));
}

#[test]
fn typed_text_stays_text_on_every_page() {
    let [chart, _] = individuals(&[1.0, 2.0, 3.0], Rules::Nelson).unwrap();
    let names = [EVIL.to_owned(), EVIL.to_owned(), EVIL.to_owned()];
    let named = NamedChart {
        of: EVIL,
        chart: &chart,
        names: &names,
    };
    for language in LANGUAGES {
        let paper = paper(language);
        for page in [
            lot_report(language),
            certificate(&paper, &part("pass"), &run(), None, NO_RESULTS),
            spc(&paper, EVIL, std::slice::from_ref(&named), 3),
        ] {
            assert!(page.contains("&lt;script&gt;") && !page.contains("<script"));
        }
    }
}

#[test]
fn every_page_of_a_good_part_names_untested_properties() {
    for (language, words) in [
        (Lang::En, ["insulation", "dielectric", "endurance"]),
        (Lang::Zh, ["绝缘电阻", "介质耐压", "寿命"]),
    ] {
        let pages = [
            lot_report(language),
            certificate(&paper(language), &part("pass"), &run(), None, NO_RESULTS),
            process_card(language),
        ];
        for page in pages {
            assert!(words.iter().all(|word| page.contains(word)));
        }
    }
}

#[test]
fn a_failed_part_gets_a_record_not_a_certificate() {
    let good = certificate(&paper(Lang::En), &part("pass"), &run(), None, NO_RESULTS);
    assert!(good.contains("<h1>Test certificate</h1>"));
    let bad = certificate(&paper(Lang::En), &part("fail"), &run(), None, NO_RESULTS);
    assert!(bad.contains("<h1>Test record</h1>") && !bad.contains("certificate"));
}

#[test]
fn a_record_gives_reasons_in_its_language() {
    let why = ["operate_voltage_v high", "coil open"].map(Reason::from_text);
    let failed = part("fail").with_reasons(why.into());
    for (language, words) in [
        (
            Lang::En,
            ["Operate voltage / V: above the upper limit", "coil open"],
        ),
        (Lang::Zh, ["动作电压 / V：超出上限", "线圈开路"]),
    ] {
        let page = certificate(&paper(language), &failed, &run(), None, NO_RESULTS);
        assert!(words.iter().all(|it| page.contains(it)), "{page}");
    }
}

#[test]
fn a_bin_chart_names_bin_and_omitted_points() {
    let chart = shares(&[(100, 3), (100, 5), (100, 4)]).unwrap();
    let named = NamedChart {
        of: "coil",
        chart: &chart,
        names: &[],
    };
    let page = spc(&paper(Lang::Zh), "", &[named], 2);
    assert!(
        page.contains("料箱：线圈不良箱 – 占比图（p），共 3 点，图示最后 2 点"),
        "{page}"
    );
}

#[test]
fn a_certificate_rounds_the_last_attempt_by_its_uncertainty() {
    let page = certificate(&paper(Lang::En), &part("pass"), &run(), None, NO_RESULTS);
    assert!(
        page.contains(">7.704<") && page.contains(">0.011<"),
        "{page}"
    );
    assert!(!page.contains("8.123"));
}

#[test]
fn a_simulated_lot_says_so() {
    assert!(lot_report(Lang::En).contains("SIMULATED RIG"));
    assert!(lot_report(Lang::Zh).contains("仿真测试机"));
}

#[test]
fn paper_of_simulated_parts_says_simulation_across_it() {
    let [chart, _] = individuals(&[1.0, 2.0, 3.0], Rules::Nelson).unwrap();
    let named = [NamedChart {
        of: "coil",
        chart: &chart,
        names: &[],
    }];
    for (language, word) in [(Lang::En, ">SIMULATION<"), (Lang::Zh, ">仿真<")] {
        for simulated in [false, true] {
            let paper = Paper {
                simulated,
                ..paper(language)
            };
            for page in [
                lot_report_on(&paper),
                certificate(&paper, &part("pass"), &run(), None, NO_RESULTS),
                spc(&paper, "", &named, 3),
                alarms::list(&paper, "", &[]),
            ] {
                assert_eq!(page.contains(word), simulated, "{page}");
            }
        }
    }
}

#[test]
fn a_lot_report_shows_name_and_reason_of_reopening() {
    let page = lot_report(Lang::En);
    let words = "1970-01-01 00:01:30 +00:00 by zhao: &lt;/td&gt;";
    assert!(page.contains(words), "{page}");
}

#[test]
fn a_lot_report_shows_who_answered_which_prompt() {
    for (language, title) in [(Lang::En, "Answers to prompts"), (Lang::Zh, "提示的答复")] {
        let page = lot_report(language);
        let (_, answers) = page.split_once(title).unwrap();
        let row = "<td>1970-01-01 00:00:01 +00:00</td><td class=\"n\">1</td><td class=\"text\">nest</td>\
                   <td class=\"text\">changed</td><td class=\"text\">&lt;/td&gt;";
        assert!(answers.contains(row), "{answers}");
    }
}

#[test]
fn a_lot_report_has_both_yields_and_alarm_times() {
    let page = lot_report(Lang::En);
    assert!(page.contains("33.33 %") && page.contains("66.67 %"));
    assert!(page.contains("0:01:00"));
}

fn recipe() -> Recipe {
    load_recipe(&Folder::built_in(), "jzc-22f-012").unwrap()
}

fn process_card(language: Lang) -> String {
    let quota = Quota {
        machine_s: 0.25,
        auxiliary_s: 0.125,
    };
    let plant = CardSettings {
        workshop: "W7".into(),
        operation_no: "40".into(),
        equipment_model: "relayrig".into(),
        equipment_no: "E-1".into(),
        fixture_no: "F-1".into(),
        pieces_at_once: 1,
        preparation_min: 15.0,
        quota: STEPS.iter().map(|it| ((*it).to_owned(), quota)).collect(),
    };
    card(&paper(language), &recipe(), &plant)
}

#[test]
fn a_process_card_has_steps_limits_and_total_time() {
    for language in LANGUAGES {
        let page = process_card(language);
        let rows = page.matches("<td>0.25</td>").count();
        assert_eq!(rows, STEPS.len());
        assert!(page.contains("3.75"), "ten steps of 0.375 s");
        for demand in ["≤ 9", "≥ 1.2", "360 … 440", "≤ 100"] {
            assert!(page.contains(demand), "{demand}");
        }
    }
}

#[test]
fn every_card_step_has_its_quota_by_name() {
    let steps = recipe().device.card().steps;
    assert!(steps.iter().map(|it| it.name).eq(STEPS.iter().copied()));
}

#[test]
fn a_control_chart_numbers_signals_among_the_last_points() {
    let values: Vec<f64> = (0..50).map(|n| f64::from(n % 3)).chain([40.0]).collect();
    let [chart, _] = individuals(&values, Rules::Nelson).unwrap();
    let svg = super::charts::control(&chart, 10, &[]);
    assert_eq!(svg.matches("<circle").count(), 10);
    assert!(svg.contains("r=\"3.6\"") && svg.contains(">1</text>"));
}

#[test]
fn every_alarm_state_has_a_word_in_both_languages() {
    let states = [
        (AlarmState::Unacknowledged, "unacknowledged", "未确认"),
        (AlarmState::Acknowledged, "acknowledged", "已确认"),
        (
            AlarmState::ReturnedUnacknowledged,
            "returned, unacknowledged",
            "已恢复，未确认",
        ),
        (AlarmState::Normal, "normal", "已恢复"),
    ];
    for (state, en, zh) in states {
        let alarm = Alarm {
            lot: None,
            run: None,
            code: "late".into(),
            line: None,
            text: "late".into(),
            args: Default::default(),
            text_zh: None,
            cause_zh: None,
            raised: Moment(0),
            cleared: None,
            acknowledged: None,
            acknowledged_by: None,
            shelf: None,
            state,
        };
        for (language, word) in [(Lang::En, en), (Lang::Zh, zh)] {
            let page = alarms::list(&paper(language), "", std::slice::from_ref(&alarm));
            assert!(page.contains(&format!(">{word}<")), "{word}: {page}");
        }
    }
}
