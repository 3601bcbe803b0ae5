//! Messages, instruments and relays against the numbers that they promise.
#![allow(clippy::unwrap_used)]

mod instruments;
mod relays;

use super::bench::{Bench, Desk, Instruments, SharedBench};
use super::file::build_text;
use super::message::{Framer, block, nr3, units};
use super::port::Out;
use super::relay::{Defect, Kind, Truth};
use super::status::Failure;

impl Bench {
    /// Sends one message to an instrument and returns its reply.
    fn ask(&mut self, device: usize, message: &str) -> Option<String> {
        let at_us = self.now_us;
        let Instruments {
            devices, faults, ..
        } = &mut self.instruments;
        devices[device].receive(message.as_bytes(), at_us, faults);
        while self.instruments.devices[device].is_busy() {
            let next_us = self.instruments.devices[device].next_us()?;
            self.advance(next_us);
        }
        let (at_us, bytes) = self.instruments.devices[device].outbox.pop_front()?;
        self.advance(at_us);
        Some(String::from_utf8_lossy(&bytes).trim_end().to_owned())
    }
}

fn bench(text: &str) -> SharedBench {
    build_text(text, 1, &[]).unwrap()
}

/// Sends messages; returns the replies.
fn told(bench: &mut Bench, device: usize, messages: &[&str]) -> Vec<String> {
    let replies = messages.iter().map(|message| bench.ask(device, message));
    replies.flatten().collect()
}

fn value(text: &str) -> f64 {
    text.parse().unwrap()
}

const SMU: &str = "[[instrument]]\nname = \"smu\"\nmodel = \"2450\"\ntcp = 0\nexact = true\n";

#[test]
fn headers_take_short_long_and_optional_nodes() {
    let unit = |text: &str| units(text.as_bytes()).remove(0).unwrap();
    let pattern = "[:SOURce#]:VOLTage[:LEVel]";
    for text in [
        "volt 1",
        ":SOUR:VOLT 1",
        "source1:voltage:level 1",
        "VOLT:LEV 1",
    ] {
        assert_eq!(unit(text).matches(pattern), Some(vec![1]), "{text}");
    }
    assert_eq!(unit("SOUR2:VOLT 1").matches(pattern), Some(vec![2]));
    for text in ["VOLTA 1", "SOUR:CURR 1", "VOLT:LEV:IMM 1"] {
        assert_eq!(unit(text).matches(pattern), None, "{text}");
    }
}

#[test]
fn a_later_unit_continues_the_path() {
    let parsed = units(b":SENS:CURR:RANG 1;NPLC 0.1;*OPC?;:OUTP ON");
    let nodes: Vec<String> = parsed
        .iter()
        .map(|it| it.as_ref().unwrap().nodes.join(":"))
        .collect();
    assert_eq!(nodes, ["SENS:CURR:RANG", "SENS:CURR:NPLC", "*OPC", "OUTP"]);
}

#[test]
fn numbers_take_units_and_limits() {
    for (text, expected) in [
        ("1.5", 1.5),
        ("+2E-3", 2e-3),
        ("15MV", 0.015),
        ("2 MHZ", 2e6),
        ("#H1F", 31.0),
        ("MAX", 1e9),
    ] {
        let unit = units(format!("X {text}").as_bytes()).remove(0).unwrap();
        assert_eq!(unit.number(0, -1e9, 1e9, 0.0), Ok(expected), "{text}");
    }
    let unit = units(b"X 12").remove(0).unwrap();
    assert_eq!(unit.number(0, 0.0, 10.0, 0.0), Err(Failure::OUT_OF_RANGE));
    assert_eq!(nr3(-0.00125), "-1.2500000E-03");
    assert_eq!(nr3(f64::NEG_INFINITY), "-9.9000000E+37");
    assert_eq!(nr3(f64::NAN), "+9.9100000E+37");
}

#[test]
fn a_line_feed_inside_a_block_ends_nothing() {
    let mut framer = Framer::default();
    let text = b"DATA #15ab\ncd;X?\n";
    let messages: Vec<_> = text
        .iter()
        .filter_map(|byte| framer.push(*byte).unwrap())
        .collect();
    assert_eq!(messages, [b"DATA #15ab\ncd;X?".to_vec()]);
    assert_eq!(units(&messages[0]).len(), 2);
    assert_eq!(block(b"ab", 9), b"#9000000002ab");
}

