//! The runner carries out acts in order and accounts for the time.
#![allow(clippy::unwrap_used)]

use crate::dut::em_relay::points::{AnalogIn, AnalogOut, Counter, DigitalIn, DigitalOut};
use crate::handling::tests::Shop;
use crate::instrument::act::{Act, Doing, Job, JobDone, Read, Runner, Spent};
use crate::rig::point::Point;
use units::{RigTime, Span, Volt};

fn done(at: RigTime) -> JobDone {
    JobDone { at, trouble: None }
}

/// Returns a test rig that has read every point once, analog and counters included.
fn read_once() -> Shop {
    let mut shop = Shop::at_rest();
    for (point, volts) in [
        (AnalogIn::CoilVoltageFine, 8.0),
        (AnalogIn::CoilCurrentFine, 7.5),
        (AnalogIn::ContactDrop, 1.1),
    ] {
        shop.volts(point, volts);
    }
    shop.gate(Counter::Gate0, 7);
    shop.gate(Counter::Gate1, 9);
    shop.track(23.0);
    shop
}

/// Returns the write of one word to the board.
fn armed(shop: &Shop) -> Act {
    Act::Set(vec![(shop.points.output(DigitalOut::Arm), true)])
}

fn analog(shop: &Shop, point: AnalogIn) -> Point {
    Point::Analog(shop.points.analog(point))
}

fn gates(shop: &Shop) -> [Point; 2] {
    [Counter::Gate0, Counter::Gate1].map(|it| Point::Count(shop.points.counter(it)))
}

#[test]
fn every_bus_act_becomes_one_job() {
    let shop = read_once();
    let (points, coil) = (&shop.points, analog(&shop, AnalogIn::CoilVoltageFine));
    let outputs = vec![(points.output(DigitalOut::Arm), true)];
    let levels = vec![(points.source(AnalogOut::SupplyLevel), Volt(5.0))];
    let masked = vec![points.analog(AnalogIn::CoilCurrent)];
    let [gate, other] = gates(&shop);
    let word: Vec<Point> = points
        .board
        .inputs
        .iter()
        .copied()
        .map(Point::Input)
        .collect();
    let latch = points.input(DigitalIn::Latch);
    let latched = [Point::Input(latch)].into_iter().chain(word.clone());
    let cases = [
        (Act::Set(outputs.clone()), Job::Set(outputs)),
        (Act::Level(levels.clone()), Job::Level(levels.clone())),
        (Act::Ramp(levels.clone()), Job::Level(levels)),
        (Act::Read(Read::points([coil])), Job::Read(vec![coil])),
        (Act::Read(Read::Word(points.board.clone())), Job::Read(word)),
        (
            Act::Read(Read::Points {
                asked: vec![gate],
                beside: vec![other],
            }),
            Job::Read(vec![gate]),
        ),
        (Act::Read(Read::Restarts), Job::Restarts),
        (Act::Mask(masked.clone()), Job::Mask(masked)),
        (
            Act::Until {
                point: latch,
                word: points.board.clone(),
                within: Span(0),
            },
            Job::Read(latched.collect()),
        ),
    ];
    for (act, job) in cases {
        let shop = read_once();
        let mut runner = Runner::new(vec![act], shop.now);
        let asked = runner.step(shop.now, None, &shop.image);
        assert_eq!(asked, Doing::Job(job.clone()));
        assert_eq!(runner.step(shop.now, None, &shop.image), Doing::Busy);
        assert!(!runner.is_done(), "{job:?}");
        let answered = runner.step(shop.now, Some(&done(shop.now)), &shop.image);
        assert_eq!(answered, Doing::Done, "{job:?}");
        assert!(runner.is_done(), "{job:?}");
    }
}

#[test]
fn readings_are_kept_by_point() {
    let shop = read_once();
    let (points, [gate, other]) = (&shop.points, gates(&shop));
    let reads = [
        Read::Word(points.board.clone()),
        Read::points([analog(&shop, AnalogIn::CoilVoltageFine)]),
        Read::points([gate, other]),
        Read::Points {
            asked: vec![gate],
            beside: vec![other],
        },
        Read::points([Point::Temperature(points.track)]),
    ];
    let mut runner = Runner::new(reads.clone().map(Act::Read).to_vec(), shop.now);
    let mut last = runner.step(shop.now, None, &shop.image);
    for _ in reads {
        last = runner.step(shop.now, Some(&done(shop.now)), &shop.image);
    }
    assert_eq!(last, Doing::Done);
    let readings = &runner.readings;
    let state = |point| readings.states(points.input(point)).collect::<Vec<_>>();
    assert_eq!(state(DigitalIn::NcClosed), [true]);
    assert_eq!(state(DigitalIn::NoClosed), [false]);
    assert!(state(DigitalIn::Latch).is_empty(), "no input of the word");
    let volts = |point| {
        readings
            .analog(points.analog(point))
            .map(|it| it.terminal_volts)
    };
    assert!((volts(AnalogIn::CoilVoltageFine).sum::<f64>() - 8.0).abs() < 0.001);
    assert_eq!(volts(AnalogIn::CoilCurrentFine).count(), 0, "not asked for");
    for (counter, count) in [(Counter::Gate0, 7), (Counter::Gate1, 9)] {
        let counts = readings.counts(points.counter(counter));
        let counts: Vec<u32> = counts.map(|it| it.count).collect();
        assert_eq!(counts, [count; 2], "read, and kept beside");
    }
    let track = readings.temperatures(points.track).next().unwrap();
    assert_eq!(track.value, 23.0);
    let curves = readings.trace.samples().iter().map(|it| it.signal.name);
    let curves: Vec<_> = curves.collect();
    assert_eq!(curves, ["board", "coil_voltage_fine", "gate_0", "gate_1"]);
}

