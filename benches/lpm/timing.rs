//! How a query is timed: alone, the cost of the clock taken off, the best of several warm passes;
//! then mean, median and 99th percentile over the queries.

use std::hint::black_box;
use std::time::Instant;

/// Passes over all queries; the first ones also warm the caches.
const PASSES: usize = 7;
/// Bytes written before each cold query: more than any cache level of the machines in use.
const FLUSHED_BYTES: usize = 48 << 20;

/// Distribution of the time of one query, ns.
#[derive(Debug, Clone, Copy)]
pub struct Spread {
    pub mean: f64,
    pub median: f64,
    pub p99: f64,
}

impl Spread {
    fn of(mut times: Vec<f64>) -> Spread {
        times.sort_by(f64::total_cmp);
        let at = |part: f64| times[((times.len() - 1) as f64 * part).round() as usize];
        Spread {
            mean: times.iter().sum::<f64>() / times.len() as f64,
            median: at(0.5),
            p99: at(0.99),
        }
    }
}

/// What reading the clock twice costs, ns: the median of many empty measurements.
pub fn clock_ns() -> f64 {
    let empty = (0..10_001).map(|_| {
        let start = Instant::now();
        black_box(());
        start.elapsed().as_nanos() as f64
    });
    Spread::of(empty.collect()).median
}

/// Each query alone, its best of [`PASSES`].
pub fn warm<Q, A>(queries: &[Q], clock_ns: f64, ask: impl Fn(&Q) -> A) -> Spread {
    let mut best = vec![f64::INFINITY; queries.len()];
    for _ in 0..PASSES {
        for (query, best) in queries.iter().zip(&mut best) {
            let start = Instant::now();
            black_box(ask(black_box(query)));
            let spent = start.elapsed().as_nanos() as f64 - clock_ns;
            *best = best.min(spent.max(0.5));
        }
    }
    Spread::of(best)
}

/// Each query once, with every cache full of something else.
pub fn cold<Q, A>(queries: &[Q], clock_ns: f64, ask: impl Fn(&Q) -> A) -> Spread {
    let mut ballast = vec![0u8; FLUSHED_BYTES];
    let times = queries.iter().map(|query| {
        ballast
            .iter_mut()
            .step_by(64)
            .for_each(|line| *line = line.wrapping_add(1));
        black_box(&mut ballast);
        let start = Instant::now();
        black_box(ask(black_box(query)));
        start.elapsed().as_nanos() as f64 - clock_ns
    });
    Spread::of(times.collect())
}

/// Runs of which the best counts, of something large.
const TRIES: usize = 3;

/// Distribution of `rounds` measurements of something large, each the best of [`TRIES`], ns.
pub fn rounds<S, A>(
    rounds: usize,
    mut ready: impl FnMut() -> S,
    mut run: impl FnMut(S) -> A,
) -> Spread {
    let mut once = || {
        let state = ready();
        let start = Instant::now();
        let made = black_box(run(state));
        let spent = start.elapsed().as_nanos() as f64;
        drop(made);
        spent
    };
    let best = |once: &mut dyn FnMut() -> f64| (0..TRIES).map(|_| once()).fold(f64::MAX, f64::min);
    Spread::of((0..rounds).map(|_| best(&mut once)).collect())
}
