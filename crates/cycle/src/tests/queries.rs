//! Queries of a measuring job.

use super::*;
use machine::instrument::conversion::Conversion;
use machine::station::catalogue::AlarmCode;
use texts::Lang;

fn meters() -> [Meter; 2] {
    ["meter", "source"].map(Meter::new)
}

#[test]
fn a_job_delivers_the_numbers_of_each_query() {
    in_virtual_time(meters(), async |mut bench| {
        let level = Query {
            arguments: vec![("level_v", 2.5)],
            ..bench.query("source", "level")
        };
        let queries = vec![
            bench.query("meter", "value"),
            level,
            bench.query("meter", "value"),
        ];
        let done = bench.job(queries).await;
        assert_eq!(done.trouble, None);
        let numbers: Vec<_> = done.delivered.iter().map(|it| it.numbers.clone()).collect();
        assert_eq!(numbers, [[1.0], [2.5], [2.0]]);
        assert_eq!(done.at, bench.pace.now());
    });
}

#[test]
fn programs_of_two_instruments_run_at_the_same_time() {
    in_virtual_time(meters(), async |mut bench| {
        let both = |bench: &Bench, program| ["meter", "source"].map(|it| bench.query(it, program));
        bench.job(both(&bench, "value").into()).await;
        let began = bench.pace.now();
        let done = bench.job(both(&bench, "slow").into()).await;
        assert_eq!(done.trouble, None);
        let took = done.at.since(began);
        assert!((Span::ms(1000)..Span::ms(1200)).contains(&took), "{took:?}");
    });
}

#[test]
fn a_silent_instrument_leaves_a_job_without_values() {
    in_virtual_time(meters(), async |mut bench| {
        bench.job(vec![bench.query("meter", "value")]).await;
        let done = bench.job(vec![bench.query("meter", "hang")]).await;
        assert!(done.delivered.is_empty());
        let trouble = done.trouble.unwrap();
        assert_eq!(
            trouble.say(Lang::En),
            "meter, program hang: HANG?: no reply within 200 ms."
        );
        assert!(trouble.say(Lang::Zh).contains("meter"));
        assert!(bench.cycle.bus_alarms.is_empty(), "one failure is no alarm");
        let done = bench.job(vec![bench.query("meter", "value")]).await;
        assert_eq!(done.trouble, None, "the link is in step again");
    });
}

#[test]
fn an_instrument_that_keeps_failing_raises_an_alarm() {
    in_virtual_time(meters(), async |mut bench| {
        for tries in 1..=bench.cycle.wiring.bus.tries {
            assert!(bench.cycle.bus_alarms.is_empty(), "{tries}");
            bench.job(vec![bench.query("meter", "hang")]).await;
        }
        let codes: Vec<AlarmCode> = bench.cycle.bus_alarms.iter().map(|it| it.code).collect();
        assert_eq!(codes, [AlarmCode::InstrumentTrouble]);
    });
}

#[test]
fn a_program_that_always_fails_raises_an_alarm() {
    for program in ["hang", "refused"] {
        in_virtual_time(meters(), async |mut bench| {
            for tries in 1..=bench.cycle.wiring.bus.tries {
                assert!(bench.cycle.bus_alarms.is_empty(), "{tries}");
                let good = bench.job(vec![bench.query("meter", "value")]).await;
                assert_eq!(good.trouble, None);
                bench.job(vec![bench.query("meter", program)]).await;
            }
            let codes: Vec<AlarmCode> = bench.cycle.bus_alarms.iter().map(|it| it.code).collect();
            assert_eq!(codes, [AlarmCode::InstrumentTrouble], "{program}");
        });
    }
}

#[test]
fn over_range_of_every_part_is_no_alarm() {
    in_virtual_time(meters(), async |mut bench| {
        for _ in 0..=bench.cycle.wiring.bus.tries {
            let done = bench.job(vec![bench.query("meter", "over")]).await;
            let trouble = done.trouble.unwrap().say(Lang::En);
            assert!(trouble.contains("OVER?"), "{trouble}");
        }
        assert!(bench.cycle.bus_alarms.is_empty());
    });
}

#[test]
fn a_late_reply_never_reaches_the_next_query() {
    in_virtual_time(meters(), async |mut bench| {
        bench.job(vec![bench.query("meter", "value")]).await;
        let done = bench.job(vec![bench.query("meter", "late")]).await;
        assert!(done.trouble.is_some(), "{:?}", done.delivered);
        for expected in [2.0, 3.0] {
            let done = bench.job(vec![bench.query("meter", "value")]).await;
            assert_eq!(done.delivered[0].numbers, [expected]);
        }
    });
}

#[test]
fn queries_behind_a_failed_one_are_not_sent() {
    in_virtual_time(meters(), async |mut bench| {
        let queries = ["hang", "value"].map(|it| bench.query("meter", it));
        let other = bench.query("source", "value");
        let done = bench
            .job(queries.into_iter().chain([other]).collect())
            .await;
        assert!(done.trouble.is_some());
        assert_eq!(bench.log.count("meter VALUE?"), 0);
        assert_eq!(bench.log.count("source VALUE?"), 1);
    });
}

#[test]
fn an_argument_out_of_range_starts_no_program() {
    in_virtual_time(meters(), async |mut bench| {
        let level = Query {
            arguments: vec![("level_v", 50.0)],
            ..bench.query("source", "level")
        };
        let done = bench.job(vec![bench.query("meter", "value"), level]).await;
        let trouble = done.trouble.unwrap().say(Lang::En);
        assert!(trouble.contains("a number from 0 to 5"), "{trouble}");
        assert_eq!(bench.log.all(), []);
    });
}

#[test]
fn the_answer_to_a_dropped_job_is_no_answer() {
    in_virtual_time(meters(), async |mut bench| {
        let slow = vec![bench.query("meter", "slow")];
        bench.cycle.start(Job::Query(slow));
        for _ in 0..3 {
            bench.turn().await;
        }
        bench.go_safe();
        while !bench.cycle.instruments.is_quiet() {
            bench.turn().await;
        }
        assert!(bench.cycle.job_done.is_none());
        let done = bench.job(vec![bench.query("meter", "value")]).await;
        assert_eq!(done.delivered.len(), 1);
    });
}

#[test]
fn a_conversion_ends_its_job_in_no_time() {
    in_virtual_time(meters(), async |mut bench| {
        bench.job(vec![bench.query("meter", "value")]).await;
        let began = bench.pace.now();
        let conversion = Conversion::new(|all| all.len());
        bench.cycle.start(Job::Convert(conversion, Vec::new()));
        let done = loop {
            if let Some(done) = bench.cycle.job_done.take() {
                break done;
            }
            bench.turn().await;
        };
        assert_eq!((done.at, done.trouble), (began, None));
        assert_eq!(done.converted.unwrap().get(), Some(&0_usize));
        let next = bench.job(vec![bench.query("meter", "value")]).await;
        assert_eq!((next.delivered.len(), next.converted), (1, None));
    });
}
