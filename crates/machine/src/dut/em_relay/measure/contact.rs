//! Contact resistance of a closure: source on, then one conversion per polarity of the recipe, each begun after the
//! source has settled. Under `alternating` the reversed reading of NO and the zero ride with the ramps and the coil.

use super::board::{Armature, BoardState};
use super::plan::Plan;
use super::state::TestState;
use super::{Context, INTERLOCK, Stage, set};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::contact::{Closure, ContactDrop, Zero, resistance};
use crate::dut::em_relay::finding::{Contact, Finding};
use crate::dut::em_relay::points::DigitalOut::{Arm, KelvinTest, SourceOn, SourceReverse};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::sampling::Polarities;
use crate::rig::sample::{Quality, Sample};
use units::{Celsius, Span, Volt};

/// Smallest resistance of any contact of the 10 A class, milliohms; with the source off the drop reads about 0.
const LEAST_MOHM: f64 = 0.5;
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
    match context.polarities() {
        Polarities::Alternating => acts.clear(),
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

/// Reads the NC contact at rest, reversed under `alternating`, else in all polarities. During the first conversion the
/// stage reads the temperature and prepares the timed operation: ARM, counters, supply at nominal with the drive off.
pub(super) fn acts_nc(context: &Context, mut board: BoardState) -> (Vec<Act>, BoardState) {
    let mut acts = vec![
        set(&[
            (KelvinTest, false),
            (SourceOn, true),
            (SourceReverse, context.alternates()),
            (Arm, true),
        ]),
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
    Closure::of(&drops?, context.polarities()).ok_or(Unread::Missing)
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
    let u_v = context.reading_u_v();
    match closure(context, readings) {
        Ok(closure) if context.alternates() => {
            let drop = ContactDrop::single(closure.drop, true, u_v);
            add(context, (Contact::Nc, drop), &readings.drops, state);
        }
        Ok(closure) => {
            state.plan.zero = Some(Zero::read(closure.zero, closure.u_v(u_v)));
            let drop = ContactDrop::reversed(closure, u_v);
            add(context, (Contact::Nc, drop), &readings.drops, state);
        }
        Err(unread) => {
            state.board.armature = Armature::Unknown;
            state.record.stop(unread.of(Contact::Nc));
        }
    }
    None
}

/// Returns the parameter of a contact, and the drops of its closures.
fn of(contact: Contact, plan: &Plan) -> (Parameter, &[ContactDrop]) {
    match contact {
        Contact::No => (Parameter::ContactResistanceNo, &plan.no),
        Contact::Nc => (Parameter::ContactResistanceNc, &plan.nc),
    }
}

/// Returns the resistance of each closure read so far.
fn each_mohm(context: &Context, contact: Contact, plan: &Plan) -> Vec<f64> {
    let per_v = context.calibration.contact_mohm_per_v.value;
    let zero = plan.zero.unwrap_or(Zero::unknown());
    let drops = of(contact, plan).1.iter();
    drops.map(|it| per_v * it.without(zero).0).collect()
}

/// Returns true when further closures would not change the judgement of this contact.
pub(super) fn is_clear(context: &Context, state: &TestState, contact: Contact) -> bool {
    let (recipe, parameter) = (&context.recipe, of(contact, &state.plan).0);
    let u_mohm = state
        .record
        .result(parameter)
        .map_or(f64::INFINITY, |reading| reading.budget.combined());
    let sampling = context.relay.test.strategy.contact;
    let values_mohm = each_mohm(context, contact, &state.plan);
    sampling.is_clear(&values_mohm, u_mohm, &recipe.limits.of(parameter))
}

/// Adds one closure; the result is the mean of all closures. Ends the test when its resistance is below that of any real
/// contact: the source was off, or the reply belongs to another request.
pub(super) fn add(
    context: &Context,
    (contact, drop): (Contact, ContactDrop),
    samples: &[Sample],
    state: &mut TestState,
) {
    match contact {
        Contact::No => state.plan.no.push(drop),
        Contact::Nc => state.plan.nc.push(drop),
    }
    let mohm = each_mohm(context, contact, &state.plan).pop();
    if let Some(mohm) = mohm.filter(|it| it.is_nan() || *it < LEAST_MOHM) {
        let detail = format!("{mohm:.2} mOhm");
        let finding = Finding::ContactImplausible(contact).with(detail);
        state.record.stop(finding);
        return;
    }
    evaluate(context, contact, samples, state);
}

/// Keeps the drop without current of a closed contact, and evaluates the closures again.
pub(super) fn keep_zero(context: &Context, samples: &[Sample], state: &mut TestState) {
    let Ok(volts) = drop_of(samples.first(), false) else {
        return;
    };
    state.plan.zero = Some(Zero::read(volts, context.reading_u_v()));
    for contact in [Contact::No, Contact::Nc] {
        evaluate(context, contact, samples, state);
    }
}

fn evaluate(context: &Context, contact: Contact, samples: &[Sample], state: &mut TestState) {
    let TestState { plan, record, .. } = state;
    let (parameter, drops) = of(contact, plan);
    let zero = plan.zero.unwrap_or(Zero::unknown());
    if let Some(reading) = resistance(drops, zero, context.calibration.contact_mohm_per_v) {
        record.forget(parameter);
        record.found(parameter, reading, samples);
    }
    if contact == Contact::Nc && plan.zero.is_some() {
        record.own.nc_mohm = each_mohm(context, contact, plan);
    }
}
