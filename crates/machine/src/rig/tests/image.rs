//! The commands that read points, and the image of their answers.

use super::{module, motion, text, wiring};
use crate::rig::image::{Image, Unexpected};
use crate::rig::point::{AnalogInput, DigitalIn, GatedCounter, Point};
use crate::rig::sample::Quality;
use crate::rig::wiring::{LineId, Wiring};
use dcon::{Address, Command, Common};
use std::sync::Arc;
use units::{RigTime, Span};

const NOW: RigTime = RigTime(1_000_000);

fn measure(wiring: &Wiring) -> LineId {
    wiring.line_named("measure").unwrap()
}

fn analog(wiring: &Wiring, name: &str) -> AnalogInput {
    wiring.analog_input(name).unwrap()
}

fn counter(wiring: &Wiring, name: &str) -> GatedCounter {
    wiring.gated_counter(name).unwrap()
}

/// Returns the command that reads this point.
fn reads(wiring: &Wiring, point: Point) -> Command {
    wiring.reads(&[point])[0].1
}

/// Returns the requests that read these points.
fn texts(wiring: &Wiring, points: &[Point]) -> Vec<String> {
    let reads = wiring.reads(points);
    reads.iter().map(|(_, command)| text(command)).collect()
}

/// Feeds the answer `reply` to `command` of a module on `line` into the image at `at`.
fn answer(
    image: &mut Image,
    line: LineId,
    command: Command,
    reply: &str,
    at: RigTime,
) -> Result<(), Unexpected> {
    let decoded = command
        .decode(format!("{reply}\r").as_bytes(), false)
        .unwrap();
    image.accept(line, &command, &decoded, reply, at)
}

#[test]
fn every_point_is_read_at_its_own_terminal() {
    let wiring = wiring();
    let track = wiring.thermometer("track_temperature").unwrap();
    for (point, request) in [
        (Point::Analog(analog(&wiring, "contact_drop")), "#090"),
        (Point::Analog(analog(&wiring, "coil_current_fine")), "#016"),
        (Point::Temperature(track), "#052"),
        (Point::Count(counter(&wiring, "gate_1")), "#031"),
    ] {
        assert_eq!(texts(&wiring, &[point]), [request]);
    }
    let beam = |name| wiring.digital_input(name).unwrap();
    assert_eq!(text(&wiring.read_events(beam("beam_pass"))), "#129");
    assert_eq!(text(&wiring.poll(module(&wiring, "contact_ai"))), "#090");
    assert_eq!(text(&wiring.poll(module(&wiring, "coil_ai"))), "#01");
    assert_eq!(text(&wiring.poll(wiring.emergency_stop_module())), "@11");
}

#[test]
fn two_kinds_may_declare_the_same_point() {
    let settings = toml::from_str(include_str!("../../../../../config/rig.toml")).unwrap();
    let twice = [crate::dut::FIXTURES, crate::dut::FIXTURES].concat();
    let both = Wiring::resolve(&settings, &twice).unwrap();
    assert_eq!(
        both.digital_inputs().count(),
        wiring().digital_inputs().count()
    );
    assert_eq!(
        texts(&both, &[Point::Analog(analog(&both, "contact_drop"))]),
        ["#090"]
    );
}

#[test]
fn points_of_one_module_share_a_transaction() {
    let wiring = wiring();
    let input = |name| Point::Input(wiring.digital_input(name).unwrap());
    let inputs = ["latch", "no_closed", "kelvin_nc"].map(input);
    assert_eq!(texts(&wiring, &inputs), ["@08"]);
    let coil = ["coil_voltage_fine", "coil_current_fine"];
    let scan = coil.map(|name| Point::Analog(analog(&wiring, name)));
    assert_eq!(texts(&wiring, &scan), ["#01"]);
    let gates = ["gate_0", "gate_1"].map(|name| Point::Count(counter(&wiring, name)));
    assert_eq!(texts(&wiring, &gates), ["#030", "#031"]);
}

#[test]
fn a_channel_mask_is_that_of_the_points_wanted() {
    let wiring = wiring();
    let mask = |names: &[&str]| {
        let inputs: Vec<_> = names.iter().map(|name| analog(&wiring, name)).collect();
        let masks = wiring.masks(&inputs);
        let masks = masks.iter().map(|(_, command)| text(command));
        masks.collect::<Vec<String>>()
    };
    assert_eq!(
        mask(&["coil_voltage_fine", "coil_current_fine"]),
        ["$01560"]
    );
    assert_eq!(mask(&["coil_voltage_fine", "coil_current"]), ["$01522"]);
    let both = mask(&["contact_drop", "coil_voltage_fine"]);
    assert_eq!(both, ["$01520", "$09501"]);
}

#[test]
fn unread_and_stale_inputs_have_no_value() {
    let wiring = wiring();
    let mut image = Image::new(Arc::clone(&wiring));
    let age = Span::ms(100);
    assert_eq!(image.input(DigitalIn::EmergencyStopOk, NOW, age), None);
    let poll = wiring.poll(wiring.emergency_stop_module());
    answer(&mut image, motion(&wiring), poll, ">FFFE", NOW).unwrap();
    assert_eq!(
        image.input(DigitalIn::EmergencyStopOk, NOW + age, age),
        Some(true)
    );
    assert_eq!(image.input(DigitalIn::DoorClosed, NOW, age), Some(false));
    assert_eq!(
        image.input(DigitalIn::EmergencyStopOk, NOW + Span(100_001), age),
        None
    );
    image.forget(wiring.emergency_stop_module());
    assert_eq!(image.input(DigitalIn::EmergencyStopOk, NOW, age), None);
}