#[test]
fn an_unread_value_is_trouble() {
    let shop = Shop::unread();
    for (read, name) in [
        (Read::Word(shop.points.board.clone()), "board"),
        (
            Read::points([analog(&shop, AnalogIn::ContactDrop)]),
            "contact_drop",
        ),
        (Read::points(gates(&shop)), "gate_0"),
        (
            Read::points([Point::Temperature(shop.points.track)]),
            "track_temperature",
        ),
    ] {
        let mut runner = Runner::new(vec![Act::Read(read)], shop.now);
        runner.step(shop.now, None, &shop.image);
        let answered = runner.step(shop.now, Some(&done(shop.now)), &shop.image);
        let why = format!("{name} was answered without a value");
        assert_eq!(answered, Doing::Trouble(why));
    }
}

#[test]
fn waits_count_from_reply_or_mark() {
    let shop = read_once();
    let start = shop.now;
    let board = || armed(&shop);
    let acts = vec![
        Act::Mark,
        board(),
        Act::Wait(Span::ms(10)),
        board(),
        Act::WaitSinceMark(Span::ms(50)),
    ];
    let mut runner = Runner::new(acts, start);
    runner.step(start, None, &shop.image);
    let at = start + Span::ms(4);
    let late = at + Span::ms(1);
    let waits = runner.step(late, Some(&done(at)), &shop.image);
    assert_eq!(waits, Doing::Wait(start + Span::ms(14)));
    let again = runner.step(start + Span(13_999), None, &shop.image);
    assert_eq!(again, Doing::Wait(start + Span::ms(14)));
    let next = runner.step(start + Span::ms(14), None, &shop.image);
    assert!(matches!(next, Doing::Job(_)));
    let at = start + Span::ms(18);
    let waits = runner.step(at, Some(&done(at)), &shop.image);
    assert_eq!(waits, Doing::Wait(start + Span::ms(50)));
    let last = runner.step(start + Span::ms(50), None, &shop.image);
    assert_eq!(last, Doing::Done);
}

#[test]
fn an_elapsed_wait_since_mark_costs_nothing() {
    let shop = read_once();
    let acts = vec![
        Act::Mark,
        Act::Wait(Span::ms(30)),
        Act::WaitSinceMark(Span::ms(20)),
    ];
    let mut runner = Runner::new(acts, shop.now);
    let end = shop.now + Span::ms(30);
    assert_eq!(runner.step(shop.now, None, &shop.image), Doing::Wait(end));
    assert_eq!(runner.step(end, None, &shop.image), Doing::Done);
    assert_eq!(runner.spent().settling, Span::ms(30));
}

fn until(shop: &Shop, within: Span) -> Vec<Act> {
    vec![Act::Until {
        point: shop.points.input(DigitalIn::Latch),
        word: shop.points.board.clone(),
        within,
    }]
}

#[test]
fn until_polls_until_the_point_is_active() {
    let mut shop = read_once();
    let mut runner = Runner::new(until(&shop, Span::ms(60)), shop.now);
    runner.step(shop.now, None, &shop.image);
    for _ in 0..5 {
        shop.after(5);
        let asked = runner.step(shop.now, Some(&done(shop.now)), &shop.image);
        assert!(matches!(asked, Doing::Job(Job::Read(_))), "{asked:?}");
    }
    shop.set_board(DigitalIn::Latch, true);
    shop.after(5);
    let last = runner.step(shop.now, Some(&done(shop.now)), &shop.image);
    assert_eq!((last, &*runner.readings.seen), (Doing::Done, &[true][..]));
    assert_eq!(runner.spent().ramp, Span::ms(30));
}

