//! All moves of a small world: every block with integer corners from 0 to 3 on each axis moves past every other block
//! by every integer displacement from -3 to 3. These are 16,003,008 moves; the study compares the verdict and the time
//! of each answer with the exact truth.

use crate::pool;
use lpm::exact::{Body, first_contact};
use lpm::{Answer, Model, Move, Mover, Pose};

/// Fraction of the move by which an answer may be earlier than the true contact; a later answer is always wrong.
const EARLY: f64 = 1e-9;

/// Counts of moves and of wrong answers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SmallWorldCounts {
    /// Number of all moves.
    pub moves: u64,
    /// Moves with a contact that the core calls clear.
    pub missed: u64,
    /// Clear moves for which the core answers a contact.
    pub false_blocks: u64,
    /// Answers later than the true contact, or earlier by more than 1e-9 of the move.
    pub wrong_times: u64,
}

impl SmallWorldCounts {
    fn and(self, other: SmallWorldCounts) -> SmallWorldCounts {
        SmallWorldCounts {
            moves: self.moves + other.moves,
            missed: self.missed + other.missed,
            false_blocks: self.false_blocks + other.false_blocks,
            wrong_times: self.wrong_times + other.wrong_times,
        }
    }
}

/// Checks every move of the world with corners from 0 to `most`, on all processor cores.
///
/// # Errors
/// Fails when the collision core refuses a block.
pub fn check_all(most: i64) -> anyhow::Result<SmallWorldCounts> {
    let blocks = every_block(most);
    let counts = pool::map(&blocks, pool::cores(), |it| {
        check_element(it, &blocks, most)
    })?;
    Ok(counts
        .into_iter()
        .fold(SmallWorldCounts::default(), SmallWorldCounts::and))
}

/// Returns every block; its centre and half extents are doubled, so that they are integers.
fn every_block(most: i64) -> Vec<Body> {
    let spans = || {
        (0..most).flat_map(move |low| (low + 1..=most).map(move |high| [low + high, high - low]))
    };
    let mut blocks = Vec::new();
    for x in spans() {
        for y in spans() {
            blocks.extend(spans().map(|z| Body::block([x[0], y[0], z[0]], [x[1], y[1], z[1]])));
        }
    }
    blocks
}

fn check_element(element: &Body, movers: &[Body], most: i64) -> anyhow::Result<SmallWorldCounts> {
    let mut model = Model::new();
    let mut counted = SmallWorldCounts::default();
    let pose = Pose::at(element.pose(0.5).position);
    model.insert("element", &element.shape(0.5), &pose)?;
    let steps = || (-most..=most).map(|it| 2 * it);
    for mover in movers {
        let body = Mover::new(&mover.shape(0.5))?;
        let runs = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
        for run in runs {
            let order = Move {
                from: mover.pose(0.5),
                to: mover.moved(run).pose(0.5),
                margin_mm: 0.0,
                ignore: &[],
            };
            let found = match model.first_contact(&body, &order) {
                Answer::Clear => None,
                Answer::Blocked(contact) => Some(contact.t_stop),
            };
            counted = counted.and(count_answer(first_contact(element, mover, run), found));
        }
    }
    Ok(counted)
}

fn count_answer(truth: Option<f64>, found: Option<f64>) -> SmallWorldCounts {
    let wrong_time = |(truth, found): (f64, f64)| found > truth || truth - found > EARLY;
    SmallWorldCounts {
        moves: 1,
        missed: u64::from(truth.is_some() && found.is_none()),
        false_blocks: u64::from(truth.is_none() && found.is_some()),
        wrong_times: u64::from(truth.zip(found).is_some_and(wrong_time)),
    }
}
