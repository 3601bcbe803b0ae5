//! The runner carries out acts in order and accounts for the time.
#![allow(clippy::unwrap_used)]

use crate::dut::em_relay::points::{AnalogIn, AnalogOut, Counter, DigitalIn, DigitalOut};
use crate::handling::tests::MockRig;
use crate::instrument::act::{Act, Job, JobDone, Read, Runner, RunnerState, Spent};
use crate::rig::point::Point;
use texts::Message;
use units::{RigTime, Span, Volt};

fn done(at: RigTime) -> JobDone {
    JobDone::new(at, None)
}

/// Returns a test rig that has read every point once, analog and counters included.
fn read_once() -> MockRig {
    let mut mock = MockRig::at_rest();
    for (point, volts) in [
        (AnalogIn::CoilVoltageFine, 8.0),
        (AnalogIn::CoilCurrentFine, 7.5),
        (AnalogIn::ContactDrop, 1.1),
    ] {
        mock.volts(point, volts);
    }
    mock.gate(Counter::Gate0, 7);
    mock.gate(Counter::Gate1, 9);
    mock.track(23.0);
    mock
}

fn armed(mock: &MockRig) -> Act {
    Act::Set(vec![(mock.points.output(DigitalOut::Arm), true)])
}

fn analog(mock: &MockRig, point: AnalogIn) -> Point {
    Point::Analog(mock.points.analog(point))
}

fn gates(mock: &MockRig) -> [Point; 2] {
    [Counter::Gate0, Counter::Gate1].map(|it| Point::Count(mock.points.counter(it)))
}

#[test]
fn every_bus_act_becomes_one_job() {
    let mock = read_once();
    let (points, coil) = (&mock.points, analog(&mock, AnalogIn::CoilVoltageFine));
    let outputs = vec![(points.output(DigitalOut::Arm), true)];
    let levels = vec![(points.source(AnalogOut::SupplyLevel), Volt(5.0))];
    let masked = vec![points.analog(AnalogIn::CoilCurrent)];
    let [gate, other] = gates(&mock);
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
                read: vec![gate],
                retained: vec![other],
            }),
            Job::Read(vec![gate]),
        ),
        (
            Act::Below {
                point: points.analog(AnalogIn::CoilVoltageFine),
                amount: 9.0,
                within: Span(0),
            },
            Job::Read(vec![coil]),
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
        let mock = read_once();
        let mut runner = Runner::new(vec![act], mock.now);
        let request = runner.step(mock.now, None, &mock.image);
        assert_eq!(request, RunnerState::Job(job.clone()));
        assert_eq!(runner.step(mock.now, None, &mock.image), RunnerState::Busy);
        assert!(!runner.is_done(), "{job:?}");
        let answered = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
        assert_eq!(answered, RunnerState::Done, "{job:?}");
        assert!(runner.is_done(), "{job:?}");
    }
}

#[test]
fn readings_are_kept_by_point() {
    let mock = read_once();
    let (points, [gate, other]) = (&mock.points, gates(&mock));
    let reads = [
        Read::Word(points.board.clone()),
        Read::points([analog(&mock, AnalogIn::CoilVoltageFine)]),
        Read::points([gate, other]),
        Read::Points {
            read: vec![gate],
            retained: vec![other],
        },
        Read::points([Point::Temperature(points.track)]),
    ];
    let mut runner = Runner::new(reads.clone().map(Act::Read).to_vec(), mock.now);
    let mut last = runner.step(mock.now, None, &mock.image);
    for _ in reads {
        last = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
    }
    assert_eq!(last, RunnerState::Done);
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
    assert_eq!(volts(AnalogIn::CoilCurrentFine).count(), 0, "not requested");
    for (counter, count) in [(Counter::Gate0, 7), (Counter::Gate1, 9)] {
        let counts = readings.counts(points.counter(counter));
        let counts: Vec<u32> = counts.map(|it| it.count).collect();
        assert_eq!(counts, [count; 2], "read and retained");
    }
    let track = readings.temperatures(points.track).next().unwrap();
    assert_eq!(track.value, 23.0);
    let curves = readings.trace.samples().iter().map(|it| it.signal.name);
    let curves: Vec<_> = curves.collect();
    assert_eq!(curves, ["board", "coil_voltage_fine", "gate_0", "gate_1"]);
}

#[test]
fn an_unread_value_is_trouble() {
    let mock = MockRig::unread();
    for (read, name) in [
        (Read::Word(mock.points.board.clone()), "board"),
        (
            Read::points([analog(&mock, AnalogIn::ContactDrop)]),
            "contact_drop",
        ),
        (Read::points(gates(&mock)), "gate_0"),
        (
            Read::points([Point::Temperature(mock.points.track)]),
            "track_temperature",
        ),
    ] {
        let mut runner = Runner::new(vec![Act::Read(read)], mock.now);
        runner.step(mock.now, None, &mock.image);
        let answered = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
        let why = format!("{name} was answered without a value");
        assert_eq!(
            answered,
            RunnerState::Trouble(Message::detail("unread", why))
        );
    }
}

