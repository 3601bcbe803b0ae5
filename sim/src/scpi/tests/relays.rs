//! Solid-state relays in their circuit, and the file that describes them.

use super::*;
use crate::scpi::circuit::{Circuit, Drive, Terminal};
use crate::scpi::line::{Line, Unrest};
use crate::scpi::relay::SolidState;

/// Puts a zero-cross relay on 230 V, 50 Hz.
fn on_the_line(defect: Option<Defect>, load_h: f64) -> SolidState {
    let truth = Truth::draw(Kind::AcZeroCross, defect, 1);
    let mut relay = SolidState::new(truth, Line::new(1, Unrest::NONE), 2_300.0, load_h);
    let sine = Drive::Sine {
        rms_v: 230.0,
        hz: 50.0,
        phase_deg: Some(0.0),
    };
    relay.drive(Terminal::Line, sine);
    relay
}

fn light(relay: &mut SolidState, volts: f64) {
    let drive = Drive::Voltage {
        volts,
        limit_a: 0.05,
        source_ohm: 0.0,
    };
    relay.drive(Terminal::Input, drive);
}

/// Returns the means over the 20 ms after `from_us` of a function of voltage and current at the output.
fn mean(relay: &mut SolidState, from_us: u64, of: impl Fn(f64, f64) -> f64) -> f64 {
    let samples = (1..=1_000).map(|n| {
        relay.advance(from_us + n * 20);
        let output = relay.at(Terminal::Output);
        of(output.volts, output.amps)
    });
    samples.sum::<f64>() / 1_000.0
}

#[test]
fn a_snubber_takes_no_power() {
    for defect in [None, Some(Defect::WrongSnubber)] {
        let relay = &mut on_the_line(defect, 0.0);
        let watts = mean(relay, 20_000, |volts, amps| volts * amps);
        // 230 V over the 50 Mohm of the leakage, and some nanoamperes of the junction.
        let resistive_a = watts / 230.0;
        assert!(
            (resistive_a - 4.6e-6).abs() < 1e-6,
            "{defect:?} {resistive_a}"
        );
    }
    let relay = &mut on_the_line(Some(Defect::LeakyJunction), 0.0);
    let resistive_a = mean(relay, 20_000, |volts, amps| volts * amps) / 230.0;
    assert!((resistive_a - 5.75e-4).abs() < 1e-5, "{resistive_a}");
}

#[test]
fn a_weak_triac_stays_on_over_an_inductive_load() {
    for (defect, load_h, stays) in [
        (None, 0.0, false),
        (None, 3.0, false),
        (Some(Defect::OpenSnubber), 0.0, false),
        (Some(Defect::OpenSnubber), 3.0, true),
        (Some(Defect::WeakCommutation), 0.0, false),
        (Some(Defect::WeakCommutation), 3.0, true),
    ] {
        let relay = &mut on_the_line(defect, load_h);
        light(relay, 5.0);
        let on_a = mean(relay, 100_000, |_, amps| amps.abs());
        assert!(on_a > 0.05, "{defect:?} {load_h} {on_a}");
        light(relay, 0.0);
        let later_a = mean(relay, 200_000, |_, amps| amps.abs());
        assert_eq!(later_a > 0.05, stays, "{defect:?} {load_h} {later_a}");
    }
}

#[test]
fn no_current_needs_no_voltage() {
    let truth = Truth::draw(Kind::Dc, None, 1);
    let mut relay = SolidState::new(truth, Line::new(1, Unrest::NONE), 2_300.0, 0.0);
    let mut volts = |terminal, amps| {
        let limit_v = 20.0;
        relay.drive(terminal, Drive::Current { amps, limit_v });
        relay.at(terminal).volts
    };
    assert_eq!(volts(Terminal::Input, 0.0), 0.0);
    assert_eq!(volts(Terminal::Output, 0.0), 0.0);
    assert_eq!(volts(Terminal::Input, -1e-3), -20.0);
    assert!((volts(Terminal::Input, 5e-3) - truth.input_v(5e-3, 25.0)).abs() < 1e-9);
    assert_eq!(volts(Terminal::Output, 1e-3), 20.0);
    let part = volts(Terminal::Output, 0.25 * truth.leakage_a);
    assert!(part > 0.0 && part < 20.0, "{part}");
}

#[test]
fn a_mistake_of_the_file_is_refused_with_its_place() {
    let smu = "[[instrument]]\nname = 'smu'\nmodel = '2450'\ntcp = 0\n";
    let gpib = "[[adapter]]\nname = 'smu'\ntcp = 0\n";
    for (text, error) in [
        (
            format!("[circuit]\nkind = 'dc'\ndefect = 'no_zero_cross'\n{smu}"),
            "-:3: circuit.defect: found 'no_zero_cross', expected a defect that",
        ),
        (
            format!("[circuit]\nload_ohm = 0\n{smu}"),
            "-:2: circuit.load_ohm: found 0, expected a number from 0.1 to 10000",
        ),
        (format!("{smu}{smu}"), "-:6: instrument[1].name: found 'smu', expected a name that no other"),
        (format!("{gpib}{smu}"), "-:5: instrument[0].name: found 'smu', expected a name that no other"),
        (
            format!("{smu}channel = [{{ at = 'input', ratio = 1 }}]\n"),
            "-:5: instrument[0].channel: found an unknown key, expected one of adapter, at, ",
        ),
        (
            "[[instrument]]\nname = 'dig'\nmodel = 'digitizer-rigol'\ntcp = 0\nat = 'input'\n".into(),
            "-:5: instrument[0].at: found an unknown key, expected one of ",
        ),
        (
            "[[instrument]]\nname = 'dig'\nmodel = 'digitizer-rigol'\ntcp = 0\nchannel = [{ at = 'input', ratio = 0 }]\n".into(),
            "-:5: instrument[0].channel: found [{ at = 'input', ratio = 0 }], expected at most 4 channels",
        ),
    ] {
        let found = match build_text(&text, 1, &[]) {
            Ok(_) => panic!("accepted: {text}"),
            Err(error) => error.to_string(),
        };
        assert!(found.starts_with(error), "{found}");
    }
}
