//! Instruments at the start of a run, when everything becomes safe, and at the end.

use super::*;
use machine::station::catalogue::AlarmCode;
use texts::Lang;

fn meters() -> [Meter; 2] {
    ["meter", "source"].map(Meter::new)
}

/// Prepares the instruments and returns the alarms.
async fn prepared(bench: &mut Bench) -> Vec<Alarm> {
    let is_ready = bench.cycle.prepare_instruments().await;
    let alarms = std::mem::take(&mut bench.cycle.bus_alarms);
    assert_eq!(is_ready, alarms.is_empty());
    alarms
}

#[test]
fn every_instrument_is_set_up_before_the_run() {
    in_virtual_time(meters(), async |mut bench| {
        assert_eq!(prepared(&mut bench).await, []);
        assert_eq!(bench.log.count("meter *RST"), 1);
        assert_eq!(bench.log.count("source *RST"), 1);
    });
}

#[test]
fn another_identity_is_an_alarm_before_the_run() {
    let [meter, source] = meters();
    let identity = "ACME,X9,7,1.0";
    in_virtual_time([meter, Meter { identity, ..source }], async |mut bench| {
        let alarms = prepared(&mut bench).await;
        let codes: Vec<AlarmCode> = alarms.iter().map(|it| it.code).collect();
        assert_eq!(codes, [AlarmCode::InstrumentTrouble]);
        let text = alarms[0].text(Lang::En);
        assert!(
            text.starts_with("source: Another instrument answers: found ACME,X9"),
            "{text}"
        );
    });
}

#[test]
fn a_missing_instrument_is_an_alarm_before_the_run() {
    let [meter, source] = meters();
    let missing = true;
    in_virtual_time([Meter { missing, ..meter }, source], async |mut bench| {
        let alarms = prepared(&mut bench).await;
        let text = alarms[0].text(Lang::En);
        assert!(text.starts_with("meter: The link is down"), "{text}");
        assert!(bench.pace.now() < RigTime(30_000_000));
        assert!(bench.log.count("accepted") == 0, "nothing moves");
    });
}

#[test]
fn outputs_become_safe_before_the_instruments() {
    in_virtual_time(meters(), async |mut bench| {
        bench.job(vec![bench.query("meter", "value")]).await;
        let from = bench.pace.now();
        bench.go_safe();
        while !bench.cycle.instruments.is_quiet() {
            bench.turn().await;
        }
        let texts = bench.log.since(from);
        let last = texts
            .iter()
            .rposition(|it| it.contains("accepted"))
            .unwrap();
        let off = texts.iter().position(|it| it == "meter :OUTP OFF").unwrap();
        assert!(last < off, "{texts:?}");
        assert_eq!(
            bench.log.count("source :OUTP OFF"),
            0,
            "it has run no program"
        );
    });
}

#[test]
fn safe_outputs_precede_the_resynchronisation_of_a_hanging_query() {
    in_virtual_time(meters(), async |mut bench| {
        assert_eq!(prepared(&mut bench).await, []);
        let stuck = vec![bench.query("meter", "stuck")];
        bench.cycle.start(Job::Query(stuck));
        while bench.log.count("HANG?") == 0 {
            bench.turn().await;
        }
        let from = bench.pace.now();
        bench.go_safe();
        while !bench.cycle.instruments.is_quiet() {
            bench.turn().await;
        }
        let accepted = bench.log.first("accepted", from).unwrap();
        assert!(accepted.since(from) < Span::ms(10), "{accepted:?}");
        let texts = bench.log.since(from);
        let last = texts
            .iter()
            .rposition(|it| it.contains("accepted"))
            .unwrap();
        let resync = texts.iter().position(|it| it.starts_with("meter")).unwrap();
        assert!(last < resync, "{texts:?}");
        let off = bench.log.first("meter :OUTP OFF", from).unwrap();
        assert!(off.since(from) < Span::ms(1000), "{off:?}");
        assert!(bench.cycle.bus_alarms.is_empty());
    });
}

#[test]
fn a_dead_instrument_delays_the_end_by_seconds_only() {
    let meters = meters();
    let dead = Arc::clone(&meters[0].dead);
    in_virtual_time(meters, async |mut bench| {
        bench.job(vec![bench.query("meter", "value")]).await;
        dead.store(true, Ordering::Release);
        let began = bench.pace.now();
        assert!(
            !bench.cycle.make_instruments_safe().await,
            "a dead one is not safe"
        );
        let took = bench.pace.now().since(began);
        assert!(took <= Span::ms(5_100), "{took:?}");
        let Event::Alarm(alarm, _) = bench.events.recv().await.unwrap() else {
            panic!("no alarm");
        };
        assert_eq!(alarm.code, AlarmCode::InstrumentNotSafe);
    });
}

/// Drops the cycle, as a failed assertion does; returns how each instrument ended.
async fn abandoned(bench: Bench) -> (Log, Vec<bool>) {
    let Bench {
        cycle, log, tasks, ..
    } = bench;
    drop(cycle);
    let mut ends = Vec::new();
    for task in tasks {
        ends.push(task.await.unwrap().is_ok());
    }
    (log, ends)
}

#[test]
fn an_abandoned_instrument_makes_itself_safe() {
    for program in ["value", "stuck"] {
        in_virtual_time(meters(), async |mut bench| {
            assert_eq!(prepared(&mut bench).await, []);
            let query = bench.query("meter", program);
            bench.cycle.start(Job::Query(vec![query]));
            while bench.log.count("VALUE?") + bench.log.count("HANG?") == 0 {
                bench.turn().await;
            }
            let (log, ends) = abandoned(bench).await;
            assert_eq!(ends, [true, true], "{program}");
            assert_eq!(log.count("meter :OUTP OFF"), 1, "{program}");
            assert_eq!(log.count("source :OUTP OFF"), 0, "it has run no program");
        });
    }
}

#[test]
fn a_cut_off_safe_program_runs_again() {
    in_virtual_time(meters(), async |mut bench| {
        bench.job(vec![bench.query("meter", "value")]).await;
        let (pace, log) = (bench.pace, bench.log.clone());
        let sent = async {
            while log.count("meter :OUTP OFF") == 0 {
                pace.sleep_until(pace.now() + Span(100)).await;
            }
        };
        tokio::select! {
            biased;
            () = sent => {}
            _ = bench.cycle.make_instruments_safe() => panic!("confirmed before it was cut off"),
        }
        let (log, ends) = abandoned(bench).await;
        assert_eq!(ends, [true, true]);
        assert_eq!(log.count("meter :OUTP OFF"), 2);
    });
}

#[test]
fn an_instrument_made_safe_is_left_alone() {
    in_virtual_time(meters(), async |mut bench| {
        bench.job(vec![bench.query("meter", "value")]).await;
        assert!(bench.cycle.make_instruments_safe().await);
        let (log, ends) = abandoned(bench).await;
        assert_eq!(ends, [true, true]);
        assert_eq!(log.count("meter :OUTP OFF"), 1);
    });
}

#[test]
fn a_dead_abandoned_instrument_ends_in_seconds() {
    let meters = meters();
    let dead = Arc::clone(&meters[0].dead);
    in_virtual_time(meters, async |mut bench| {
        bench.job(vec![bench.query("meter", "value")]).await;
        dead.store(true, Ordering::Release);
        let (pace, began) = (bench.pace, bench.pace.now());
        let (_, ends) = abandoned(bench).await;
        assert_eq!(ends, [false, true]);
        let took = pace.now().since(began);
        assert!(took <= Span::ms(5_100), "{took:?}");
    });
}
