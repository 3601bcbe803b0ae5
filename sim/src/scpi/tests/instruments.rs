//! Settings, measurements and sources of the instruments.

use super::*;
use crate::scpi::circuit::Terminal;

const DMM: &str = "[[instrument]]\nname = \"dmm\"\nmodel = \"34461A\"\ntcp = 0\n";
const PULSES: &str = "[circuit]\ninput_ohm = 1000.0
[[instrument]]\nname = \"pulses\"\nmodel = \"pulse-source\"\ntcp = 0\nexact = true\n";

/// Returns a file with an AC source over 2.4 kohm.
fn ac_source(more: &str) -> String {
    format!(
        "[circuit]\noutput_ohm = 0.0\nload_ohm = 2400.0
        [[instrument]]\nname = \"ac\"\nmodel = \"61500\"\ntcp = 0\n{more}"
    )
}

fn asked(bench: &mut Bench, message: &str) -> f64 {
    value(&bench.ask(0, message).unwrap())
}

#[test]
fn an_rms_reading_is_its_noise_without_a_signal() {
    for seed in 0..20 {
        let shared = build_text(&ac_source(""), seed, &[]).unwrap();
        let bench = &mut *shared.lock();
        for (query, most) in [("MEAS:VOLT:AC?", 0.65), ("MEAS:CURR:AC?", 0.022)] {
            let read = asked(bench, query);
            assert!(read > 0.0 && read < most, "{seed} {query} {read}");
        }
        bench.ask(0, ":VOLT:AC 230;:FREQ 50;:OUTP ON");
        let read = asked(bench, "MEAS:VOLT:AC?");
        assert!((read - 230.0).abs() < 12.0, "{seed} {read}");
        let shared = build_text(DMM, seed, &[]).unwrap();
        let read = asked(&mut shared.lock(), "MEAS:VOLT:AC?");
        assert!(read > 0.0 && read < 5e-5, "{seed} {read}");
    }
}

#[test]
fn a_sine_goes_on_when_its_voltage_changes() {
    let shared = bench(&ac_source("exact = true"));
    let bench = &mut *shared.lock();
    bench.ask(0, ":PHAS:OFF 90;:VOLT:AC 230;:FREQ 50;:OUTP ON");
    bench.advance(20_000_000);
    // Reads the phase beside the message queue, so that no time passes.
    let before = bench.circuit.line_deg();
    bench.ask(0, ":VOLT:AC 115");
    let cycles = (bench.now_us - 20_000_000) as f64 * 50e-6;
    let turned = (bench.circuit.line_deg() - before - 360.0 * cycles).rem_euclid(360.0);
    assert!(!(1.0..359.0).contains(&turned), "{turned}");
    bench.ask(0, "OUTP OFF");
    bench.advance(21_000_000);
    let off = bench.circuit.line_deg();
    assert!((off - 90.0).abs() < 1.0, "{off}");
    assert_eq!(bench.circuit.at(Terminal::Line).volts, 0.0);
}

#[test]
fn an_ac_source_keeps_to_its_limits() {
    let shared = bench(&ac_source(""));
    let bench = &mut *shared.lock();
    bench.ask(0, ":VOLT:LIM:AC 250;:FREQ:LIM 400;:VOLT:AC 230");
    for refused in [
        "VOLT:AC 260",
        "VOLT:LIM:AC 200",
        "FREQ 500",
        "VOLT:RANG LOW",
    ] {
        let error = told(bench, 0, &[refused, "SYST:ERR?"]);
        assert_eq!(error, ["-222,\"Data out of range\""], "{refused}");
    }
    let kept = ["VOLT:AC?", "VOLT:LIM:AC?"].map(|query| asked(bench, query));
    assert_eq!(kept, [230.0, 250.0]);
    assert_eq!(told(bench, 0, &["FETC:VOLT:AC?", "SYST:ERR?"]).len(), 1);
    let read = asked(bench, "MEAS:VOLT:AC?");
    assert!((asked(bench, "FETC:VOLT:AC?") - read).abs() < 0.1);
}

