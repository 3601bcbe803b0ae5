//! Acts of a stage on the default rig, and the readings that they return.
#![allow(clippy::unwrap_used)]

use super::{Act, Read};
use crate::dut::em_relay::points::{AnalogIn, AnalogOut, Counter};
use crate::dut::em_relay::readings::Readings;
use crate::handling::tests::MockRig;
use crate::instrument::act::{self, Job, JobDone, Runner, RunnerState};
use dcon::Command;
use units::{Span, Volt};

const FINE: [AnalogIn; 2] = [AnalogIn::CoilVoltageFine, AnalogIn::CoilCurrentFine];

fn text(command: &Command) -> String {
    let mut bytes = Vec::new();
    command.encode(false, &mut bytes);
    String::from_utf8(bytes).unwrap().trim_end().to_owned()
}

#[test]
fn each_reading_takes_the_transactions_of_its_points() {
    let mock = MockRig::unread();
    for (read, sent) in [
        (Read::Board, vec!["@08"]),
        (Read::Coil, vec!["#01"]),
        (Read::Drop, vec!["#090"]),
        (Read::Gates, vec!["#030", "#031"]),
        (Read::Gate, vec!["#030"]),
        (Read::Track, vec!["#052"]),
    ] {
        let acts = mock.points.wired(vec![Act::Read(read)], &FINE);
        let mut runner = Runner::new(acts, mock.now);
        let RunnerState::Job(Job::Read(points)) = runner.step(mock.now, None, &mock.image) else {
            panic!("{read:?} is no reading");
        };
        let reads = mock.wiring.reads(&points);
        let texts: Vec<String> = reads.iter().map(|(_, command)| text(command)).collect();
        assert_eq!(texts, sent, "{read:?}");
    }
}

#[test]
fn the_level_steps_and_the_other_outputs_ramp() {
    let points = MockRig::unread().points;
    let wired = |output| {
        let acts = vec![Act::Supply(vec![(output, Volt(1.0))])];
        points.wired(acts, &FINE).remove(0)
    };
    let level = points.source(AnalogOut::SupplyLevel);
    assert_eq!(
        wired(AnalogOut::SupplyLevel),
        act::Act::Level(vec![(level, Volt(1.0))])
    );
    for output in [AnalogOut::SupplyCoarse, AnalogOut::SupplyFine] {
        let ramp = act::Act::Ramp(vec![(points.source(output), Volt(1.0))]);
        assert_eq!(wired(output), ramp);
    }
}

#[test]
fn readings_follow_the_order_of_their_acts() {
    let mut mock = MockRig::at_rest();
    let reads = [Read::Board, Read::Gates, Read::Coil, Read::Gate, Read::Coil];
    let acts = mock.points.wired(reads.map(Act::Read).to_vec(), &FINE);
    let mut runner = Runner::new(acts, mock.now);
    let mut doing = runner.step(mock.now, None, &mock.image);
    for n in 0..5_u32 {
        assert!(matches!(doing, RunnerState::Job(_)), "{doing:?}");
        mock.after(4);
        mock.gate(Counter::Gate0, n);
        // The rig reads the second counter only twice.
        if n < 2 {
            mock.gate(Counter::Gate1, 100);
        }
        for channel in FINE {
            mock.volts(channel, f64::from(n));
        }
        let done = JobDone::new(mock.now, None);
        doing = runner.step(mock.now, Some(&done), &mock.image);
    }
    assert_eq!(doing, RunnerState::Done);
    let readings = Readings::of(&runner.readings, &mock.points, None);
    assert!(readings.boards[0].nc_closed && !readings.boards[0].no_closed);
    assert!(!readings.boards[0].probe_chain && readings.boards.len() == 1);
    let counts = |pair: &[_; 2]| {
        pair.each_ref()
            .map(|it: &crate::rig::sample::CountSample| it.count)
    };
    let gates: Vec<[u32; 2]> = readings.gates.iter().map(counts).collect();
    assert_eq!(gates, [[1, 100], [3, 100]]);
    let volts = readings.coil.iter().map(|scan| {
        assert!(scan.current_wide.is_none() && scan.reference.is_none());
        let both = [&scan.voltage_fine, &scan.current_fine];
        both.map(|it| it.as_ref().unwrap().terminal_volts.round())
    });
    assert_eq!(volts.collect::<Vec<_>>(), [[2.0; 2], [4.0; 2]]);
    let carried = Readings::of(
        &runner.readings,
        &mock.points,
        readings.gates.last().cloned(),
    );
    assert_eq!(carried.gates.len(), 3, "behind those of the stage before");
    assert_eq!(runner.spent().bus, Span::ms(20));
}
