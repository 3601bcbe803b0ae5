//! `relayrig study collision`: speed against error of every way to check a move.
//!
//! Every method checks the same moves of five kinds in a scene of 1,000 bodies (`scene`). The study knows the exact
//! truth about each move (`world`). The methods:
//! - the method of the paper (layer-based projection model of Peng and others, 2010), rebuilt (`paper`), at steps of
//!   10, 1, 0.1 and 0.01 mm;
//! - swept boxes: the swept query of the collision core over bounding boxes instead of the exact shapes; compared with
//!   `swept exact`, only the shapes differ;
//! - swept exact: the collision core as the guard of the motions uses it;
//! - parry3d in f32 and f64 (`peer`).
//!
//! The study times each move separately, subtracts the time of reading the clock and takes the fastest of three passes;
//! ratios compare times of the same run. The paper's method answers with its last pose free of a collision. Finally the
//! study checks every move of a small world (`small_world`).

mod outline;
mod paper;
mod peer;
mod report;
mod scene;
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
    Scored, bars, bodies_near, errors, missed_by_kind, notes, speed_against_error, speeds,
    wrong_verdicts,
};
use score::{Method, Query, outcomes};
use world::{KINDS, UNIT_MM, World};

/// Step lengths of the paper's method, mm.
const STEPS_MM: [f64; 4] = [10.0, 1.0, 0.1, 0.01];
/// Number of moves of each kind.
const EACH: usize = 200;
/// Seed of the scene and of its moves.
const SEED: u64 = 1;
/// Greatest coordinate of a corner in the small world.
const SMALL_WORLD: i64 = 3;
/// Name of the method under test, to which bars and ratios refer.
const OURS: &str = "swept exact";
/// Rounding error of the exact truth, mm: an answer counts as late only when it is later by more than this.
const ROUNDING_MM: f64 = 1e-12;

/// Compares ways to check a move with the exact truth; returns the report, and the plot of speed against error as SVG.
///
/// # Errors
/// Fails when the collision core refuses a body.
pub fn study() -> anyhow::Result<(Report, String)> {
    let world = World::random(SEED, EACH);
    let scored = scored(&world)?;
    let small = small_world::check_all(SMALL_WORLD)?;
    let about = format!(
        "{} bodies, a mover of {} parts, {} moves ({} each of {}), seed {SEED}",
        world.elements.len(),
        world.parts.len(),
        world.moves.len(),
        EACH,
        KINDS.join(", ")
    );
    let groups = vec![
        speeds(&scored),
        errors(&scored),
        missed_by_kind(&scored),
        bodies_near(&world.moves),
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
            outcomes: outcomes(&mut method, &world.moves, clock_us),
            name: method.name,
        })
        .collect())
}

fn methods(world: &World) -> anyhow::Result<Vec<Method>> {
    let method = |name: &str, query: Query| Method {
        name: name.to_owned(),
        query,
    };
    let stepping = |step_mm: f64| {
        let mut stepping = Stepping::new(&world.elements, &world.parts);
        let query =
            Box::new(move |test_move: &world::TestMove| stepping.first_contact(test_move, step_mm));
        method(&format!("paper, step {step_mm} mm"), query)
    };
    let boxes = |bodies: &[lpm::exact::Body]| bodies.iter().map(scene::boxed).collect::<Vec<_>>();
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
            Box::new(move |test_move| double.first_contact(test_move)),
        ),
        method(
            "parry3d f32",
            Box::new(move |test_move| single.first_contact(test_move)),
        ),
    ]);
    Ok(methods)
}

/// Returns a [`Query`] by the collision core: it sweeps the mover of `parts` through the scene of `elements`.
fn swept(elements: &[lpm::exact::Body], parts: &[lpm::exact::Body]) -> anyhow::Result<Query> {
    let mut model = Model::new();
    for (number, body) in elements.iter().enumerate() {
        let (name, shape, pose) = (number.to_string(), body.shape(UNIT_MM), body.pose(UNIT_MM));
        let inserted = model.insert(&name, &shape, &pose);
        inserted.context("building the scene of the study")?;
    }
    let mover = Mover::new(&scene::compound(parts)).context("building the mover of the study")?;
    Ok(Box::new(move |test_move| {
        match model.first_contact(&mover, &test_move.order()) {
            Answer::Clear => None,
            Answer::Blocked(contact) => Some(contact.t_stop),
        }
    }))
}