#[test]
fn a_full_error_queue_ends_in_overflow() {
    let shared = bench(SMU);
    let bench = &mut *shared.lock();
    assert_eq!(told(bench, 0, &["*ESR?", "*ESR?"]), ["128", "0"]);
    for _ in 0..25 {
        bench.ask(0, "NONSENSE?");
    }
    let errors: Vec<String> = (0..21).filter_map(|_| bench.ask(0, "SYST:ERR?")).collect();
    assert_eq!(errors[0], "-113,\"Undefined header\"");
    assert_eq!(errors[19], "-350,\"Queue overflow\"");
    assert_eq!(errors[20], "0,\"No error\"");
    assert_eq!(told(bench, 0, &["*ESR?", "*ESE 173;*ESE?"]), ["40", "173"]);
    assert_eq!(told(bench, 0, &["*IDN?;*OPC?", "SYST:ERR?"]).len(), 2);
}

#[test]
fn a_source_measure_unit_sweeps_over_a_resistor() {
    let shared = bench(SMU);
    let bench = &mut *shared.lock();
    bench.ask(0, "*RST;*CLS");
    bench.ask(
        0,
        ":SOUR:FUNC VOLT;:SOUR:VOLT:RANG 20;:SOUR:VOLT:ILIM 0.05;:SENS:FUNC \"CURR\"",
    );
    bench.ask(
        0,
        ":SENS:CURR:RANG 0.1;:SENS:CURR:NPLC 0.1;:SENS:CURR:RSEN ON;:SOUR:VOLT 4;:OUTP ON",
    );
    assert_eq!(value(&bench.ask(0, ":READ?").unwrap()), 0.004);
    bench.ask(0, ":SOUR:SWE:VOLT:LIN:STEP 1.5,4,0.05,0.002;:INIT");
    let data = bench
        .ask(0, "*WAI;:TRAC:DATA? 1,51,\"defbuffer1\",SOUR,READ")
        .unwrap();
    let numbers: Vec<f64> = data.split(',').map(value).collect();
    assert_eq!(numbers.len(), 102);
    assert!((numbers[100] - 4.0).abs() < 1e-6 && (numbers[1] - 0.0015).abs() < 1e-9);
    bench.ask(0, ":SENS:CURR:RANG 1e-3");
    assert_eq!(bench.ask(0, ":READ?").unwrap(), "+9.9000000E+37");
    assert_eq!(bench.ask(0, "SYST:ERR?").unwrap(), "0,\"No error\"");
}

#[test]
fn an_ac_source_needs_seconds_to_reset() {
    let shared = bench(
        "[circuit]\ndistorted = false\noutput_ohm = 0.0\n[[instrument]]\nname = \"ac\"\nmodel = \"61500\"\ntcp = 0\nexact = true\n",
    );
    let bench = &mut *shared.lock();
    bench.ask(0, "*RST;*OPC?");
    assert!(bench.now_us >= 7_000_000);
    bench.ask(0, ":VOLT:LIM:AC 250;:VOLT:AC 230;:FREQ 50;:OUTP ON");
    let amps = value(&bench.ask(0, "MEAS:CURR:AC?").unwrap());
    assert!((amps - 0.1).abs() < 1e-4, "{amps}");
    assert_eq!(
        told(bench, 0, &["VOLT:AC 260", "SYST:ERR?"]),
        ["-222,\"Data out of range\""]
    );
}

#[test]
fn an_aged_led_raises_the_threshold_alone() {
    let truth = Truth::draw(Kind::Dc, None, 7);
    for volts in [0.8, 2.0, 4.0, 30.0] {
        let back = truth.input_v(truth.input_a(volts, 0.0, 25.0), 25.0);
        assert!((back - volts).abs() < 1e-6, "{volts} {back}");
    }
    let aged = Truth::draw(Kind::Dc, Some(Defect::AgedLed), 7);
    assert!(aged.v_on() > truth.v_on() + 1.0);
    assert_eq!(aged.input_a(5.0, 0.0, 25.0), truth.input_a(5.0, 0.0, 25.0));
}

