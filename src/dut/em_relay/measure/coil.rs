//! Coil resistance at the pre-bias, below pickup: the armature is open and L/R short. The pre-bias is
//! also where the operate ramp starts, so the coil stays on.

use super::{Bench, Findings, INTERLOCK, OFF, Stage, board};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::bins;
use crate::dut::em_relay::coil::{resistance, to_reference};
use crate::dut::em_relay::probe_contact::in_series;
use crate::dut::em_relay::supply::Supply;
use crate::dut::recipe::CoilChannels;
use crate::instrument::act::{Act, CoilScan, Read, Readings};
use crate::rig::point::AnalogIn;
use crate::rig::point::DigitalOut::{
    self, Arm, CoilDrive, EventNoBreak, KelvinTest, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::rig::sample::{Quality, Sample};
use crate::units::{Ohm, Span, Volt};

/// Channels of the coil converter that a recipe has enabled.
const CHANNELS: usize = 2;
/// Below this fraction of the pre-bias the supply or the probe-up chain is in trouble, not the coil.
const LEAST_PREBIAS: f64 = 0.5;
/// Below this terminal voltage of the fine current channel (0.25 mA) no current flows.
const NO_CURRENT: Volt = Volt(0.15);
/// Below this coil current the clamp may be switched and the probes may leave, ampere.
const OFF_CURRENT_A: f64 = 0.001;
/// The word that takes the drive off is written, and the current gone, so long after the mark before it.
const FREED: Span = Span::ms(6);
/// Nothing driven, nothing selected; the pins of the next part will be looked at first.
const IDLE: [(DigitalOut, bool); 8] = [
    (SourceOn, false),
    (SourceReverse, false),
    (CoilDrive, false),
    (Arm, false),
    (RampMode, false),
    (SelectNo, false),
    (EventNoBreak, false),
    (KelvinTest, true),
];

/// The board is prepared for the operate ramp while the coil is converted: nothing moves the supply
/// between arming and the ramp.
pub(super) fn acts(bench: &Bench, supply: &mut Supply, findings: &mut Findings) -> Vec<Act> {
    let prebias = Volt(bench.recipe.test.prebias_v);
    let sampling = bench.recipe.test.strategy.coil;
    let (coarse, coarse_takes) = supply.ramp_coarse(Volt(0.0));
    let (fine, fine_takes) = supply.ramp_fine(Volt(0.0));
    let repeated = findings.attempts(Parameter::CoilResistance) > 0;
    (findings.operated, findings.released, findings.armed) = (false, false, true);
    let mut acts = Vec::new();
    if repeated {
        let falls = std::mem::take(&mut findings.still_ramping);
        let down = OFF.max(coarse_takes).max(falls + fine_takes);
        acts.extend([coarse, fine, Act::Board(IDLE.to_vec()), Act::Wait(down)]);
    }
    acts.extend((supply.total() != prebias).then(|| supply.step_to(prebias)));
    acts.extend([
        board(&[
            (SourceOn, false),
            (SourceReverse, false),
            (RampMode, true),
            (EventNoBreak, false),
            (Arm, false),
            (SelectNo, true),
            (CoilDrive, true),
        ]),
        Act::Wait(INTERLOCK + Span::ms(sampling.settles_ms.into())),
        Act::Mark,
        board(&[(Arm, true)]),
        Act::Read(Read::Gates),
        Act::ConvertSinceMark(bench.fresh(CHANNELS)),
        Act::Read(Read::Coil),
    ]);
    for _ in 1..sampling.scans {
        acts.extend([
            Act::Mark,
            Act::ConvertSinceMark(bench.round(CHANNELS)),
            Act::Read(Read::Coil),
        ]);
    }
    acts
}

/// Everything off, and the supply where the next part begins. After a release the coil is free since its mark,
/// or since the word that followed it.
pub(super) fn acts_off(bench: &Bench, supply: &mut Supply, findings: &Findings) -> Vec<Act> {
    let mut acts = vec![Act::Board(IDLE.to_vec())];
    if !findings.rested {
        acts.extend((!findings.released).then_some(Act::Mark));
        // What stands already is not written: a module that ignores writes would be found out by the next part only.
        acts.extend(findings.stopped().then(|| supply.step_to(Volt(0.0))));
        acts.extend(rest(bench, supply));
    }
    acts.extend([
        Act::ConvertSinceMark(FREED + bench.fresh(CHANNELS)),
        Act::Read(Read::Current(current_channel(bench))),
    ]);
    acts
}

/// The supply goes where the next part begins: pre-bias on the level, both ramps down. Then every module
/// with outputs is asked whether it has restarted under this part.
pub(super) fn rest(bench: &Bench, supply: &mut Supply) -> [Act; 4] {
    let (coarse, _) = supply.ramp_coarse(Volt(0.0));
    let (fine, _) = supply.ramp_fine(Volt(0.0));
    let level = supply.step_to(Volt(bench.recipe.test.prebias_v));
    [coarse, fine, level, Act::Read(Read::Resets)]
}

fn current_of(bench: &Bench, scan: &CoilScan) -> Option<Sample> {
    match bench.recipe.test.coil_channels {
        CoilChannels::Fine => scan.current_fine.clone(),
        CoilChannels::CoarseCurrent => scan.current_wide.clone(),
    }
}

fn current_channel(bench: &Bench) -> AnalogIn {
    match bench.recipe.test.coil_channels {
        CoilChannels::Fine => AnalogIn::CoilCurrentFine,
        CoilChannels::CoarseCurrent => AnalogIn::CoilCurrent,
    }
}

pub(super) fn conclude(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
) -> Option<Stage> {
    let calibration = &bench.calibration;
    let mut scans = Vec::new();
    let mut samples = Vec::new();
    for scan in &readings.coil {
        let (Some(voltage), Some(current)) = (scan.voltage_fine.clone(), current_of(bench, scan))
        else {
            findings.void("coil converter gave no voltage or current");
            return None;
        };
        if voltage.quality != Quality::Good {
            findings.void("coil voltage not readable");
            return None;
        }
        if voltage.value < LEAST_PREBIAS * bench.recipe.test.prebias_v {
            findings.void(format!(
                "coil supply gives {:.2} V at the pre-bias",
                voltage.value
            ));
            return None;
        }
        if current.quality == Quality::OverRange {
            findings.fail("coil_resistance_ohm low: current over range", bins::COIL);
            return None;
        }
        let offset = Volt(calibration.coil_input.offset_v.value);
        scans.push((
            Volt(voltage.terminal_volts) - offset,
            Volt(current.terminal_volts) - offset,
        ));
        samples.extend([voltage, current]);
    }
    let ohm = match bench.recipe.test.coil_channels {
        CoilChannels::Fine => calibration.ohm_fine,
        CoilChannels::CoarseCurrent => calibration.ohm_wide,
    };
    if scans.iter().all(|(_, current)| current.abs() < NO_CURRENT) {
        findings.fail("coil open", bins::COIL);
        return None;
    }
    let part = findings.track?;
    let reference = bench.reference_temperature();
    match resistance(&scans, ohm, part, reference, bench.scan_doubt()) {
        Some(reading) => {
            let coil = Ohm(reading.value / to_reference(part, reference));
            findings.probe_contact = probe_contact(bench, &readings.coil, coil);
            findings.found(Parameter::CoilResistance, reading, &samples);
        }
        None => findings.fail("coil open", bins::COIL),
    }
    if let Some(unmoved) = findings.unmoved.take() {
        findings.fail(unmoved, bins::CONTACT);
    }
    None
}

/// What is lost between the supply and the pins of `coil`; the input is taken as it was calibrated, like the supply.
fn probe_contact(bench: &Bench, scans: &[CoilScan], coil: Ohm) -> Option<Ohm> {
    let at_pins = |scan: &CoilScan| {
        let Sample {
            value,
            terminal_volts,
            ..
        } = *scan.voltage_fine.as_ref()?;
        let corrected = bench.calibration.coil_input.correct(Volt(terminal_volts));
        Some(value * corrected.0 / terminal_volts)
    };
    let volts = scans.iter().map(at_pins).sum::<Option<f64>>()? / scans.len() as f64;
    Some(in_series(
        Volt(bench.recipe.test.prebias_v),
        Volt(volts),
        coil,
    ))
}

pub(super) fn conclude_off(readings: &Readings, findings: &mut Findings) -> Option<Stage> {
    match readings.currents.first() {
        Some(sample) if sample.quality == Quality::Good && sample.value.abs() < OFF_CURRENT_A => {}
        Some(_) | None => findings.void("coil current not gone after the test"),
    }
    None
}
