//! Tests of plans.
#![allow(clippy::unwrap_used)]
use super::*;
use lpm::{Mesh, Pose, Shape};

mod contact;
mod four_parts;
mod hard_orders;
mod large;
mod random_scenes;
mod refused_input;

fn block(half: [f64; 3]) -> Shape {
    Shape::Block { half }
}

fn element(id: &str, shape: Shape, position: [f64; 3]) -> Element {
    Element {
        id: id.to_owned(),
        shape,
        pose: Pose::at(position),
    }
}

/// Makes a block from its least and its greatest corner.
fn between(id: &str, low: [f64; 3], high: [f64; 3]) -> Element {
    let half = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
    let middle = [0, 1, 2].map(|axis| 0.5 * (high[axis] + low[axis]));
    element(id, block(half), middle)
}

/// Makes a plate along z with a square hole of half width `hole` through its middle.
fn holed(id: &str, half: f64, hole: f64, low: f64, high: f64) -> Element {
    let bar = 0.5 * (half - hole);
    let (middle, tall) = (0.5 * (half + hole), 0.5 * (high - low));
    let along_x = block([half, bar, tall]);
    let along_y = block([bar, hole, tall]);
    let parts = vec![
        (Pose::at([0.0, middle, 0.0]), along_x.clone()),
        (Pose::at([0.0, -middle, 0.0]), along_x),
        (Pose::at([middle, 0.0, 0.0]), along_y.clone()),
        (Pose::at([-middle, 0.0, 0.0]), along_y),
    ];
    element(id, Shape::Compound(parts), [0.0, 0.0, 0.5 * (low + high)])
}

fn assembled(elements: Vec<Element>) -> Assembly {
    Assembly::new(elements, None, Tolerance::default(), Vec::new()).unwrap()
}

/// Plans and verifies every step of a sequence.
fn planned(assembly: &Assembly, demands: &Demands) -> Outcome {
    let planner = Planner::new(assembly, Vec::new()).unwrap();
    let outcome = planner.disassembly(demands).unwrap();
    if let Outcome::Sequence(sequence) = &outcome {
        assert_eq!(verified(assembly, &sequence.steps).unwrap().err(), None);
    }
    outcome
}

fn sequence_of(assembly: &Assembly, demands: &Demands) -> Sequence {
    match planned(assembly, demands) {
        Outcome::Sequence(sequence) => sequence,
        Outcome::Locked(locked) => panic!("locked: {locked:?}"),
    }
}

/// Returns the steps as text, such as `cap +z`.
fn told(assembly: &Assembly, steps: &[Step]) -> Vec<String> {
    let text = |step: &Step| {
        let ids: Vec<&str> = step.elements.iter().map(|it| assembly.id(*it)).collect();
        let legs: Vec<&str> = step.legs.iter().map(|leg| leg.direction.name()).collect();
        format!("{} {}", ids.join("+"), legs.join(" "))
    };
    steps.iter().map(text).collect()
}
