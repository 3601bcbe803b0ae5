//! Checks whether a gripper can travel over a fixture: `cargo run -p lpm --example gate`.

use lpm::{Answer, Flaw, Model, Move, Mover, Pose, Shape};

fn main() -> Result<(), Flaw> {
    let mut fixture = Model::new();
    let jaw = Shape::Block {
        half: [10.0, 20.0, 15.0],
    };
    fixture.insert("jaw", &jaw, &Pose::at([100.0, 0.0, 15.0]))?;

    let gripper = Mover::new(&Shape::Cylinder {
        radius: 8.0,
        height: 40.0,
    })?;
    for height_mm in [55.0, 51.0] {
        let way = Move {
            from: Pose::at([0.0, 0.0, height_mm]),
            to: Pose::at([200.0, 0.0, height_mm]),
            margin_mm: 2.0,
            ignore: &[],
        };
        match fixture.first_contact(&gripper, &way) {
            Answer::Clear => println!("z {height_mm} mm: clear by more than 2 mm"),
            Answer::Blocked(contact) => println!(
                "z {height_mm} mm: blocked by {} after {:.1} % of the move, {:.3} mm apart",
                fixture.id(contact.blocker),
                100.0 * contact.t_stop,
                contact.distance_mm
            ),
        }
    }
    Ok(())
}
