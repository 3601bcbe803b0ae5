//! Contact resistance of a closure: source on, then one conversion per polarity of the recipe, each begun after the
//! source has settled.

use super::board::{Armature, BoardState};
use super::state::TestState;
use super::{Context, INTERLOCK, Stage, TestRecord, set};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::contact::{Closure, resistance, u_with_later_v};
use crate::dut::em_relay::finding::{Contact, Finding};
use crate::dut::em_relay::points::DigitalOut::{Arm, KelvinTest, SourceOn, SourceReverse};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::sampling::Polarities;
use crate::rig::sample::{Quality, Sample};
use units::{Celsius, Span, Volt};

/// Smallest resistance of any contact of the 10 A class, milliohms; with the source off the drop reads about 0.
const LEAST_MOHM: f64 = 0.5;
/// Change of the thermal EMF between two closures (30 uV), volts at the terminal, behind the amplifier with gain 50.
const EMF_MOVES_V: f64 = 30e-6 * 50.0;
/// Settling time of source and amplifier.
pub(super) const SOURCE_SETTLES: Span = Span::ms(1);

fn directed(context: &Context, reverse: bool) -> [Act; 4] {
    [
        set(&[(SourceReverse, reverse)]),
        Act::Mark,
        Act::ConvertSinceMark(INTERLOCK + SOURCE_SETTLES + context.fresh(1)),
        Act::Read(Read::Drop),
    ]
}

/// Returns the acts that read every polarity after the first, forward one; the source stays on in its last direction.
pub(super) fn reversed(context: &Context) -> Vec<Act> {
    let mut acts = directed(context, true).to_vec();
    match context.relay.test.strategy.contact.polarities {
        Polarities::PlusMinus => {}
        Polarities::PlusMinusMinusPlus => {
            acts.extend([
                Act::Mark,
                Act::ConvertSinceMark(context.round(1)),
                Act::Read(Read::Drop),
            ]);
            acts.extend(directed(context, false));
        }
    }
    acts
}

/// Reads the NC contact at rest in all polarities. During the first conversion the stage reads the temperature and
/// prepares the timed operation: ARM, counters, supply at nominal with the drive off.
pub(super) fn acts_nc(context: &Context, mut board: BoardState) -> (Vec<Act>, BoardState) {
    let mut acts = vec![
        set(&[(KelvinTest, false), (SourceOn, true), (Arm, true)]),
        Act::Mark,
        Act::Read(Read::Track),
        Act::Read(Read::Board),
        Act::Read(Read::Gates),
        board.supply.step_to(Volt(context.relay.part.nominal_v)),
        Act::ConvertSinceMark(SOURCE_SETTLES + context.fresh(1)),
        Act::Read(Read::Drop),
    ];
    acts.extend(reversed(context));
    board.armature = Armature::ReadyForTiming;
    (acts, board)
}

/// Returns the drop of a reading, or why it has none.
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

/// Reason why a reading gives no drop.
pub(super) enum Unread {
    /// No usable sample.
    Missing,
    /// Over range while the source drives its current: resistance far above the limit.
    OverRange,
    /// Over range with the source in compliance: open, or resistance far above the limit.
    OpenContact,
}

impl Unread {
    pub(super) fn of(self, contact: Contact) -> Finding {
        match self {
            Unread::Missing => Finding::DropNotReadable(contact),
            Unread::OverRange => Finding::ContactOverRange(contact),
            Unread::OpenContact => Finding::ContactOpen(contact),
        }
    }
}

/// Evaluates the readings of a closure with the polarities of the recipe.
pub(super) fn closure(context: &Context, readings: &Readings) -> Result<Closure, Unread> {
    let compliance = readings.boards.iter().any(|board| board.compliance);
    let drops: Result<Vec<Volt>, Unread> = readings
        .drops
        .iter()
        .map(|sample| drop_of(Some(sample), compliance))
        .collect();
    let polarities = context.relay.test.strategy.contact.polarities;
    Closure::of(&drops?, polarities).ok_or(Unread::Missing)
}

pub(super) fn conclude_nc(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
) -> Option<Stage> {
    match readings.track.first() {
        Some(track) if track.quality == Quality::Good && track.value.is_finite() => {
            state.record.own.track = Some(Celsius(track.value));
        }
        Some(_) | None => state.record.stop(Finding::TrackNotReadable),
    }
    match closure(context, readings) {
        Ok(closure) => {
            state.plan.drop_zero = Some(closure.zero);
            add_nc(context, closure.drop, &readings.drops, state);
        }
        Err(unread) => {
            state.board.armature = Armature::Unknown;
            state.record.stop(unread.of(Contact::Nc));
        }
    }
    None
}

/// Ends the test and returns true when the resistance is below that of any real contact: the source was off, or the
/// reply belongs to another request.
pub(super) fn is_implausible(contact: Contact, mohm: f64, record: &mut TestRecord) -> bool {
    let implausible = mohm.is_nan() || mohm < LEAST_MOHM;
    if implausible {
        let detail = format!("{mohm:.2} mOhm");
        record.stop(Finding::ContactImplausible(contact).with(detail));
    }
    implausible
}

/// Returns true when further closures would not change the judgement of this contact.
pub(super) fn is_clear(context: &Context, state: &TestState, parameter: Parameter) -> bool {
    let (recipe, record) = (&context.recipe, &state.record);
    let per_v = context.calibration.contact_mohm_per_v.value;
    let values_mohm: Vec<f64> = if parameter == Parameter::ContactResistanceNc {
        state.plan.nc_drops.iter().map(|it| per_v * it.0).collect()
    } else {
        record.each(parameter).map(|it| it.value).collect()
    };
    let u_mohm = record
        .result(parameter)
        .map_or(f64::INFINITY, |reading| reading.budget.combined());
    let sampling = context.relay.test.strategy.contact;
    sampling.is_clear(&values_mohm, u_mohm, &recipe.limits.of(parameter))
}

/// Adds one NC closure; the result is the mean of all NC closures.
pub(super) fn add_nc(context: &Context, drop: Volt, samples: &[Sample], state: &mut TestState) {
    let (drops, record) = (&mut state.plan.nc_drops, &mut state.record);
    let per_v = context.calibration.contact_mohm_per_v;
    drops.push(drop);
    record.own.nc_mohm.push(per_v.value * drop.0);
    let first = context.relay.test.strategy.contact.polarities.signs().len();
    let later = drops.len() - 1;
    let u = u_with_later_v(first, later, context.reading_u_v(), EMF_MOVES_V);
    if let Some(reading) = resistance(drops, per_v, u) {
        if is_implausible(Contact::Nc, reading.value, record) {
            return;
        }
        record.forget(Parameter::ContactResistanceNc);
        record.found(Parameter::ContactResistanceNc, reading, samples);
    }
}
