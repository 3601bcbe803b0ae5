//! Takes a base, a shaft, a plate and a cap apart: `cargo run -p plan --example four_parts`.

use lpm::{Pose, Shape};
use plan::{Assembly, Demands, Direction, Element, Outcome, PlanError, Planner, Tolerance};
use plan::{mates, priority, verified};

/// Makes a plate with a square hole of 10 mm through its middle, from `low` to `high` along z, mm.
fn holed(id: &str, half: f64, low: f64, high: f64) -> Element {
    let (bar, tall) = (0.5 * (half - 5.0), 0.5 * (high - low));
    let middle = 0.5 * (half + 5.0);
    let along_x = Shape::Block {
        half: [half, bar, tall],
    };
    let along_y = Shape::Block {
        half: [bar, 5.0, tall],
    };
    Element {
        id: id.to_owned(),
        shape: Shape::Compound(vec![
            (Pose::at([0.0, middle, 0.0]), along_x.clone()),
            (Pose::at([0.0, -middle, 0.0]), along_x),
            (Pose::at([middle, 0.0, 0.0]), along_y.clone()),
            (Pose::at([-middle, 0.0, 0.0]), along_y),
        ]),
        pose: Pose::at([0.0, 0.0, 0.5 * (low + high)]),
    }
}

fn main() -> Result<(), PlanError> {
    let shaft = Element {
        id: "shaft".to_owned(),
        shape: Shape::Cylinder {
            radius: 5.0,
            height: 30.0,
        },
        pose: Pose::at([0.0, 0.0, 15.0]),
    };
    let cap = Element {
        id: "cap".to_owned(),
        shape: Shape::Block {
            half: [10.0, 10.0, 2.0],
        },
        pose: Pose::at([0.0, 0.0, 32.0]),
    };
    let elements = vec![
        holed("base", 20.0, 0.0, 10.0),
        shaft,
        holed("plate", 15.0, 10.0, 16.0),
        cap,
    ];
    let assembly = Assembly::new(elements, None, Tolerance::default(), Vec::new())?;
    let first = Planner::new(&assembly, Vec::new())?;
    let found = mates(&assembly, first.local())?;
    let planner = Planner::new(&assembly, priority(&found))?;
    for number in 0..assembly.len() {
        for direction in Direction::ALL {
            let row = planner.global().blockers(number, direction).iter();
            let ids: Vec<&str> = row.map(|it| assembly.id(*it as usize)).collect();
            println!("{} {direction}: {}", assembly.id(number), ids.join(", "));
        }
    }
    let demands = Demands {
        stay: vec!["base".to_owned()],
        ..Demands::default()
    };
    match planner.disassembly(&demands)? {
        Outcome::Locked(locked) => println!("locked: {:?}", locked.elements),
        Outcome::Sequence(sequence) => {
            for step in &sequence.steps {
                let ids: Vec<&str> = step.elements.iter().map(|it| assembly.id(*it)).collect();
                for leg in &step.legs {
                    println!(
                        "{} {} {} mm",
                        ids.join(", "),
                        leg.direction,
                        leg.distance_mm
                    );
                }
            }
            let is_clear = verified(&assembly, &sequence.steps)?.is_ok();
            println!("every step verified: {is_clear}");
        }
    }
    Ok(())
}