#[test]
fn a_source_measure_unit_takes_as_many_readings_as_set() {
    let shared = bench(SMU);
    let bench = &mut *shared.lock();
    bench.ask(0, ":SOUR:VOLT 2;:SOUR:VOLT:ILIM 0.05;:OUTP ON;:SENS:COUN 5");
    assert!((asked(bench, ":READ?") - 2.0 / 1000.15).abs() < 1e-9);
    assert_eq!(asked(bench, ":TRAC:ACT?"), 5.0);
    // Over two wires the unit reads at its own terminals.
    assert!((asked(bench, ":MEAS:VOLT?") - 2.0).abs() < 1e-6);
    assert_eq!(bench.ask(0, ":SENS:FUNC?").unwrap(), "VOLT");
    assert!((asked(bench, ":MEAS:RES?") - 1000.15).abs() < 1e-3);
}

#[test]
fn a_sweep_keeps_its_step_and_its_source() {
    let shared = bench(SMU);
    let bench = &mut *shared.lock();
    bench.ask(
        0,
        ":SOUR:VOLT:ILIM 0.05;:OUTP ON;:SOUR:SWE:VOLT:LIN:STEP 0,1,0.3;:INIT",
    );
    let levels = bench
        .ask(0, "*WAI;:TRAC:DATA? 1,4,\"defbuffer1\",SOUR")
        .unwrap();
    let levels: Vec<f64> = levels.split(',').map(value).collect();
    assert_eq!(levels, [0.0, 0.3, 0.6, 0.9]);
    assert_eq!(asked(bench, ":TRAC:ACT?"), 4.0);
    for (refused, error) in [
        (":SOUR:SWE:VOLT:LIN 0,1000,11", "-222,"),
        (":SOUR:SWE:VOLT:LIN:STEP 0,1,0", "-222,"),
        (":SOUR:SWE:CURR:LIN 0,0.01,11;:INIT", "-221,"),
    ] {
        let said = told(bench, 0, &[refused, "SYST:ERR?"]);
        assert!(said[0].starts_with(error), "{refused}: {said:?}");
    }
}

#[test]
fn a_stopped_resistance_leaves_no_source() {
    for stop in ["ABOR", "*RST", "FUNC \"VOLT\"", "CONF:VOLT:DC 10"] {
        let shared = bench(DMM);
        let bench = &mut *shared.lock();
        bench.ask(0, "CONF:RES;:INIT");
        assert_eq!(bench.circuit.at(Terminal::Output).amps, 1e-3, "{stop}");
        bench.ask(0, stop);
        assert_eq!(bench.circuit.at(Terminal::Output).amps, 0.0, "{stop}");
    }
}

#[test]
fn a_range_belongs_to_its_function() {
    let shared = bench(DMM);
    let bench = &mut *shared.lock();
    bench.ask(0, "FUNC \"VOLTage:DC\";:CURR:RANG 0.01");
    assert_eq!(bench.ask(0, "FUNC?").unwrap(), "\"VOLT\"");
    let replies = told(
        bench,
        0,
        &["VOLT:RANG:AUTO?", "CURR:RANG:AUTO?", "CURR:RANG?"],
    );
    assert_eq!(replies, ["1", "0", "+1.0000000E-02"]);
    bench.ask(0, "CONF:CURR DEFAULT");
    assert_eq!(bench.ask(0, "CURR:RANG:AUTO?").unwrap(), "1");
    let replies = told(bench, 0, &["TRIG:SOUR BUS;:READ?", "SYST:ERR?"]);
    assert_eq!(replies, ["-214,\"Trigger deadlock\""]);
}

