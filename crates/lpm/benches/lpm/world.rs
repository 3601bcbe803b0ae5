//! The scenes and moves of the benchmark: a plate with stacks of elements, and one gripper.
//!
//! Stacks of one to five elements stand 60 mm apart. 60 % of the elements are blocks (5 % of them yawed) and 40 % are
//! upright cylinders, each 20 to 60 mm high. The plate grows with the number of elements, so that their density stays
//! constant. The mover has two fingers, a palm and a spindle.

use lpm::{Move, Pose, Shape};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Distance between stacks, mm.
const PITCH_MM: f64 = 60.0;
/// Mean number of elements in a stack.
const MEAN_STACK: f64 = 3.0;

/// Random numbers that are the same in every run of the benchmark.
pub struct Dice(SplitMix64);

impl Dice {
    /// Creates a generator with a seed.
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::seed_from_u64(seed))
    }

    /// Draws uniformly in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: u64) -> u64 {
        self.0.next_u64() % count
    }

    /// Shuffles a slice.
    pub fn shuffle<T>(&mut self, things: &mut [T]) {
        for last in (1..things.len()).rev() {
            things.swap(last, self.below(last as u64 + 1) as usize);
        }
    }
}

/// The stationary bodies of a benchmark.
pub struct World {
    /// Body and pose of each element, the plate first.
    pub elements: Vec<(Shape, Pose)>,
    /// Edge length of the square plate, mm; the plate extends from 0 to this in x and y, with its top at z = 0.
    pub edge_mm: f64,
    /// Height of the highest stack, mm.
    pub top_mm: f64,
}

/// Builds `count` elements and the plate below them.
pub fn world(count: usize) -> World {
    let mut dice = Dice::new(count as u64);
    let side = (count as f64 / MEAN_STACK).sqrt().ceil().max(1.0) as u64;
    let edge_mm = side as f64 * PITCH_MM;
    let plate = Shape::Block {
        half: [edge_mm / 2.0, edge_mm / 2.0, 10.0],
    };
    let mut elements = vec![(plate, Pose::at([edge_mm / 2.0, edge_mm / 2.0, -10.0]))];
    let mut top_mm: f64 = 0.0;
    // Fills stack after stack. When the plate is full, another round continues above the stacks; this happens only in
    // the smallest worlds.
    for stack in 0.. {
        if elements.len() > count {
            break;
        }
        let (row, column) = (stack / side % side, stack % side);
        let mut height = if stack < side * side { 0.0 } else { 320.0 };
        for _ in 0..=dice.below(5) {
            if elements.len() > count {
                break;
            }
            let place = [column, row]
                .map(|index| (index as f64 + 0.5) * PITCH_MM + dice.between(-3.0, 3.0));
            let tall = dice.between(20.0, 60.0);
            let centre = [place[0], place[1], height + tall / 2.0];
            elements.push(element(&mut dice, tall, centre));
            height += tall;
            top_mm = top_mm.max(height);
        }
    }
    World {
        elements,
        edge_mm,
        top_mm,
    }
}

fn element(dice: &mut Dice, tall: f64, centre: [f64; 3]) -> (Shape, Pose) {
    if dice.below(10) >= 6 {
        let radius = dice.between(8.0, 27.0);
        return (
            Shape::Cylinder {
                radius,
                height: tall,
            },
            Pose::at(centre),
        );
    }
    let half = [dice.between(8.0, 27.0), dice.between(8.0, 27.0), tall / 2.0];
    let pose = if dice.below(20) == 0 {
        Pose::yawed(centre, dice.between(0.1, 1.4))
    } else {
        Pose::at(centre)
    };
    (Shape::Block { half }, pose)
}

/// Returns the gripper: two fingers, a palm and a spindle, with the origin between the finger tips.
pub fn gripper() -> Vec<(Shape, Pose)> {
    let block = |half: [f64; 3], at: [f64; 3]| (Shape::Block { half }, Pose::at(at));
    vec![
        block([5.0, 8.0, 20.0], [-18.0, 0.0, 20.0]),
        block([5.0, 8.0, 20.0], [18.0, 0.0, 20.0]),
        block([28.0, 18.0, 10.0], [0.0, 0.0, 50.0]),
        (
            Shape::Cylinder {
                radius: 16.0,
                height: 80.0,
            },
            Pose::at([0.0, 0.0, 100.0]),
        ),
    ]
}

/// Returns four specks in the corners of the gripper's box: they need all tests of boxes but meet almost nothing.
pub fn specks() -> Vec<(Shape, Pose)> {
    let speck = Shape::Block { half: [0.01; 3] };
    let corners = [
        [-28.0, -18.0, 0.0],
        [28.0, 18.0, 0.0],
        [28.0, -18.0, 140.0],
        [-28.0, 18.0, 140.0],
    ];
    corners
        .map(|corner| (speck.clone(), Pose::at(corner)))
        .into()
}

/// Kinds of moves, in the order of the tables.
pub const KINDS: [&str; 6] = [
    "disc_yaw0",
    "disc_yaw",
    "jog5",
    "descend",
    "local300",
    "traverse",
];

/// Draws `count` moves of one kind.
pub fn moves(world: &World, kind: &str, count: usize) -> Vec<Move<'static>> {
    let mut dice = Dice::new(kind.bytes().map(u64::from).sum());
    (0..count).map(|_| drawn(world, kind, &mut dice)).collect()
}

fn drawn(world: &World, kind: &str, dice: &mut Dice) -> Move<'static> {
    let edge = world.edge_mm;
    let place = [dice.between(0.0, edge), dice.between(0.0, edge)];
    let tip = dice.between(0.0, world.top_mm);
    let at = |x, y, z| Pose::at([x, y, z]);
    let here = at(place[0], place[1], tip);
    let angle = dice.between(0.0, std::f64::consts::TAU);
    let (sin, cos) = angle.sin_cos();
    let (from, to) = match kind {
        "disc_yaw0" => (here, here),
        "disc_yaw" => {
            let turned = Pose::yawed(here.position, angle);
            (turned, turned)
        }
        "jog5" => {
            let rise = dice.between(-1.0, 1.0);
            let flat = 5.0 * (1.0 - rise * rise).sqrt();
            (
                here,
                at(
                    place[0] + flat * cos,
                    place[1] + flat * sin,
                    tip + 5.0 * rise,
                ),
            )
        }
        "descend" => {
            let above = world.top_mm + dice.between(5.0, 150.0);
            (
                at(place[0], place[1], above),
                at(place[0], place[1], dice.between(1.0, 60.0)),
            )
        }
        "local300" => (
            here,
            at(place[0] + 300.0 * cos, place[1] + 300.0 * sin, tip),
        ),
        "traverse" => {
            let high = world.top_mm * dice.between(0.7, 1.0);
            let drift = dice.between(0.0, edge);
            match dice.below(4) {
                0 => (at(-60.0, place[1], high), at(edge + 60.0, drift, high)),
                1 => (at(edge + 60.0, place[1], high), at(-60.0, drift, high)),
                2 => (at(place[0], -60.0, high), at(drift, edge + 60.0, high)),
                _ => (at(place[0], edge + 60.0, high), at(drift, -60.0, high)),
            }
        }
        other => unreachable!("no kind {other}"),
    };
    Move {
        from,
        to,
        margin_mm: 0.0,
        ignore: &[],
    }
}
