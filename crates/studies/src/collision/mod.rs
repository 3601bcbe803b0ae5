//! `relayrig study collision`: speed against error of every way to check a move.
//!
//! One scene of 1,000 bodies and moves of five kinds (`world`), with the exact truth about each. Asked are
//! - the method of the paper, rebuilt (`paper`), at steps of 10, 1, 0.1 and 0.01 mm;
//! - swept boxes: the extrusion of the bounding boxes, by the swept query of our own core over boxes
//!   instead of shapes, so that the difference is the shapes and nothing else;
//! - swept exact: our own core as the guard uses it;
//! - parry3d in f32 and f64 (`peer`), when the program was built with the feature `study`.
//!
//! Every move is timed alone, reading the clock is taken off, of three passes the fastest counts; the
//! ratios are within this run. An answer of stepping is its last clear pose. Then a small world is
//! gone through completely (`small_world`).

mod outline;
mod paper;
mod peer;
mod report;
mod score;
mod small_world;
#[cfg(test)]
mod tests;
mod world;

use super::output::Report;
use anyhow::Context;
use lpm::{Answer, Model, Mover};
use paper::Stepping;
use report::{
    Scored, bars, errors, missed_by_kind, notes, refined, speed_against_error, speeds,
    wrong_verdicts,
};
use score::{Ask, Method, outcomes};
use world::{KINDS, UNIT_MM, World};

/// Steps of the paper's method, mm.
const STEPS_MM: [f64; 4] = [10.0, 1.0, 0.1, 0.01];
/// Moves of each kind.
const EACH: usize = 200;
/// The scene and its moves follow from it.
const SEED: u64 = 1;
/// Greatest corner of the small world.
const SMALL_WORLD: i64 = 3;
/// The name the bars and ratios refer to.
const OURS: &str = "swept exact";
/// The truth is rounded to a few units in the last place: later than this is late, mm.
const ROUNDING_MM: f64 = 1e-12;

/// Runs everything and draws the report up, with the plot of speed against error.
///
/// # Errors
/// The scene could not be built (it always can).
pub fn study() -> anyhow::Result<(Report, String)> {
    let world = World::drawn(SEED, EACH);
    let scored = scored(&world)?;
    let small = small_world::judged(SMALL_WORLD)?;
    let about = format!(
        "{} bodies, a mover of {} parts, {} moves ({} each of {}), seed {SEED}",
        world.elements.len(),
        world.parts.len(),
        world.ways.len(),
        EACH,
        KINDS.join(", ")
    );
    let groups = vec![
        speeds(&scored),
        errors(&scored),
        missed_by_kind(&scored),
        refined(&world.ways),
        bars(&scored, &small),
    ];
    let report = Report::new("collision", about, groups, wrong_verdicts(&scored)).noted(notes());
    Ok((report, speed_against_error(&scored).svg()))
}

fn scored(world: &World) -> anyhow::Result<Vec<Scored>> {
    let clock_us = score::clock_us();
    let methods = methods(world)?;
    Ok(methods
        .into_iter()
        .map(|mut method| Scored {
            outcomes: outcomes(&mut method, &world.ways, clock_us),
            name: method.name,
        })
        .collect())
}

fn methods(world: &World) -> anyhow::Result<Vec<Method>> {
    let method = |name: &str, ask: Ask| Method {
        name: name.to_owned(),
        ask,
    };
    let stepping = |step_mm: f64| {
        let mut stepping = Stepping::new(&world.elements, &world.parts);
        let ask = Box::new(move |way: &world::Way| stepping.first_contact(way, step_mm));
        method(&format!("paper, step {step_mm} mm"), ask)
    };
    let boxes = |bodies: &[lpm::exact::Body]| bodies.iter().map(world::boxed).collect::<Vec<_>>();
    let double = peer::double::Peer::new(&world.elements, &world.parts);
    let single = peer::single::Peer::new(&world.elements, &world.parts);
    let mut methods: Vec<Method> = STEPS_MM.map(stepping).into();
    methods.extend([
        method(
            "swept boxes",
            swept(&boxes(&world.elements), &boxes(&world.parts))?,
        ),
        method(OURS, swept(&world.elements, &world.parts)?),
        method(
            "parry3d f64",
            Box::new(move |way| double.first_contact(way)),
        ),
        method(
            "parry3d f32",
            Box::new(move |way| single.first_contact(way)),
        ),
    ]);
    Ok(methods)
}

/// Our own core over these bodies.
fn swept(elements: &[lpm::exact::Body], parts: &[lpm::exact::Body]) -> anyhow::Result<Ask> {
    let mut model = Model::new();
    for (number, body) in elements.iter().enumerate() {
        let (name, shape, pose) = (number.to_string(), body.shape(UNIT_MM), body.pose(UNIT_MM));
        let inserted = model.insert(&name, &shape, &pose);
        inserted.context("building the scene of the study")?;
    }
    let mover = Mover::new(&world::compound(parts)).context("building the mover of the study")?;
    Ok(Box::new(move |way| {
        match model.first_contact(&mover, &way.order()) {
            Answer::Clear => None,
            Answer::Blocked(contact) => Some(contact.t_stop),
        }
    }))
}
