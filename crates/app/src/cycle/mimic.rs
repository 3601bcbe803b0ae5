//! Converts the bodies of the guard into the picture of the machine.

use machine::guard::{Actuator, Drawn};
use machine::view::{Mimic, MimicBody};

/// Returns the scene for a screen.
#[must_use]
pub fn mimic(drawing: Vec<Drawn>) -> Mimic {
    let bodies = drawing.into_iter().map(|body| MimicBody {
        id: body.id,
        rides: named(body.rides),
        above: body.above,
        front: body.front,
    });
    Mimic {
        bodies: bodies.collect(),
    }
}

fn named(rides: Vec<(Actuator, [f64; 3])>) -> Vec<(String, [f64; 3])> {
    let rides = rides.into_iter();
    rides.map(|(it, way)| (it.name().to_owned(), way)).collect()
}