const AC: &str = "[circuit]\nkind = \"ac-zero-cross\"\ndistorted = false\n
[[instrument]]\nname = \"ac\"\nmodel = \"61500\"\ntcp = 0\nexact = true
[[instrument]]\nname = \"smu\"\nmodel = \"2450\"\ntcp = 0\nexact = true
[[instrument]]\nname = \"dig\"\nmodel = \"digitizer-rigol\"\ntcp = 0\nexact = true
channel = [{ at = \"input\", ratio = 1.0 }, { at = \"output\", ratio = 0.01 }, { at = \"clamped\", ratio = 1.0 }, { at = \"load\", ratio = 1.0 }]\n";

/// Captures one turn-on; returns output voltage and load current, 10 us a sample, trigger in the middle.
fn turn_on(bench: &mut Bench, wait_us: u64) -> (Vec<f64>, Vec<f64>) {
    bench.ask(0, ":VOLT:AC 230;:FREQ 50;:OUTP ON");
    bench.ask(
        1,
        ":SOUR:FUNC VOLT;:SOUR:VOLT:RANG 20;:SOUR:VOLT:ILIM 0.05;:OUTP ON",
    );
    bench.ask(2, ":CHAN1:SCAL 2;:CHAN2:SCAL 100;:CHAN2:PROB 100;:CHAN4:SCAL 0.05;:TIM:SCAL 0.02;:TRIG:SOUR CHAN1;:TRIG:LEV 2;:SING");
    let wake_us = bench.now_us + wait_us;
    bench.advance(wake_us);
    bench.ask(1, ":SOUR:VOLT 5");
    let end_us = bench.now_us + 150_000;
    bench.advance(end_us);
    assert_eq!(bench.ask(2, ":TRIG:STAT?").unwrap(), "STOP");
    bench.ask(2, ":WAV:MODE RAW;FORM ASC");
    let mut curve = |source: &str| -> Vec<f64> {
        bench.ask(2, &format!(":WAV:SOUR {source}"));
        let text = bench.ask(2, ":WAV:DATA?").unwrap();
        text[11..].split(',').map(value).collect()
    };
    (curve("CHAN2"), curve("CHAN4"))
}

#[test]
fn a_zero_cross_relay_waits_for_the_window() {
    let truth = Truth::draw(Kind::AcZeroCross, None, 1);
    let shared = bench(AC);
    let (volts, amps) = turn_on(&mut shared.lock(), 133_000);
    assert_eq!(volts.len(), 20_000);
    let first = amps.iter().position(|amps| amps.abs() > 0.1).unwrap();
    let jump = volts[10_000..first]
        .iter()
        .rev()
        .map(|it| it.abs())
        .take(120)
        .fold(f64::MAX, f64::min);
    assert!(
        first > 10_000 && jump < truth.inhibit_v + 2.0,
        "{first} {jump}"
    );
    let rms = (amps[first..first + 6_000]
        .iter()
        .map(|it| it * it)
        .sum::<f64>()
        / 6_000.0)
        .sqrt();
    assert!((rms - 0.0994).abs() < 0.002, "{rms}");
    let off = (volts[..8_000].iter().map(|it| it * it).sum::<f64>() / 8_000.0).sqrt();
    assert!((off - 230.0).abs() < 2.0, "{off}");
}

#[test]
fn a_snubber_leaks_as_the_formula_says() {
    let truth = Truth::draw(Kind::AcZeroCross, None, 1);
    let shared = bench(AC);
    let bench = &mut *shared.lock();
    bench.ask(0, ":VOLT:AC 230;:FREQ 50;:OUTP ON");
    let amps = value(&bench.ask(0, "MEAS:CURR:AC?").unwrap());
    let expected = std::f64::consts::TAU * 50.0 * truth.capacitance_f * 230.0;
    assert!((amps / expected - 1.0).abs() < 0.01, "{amps} {expected}");
}

#[test]
fn a_port_applies_the_faults_of_its_link() {
    let faults = ["reply_joined=1@0..1".to_owned(), "block_cut=1".to_owned()];
    let shared = build_text(SMU, 1, &faults).unwrap();
    assert!(shared.open(0, 0));
    shared.receive(0, b"*ESE 7;*ESE?\n", 10);
    assert_eq!(shared.due(0, 900_000), []);
    shared.receive(0, b"*ESE?\n", 1_100_000);
    assert_eq!(shared.due(0, 1_200_000), [Out::Bytes(b"7\n7\n".to_vec())]);
    assert!(build_text(SMU, 1, &["reply_lost=dmm:1".to_owned()]).is_err());
}

const GPIB: &str = "[[adapter]]\nname = \"gpib\"\ntcp = 0
[[instrument]]\nname = \"dmm\"\nmodel = \"34461A\"\nadapter = \"gpib\"\ngpib = 9\n";

/// Sends lines to the adapter; returns what has come after two seconds.
fn through_adapter(shared: &SharedBench, from_us: u64, text: &[u8]) -> String {
    shared.receive(0, text, from_us);
    let mut said = Vec::new();
    for step in 1..20_000 {
        for out in shared.due(0, from_us + step * 100) {
            if let Out::Bytes(bytes) = out {
                said.extend(bytes);
            }
        }
    }
    String::from_utf8(said).unwrap()
}

#[test]
fn an_adapter_reads_only_when_asked() {
    let shared = bench(GPIB);
    assert_eq!(
        through_adapter(&shared, 0, b"++addr 9\n++auto 0\n*ESE 5\n*ESE?\n"),
        ""
    );
    assert_eq!(through_adapter(&shared, 2_000_000, b"++read eoi\n"), "5\n");
    assert_eq!(through_adapter(&shared, 4_000_000, b"++read eoi\n"), "");
    let errors = through_adapter(&shared, 6_000_000, b"SYST:ERR?\n++read eoi\n++addr\n");
    assert!(
        errors.contains("-420,") && errors.contains("9\r\n"),
        "{errors}"
    );
    let text = b"*ESE?\n";
    through_adapter(&shared, 8_000_000, text);
    let errors = through_adapter(&shared, 10_000_000, b"SYST:ERR?\n++read eoi\n");
    assert!(errors.contains("-410,"), "{errors}");
    // A value that is no number is ignored, and answers nothing.
    let said = through_adapter(&shared, 12_000_000, b"++addr nine\n++addr 31\n++addr\n");
    assert_eq!(said, "9\r\n");
    // A connection that ends inside an escaped line leaves nothing of it.
    shared.receive(0, b"\x1b+", 14_000_000);
    shared.close(0, 14_000_000);
    assert_eq!(through_adapter(&shared, 16_000_000, b"++addr\n"), "9\r\n");
}

#[test]
fn virtual_time_serves_streams_at_their_latency() {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    let answered = virtual_time::block_on(async {
        let plugs = super::serve::virtual_time(&bench(SMU));
        let mut host = plugs[0].1.open().unwrap();
        let start_us = virtual_time::now_us();
        host.write_all(b"*RST;*OPC?\n").await.unwrap();
        let mut reply = [0; 2];
        host.read_exact(&mut reply).await.unwrap();
        let rig_us = virtual_time::now_us() - start_us;
        assert_eq!(&reply, b"1\n");
        assert!((20_000..30_000).contains(&rig_us), "{rig_us}");
    });
    answered.unwrap();
}

#[test]
fn a_served_circuit_advances_without_a_host() {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .start_paused(true)
        .build()
        .unwrap();
    runtime.block_on(async {
        let shared = bench(SMU);
        let _served = super::serve::real_time(&shared).await.unwrap();
        tokio::task::yield_now().await;
        tokio::time::advance(std::time::Duration::from_secs(10)).await;
        tokio::task::yield_now().await;
        assert_eq!(shared.lock().now_us, 10_000_000);
    });
}

const DC: &str = "[circuit]\nkind = \"dc\"
[[instrument]]\nname = \"in\"\nmodel = \"2450\"\ntcp = 0\nexact = true
[[instrument]]\nname = \"out\"\nmodel = \"2450\"\nat = \"output\"\ntcp = 0\nexact = true\n";

#[test]
fn a_dc_relay_conforms_at_its_true_thresholds() {
    let truth = Truth::draw(Kind::Dc, None, 1);
    let shared = bench(DC);
    let bench = &mut *shared.lock();
    bench.ask(0, ":SOUR:VOLT:ILIM 0.05;:SENS:CURR:RANG 0.1;:OUTP ON");
    bench.ask(1, ":SOUR:VOLT 20;:SOUR:VOLT:ILIM 0.1;:OUTP ON");
    let conducts = |bench: &mut Bench, volts: f64| {
        bench.ask(0, &format!(":SOUR:VOLT {volts}"));
        let settled_us = bench.now_us + 100_000;
        bench.advance(settled_us);
        value(&bench.ask(1, ":READ?").unwrap()) > 0.09
    };
    assert!(!conducts(bench, truth.v_on() - 0.01));
    assert!(conducts(bench, truth.v_on() + 0.02));
    assert!(conducts(bench, truth.v_off() + 0.02));
    assert!(!conducts(bench, truth.v_off() - 0.01));
    let leak_a = value(&bench.ask(1, ":READ?").unwrap());
    assert!(
        (leak_a - truth.leakage_a - 20.0 / truth.leakage_ohm).abs() < 2e-8,
        "{leak_a}"
    );
    conducts(bench, 5.0);
    bench.ask(1, ":SOUR:FUNC CURR;:SOUR:CURR 1;:SOUR:CURR:VLIM 2;:SENS:FUNC \"VOLT\";:SENS:VOLT:RSEN ON;:OUTP ON");
    let volts = value(&bench.ask(1, ":READ?").unwrap());
    assert!((volts / truth.on_ohm - 1.0).abs() < 0.02, "{volts}");
}

/// Lets a host come, work and leave within two seconds; returns whether the port opened, what left it after each
/// message, and the errors.
fn visit(shared: &SharedBench) -> (bool, Vec<Vec<Out>>, Vec<Out>) {
    let opened = shared.open(0, 0);
    let mut heard = Vec::new();
    for (place, text) in [
        &b":TRIG:SWE AUTO;:ACQ:MDEP 100;:RUN;*OPC?\n"[..],
        b":WAV:FORM ASC;DATA?\n",
        b":WAV:FORM BYTE;DATA?\n",
        b"READ?\n*IDN?\n",
    ]
    .into_iter()
    .enumerate()
    {
        let at_us = place as u64 * 400_000;
        shared.receive(0, text, at_us);
        heard.push(shared.due(0, at_us + 400_000));
    }
    shared.receive(0, b"*ESR?;:SYST:ERR:COUN?\n", 1_600_000);
    let errors = shared.due(0, 2_000_000);
    shared.close(0, 2_000_000);
    (opened, heard, errors)
}

#[test]
fn every_fault_strikes_and_the_port_recovers() {
    const RIGOL: &str = "[[instrument]]\nname = \"dig\"\nmodel = \"digitizer-rigol\"\ntcp = 0\n";
    let usual = visit(&bench(RIGOL));
    // These faults strike at an adapter, at a measured value, or at the next connection.
    let elsewhere = ["address_changed", "over_range", "not_a_number", "half_kept"];
    for fault in crate::fault::instrument::list() {
        let value = fault
            .default
            .split_once('/')
            .map_or("1".to_owned(), |(_, ms)| format!("1/{ms}"));
        let text = format!("{}={value}@0..3", fault.name);
        let shared = build_text(RIGOL, 1, &[text]).unwrap();
        let strikes = visit(&shared) != usual;
        let expected = !elsewhere.contains(&fault.name.as_str());
        assert_eq!(strikes, expected, "{}", fault.name);
        assert!(shared.open(0, 3_000_000), "{}", fault.name);
        shared.receive(0, b"\nSYST:REM;*CLS;*ESE 129;*ESE?\n", 3_000_000);
        let out = shared.due(0, 5_000_000);
        assert_eq!(out, [Out::Bytes(b"129\n".to_vec())], "{}", fault.name);
    }
}

#[test]
fn measured_values_and_addresses_have_faults_too() {
    for (fault, reply) in [
        ("over_range=1", "+9.9000000E+37"),
        ("not_a_number=1", "+9.9100000E+37"),
    ] {
        let shared = build_text(SMU, 1, &[fault.to_owned()]).unwrap();
        let reply_of = |message| shared.lock().ask(0, message);
        assert_eq!(reply_of(":READ?").as_deref(), Some(reply), "{fault}");
        assert_eq!(reply_of("*ESE?").as_deref(), Some("0"), "{fault}");
    }
    let shared = build_text(GPIB, 1, &["address_changed=1@0..1".to_owned()]).unwrap();
    let said = through_adapter(&shared, 0, b"++addr 9\n*ESE?\n++addr\n");
    assert_eq!(said, "10\r\n");
    let shared = build_text(SMU, 1, &["half_kept=1@0..1".to_owned()]).unwrap();
    assert!(shared.open(0, 0));
    shared.close(0, 10);
    assert!(shared.open(0, 20));
    shared.receive(0, b"*ESE?\nSYST:ERR?\n", 30);
    let out = shared.due(0, 1_000_000);
    assert_eq!(out, [Out::Bytes(b"-113,\"Undefined header\"\n".to_vec())]);
}
