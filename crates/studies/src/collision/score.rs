//! What a method answers, set against the truth, and how long it takes.

use super::world::Way;
use std::hint::black_box;
use std::time::Instant;

/// Passes over the moves; of each move the fastest one counts, so that a neighbour on the machine does not.
const PASSES: usize = 3;
/// A method slower than this on a move is asked once, seconds.
const SLOW_S: f64 = 1e-4;

/// A question: first contact of a move as a fraction of it, or none.
pub type Ask = Box<dyn FnMut(&Way) -> Option<f64>>;

/// One way to check a move.
pub struct Method {
    /// As the report calls it.
    pub name: String,
    /// Asked with each move.
    pub ask: Ask,
}

/// What became of one move.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// Kind of the move.
    pub kind: usize,
    /// Wall time, us.
    pub us: f64,
    /// Truth says contact, the method says clear.
    pub missed: bool,
    /// The contact is deeper than one unit.
    pub deep: bool,
    /// Truth says clear, the method says contact.
    pub false_block: bool,
    /// Answer minus truth where both say contact, mm of the way; positive is late.
    pub late_mm: Option<f64>,
}

/// Asks every move, each timed alone.
pub fn outcomes(method: &mut Method, ways: &[Way], clock_us: f64) -> Vec<Outcome> {
    let first: Vec<(f64, Option<f64>)> = ways.iter().map(|way| timed(method, way)).collect();
    let mut least: Vec<f64> = first.iter().map(|(s, _)| *s).collect();
    for _ in 1..PASSES {
        for (way, s) in ways.iter().zip(&mut least).filter(|(_, s)| **s < SLOW_S) {
            *s = s.min(timed(method, way).0);
        }
    }
    let answers = first.into_iter().map(|(_, answer)| answer);
    let outcome = |((way, s), found): ((&Way, f64), Option<f64>)| Outcome {
        kind: way.kind,
        us: (1e6 * s - clock_us).max(0.0),
        missed: way.truth.is_some() && found.is_none(),
        deep: way.deep,
        false_block: way.truth.is_none() && found.is_some(),
        late_mm: way
            .truth
            .zip(found)
            .map(|(truth, found)| (found - truth) * way.length_mm()),
    };
    ways.iter().zip(least).zip(answers).map(outcome).collect()
}

fn timed(method: &mut Method, way: &Way) -> (f64, Option<f64>) {
    let begun = Instant::now();
    let answer = black_box((method.ask)(black_box(way)));
    (begun.elapsed().as_secs_f64(), answer)
}

/// What reading the clock twice costs, us.
pub fn clock_us() -> f64 {
    let one = || Instant::now().elapsed().as_secs_f64();
    1e6 * (0..1_000).map(|_| one()).fold(f64::INFINITY, f64::min)
}

/// The value below which the share `share` of them lies; `None` of nothing.
pub fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get((share * last as f64).round() as usize).copied()
}
