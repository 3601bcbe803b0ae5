//! What programs deliver, and where a stage finds it.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::instrument::act::{Act, Job, JobDone, Runner, RunnerState};
use crate::instrument::conversion::Conversion;
use crate::instrument::trace::MAX_NUMBERS;
use crate::rig::image::Image;
use crate::rig::instruments::Profiles;
use crate::rig::settings::RigSettings;
use crate::rig::wiring::Wiring;
use scpi::Profile;
use units::RigTime;

const INSTRUMENTS: &str = "
[instrument.meter]
profile = \"smu-2450\"
link = \"tcp:10.0.0.1:5025\"

[instrument.source]
profile = \"smu-2450\"
link = \"tcp:10.0.0.2:5025\"
";

fn image() -> Image {
    let rig = include_str!("../../../../../config/rig.toml");
    let settings: RigSettings = toml::from_str(&format!("{rig}{INSTRUMENTS}")).unwrap();
    let profile = include_str!("../../../../../config/instruments/smu-2450.toml");
    let profile: Profile = toml::from_str(profile).unwrap();
    let profiles = Profiles::from([(profile.name.clone(), Arc::new(profile))]);
    let wiring = Wiring::resolve_with(&settings, crate::dut::FIXTURES, &profiles);
    Image::new(Arc::new(wiring.unwrap()))
}

fn query(image: &Image, name: &str, program: &'static str) -> Query {
    Query {
        instrument: image.wiring().instrument_named(name).unwrap(),
        program,
        arguments: Vec::new(),
        shows: Vec::new(),
    }
}

/// Carries out one act with these queries, each of which delivers its numbers.
fn carried_out(image: &Image, each: &[(Query, Vec<f64>)]) -> Runner {
    let queries: Vec<Query> = each.iter().map(|it| it.0.clone()).collect();
    let mut runner = Runner::new(vec![Act::Query(queries.clone())], RigTime(0));
    let asked = runner.step(RigTime(0), None, image);
    assert_eq!(asked, RunnerState::Job(Job::Query(queries)));
    let delivered = each.iter().map(|it| Delivered {
        numbers: it.1.clone(),
        waveform: None,
    });
    let done = JobDone {
        delivered: delivered.collect(),
        ..JobDone::new(RigTime(900), None)
    };
    let state = runner.step(RigTime(1000), Some(&done), image);
    assert_eq!(state, RunnerState::Done);
    runner
}

#[test]
fn deliveries_are_found_by_their_instrument() {
    let image = image();
    let of = |name| query(&image, name, "current_at_level");
    let each = [
        (of("meter"), vec![1.0]),
        (of("source"), vec![2.0]),
        (of("meter"), vec![3.0]),
    ];
    let readings = carried_out(&image, &each).readings;
    let numbers = |name| -> Vec<f64> {
        let here = readings.delivered(image.wiring().instrument_named(name).unwrap());
        here.flat_map(|it| it.numbers.clone()).collect()
    };
    assert_eq!(
        (numbers("meter"), numbers("source")),
        (vec![1.0, 3.0], vec![2.0])
    );
}

#[test]
fn the_history_names_instrument_and_program() {
    let image = image();
    let ramp = vec![0.5; MAX_NUMBERS + 1];
    let each = [
        (query(&image, "source", "current_at_level"), vec![2e-9]),
        (query(&image, "meter", "ramp"), ramp),
    ];
    let trace = carried_out(&image, &each).readings.trace;
    let stored = trace.samples().iter();
    let stored = stored.map(|it| (it.signal.stored_name(image.wiring()), it.at, it.value));
    let expected = ("source.current_at_level".to_owned(), RigTime(900), 2e-9);
    assert_eq!(
        stored.collect::<Vec<_>>(),
        [expected],
        "a ramp is no sample"
    );
}

#[test]
fn numbers_of_all_replies_keep_their_order() {
    let replies = [
        Reply::Number(1.5),
        Reply::Line("STOP".to_owned()),
        Reply::Line("8".to_owned()),
        Reply::Numbers(vec![2.0, 3.0]),
    ];
    let delivered = Delivered::of(Dialect::Scpi, &replies);
    let numbers = vec![1.5, 8.0, 2.0, 3.0];
    assert_eq!(delivered.map(|it| it.numbers), Ok(numbers));
}

#[test]
fn a_block_and_its_preamble_are_a_waveform() {
    let preamble = vec![0.0, 2.0, 3.0, 1.0, 1e-6, -2e-6, 0.0, 0.5, 0.0, 128.0];
    let replies = [Reply::Numbers(preamble), Reply::Block(vec![128, 130, 126])];
    let Ok(delivered) = Delivered::of(Dialect::Rigol, &replies) else {
        panic!("no waveform");
    };
    assert!(delivered.numbers.is_empty(), "the preamble is no value");
    let waveform = delivered.waveform.map(|it| (*it).clone());
    let expected = Waveform {
        start_s: -2e-6,
        step_s: 1e-6,
        volts: vec![0.0, 1.0, -1.0],
    };
    assert_eq!(waveform, Some(expected));
}

#[test]
fn a_block_without_preamble_is_refused() {
    let replies = [Reply::Block(vec![1, 2])];
    assert!(Delivered::of(Dialect::Rigol, &replies).is_err());
}

#[test]
fn a_conversion_gets_the_waveforms_of_its_stage() {
    let image = image();
    let query = query(&image, "meter", "current_at_level");
    let sum = Conversion::new(|all| all.iter().map(|it| it.volts.len()).sum::<usize>());
    let acts = vec![Act::Query(vec![query]), Act::Convert(sum.clone())];
    let mut runner = Runner::new(acts, RigTime(0));
    runner.step(RigTime(0), None, &image);
    let waveform = Arc::new(Waveform {
        start_s: 0.0,
        step_s: 1e-6,
        volts: vec![0.5; 7],
    });
    let done = JobDone {
        delivered: vec![Delivered {
            waveform: Some(Arc::clone(&waveform)),
            ..Delivered::default()
        }],
        ..JobDone::new(RigTime(900), None)
    };
    let asked = runner.step(RigTime(1000), Some(&done), &image);
    let waveforms = vec![waveform];
    assert_eq!(
        asked,
        RunnerState::Job(Job::Convert(sum.clone(), waveforms.clone()))
    );
    let done = JobDone {
        converted: Some(sum.run(&waveforms)),
        ..JobDone::new(RigTime(1000), None)
    };
    assert_eq!(
        runner.step(RigTime(1001), Some(&done), &image),
        RunnerState::Done
    );
    let converted: Vec<_> = runner
        .readings
        .converted
        .iter()
        .map(|it| it.get())
        .collect();
    assert_eq!(converted, [Some(&7_usize)]);
    assert_eq!(runner.readings.converted[0].get::<f64>(), None);
}