#[test]
fn the_high_byte_of_sixteen_inputs_comes_first() {
    let wiring = wiring();
    let mut image = Image::new(Arc::clone(&wiring));
    let poll = wiring.poll(wiring.emergency_stop_module());
    answer(&mut image, motion(&wiring), poll, ">BFFF", NOW).unwrap();
    assert_eq!(image.input(DigitalIn::ProbeUp, NOW, Span(0)), Some(true));
    assert_eq!(
        image.input(DigitalIn::PusherRetracted, NOW, Span(0)),
        Some(false)
    );
}

#[test]
fn a_reading_carries_value_terminal_and_bytes() {
    let wiring = wiring();
    let mut image = Image::new(Arc::clone(&wiring));
    let read = reads(&wiring, Point::Analog(analog(&wiring, "coil_voltage_fine")));
    answer(&mut image, measure(&wiring), read, ">4000", NOW).unwrap();
    let fine = analog(&wiring, "coil_voltage_fine");
    let sample = image.analog(fine).unwrap();
    assert_eq!((sample.terminal_volts, sample.value), (5.0, 5.0 / 1.6));
    assert_eq!(&*sample.origin.raw, ">4000");
    assert_eq!(wiring.module(sample.origin.module).name, "coil_ai");
    assert_eq!(sample.origin.channel.get(), 5);
    assert_eq!(sample.origin.at, NOW);
    assert_eq!(image.analog(analog(&wiring, "coil_voltage")), None);
}

#[test]
fn a_scan_reaches_each_point() {
    let wiring = wiring();
    let mut image = Image::new(Arc::clone(&wiring));
    let all = wiring.poll(module(&wiring, "coil_ai"));
    answer(
        &mut image,
        measure(&wiring),
        all,
        ">                    20007FFF    ",
        NOW,
    )
    .unwrap();
    assert_eq!(
        image
            .analog(analog(&wiring, "coil_voltage_fine"))
            .unwrap()
            .good(),
        Some(2.5 / 1.6)
    );
    let over = image.analog(analog(&wiring, "coil_current_fine")).unwrap();
    assert_eq!((over.quality, over.good()), (Quality::OverRange, None));
    assert!(over.value.is_nan());
    assert_eq!(
        image
            .analog(analog(&wiring, "coil_voltage"))
            .unwrap()
            .quality,
        Quality::Blank
    );
}

#[test]
fn counts_are_differences_across_the_wrap() {
    let wiring = wiring();
    let mut image = Image::new(Arc::clone(&wiring));
    let read = reads(&wiring, Point::Count(counter(&wiring, "gate_0")));
    answer(&mut image, measure(&wiring), read, ">FFFFFFF0", NOW).unwrap();
    let before = image.counter(counter(&wiring, "gate_0")).unwrap().clone();
    answer(&mut image, measure(&wiring), read, ">00000010", NOW).unwrap();
    assert_eq!(
        image
            .counter(counter(&wiring, "gate_0"))
            .unwrap()
            .since(&before),
        32
    );
    let read = wiring.read_events(wiring.digital_input("beam_pass").unwrap());
    answer(&mut image, motion(&wiring), read, "!1265535", NOW).unwrap();
    let before = image
        .events(wiring.digital_input("beam_pass").unwrap())
        .unwrap()
        .clone();
    answer(&mut image, motion(&wiring), read, "!1200001", NOW).unwrap();
    assert_eq!(
        image
            .events(wiring.digital_input("beam_pass").unwrap())
            .unwrap()
            .since(&before),
        2
    );
}

#[test]
fn an_answer_from_an_unwired_address_changes_nothing() {
    let wiring = wiring();
    let mut image = Image::new(Arc::clone(&wiring));
    let stranger = Common::ReadResetStatus.to(Address(0x77));
    let error = answer(&mut image, motion(&wiring), stranger, "!771", NOW).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line motion: an answer from address 77, where no module is wired"
    );
}

#[test]
fn a_reset_module_is_forgotten_and_reported_once() {
    let wiring = wiring();
    let mut image = Image::new(Arc::clone(&wiring));
    let module = wiring.emergency_stop_module();
    answer(
        &mut image,
        motion(&wiring),
        wiring.poll(module),
        ">0000",
        NOW,
    )
    .unwrap();
    let status = Common::ReadResetStatus.to(wiring.module(module).address);
    answer(&mut image, motion(&wiring), status, "!111", NOW).unwrap();
    assert_eq!(image.input(DigitalIn::AirOk, NOW, Span::ms(1)), None);
    assert_eq!(
        (image.take_resets(), image.take_resets()),
        (vec![module], vec![])
    );
}

#[test]
fn the_emergency_stop_line_has_one_try() {
    let wiring = wiring();
    assert_eq!(wiring.tries_on(motion(&wiring)), 1);
    assert_eq!(wiring.tries_on(measure(&wiring)), 3);
    assert!(wiring.longest_reaction() < Span::ms(420));
}
