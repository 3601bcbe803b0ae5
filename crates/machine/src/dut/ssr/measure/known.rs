//! Known states of the fixture in place of the output, before a finding about the output fails the part.
//!
//! A short in the socket looks like a shorted output, and an open lead of the source like an output that never conducts.
//! With the open reference in place of the output the short check must see no current. With the short reference the source
//! of a DC part must drive its load. The records of AC parts show themselves whether their circuit was closed.

use super::board::{self, Position, RELAY};
use super::conformity::is_on;
use super::contact::look;
use super::given::{Given, NotDelivered};
use super::line;
use super::state::{Next, State};
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::plan::{LOAD_V, OutputPlan, Plan};
use crate::dut::ssr::points::{Device, DigitalIn, DigitalOut, Points};
use crate::instrument::act::Act;

/// Returns the acts: the short check at the open reference; for a DC part also its load at the short reference.
pub fn acts(state: &mut State, plan: &Plan, points: &Points) -> Vec<Act> {
    use DigitalOut::{BleedOpen, Reference0, Reference1, ShortCheck, SmuLoad, SmuToOutput};
    let mut acts = match state.position.is_on_mains() {
        true => {
            let mut acts = line::leave(state, points);
            acts.push(Act::Query(vec![points.off(Device::SmuIn)]));
            acts
        }
        false => board::change(points, state.position, Position::Isolated),
    };
    state.position = Position::Isolated;
    let settle = |on: &[DigitalOut]| [Act::Set(points.outputs(on)), Act::Wait(RELAY)];
    acts.extend(settle(&[Reference0]));
    acts.extend(look(points, &[Reference0, ShortCheck]));
    acts.extend(settle(&[Reference0]));
    acts.extend(settle(&[]));
    if checks_load(state, plan) {
        let connected = [BleedOpen, Reference1, SmuToOutput, SmuLoad];
        acts.extend(settle(&[BleedOpen, Reference1]));
        acts.extend(settle(&connected));
        acts.push(Act::Query(vec![
            points.source(Device::SmuOut, LOAD_V, &plan.load),
            points.read(Device::SmuOut),
            points.off(Device::SmuOut),
        ]));
        acts.extend(settle(&[BleedOpen, Reference1]));
        acts.extend(settle(&[]));
    }
    acts
}

/// Returns true when the source of a DC part has a share in the doubted finding; the first short check has its own source.
fn checks_load(state: &State, plan: &Plan) -> bool {
    let is_short = state.doubted == Some(Finding::Shorted.into());
    matches!(plan.output, OutputPlan::Dc(_)) && !is_short
}

/// Concludes: the finding holds unless the fixture shows another cause.
pub fn conclude(state: &mut State, plan: &Plan, given: &Given) -> Result<Next, Reason> {
    line::switched(given)?;
    let why = cause(checks_load(state, plan), given)?.map(Reason::from);
    if let Some(why) = why.or(state.doubted.take()) {
        state.record.stop(why);
    }
    Ok(Next::Planned)
}

/// Returns the trouble of the fixture that explains a doubted finding; `None` without one.
fn cause(checks_load: bool, given: &Given) -> Result<Option<Finding>, NotDelivered> {
    if given.is_on(DigitalIn::ShortSeen) {
        return Ok(Some(Finding::SocketShorted));
    }
    if !checks_load {
        return Ok(None);
    }
    let [ampere] = given.singles(Device::SmuOut)?;
    Ok((!is_on(ampere)).then_some(Finding::LoopDead))
}
