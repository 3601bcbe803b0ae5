//! Whether a rig can carry out a recipe: points, instruments, their ranges and their programs.

use super::ac_plan::{AcPlan, LINE_OHM, LOOP_OHM, MOST_LOOP_V};
use super::measure::{Stage, State};
use super::parameter::Parameter;
use super::plan::{Lack, Plan};
use super::points::{Device, Points};
use super::program::drop_count;
use super::recipe::{Output, SsrRecipe};
use crate::dut::Kind;
use crate::dut::characteristic::KindCharacteristic;
use crate::dut::device::Rig;
use crate::dut::recipe::Limits;
use crate::gauge::Rule;
use crate::instrument::act::Act;
use crate::rig::fault::Fault;
use crate::rig::wiring::Wiring;

/// Least step, as a share of the nominal control voltage, on which the digitizer triggers before a ramp.
const STEP: f64 = 0.1;
/// Share of the rated voltage up to which the line may go.
const ROOM_OF_RATING: f64 = 1.0;

/// Returns every reason why the rig cannot carry out the recipe.
pub fn infeasible(ssr: &SsrRecipe, limits: &Limits, rig: &Rig) -> Vec<Fault> {
    let points = Points::resolve(rig.wiring, ssr.part.output != Output::Dc);
    let (wiring, points) = match Kind::Ssr.reach(rig, points, None) {
        Ok(reach) => reach,
        Err(fault) => return vec![fault],
    };
    let plan = match Plan::of(ssr, limits, Rule::GuardBand, &points, &wiring) {
        Ok(plan) => plan,
        Err(lack) => return vec![without_range(&lack, &points, &wiring)],
    };
    let mut faults = undecided(limits);
    faults.extend(foreign(ssr, limits));
    faults.extend(
        plan.ac()
            .into_iter()
            .flat_map(|ac| off_line(ssr, ac, &points, &wiring)),
    );
    faults.extend(backwards(&plan));
    faults.extend(unramped(&plan));
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

/// Refuses limits of characteristics that an output of this kind does not have.
fn foreign(ssr: &SsrRecipe, limits: &Limits) -> Vec<Fault> {
    let output = ssr.part.output;
    let wrong = Parameter::ALL.into_iter().filter(|it| !output.has(*it));
    let limited = wrong.filter(|it| !limits.of(*it).is_open());
    let fault = |it: Parameter| {
        let key = format!("limits.{}", it.definition().key);
        let expected = format!("no limit, because part.output is \"{}\"", output.name());
        Fault::new(key, "a limit", expected)
    };
    limited.map(fault).collect()
}

/// Refuses a line that the source or the loads of the fixture cannot make.
fn off_line(ssr: &SsrRecipe, ac: &AcPlan, points: &Points, wiring: &Wiring) -> Vec<Fault> {
    let part = &ssr.part;
    let profile = &wiring
        .instrument(points.instrument(Device::AcSource))
        .profile;
    let refuses = |level_v: f64, hz: f64| {
        let arguments = [("level_v", level_v), ("frequency_hz", hz), ("limit_a", 1.0)];
        let program = profile.program("set", &arguments);
        program
            .err()
            .map(|error| format!("what instruments/{}.toml has: {error}", profile.name))
    };
    let load_a = part.mains_v / LINE_OHM;
    let most_v = ROOM_OF_RATING * part.rated_v;
    let all = [
        ("part.mains_v", part.mains_v, refuses(part.mains_v, 50.0)),
        ("part.mains_hz", part.mains_hz, refuses(24.0, part.mains_hz)),
        (
            "part.mains_v",
            part.mains_v,
            (part.mains_v > most_v).then(|| format!("at most {most_v}, the rated voltage")),
        ),
        (
            "part.least_a",
            part.least_a,
            (part.least_a > load_a).then(|| {
                format!("at most {load_a:.3}, mains_v over the {LINE_OHM} ohm of the line")
            }),
        ),
        (
            "part.rated_a",
            part.rated_a,
            (ac.loop_v() > MOST_LOOP_V)
                .then(|| format!("a current that {MOST_LOOP_V} V drive through {LOOP_OHM} ohm")),
        ),
    ];
    let wrong = all.into_iter();
    wrong
        .filter_map(|(key, found, expected)| Some(Fault::new(key, found, expected?)))
        .collect()
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

/// Refuses a ramp of an AC part, which switches at zeros of the mains alone, and one without a step that starts the record
/// of the digitizer: from 0 V up to the turn-off limit, and from the nominal voltage down to the turn-on limit.
fn unramped(plan: &Plan) -> Option<Fault> {
    if !plan.ramps {
        return None;
    }
    if plan.dc().is_none() {
        let expected =
            "\"conformity\" or \"bisect\", because an AC output switches once in a half period";
        return Some(Fault::new("test.method", "\"ramp\"", expected));
    }
    let least_v = STEP * plan.control_v;
    let off_v = plan.turn_off_v.unwrap_or(0.0);
    if off_v < least_v {
        let expected = format!("at least {least_v:.3}, from which a ramp begins");
        return Some(Fault::new("limits.v_off_v.low", off_v, expected));
    }
    let most_v = plan.control_v - least_v;
    let on_v = plan.turn_on_v.unwrap_or(plan.control_v);
    let expected = format!("at most {most_v:.3}, from which a ramp begins");
    (on_v > most_v).then(|| Fault::new("limits.v_on_v.high", on_v, expected))
}

/// Returns a fault for each instrument whose profile lacks a program of the test, or refuses one of its arguments.
fn unserved(plan: &Plan, points: &Points, wiring: &Wiring) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    let stages = Stage::all(&plan.output);
    for device in Device::ALL.iter().filter(|it| points.has(**it)) {
        let instrument = points.instrument(*device);
        let profile = &wiring.instrument(instrument).profile;
        let all = stages.iter().flat_map(|stage| {
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
