//! References of the fixture, connected in place of an AC part, reveal the errors of the channels of the digitizer.
//!
//! Their relays switch only while neither line, loop nor source is connected.

use super::super::board::{Position, RELAY};
use super::super::given::{Given, NotDelivered};
use super::super::state::{Next, State};
use super::leakage::{Seen, seen_at};
use super::stage::Reference;
use super::{BOUNCED, Level, STORED, contacts, leave, line_level};
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::ac_plan::{AcPlan, DIVIDER, LINE_OHM, Scales};
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{Device, DigitalOut, Points};
use crate::dut::ssr::program::{DIVIDED_CHANNEL, OUTPUT_CHANNEL, SHUNT_CHANNEL};
use crate::dut::ssr::references::{Doubt, References};
use crate::dut::ssr::wave::Channel;
use crate::dut::ssr::wave::split::Admittance;
use crate::instrument::act::Act;
use crate::instrument::query::Waveform;
use units::{RigTime, Span};

/// Resistance of the reference resistor, ohm.
pub const REFERENCE_OHM: f64 = 1000.0;
/// Largest deviation of a gain or ratio from 1 that counts as an error of a channel; beyond it something is broken.
const NEAR: f64 = 0.1;

/// Readings of the references measured so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shown {
    zero_v: f64,
    shunt_zero_v: f64,
    divided_zero_v: f64,
    gain: f64,
    divided_gain: f64,
    ratio: Admittance,
    doubt: Doubt,
}

impl Reference {
    /// Returns the outputs that select the reference, and those that then connect it.
    const fn outputs(self) -> (&'static [DigitalOut], &'static [DigitalOut]) {
        use DigitalOut::{BleedOpen, LineContactor, Reference0, Reference1, SmuToOutput};
        match self {
            Self::Zero => (&[BleedOpen, Reference1], &[]),
            Self::Gain => (&[BleedOpen, Reference0], &[SmuToOutput]),
            Self::Ratio => (&[BleedOpen, Reference0, Reference1], &[LineContactor]),
            Self::Stray => (&[BleedOpen, Reference0], &[LineContactor]),
        }
    }

    const fn is_on_line(self) -> bool {
        match self {
            Self::Zero | Self::Gain => false,
            Self::Ratio | Self::Stray => true,
        }
    }

    /// Returns the channels to read.
    const fn channels(self) -> &'static [f64] {
        match self.is_on_line() {
            true => &[DIVIDED_CHANNEL, SHUNT_CHANNEL],
            false => &[DIVIDED_CHANNEL, OUTPUT_CHANNEL, SHUNT_CHANNEL],
        }
    }

    fn scales(self, ac: &AcPlan) -> Scales {
        match self {
            Self::Zero | Self::Gain => Scales {
                clamped_v: ac.drop_scale_v,
                divided_v: (ac.reference_v() / DIVIDER / 3.5).max(1e-3),
                shunt_v: ac.looped().shunt_v,
                ..ac.line(4.0 * ac.half_s(), 1e3)
            },
            Self::Ratio => Scales {
                points: 1e4,
                ..ac.line(ac.leakage().record_s, 1e4)
            },
            Self::Stray => ac.leakage(),
        }
    }
}

/// Returns the acts that connect a reference, take one record and disconnect it.
pub fn acts(
    state: &mut State,
    reference: Reference,
    plan: &Plan,
    ac: &AcPlan,
    points: &Points,
) -> Vec<Act> {
    let scales = reference.scales(ac);
    let (relays, connection) = reference.outputs();
    let mut acts = match state.position.is_on_mains() {
        true => leave(state, points),
        false => Vec::new(),
    };
    acts.extend([Act::Set(points.outputs(relays)), Act::Wait(RELAY)]);
    if reference.is_on_line() && state.level != Level::Line {
        acts.push(Act::Query(vec![line_level(state, ac, points)]));
    }
    acts.push(Act::Set(points.outputs(&[relays, connection].concat())));
    acts.push(Act::Wait(RELAY));
    acts.extend(powered(reference, plan, ac, points));
    let mut reads = points.record(&scales, reference.channels());
    reads.extend((reference == Reference::Gain).then(|| points.off(Device::SmuOut)));
    acts.extend([
        Act::Query(vec![
            points.capture_all(plan, &scales),
            points.force_trigger(),
        ]),
        Act::Wait(Span::seconds(scales.record_s) + STORED),
        Act::Query(reads),
        Act::Set(points.outputs(relays)),
        Act::Wait(RELAY),
    ]);
    acts.extend(leave(state, points));
    acts.push(Act::Wait(RELAY));
    acts
}

/// Returns the acts after which a connected reference has its voltage.
fn powered(reference: Reference, plan: &Plan, ac: &AcPlan, points: &Points) -> Vec<Act> {
    match reference {
        Reference::Zero => Vec::new(),
        Reference::Gain => {
            let source = points.source(Device::SmuOut, ac.reference_v(), &plan.load);
            vec![Act::Query(vec![source]), Act::Wait(RELAY)]
        }
        Reference::Ratio | Reference::Stray => {
            vec![contacts(points, Position::Line), Act::Wait(BOUNCED)]
        }
    }
}

