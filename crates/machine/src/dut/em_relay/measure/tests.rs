//! Conclusions of each stage from given readings.
#![allow(clippy::unwrap_used)]

mod ramps;
mod rests;
mod sampling;
mod stages;
mod whole;

use super::TestState;
use crate::dut::em_relay::points::{AnalogIn, Counter};
use crate::dut::em_relay::readings::{BoardInputs, CoilScan, Readings};
use crate::dut::em_relay::tests::context;
use crate::dut::record::Stop;
use crate::dut::verdict::Bin;
use crate::rig::sample::{AnalogPoint, CountPoint, CountSample, Origin, Quality, Sample};
use crate::rig::wiring::{LineId, ModuleId};
use dcon::{Channel, Command};
use units::{Celsius, RigTime};

fn origin() -> Origin {
    Origin {
        line: LineId(0),
        module: ModuleId(0),
        channel: Channel::new(0).unwrap(),
        command: Command::HostOk,
        raw: ">0000".into(),
        at: RigTime(0),
    }
}

/// Reading of `value` units at a terminal of this gain; NaN unless its quality is good.
fn sample(point: AnalogIn, quality: Quality, value: f64, gain: f64) -> Sample {
    let value = if quality == Quality::Good {
        value
    } else {
        f64::NAN
    };
    Sample {
        point: AnalogPoint::Input(context().points.analog(point)),
        value,
        terminal_volts: value * gain,
        quality,
        origin: origin(),
    }
}

fn good(value: f64, gain: f64) -> Sample {
    sample(AnalogIn::ContactDrop, Quality::Good, value, gain)
}

fn drop_of(quality: Quality, volts: f64) -> Sample {
    sample(AnalogIn::ContactDrop, quality, volts, 1.0)
}

/// A scan of the fine channels: volts and amperes at the coil.
fn scan(volts: f64, ampere: f64) -> CoilScan {
    CoilScan {
        voltage_fine: Some(good(volts, 1.6)),
        current_fine: Some(good(ampere, 600.0)),
        current_wide: None,
        current_high: None,
        reference: None,
        supply: None,
    }
}

fn gates(counts: [u32; 2]) -> [CountSample; 2] {
    let gate = |counter, count| CountSample {
        point: CountPoint::Gate(context().points.counter(counter)),
        count,
        origin: origin(),
    };
    [
        gate(Counter::Gate0, counts[0]),
        gate(Counter::Gate1, counts[1]),
    ]
}

/// All pins connected, contacts at rest, probes up.
const RESTING: BoardInputs = BoardInputs {
    kelvin: [true; 5],
    no_closed: false,
    nc_closed: true,
    compliance: false,
    probe_chain: true,
    range: None,
};

/// NO made, NC open.
const PULLED: BoardInputs = BoardInputs {
    no_closed: true,
    nc_closed: false,
    ..RESTING
};

/// Readings of a stage that waited for the latch: whether the latch came, the board afterwards, the open time of gate
/// 0.
fn watched(seen: bool, board: BoardInputs, gate_ms: f64) -> Readings {
    let counts = (gate_ms * 50.0).round() as u32;
    Readings {
        seen: vec![seen],
        boards: vec![board],
        gates: vec![gates([u32::MAX, 5]), gates([counts.wrapping_sub(1), 5])],
        ..Readings::default()
    }
}

fn at_23_c() -> TestState {
    let mut state = TestState::new(&context());
    state.record.own.track = Some(Celsius(23.0));
    state
}

/// Bin and reason of an early end; `None` while the test runs.
fn ended(state: &TestState) -> Option<(Bin, String)> {
    state.record.why_stopped().map(|stop| match stop {
        Stop::Fail(reason) => (reason.bin(), reason.to_string()),
        Stop::Void(why) | Stop::Trouble(why) => (Bin::RETEST, why.to_string()),
    })
}

fn assert_ends(state: &TestState, bin: Bin, word: &str) {
    let (found, why) = ended(state).unwrap();
    assert_eq!(found, bin, "{why}");
    assert!(why.contains(word), "{why}");
}