/// Polls every `poll_ms`, so that the second poll shows the latch, and starts the ramp `sent_ms` later; returns the
/// time in ms after the mark at which a 40 ms wait since the mark ends.
fn ramp_behind_an_event(poll_ms: u64, sent_ms: u64) -> u64 {
    let mut shop = read_once();
    let mut acts = until(&shop, Span::ms(200));
    let ramp = vec![(shop.points.source(AnalogOut::SupplyCoarse), Volt(1.0))];
    acts.extend([Act::Mark, Act::Ramp(ramp), Act::RampSinceMark(Span::ms(40))]);
    let mut runner = Runner::new(acts, shop.now);
    runner.step(shop.now, None, &shop.image);
    shop.after(3);
    runner.step(shop.now, Some(&done(shop.now)), &shop.image);
    shop.set_board(DigitalIn::Latch, true);
    shop.after(poll_ms);
    runner.step(shop.now, Some(&done(shop.now)), &shop.image);
    let mark = shop.now;
    shop.after(sent_ms);
    match runner.step(shop.now, Some(&done(shop.now)), &shop.image) {
        Doing::Wait(until) => until.since(mark).0 / 1_000,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_late_ramp_doubles_its_delay() {
    assert_eq!(ramp_behind_an_event(3, 4), 40, "as planned");
    assert_eq!(ramp_behind_an_event(9, 4), 40, "as planned at the longest");
    assert_eq!(
        ramp_behind_an_event(3, 34),
        40 + 2 * 24,
        "the write was asked again"
    );
    assert_eq!(ramp_behind_an_event(33, 4), 40 + 2 * 24, "a poll was");
}

#[test]
fn until_gives_up_after_its_longest_wait() {
    let mut shop = read_once();
    let mut runner = Runner::new(until(&shop, Span::ms(60)), shop.now);
    runner.step(shop.now, None, &shop.image);
    let mut polls = 0;
    while runner.readings.seen.is_empty() && polls < 100 {
        shop.after(5);
        runner.step(shop.now, Some(&done(shop.now)), &shop.image);
        polls += 1;
    }
    assert_eq!((polls, &*runner.readings.seen), (12, &[false][..]));
    assert!(runner.is_done());
}

#[test]
fn until_reports_a_stale_board_as_trouble() {
    let shop = read_once();
    let mut runner = Runner::new(until(&shop, Span::ms(200)), shop.now);
    runner.step(shop.now, None, &shop.image);
    let board = shop
        .wiring
        .digital_in(shop.points.input(DigitalIn::Latch))
        .module;
    let line = shop.wiring.module(board).line;
    let later = shop.now + shop.wiring.answer_max_age(line) + Span(1);
    let answered = runner.step(later, Some(&done(later)), &shop.image);
    assert!(matches!(answered, Doing::Trouble(_)));
}

#[test]
fn a_job_in_trouble_ends_the_acts() {
    let shop = read_once();
    let [coil, drop] = [AnalogIn::CoilVoltageFine, AnalogIn::ContactDrop]
        .map(|it| Act::Read(Read::points([analog(&shop, it)])));
    let acts = vec![coil, drop];
    let mut runner = Runner::new(acts, shop.now);
    runner.step(shop.now, None, &shop.image);
    let failed = JobDone {
        at: shop.now,
        trouble: Some("measure 01 #01: silent".into()),
    };
    let answered = runner.step(shop.now, Some(&failed), &shop.image);
    assert_eq!(answered, Doing::Trouble("measure 01 #01: silent".into()));
    let coil = shop.points.analog(AnalogIn::CoilVoltageFine);
    assert_eq!(runner.readings.analog(coil).count(), 0);
}

#[test]
fn the_four_times_add_up_to_the_elapsed_time() {
    let mut shop = read_once();
    let start = shop.now;
    let mut acts = vec![
        armed(&shop),
        Act::Mark,
        Act::Wait(Span::ms(3)),
        Act::Read(Read::points(gates(&shop))),
        Act::WaitSinceMark(Span::ms(20)),
        Act::Mark,
        Act::Read(Read::Word(shop.points.board.clone())),
        Act::ConvertSinceMark(Span::ms(28)),
        Act::Read(Read::points([analog(&shop, AnalogIn::CoilVoltageFine)])),
    ];
    acts.extend(until(&shop, Span::ms(15)));
    let mut runner = Runner::new(acts, start);
    let mut doing = runner.step(start, None, &shop.image);
    while doing != Doing::Done {
        let answer = match doing {
            Doing::Wait(instant) => {
                shop.now = instant;
                None
            }
            Doing::Job(_) => {
                shop.after(4);
                Some(done(shop.now))
            }
            Doing::Busy | Doing::Done | Doing::Trouble(_) => panic!("{doing:?}"),
        };
        doing = runner.step(shop.now, answer.as_ref(), &shop.image);
    }
    let Spent {
        bus,
        settling,
        conversion,
        ramp,
        bound,
    } = runner.spent();
    // 20 ms after the first mark, 28 ms after the second, and the event itself.
    assert_eq!(bound, Span::ms(64));
    assert_eq!(
        bus.0 + settling.0 + conversion.0 + ramp.0,
        shop.now.since(start).0
    );
    assert_eq!((bus, ramp), (Span::ms(16), Span::ms(16)));
    assert!(settling > Span(0) && conversion > Span(0));
}
