//! The moves of the study in its scene (`scene`). All coordinates are integers of [`UNIT_MM`], so that the truth is
//! exact.
//!
//! Kinds of moves: jogs of 5 mm, descents, horizontal moves of 300 mm, traverses of the whole plate, and moves that
//! pass one body with a gap or an overlap of 0 to 1 mm. The seed determines scene and moves.

use super::scene::{gripper, reach, stacks, thinned};
use crate::dice::Dice;
use lpm::exact::{Body, first_contact};
use lpm::{Move, Pose};

/// Length of a unit, mm: a power of two, so that every number is exact in `f32` and `f64`.
pub const UNIT_MM: f64 = 1.0 / 1024.0;
/// Number of units in a millimetre.
pub const MM: i64 = 1024;

/// Kinds of moves, in the order of the report.
pub const KINDS: [&str; 5] = ["jog", "descend", "local", "traverse", "graze"];

/// A move and the truth about it.
#[derive(Debug, Clone)]
pub struct TestMove {
    /// Kind of the move, an index of [`KINDS`].
    pub kind: usize,
    /// Start of the mover, units.
    pub from: [i64; 3],
    /// Displacement, units.
    pub run: [i64; 3],
    /// Exact first contact as a fraction of the move; `None` for a clear move.
    pub truth: Option<f64>,
    /// Whether a mover thinner by one unit has a contact too, that is, whether the contact is more than a touch.
    pub deep: bool,
    /// Number of elements whose bounding box meets the swept bounding box of a part of the mover.
    pub near: usize,
}

impl TestMove {
    /// Returns the length of the move, mm.
    pub fn length_mm(&self) -> f64 {
        self.run
            .iter()
            .map(|it| (*it as f64).powi(2))
            .sum::<f64>()
            .sqrt()
            * UNIT_MM
    }

    /// Returns the move in the form that the collision core takes.
    pub fn order(&self) -> Move<'static> {
        let mm = |place: [i64; 3]| Pose::at(place.map(|it| it as f64 * UNIT_MM));
        Move {
            from: mm(self.from),
            to: mm([0, 1, 2].map(|axis| self.from[axis] + self.run[axis])),
            margin_mm: 0.0,
            ignore: &[],
        }
    }
}

/// The scene, the mover and its moves.
#[derive(Debug, Clone)]
pub struct World {
    /// Bodies of the scene.
    pub elements: Vec<Body>,
    /// Parts of the mover; its origin is the tip between the fingers.
    pub parts: Vec<Body>,
    /// Moves of every kind.
    pub moves: Vec<TestMove>,
}

impl World {
    /// Draws the scene and `each` moves of every kind.
    pub fn random(seed: u64, each: usize) -> World {
        let mut dice = Dice::new(seed);
        let (elements, edge, top) = stacks(&mut dice);
        let parts = gripper();
        let mut world = World {
            elements,
            parts,
            moves: Vec::new(),
        };
        for kind in 0..KINDS.len() {
            for _ in 0..each {
                let (from, run) = world.random_move(&mut dice, kind, edge, top);
                let test_move = world.with_truth(kind, from, run);
                world.moves.push(test_move);
            }
        }
        world
    }

    fn random_move(
        &self,
        dice: &mut Dice,
        kind: usize,
        edge: i64,
        top: i64,
    ) -> ([i64; 3], [i64; 3]) {
        let mut place = |low: i64, high: i64| {
            [
                dice.within(0, edge),
                dice.within(0, edge),
                dice.within(low, high),
            ]
        };
        match KINDS[kind] {
            "jog" => {
                let (from, to) = (place(15 * MM, top / 2), place(-MM, MM));
                (from, [to[0] % (3 * MM), to[1] % (3 * MM), to[2]])
            }
            "descend" => {
                let from = place(top, top + 60 * MM);
                let goal = dice.within(10 * MM, top / 2);
                (from, [0, 0, goal - from[2]])
            }
            "local" => {
                let from = place(top / 2, top);
                let (x, y) = direction(dice);
                (from, [300 * x * MM / 13, 300 * y * MM / 13, 0])
            }
            "traverse" => {
                let (from, to) = (place(7 * top / 10, top), place(7 * top / 10, top));
                (
                    [0, from[1], from[2]],
                    [edge, to[1] - from[1], to[2] - from[2]],
                )
            }
            _ => self.grazing_move(dice),
        }
    }

    /// Draws a move past one element, with a gap or an overlap of up to a millimetre.
    fn grazing_move(&self, dice: &mut Dice) -> ([i64; 3], [i64; 3]) {
        let (element, part) = (dice.one(&self.elements), dice.one(&self.parts));
        let delta = dice.one(&[0, 1, 4, 16, 64, 256, MM]) * dice.one(&[1, -1]);
        let (a, b) = (reach(element), reach(part));
        let (across, along) = *dice.one(&[(0, 1), (1, 0)]);
        let mut from = [0, 1, 2].map(|axis| element.centre[axis] - part.centre[axis]);
        from[across] += a[across] + b[across] + delta;
        from[along] -= 25 * MM;
        // High enough to pass over lower elements.
        from[2] += a[2] + b[2] - 2 * MM;
        let mut run = [0; 3];
        run[along] = 50 * MM;
        (from, run)
    }

    fn with_truth(&self, kind: usize, from: [i64; 3], run: [i64; 3]) -> TestMove {
        let (mut truth, mut deep, mut near): (Option<f64>, bool, usize) = (None, false, 0);
        for element in &self.elements {
            let placed = self.parts.iter().map(|part| part.moved(from));
            let close: Vec<Body> = placed
                .filter(|part| boxes_meet(element, part, run))
                .collect();
            near += usize::from(!close.is_empty());
            for part in &close {
                let t = first_contact(element, part, run);
                truth = [truth, t].into_iter().flatten().min_by(f64::total_cmp);
                deep |= t.is_some() && first_contact(element, &thinned(part), run).is_some();
            }
        }
        TestMove {
            kind,
            from,
            run,
            truth,
            deep,
            near,
        }
    }
}

/// Returns whether the bounding boxes of element and part meet while the part moves by `run`.
fn boxes_meet(element: &Body, part: &Body, run: [i64; 3]) -> bool {
    let (a, b) = (reach(element), reach(part));
    // Most of the scene is far away: comparing one axis spares the exact test of the boxes.
    let far = (0..3).any(|axis| {
        let (apart, sum) = (part.centre[axis] - element.centre[axis], a[axis] + b[axis]);
        apart + run[axis].min(0) > sum || apart + run[axis].max(0) < -sum
    });
    let (a, b) = (Body::block(element.centre, a), Body::block(part.centre, b));
    !far && first_contact(&a, &b, run).is_some()
}

/// Draws a horizontal direction with integer components and a length of exactly 13.
fn direction(dice: &mut Dice) -> (i64, i64) {
    let (x, y) = *dice.one(&[(13, 0), (0, 13), (5, 12), (12, 5)]);
    let signs = dice.within(0, 3);
    (
        if signs & 1 == 0 { x } else { -x },
        if signs & 2 == 0 { y } else { -y },
    )
}