#[test]
fn waits_count_from_reply_or_mark() {
    let mock = read_once();
    let start = mock.now;
    let board = || armed(&mock);
    let acts = vec![
        Act::Mark,
        board(),
        Act::Wait(Span::ms(10)),
        board(),
        Act::WaitSinceMark(Span::ms(50)),
    ];
    let mut runner = Runner::new(acts, start);
    runner.step(start, None, &mock.image);
    let at = start + Span::ms(4);
    let late = at + Span::ms(1);
    let waits = runner.step(late, Some(&done(at)), &mock.image);
    assert_eq!(waits, RunnerState::Wait(start + Span::ms(14)));
    let again = runner.step(start + Span(13_999), None, &mock.image);
    assert_eq!(again, RunnerState::Wait(start + Span::ms(14)));
    let next = runner.step(start + Span::ms(14), None, &mock.image);
    assert!(matches!(next, RunnerState::Job(_)));
    let at = start + Span::ms(18);
    let waits = runner.step(at, Some(&done(at)), &mock.image);
    assert_eq!(waits, RunnerState::Wait(start + Span::ms(50)));
    let last = runner.step(start + Span::ms(50), None, &mock.image);
    assert_eq!(last, RunnerState::Done);
}

#[test]
fn an_elapsed_wait_since_mark_costs_nothing() {
    let mock = read_once();
    let acts = vec![
        Act::Mark,
        Act::Wait(Span::ms(30)),
        Act::WaitSinceMark(Span::ms(20)),
    ];
    let mut runner = Runner::new(acts, mock.now);
    let end = mock.now + Span::ms(30);
    assert_eq!(
        runner.step(mock.now, None, &mock.image),
        RunnerState::Wait(end)
    );
    assert_eq!(runner.step(end, None, &mock.image), RunnerState::Done);
    assert_eq!(runner.spent().settling, Span::ms(30));
}

fn until(mock: &MockRig, within: Span) -> Vec<Act> {
    vec![Act::Until {
        point: mock.points.input(DigitalIn::Latch),
        word: mock.points.board.clone(),
        within,
    }]
}

#[test]
fn until_polls_until_the_point_is_active() {
    let mut mock = read_once();
    let mut runner = Runner::new(until(&mock, Span::ms(60)), mock.now);
    runner.step(mock.now, None, &mock.image);
    for _ in 0..5 {
        mock.after(5);
        let request = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
        assert!(
            matches!(request, RunnerState::Job(Job::Read(_))),
            "{request:?}"
        );
    }
    mock.set_board(DigitalIn::Latch, true);
    mock.after(5);
    let last = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
    assert_eq!(
        (last, &*runner.readings.seen),
        (RunnerState::Done, &[true][..])
    );
    assert_eq!(runner.spent().ramp, Span::ms(30));
}

#[test]
fn below_reads_until_a_value_is_small_or_old_enough() {
    let point = AnalogIn::CoilCurrentFine;
    // Readings 5 ms apart from the mark on, V at the terminal; how many the act takes; the last one that it keeps.
    for (volts, taken) in [
        (vec![0.1, 8.0], 1),
        (vec![8.0, 8.0, -0.1, 0.1], 3),
        (vec![8.0, 8.0, 8.0, 8.0, 0.1], 4),
    ] {
        let mut mock = read_once();
        let below = Act::Below {
            point: mock.points.analog(point),
            amount: 0.001,
            within: Span::ms(15),
        };
        let mut runner = Runner::new(vec![Act::Mark, below], mock.now);
        let mut state = runner.step(mock.now, None, &mock.image);
        let mut reads = 0;
        while matches!(state, RunnerState::Job(_)) {
            mock.volts(point, volts[reads]);
            reads += 1;
            state = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
            mock.after(5);
        }
        assert_eq!((state, reads), (RunnerState::Done, taken), "{volts:?}");
        let kept = runner.readings.analog(mock.points.analog(point));
        assert_eq!(kept.count(), 1, "{volts:?}");
    }
}

/// Polls every `poll_ms`, so that the second poll shows the latch, and starts the ramp `sent_ms` later; returns the
/// time in ms after the mark at which a 40 ms wait since the mark ends.
fn ramp_behind_an_event(poll_ms: u64, sent_ms: u64) -> u64 {
    let mut mock = read_once();
    let mut acts = until(&mock, Span::ms(200));
    let ramp = vec![(mock.points.source(AnalogOut::SupplyCoarse), Volt(1.0))];
    acts.extend([Act::Mark, Act::Ramp(ramp), Act::RampSinceMark(Span::ms(40))]);
    let mut runner = Runner::new(acts, mock.now);
    runner.step(mock.now, None, &mock.image);
    mock.after(3);
    runner.step(mock.now, Some(&done(mock.now)), &mock.image);
    mock.set_board(DigitalIn::Latch, true);
    mock.after(poll_ms);
    runner.step(mock.now, Some(&done(mock.now)), &mock.image);
    let mark = mock.now;
    mock.after(sent_ms);
    match runner.step(mock.now, Some(&done(mock.now)), &mock.image) {
        RunnerState::Wait(until) => until.since(mark).0 / 1_000,
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
        "the write was requested again"
    );
    assert_eq!(ramp_behind_an_event(33, 4), 40 + 2 * 24, "a poll was");
}

