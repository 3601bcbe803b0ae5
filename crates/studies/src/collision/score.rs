//! Answers of a method compared with the truth, and their wall time.

use super::world::TestMove;
use std::hint::black_box;
use std::time::Instant;

/// Number of passes over the moves. The fastest pass of a move counts, because other processes disturbed it least.
const PASSES: usize = 3;
/// A move whose first pass takes this time or longer, seconds, runs in no further pass.
const SLOW_S: f64 = 1e-4;

/// Function that returns the first contact as a fraction of the move; `None` for a clear move.
pub type Query = Box<dyn FnMut(&TestMove) -> Option<f64>>;

/// One way to check a move.
pub struct Method {
    /// Name in the report.
    pub name: String,
    /// Query for one move.
    pub query: Query,
}

/// Result of one move.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// Kind of the move, an index of `KINDS`.
    pub kind: usize,
    /// Wall time, us.
    pub us: f64,
    /// Whether the method missed a contact: the truth is a contact, the answer is clear.
    pub missed: bool,
    /// Whether the true contact is deeper than one unit.
    pub deep: bool,
    /// Whether the method blocked a clear move: the truth is clear, the answer is a contact.
    pub false_block: bool,
    /// Answer minus truth where both are contacts, mm along the move; positive is late.
    pub late_mm: Option<f64>,
}

/// Runs every move and times each separately; subtracts the time of reading the clock, `clock_us`.
pub fn outcomes(method: &mut Method, moves: &[TestMove], clock_us: f64) -> Vec<Outcome> {
    let first: Vec<(f64, Option<f64>)> = moves
        .iter()
        .map(|test_move| timed(method, test_move))
        .collect();
    let mut least: Vec<f64> = first.iter().map(|(s, _)| *s).collect();
    for _ in 1..PASSES {
        for (test_move, s) in moves.iter().zip(&mut least).filter(|(_, s)| **s < SLOW_S) {
            *s = s.min(timed(method, test_move).0);
        }
    }
    let answers = first.into_iter().map(|(_, answer)| answer);
    let outcome = |((test_move, s), found): ((&TestMove, f64), Option<f64>)| Outcome {
        kind: test_move.kind,
        us: (1e6 * s - clock_us).max(0.0),
        missed: test_move.truth.is_some() && found.is_none(),
        deep: test_move.deep,
        false_block: test_move.truth.is_none() && found.is_some(),
        late_mm: test_move
            .truth
            .zip(found)
            .map(|(truth, found)| (found - truth) * test_move.length_mm()),
    };
    moves.iter().zip(least).zip(answers).map(outcome).collect()
}

fn timed(method: &mut Method, test_move: &TestMove) -> (f64, Option<f64>) {
    let begun = Instant::now();
    let answer = black_box((method.query)(black_box(test_move)));
    (begun.elapsed().as_secs_f64(), answer)
}

/// Returns the least time of reading the clock twice, us.
pub fn clock_us() -> f64 {
    let one = || Instant::now().elapsed().as_secs_f64();
    1e6 * (0..1_000).map(|_| one()).fold(f64::INFINITY, f64::min)
}
