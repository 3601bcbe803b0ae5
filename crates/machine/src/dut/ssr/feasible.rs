//! Whether a rig can carry out a recipe: points, instruments, their ranges and their programs.

use super::measure::{Stage, State};
use super::parameter::Parameter;
use super::plan::{Lack, Plan};
use super::points::{Device, Points};
use super::program::drop_count;
use super::recipe::SsrRecipe;
use crate::dut::Kind;
use crate::dut::device::Rig;
use crate::dut::recipe::Limits;
use crate::gauge::Rule;
use crate::instrument::act::Act;
use crate::rig::fault::Fault;
use crate::rig::wiring::Wiring;

/// Returns every reason why the rig cannot carry out the recipe.
pub fn infeasible(ssr: &SsrRecipe, limits: &Limits, rig: &Rig) -> Vec<Fault> {
    let points = Points::resolve(rig.wiring);
    let (wiring, points) = match Kind::Ssr.reach(rig, points, None) {
        Ok(reach) => reach,
        Err(fault) => return vec![fault],
    };
    let plan = match Plan::of(ssr, limits, Rule::GuardBand, &points, &wiring) {
        Ok(plan) => plan,
        Err(lack) => return vec![without_range(&lack, &points, &wiring)],
    };
    let mut faults = undecided(limits);
    faults.extend(backwards(&plan));
    faults.extend(unserved(&plan, &points, &wiring));
    faults
}

fn without_range(lack: &Lack, points: &Points, wiring: &Wiring) -> Fault {
    let instrument = wiring.instrument(points.instrument(lack.device));
    let profile = &instrument.profile.name;
    let quantity = lack.quantity.name();
    let found = format!("{quantity} {} at {}", lack.value, lack.device);
    let expected = format!("a value in a range of instruments/{profile}.toml accuracy");
    Fault::new("test", found, expected)
}

/// Refuses sides that the conformity test cannot decide.
fn undecided(limits: &Limits) -> Vec<Fault> {
    let (on, off) = (Parameter::TurnOnVoltage, Parameter::TurnOffVoltage);
    let sides = [
        ("limits.v_on_v.low", limits.of(on).low),
        ("limits.v_off_v.high", limits.of(off).high),
    ];
    let expected = "no limit on this side: the conformity test decides the other one";
    let found = sides
        .into_iter()
        .filter_map(|(key, side)| Some((key, side?)));
    found
        .map(|(key, side)| Fault::new(key, side, expected))
        .collect()
}

/// Refuses voltages that are not in the order 0, turn-off, turn-on, nominal.
fn backwards(plan: &Plan) -> Option<Fault> {
    let off_v = plan.turn_off_v.unwrap_or(0.0);
    let on_v = plan.turn_on_v.unwrap_or(plan.control_v);
    if on_v > plan.control_v {
        let expected = format!("at most part.control_v, which is {}", plan.control_v);
        return Some(Fault::new("limits.v_on_v.high", on_v, expected));
    }
    let least_v = off_v + 4.0 * plan.guard_v;
    let expected = format!("at least {least_v:.3}: limits.v_off_v.low and two guard bands");
    (on_v < least_v).then(|| Fault::new("limits.v_on_v.high", on_v, expected))
}

/// Returns a fault for each instrument whose profile lacks a program of the test, or refuses one of its arguments.
fn unserved(plan: &Plan, points: &Points, wiring: &Wiring) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    for device in Device::ALL {
        let instrument = points.instrument(*device);
        let profile = &wiring.instrument(instrument).profile;
        let all = Stage::ALL.iter().flat_map(|stage| {
            let mut state = State::default();
            state.acts(*stage, plan, points)
        });
        let queries = all.filter_map(|act| {
            if let Act::Query(it) = act {
                Some(it)
            } else {
                None
            }
        });
        let mut own = queries
            .flatten()
            .filter(|query| query.instrument == instrument);
        let refused = own.find_map(|it| profile.program(it.program, &it.arguments).err());
        if let Some(error) = refused {
            let expected = format!(
                "what instruments/{}.toml of {device} has: {error}",
                profile.name
            );
            faults.push(Fault::new("kind", "\"ssr\"", expected));
        }
    }
    let many = drop_count();
    assert!(many > 2, "a drift needs a first and a last reading");
    faults
}