#[test]
fn until_gives_up_after_its_longest_wait() {
    let mut mock = read_once();
    let mut runner = Runner::new(until(&mock, Span::ms(60)), mock.now);
    runner.step(mock.now, None, &mock.image);
    let mut polls = 0;
    while runner.readings.seen.is_empty() && polls < 100 {
        mock.after(5);
        runner.step(mock.now, Some(&done(mock.now)), &mock.image);
        polls += 1;
    }
    assert_eq!((polls, &*runner.readings.seen), (12, &[false][..]));
    assert!(runner.is_done());
}

#[test]
fn until_reports_a_stale_board_as_trouble() {
    let mock = read_once();
    let mut runner = Runner::new(until(&mock, Span::ms(200)), mock.now);
    runner.step(mock.now, None, &mock.image);
    let board = mock
        .wiring
        .digital_in(mock.points.input(DigitalIn::Latch))
        .module;
    let line = mock.wiring.module(board).line;
    let later = mock.now + mock.wiring.answer_max_age(line) + Span(1);
    let answered = runner.step(later, Some(&done(later)), &mock.image);
    assert!(matches!(answered, RunnerState::Trouble(_)));
}

#[test]
fn a_job_in_trouble_ends_the_acts() {
    let mock = read_once();
    let [coil, drop] = [AnalogIn::CoilVoltageFine, AnalogIn::ContactDrop]
        .map(|it| Act::Read(Read::points([analog(&mock, it)])));
    let acts = vec![coil, drop];
    let mut runner = Runner::new(acts, mock.now);
    runner.step(mock.now, None, &mock.image);
    let silent = Message::detail("unread", "measure 01 #01: silent");
    let failed = JobDone::new(mock.now, Some(silent.clone()));
    let answered = runner.step(mock.now, Some(&failed), &mock.image);
    assert_eq!(answered, RunnerState::Trouble(silent));
    let coil = mock.points.analog(AnalogIn::CoilVoltageFine);
    assert_eq!(runner.readings.analog(coil).count(), 0);
}

#[test]
fn the_four_times_add_up_to_the_elapsed_time() {
    let mut mock = read_once();
    let start = mock.now;
    let mut acts = vec![
        armed(&mock),
        Act::Mark,
        Act::Wait(Span::ms(3)),
        Act::Read(Read::points(gates(&mock))),
        Act::WaitSinceMark(Span::ms(20)),
        Act::Mark,
        Act::Read(Read::Word(mock.points.board.clone())),
        Act::ConvertSinceMark(Span::ms(28)),
        Act::Read(Read::points([analog(&mock, AnalogIn::CoilVoltageFine)])),
    ];
    acts.extend(until(&mock, Span::ms(15)));
    let mut runner = Runner::new(acts, start);
    let mut doing = runner.step(start, None, &mock.image);
    while doing != RunnerState::Done {
        let answer = match doing {
            RunnerState::Wait(instant) => {
                mock.now = instant;
                None
            }
            RunnerState::Job(_) => {
                mock.after(4);
                Some(done(mock.now))
            }
            RunnerState::Busy | RunnerState::Done | RunnerState::Trouble(_) => panic!("{doing:?}"),
        };
        doing = runner.step(mock.now, answer.as_ref(), &mock.image);
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
        mock.now.since(start).0
    );
    assert_eq!((bus, ramp), (Span::ms(16), Span::ms(16)));
    assert!(settling > Span(0) && conversion > Span(0));
}

/// Waits for the probe chain, then arms.
fn agree_and_arm(mock: &MockRig) -> Vec<Act> {
    vec![
        Act::Agree {
            expected: vec![(mock.points.input(DigitalIn::ProbeChain), true)],
            word: mock.points.board.clone(),
            within: Span::ms(12),
        },
        armed(mock),
    ]
}

#[test]
fn acts_go_on_once_the_inputs_agree() {
    let mut mock = read_once();
    let mut runner = Runner::new(agree_and_arm(&mock), mock.now);
    runner.step(mock.now, None, &mock.image);
    mock.after(5);
    let again = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
    assert!(matches!(again, RunnerState::Job(Job::Read(_))), "{again:?}");
    mock.set_board(DigitalIn::ProbeChain, true);
    mock.after(5);
    let next = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
    assert!(matches!(next, RunnerState::Job(Job::Set(_))), "{next:?}");
}

#[test]
fn acts_end_where_the_inputs_never_agree() {
    let mut mock = read_once();
    let mut runner = Runner::new(agree_and_arm(&mock), mock.now);
    let mut doing = runner.step(mock.now, None, &mock.image);
    for _ in 0..3 {
        assert!(matches!(doing, RunnerState::Job(Job::Read(_))), "{doing:?}");
        mock.after(5);
        doing = runner.step(mock.now, Some(&done(mock.now)), &mock.image);
    }
    assert_eq!(doing, RunnerState::Done);
    let chain = mock.points.input(DigitalIn::ProbeChain);
    let seen: Vec<bool> = runner.readings.states(chain).collect();
    assert_eq!(seen, [false]);
}