/// Concludes a reference. After the last one all of them are valid from `now` on.
pub fn conclude(
    state: &mut State,
    reference: Reference,
    ac: &AcPlan,
    given: &Given,
    now: RigTime,
) -> Result<Next, Reason> {
    let is_plausible = match reference {
        Reference::Zero | Reference::Gain => clamped(state, reference, ac, given)?,
        Reference::Ratio | Reference::Stray => line(state, reference, ac, given, now)?,
    };
    if !is_plausible {
        state.record.stop(Finding::WrongReference);
    }
    Ok(Next::Planned)
}

fn clamped(
    state: &mut State,
    reference: Reference,
    ac: &AcPlan,
    given: &Given,
) -> Result<bool, NotDelivered> {
    let all: [_; 3] = given.waveforms()?;
    let means: Option<Vec<(f64, f64)>> = all.iter().map(|it| mean(it)).collect();
    let Some(&[(divided_v, _), (clamped_v, zero_u_v), (shunt_v, shunt_u_v)]) = means.as_deref()
    else {
        return Err(NotDelivered(Device::Digitizer));
    };
    let level_v = ac.reference_v();
    let at_channel = [level_v / DIVIDER, level_v];
    if !all
        .iter()
        .zip(at_channel)
        .all(|(it, level_v)| is_steady(it, level_v))
    {
        return Ok(false);
    }
    let shown = &mut state.shown;
    if reference == Reference::Zero {
        (shown.zero_v, shown.shunt_zero_v) = (clamped_v, shunt_v);
        shown.divided_zero_v = divided_v;
        (shown.doubt.zero_v, shown.doubt.shunt_zero_v) = (zero_u_v, shunt_u_v);
        return Ok(clamped_v.abs() < NEAR * level_v);
    }
    shown.gain = (clamped_v - shown.zero_v) / level_v;
    shown.divided_gain = (divided_v - shown.divided_zero_v) * DIVIDER / level_v;
    let is_near = |gain: f64| (gain - 1.0).abs() < NEAR;
    Ok(is_near(shown.gain) && is_near(shown.divided_gain))
}

/// Returns true when a record stays where it begins: a lead that opens for a while does not.
fn is_steady(waveform: &Waveform, level_v: f64) -> bool {
    let (least, most) = waveform
        .volts
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(least, most), it| {
            (least.min(*it), most.max(*it))
        });
    f64::from(most - least) < NEAR * level_v
}

/// Returns the mean of a record, V, and its standard uncertainty.
fn mean(waveform: &Waveform) -> Option<(f64, f64)> {
    let channel = Channel::of(waveform, 1.0, 0.0).filter(|it| !it.is_empty())?;
    let count = channel.len() as f64;
    let all = (0..channel.len()).map(|it| channel.at(it));
    let mean = all.clone().sum::<f64>() / count;
    let squares: f64 = all.map(|it| (it - mean).powi(2)).sum();
    Some((mean, squares.sqrt() / count))
}

fn line(
    state: &mut State,
    reference: Reference,
    ac: &AcPlan,
    given: &Given,
    now: RigTime,
) -> Result<bool, Reason> {
    let [divided, shunt] = given.waveforms()?;
    // With the load the reference resistor divides the voltage of the line.
    let share = match reference {
        Reference::Ratio => REFERENCE_OHM / (REFERENCE_OHM + LINE_OHM),
        Reference::Zero | Reference::Gain | Reference::Stray => 1.0,
    };
    let seen = seen_at(
        ac,
        share * ac.peak_v(),
        &reference.scales(ac),
        [&divided, &shunt],
    );
    let leak = match seen {
        Some(Seen::Blocked(leak)) => leak,
        Some(Seen::Dead) => return Err(Finding::LineDead.into()),
        Some(Seen::Beyond | Seen::Half | Seen::Conducts | Seen::WrongMains) | None => {
            return Ok(false);
        }
    };
    if reference == Reference::Ratio {
        let siemens = Admittance {
            conductance: 1.0 / REFERENCE_OHM,
            susceptance: 0.0,
        };
        state.shown.ratio = leak.admittance.over(siemens);
        state.shown.doubt.ratio = leak.noise_a / (ac.mains_v * leak.admittance.size());
        return Ok((state.shown.ratio.size() - 1.0).abs() < NEAR);
    }
    let Shown {
        zero_v,
        shunt_zero_v,
        gain,
        divided_gain,
        ratio,
        doubt,
        ..
    } = state.shown;
    // The capacitance of the fixture lay beside the reference of the ratio, too.
    let beside = leak.admittance.over(ratio);
    let ratio = ratio.over(Admittance {
        conductance: 1.0 + REFERENCE_OHM * beside.conductance,
        susceptance: REFERENCE_OHM * beside.susceptance,
    });
    let stray = leak.admittance.over(ratio).at_hz(leak.hz, ac.mains_hz);
    state.references = Some(References {
        zero_v,
        shunt_zero_v,
        gain,
        divided_gain,
        ratio,
        stray,
        doubt: Doubt {
            stray_a: leak.noise_a,
            ..doubt
        },
        at: now,
    });
    Ok(stray.size() * ac.mains_v < ac.blocked_a)
}
