//! Contact resistance of a closure: source on, the polarities of the recipe, each read from a conversion that
//! began after the source had settled.

use super::{Bench, Findings, INTERLOCK, Stage, board};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::bins;
use crate::dut::em_relay::contact::{Closure, resistance, u_with_later_v};
use crate::dut::em_relay::sampling::Polarities;
use crate::dut::em_relay::supply::Supply;
use crate::instrument::act::{Act, Read, Readings};
use crate::rig::point::DigitalOut::{Arm, KelvinTest, SourceOn, SourceReverse};
use crate::rig::sample::{Quality, Sample};
use crate::units::{Celsius, Span, Volt};

/// No contact of 10 A class is below this, milliohms; a source that is off reads about 0.
const LEAST_MOHM: f64 = 0.5;
/// The thermal EMF may have moved by 30 uV between two closures; at the terminal, behind the gain of 50.
const EMF_MOVES_V: f64 = 30e-6 * 50.0;
/// Current and amplifier have settled.
pub(super) const SOURCE_SETTLES: Span = Span::ms(1);

/// The source turned round, and a reading.
fn turned(bench: &Bench, reverse: bool) -> [Act; 4] {
    [
        board(&[(SourceReverse, reverse)]),
        Act::Mark,
        Act::ConvertSinceMark(INTERLOCK + SOURCE_SETTLES + bench.fresh(1)),
        Act::Read(Read::Drop),
    ]
}

/// The readings after a first forward one; the source stays on, the way it was driven last.
pub(super) fn reversed(bench: &Bench) -> Vec<Act> {
    let mut acts = turned(bench, true).to_vec();
    match bench.recipe.test.strategy.contact.polarities {
        Polarities::PlusMinus => {}
        Polarities::PlusMinusMinusPlus => {
            acts.extend([
                Act::Mark,
                Act::ConvertSinceMark(bench.round(1)),
                Act::Read(Read::Drop),
            ]);
            acts.extend(turned(bench, false));
        }
    }
    acts
}

/// Both polarities at rest. While the first one is converted the temperature of the part is read, and the timed
/// operation prepared: counters behind an ARM that nothing can answer, supply at nominal with the drive off.
pub(super) fn acts_nc(bench: &Bench, supply: &mut Supply, findings: &mut Findings) -> Vec<Act> {
    findings.counted = true;
    let mut acts = vec![
        board(&[(KelvinTest, false), (SourceOn, true), (Arm, true)]),
        Act::Mark,
        Act::Read(Read::Track),
        Act::Read(Read::Board),
        Act::Read(Read::Gates),
        supply.step_to(Volt(bench.recipe.part.nominal_v)),
        Act::ConvertSinceMark(SOURCE_SETTLES + bench.fresh(1)),
        Act::Read(Read::Drop),
    ];
    acts.extend(reversed(bench));
    acts
}

/// Drop of a reading, or why there is none.
pub(super) fn drop_of(sample: Option<&Sample>, compliance: bool) -> Result<Volt, Unread> {
    let Some(sample) = sample else {
        return Err(Unread::Missing);
    };
    match sample.quality {
        Quality::Good if sample.terminal_volts.is_finite() => Ok(Volt(sample.terminal_volts)),
        Quality::OverRange | Quality::UnderRange if compliance => Err(Unread::OpenContact),
        Quality::OverRange | Quality::UnderRange => Err(Unread::OverRange),
        Quality::Good | Quality::Blank => Err(Unread::Missing),
    }
}

/// Why a drop could not be read.
pub(super) enum Unread {
    /// No usable sample.
    Missing,
    /// Over range though the source drives its current: far too high.
    OverRange,
    /// Over range with the source in compliance: open or far too high.
    OpenContact,
}

impl Unread {
    pub(super) fn tell(self, which: &str, findings: &mut Findings) {
        match self {
            Unread::Missing => findings.void(format!("{which} drop not readable")),
            Unread::OverRange => {
                findings.fail(&format!("{which} resistance over range"), bins::CONTACT)
            }
            Unread::OpenContact => {
                findings.fail(&format!("{which} open or far too high"), bins::CONTACT)
            }
        }
    }
}

/// The closure that a stage has read with the polarities of the recipe.
pub(super) fn closure(bench: &Bench, readings: &Readings) -> Result<Closure, Unread> {
    let compliance = readings.boards.iter().any(|board| board.compliance);
    let drops: Result<Vec<Volt>, Unread> = readings
        .drops
        .iter()
        .map(|sample| drop_of(Some(sample), compliance))
        .collect();
    let polarities = bench.recipe.test.strategy.contact.polarities;
    Closure::of(&drops?, polarities).ok_or(Unread::Missing)
}

pub(super) fn conclude_nc(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
) -> Option<Stage> {
    match readings.track.first() {
        Some(track) if track.quality == Quality::Good && track.value.is_finite() => {
            findings.track = Some(Celsius(track.value));
        }
        Some(_) | None => findings.void("track temperature not readable"),
    }
    match closure(bench, readings) {
        Ok(closure) => {
            findings.drop_zero = Some(closure.zero);
            findings.released = true;
            add_nc(bench, closure.drop, &readings.drops, findings);
        }
        Err(unread) => unread.tell("NC contact", findings),
    }
    None
}

/// Voids a resistance that no contact has: the source was off, or a reply was not its own.
pub(super) fn is_implausible(which: &str, mohm: f64, findings: &mut Findings) -> bool {
    let implausible = mohm.is_nan() || mohm < LEAST_MOHM;
    if implausible {
        findings.void(format!(
            "{which} reads {mohm:.2} mOhm: no contact does, check the 1 A source"
        ));
    }
    implausible
}

/// True when more closures would not change what is said of this contact.
pub(super) fn is_clear(bench: &Bench, findings: &Findings, parameter: Parameter) -> bool {
    let recipe = &bench.recipe;
    let per_v = bench.calibration.contact_mohm_per_v.value;
    let values: Vec<f64> = match parameter {
        Parameter::ContactResistanceNc => findings.nc_drops.iter().map(|it| per_v * it.0).collect(),
        Parameter::ContactResistanceNo
        | Parameter::CoilResistance
        | Parameter::OperateVoltage
        | Parameter::ReleaseVoltage
        | Parameter::OperateTime
        | Parameter::ReleaseTime
        | Parameter::OperateBounce
        | Parameter::ReleaseBounce => findings.each(parameter).map(|it| it.value).collect(),
    };
    let u = findings
        .result(parameter)
        .map_or(f64::INFINITY, |reading| reading.budget.combined());
    let sampling = recipe.test.strategy.contact;
    sampling.is_clear(&values, u, &recipe.limits.of(parameter))
}

/// Adds one NC closure; the result is the mean of all closures read.
pub(super) fn add_nc(bench: &Bench, drop: Volt, samples: &[Sample], findings: &mut Findings) {
    findings.nc_drops.push(drop);
    let first = bench.recipe.test.strategy.contact.polarities.signs().len();
    let later = findings.nc_drops.len() - 1;
    let u = u_with_later_v(first, later, bench.reading_u_v(), EMF_MOVES_V);
    if let Some(reading) = resistance(&findings.nc_drops, bench.calibration.contact_mohm_per_v, u) {
        if is_implausible("NC contact", reading.value, findings) {
            return;
        }
        findings.forget(Parameter::ContactResistanceNc);
        findings.found(Parameter::ContactResistanceNc, reading, samples);
    }
}