#[test]
fn a_pulse_source_has_fifty_ohms() {
    let shared = bench(PULSES);
    let bench = &mut *shared.lock();
    let high_v = |bench: &mut Bench, messages: &str| {
        bench.ask(0, messages);
        bench.circuit.at(Terminal::Pulse).volts
    };
    let set = "*RST;:FUNC PULS;:FUNC:PULS:WIDT 0.0009;:VOLT:LOW 0;:VOLT:HIGH 5;:OUTP ON";
    assert!((high_v(bench, set) - 10.0 / 1.05).abs() < 1e-9);
    // The output stays; the volts over the load now set are those without load.
    assert!((high_v(bench, "OUTP:LOAD INF") - 10.0 / 1.05).abs() < 1e-6);
    assert!((asked(bench, "VOLT:HIGH?") - 10.0).abs() < 1e-6);
    assert!((high_v(bench, "VOLT:HIGH 5") - 5.0 / 1.05).abs() < 1e-6);
    assert_eq!(high_v(bench, "OUTP:POL INV"), 0.0);
    assert_eq!(
        told(bench, 0, &["FUNC SIN", "SYST:ERR?"]),
        ["-221,\"Settings conflict\""]
    );
    assert_eq!(bench.circuit.at(Terminal::Pulse).volts, 0.0);
}

#[test]
fn what_an_instrument_cannot_do_is_refused() {
    for (model, command) in [
        ("digitizer-keysight", ":CHAN1:COUP AC"),
        ("digitizer-rigol", ":TIM:MODE XY"),
        ("61500", "OUTP:COUP DC"),
        ("2450", ":FORM REAL"),
    ] {
        let file = format!("[[instrument]]\nname = \"it\"\nmodel = \"{model}\"\ntcp = 0\n");
        let said = told(&mut bench(&file).lock(), 0, &[command, "SYST:ERR?"]);
        assert_eq!(said, ["-224,\"Illegal parameter value\""], "{model}");
    }
}

#[test]
fn automatic_triggering_waits_for_an_edge_first() {
    let file = "[[instrument]]\nname = \"dig\"\nmodel = \"digitizer-keysight\"\ntcp = 0\n";
    let shared = bench(file);
    let bench = &mut *shared.lock();
    bench.ask(0, ":ACQ:MDEP 100;:TRIG:LEV 5;:WAV:FORM BYTE");
    let from_us = bench.now_us;
    // The query waits for the record.
    let data = bench.ask(0, ":DIG CHAN1;:WAV:DATA?").unwrap();
    let taken_us = bench.now_us - from_us;
    assert!((50_000..70_000).contains(&taken_us), "{taken_us}");
    assert!(data.starts_with("#800000100"), "{data}");
    bench.ask(0, ":SING");
    bench.advance(bench.now_us + 500_000);
    assert_eq!(bench.ask(0, ":TER?").unwrap(), "0");
}

#[test]
fn a_record_keeps_the_scale_with_which_it_was_taken() {
    for model in ["digitizer-rigol", "digitizer-keysight"] {
        let dig =
            format!("[[instrument]]\nname = \"dig\"\nmodel = \"{model}\"\ntcp = 0\nexact = true\n");
        let shared = bench(&format!("{SMU}{dig}"));
        let bench = &mut *shared.lock();
        bench.ask(
            0,
            ":SOUR:VOLT 2;:SOUR:VOLT:ILIM 0.05;:SENS:CURR:RSEN ON;:OUTP ON",
        );
        bench.ask(1, ":ACQ:MDEP 100;:CHAN1:OFFS 0.5;:RUN");
        bench.ask(1, "*OPC?");
        bench.ask(1, ":CHAN1:SCAL 5;OFFS -1;:WAV:FORM BYTE");
        let preamble = bench.ask(1, ":WAV:PRE?").unwrap();
        let numbers: Vec<f64> = preamble.split(',').map(value).collect();
        let [step_v, origin, reference] = numbers[7..] else {
            panic!("{preamble}")
        };
        assert!((step_v - 8.0 / 256.0).abs() < 1e-9, "{model}: {preamble}");
        bench.ask(1, ":WAV:FORM ASC");
        let text = bench.ask(1, ":WAV:DATA?").unwrap();
        let first = text.split(',').nth(1).map(value).unwrap();
        assert!((first - 2.0).abs() < 0.002, "{model}: {first}");
        let offset_v = match model {
            "digitizer-rigol" => origin * step_v,
            _ => -origin,
        };
        let expected = if model == "digitizer-rigol" {
            0.5
        } else {
            -0.5
        };
        assert_eq!((offset_v, reference), (expected, 128.0), "{model}");
    }
}
