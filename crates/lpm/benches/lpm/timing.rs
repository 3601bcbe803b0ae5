//! Times each query separately, subtracts the cost of the clock and takes the best of several warm passes; then reports
//! mean, median and 99th percentile over the queries.
//!
//! In the warm rows the contestants (core and peers) take turns of several passes each, so that all see the same state
//! of the machine. On a shared machine everything may take 50 % longer for seconds; this distorts a ratio of two times
//! measured one after the other, as in the cold rows and in those below a missed bar. In a warm row, caches and branch
//! prediction have learned these very queries. The rows in random order shuffle the queries before each pass and use
//! the median of the passes.
//!
//! A clock with coarse steps reads too short, most of all in the best of several readings: with steps of 10 ns by about
//! 2 ns for a query of 50 ns, and by less for an empty query.

use std::hint::black_box;
use std::time::Instant;

use super::world::Dice;

/// Number of turns that each contestant takes.
pub const TURNS: usize = 4;
/// Number of passes over all queries in a turn; the first ones also warm the caches.
const PASSES: usize = 7;
/// Number of empty queries that measure the cost of the clock.
const EMPTY: usize = 2_000;
/// Number of bytes written before each cold query: more than the caches of the machines in use hold.
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

/// Returns the cost of reading the clock, ns: the time of an empty query, measured like all others.
pub fn clock_ns() -> f64 {
    warm(&[(); EMPTY], 0.0, |()| ()).mean
}

/// The queries of one contestant, with their measured times.
pub struct Timed<'a, Q> {
    queries: &'a [Q],
    clock_ns: f64,
    /// Times read for each query, ns.
    readings: Vec<Vec<f64>>,
    /// Order of the queries, as indices.
    order: Vec<usize>,
    /// Shuffles the order before each pass; `None` keeps the order.
    dice: Option<Dice>,
}

impl<'a, Q> Timed<'a, Q> {
    pub fn new(queries: &'a [Q], clock_ns: f64) -> Timed<'a, Q> {
        Timed {
            queries,
            clock_ns,
            readings: vec![Vec::with_capacity(TURNS * PASSES); queries.len()],
            order: (0..queries.len()).collect(),
            dice: None,
        }
    }

    /// Prepares queries whose order changes from pass to pass, which defeats branch prediction.
    pub fn unlearned(queries: &'a [Q], clock_ns: f64) -> Timed<'a, Q> {
        Timed {
            dice: Some(Dice::new(7)),
            ..Timed::new(queries, clock_ns)
        }
    }

    /// Runs the passes of one turn.
    pub fn turn<A>(&mut self, mut ask: impl FnMut(&Q) -> A) {
        for _ in 0..PASSES {
            if let Some(dice) = &mut self.dice {
                dice.shuffle(&mut self.order);
            }
            for number in &self.order {
                let query = &self.queries[*number];
                let start = Instant::now();
                black_box(ask(black_box(query)));
                let spent = start.elapsed().as_nanos() as f64 - self.clock_ns;
                self.readings[*number].push(spent.max(0.5));
            }
        }
    }

    /// Returns the distribution, over the queries, of the best time of each query, or of its median time when shuffled.
    pub fn spread(mut self) -> Spread {
        let which = if self.dice.is_some() {
            TURNS * PASSES / 2
        } else {
            0
        };
        let each = self.readings.iter_mut().map(|readings| {
            readings.sort_by(f64::total_cmp);
            readings[which]
        });
        Spread::of(each.collect())
    }
}

/// Times one contestant alone, with warm caches.
pub fn warm<Q, A>(queries: &[Q], clock_ns: f64, mut ask: impl FnMut(&Q) -> A) -> Spread {
    let mut timed = Timed::new(queries, clock_ns);
    (0..TURNS).for_each(|_| timed.turn(&mut ask));
    timed.spread()
}

/// Times each query once, after filling every cache with other data.
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

/// Number of attempts at each round within a turn; the best one counts.
const TRIES: usize = 2;

/// Rounds of a large operation, each with the best time of all turns, ns.
pub struct Rounds {
    best: Vec<f64>,
}

impl Rounds {
    pub fn new(rounds: usize) -> Rounds {
        Rounds {
            best: vec![f64::INFINITY; rounds],
        }
    }

    /// Runs all rounds; the measured time excludes the preparation `ready` and the drop of the results.
    pub fn turn<S, A>(&mut self, mut ready: impl FnMut() -> S, mut run: impl FnMut(S) -> A) {
        for best in &mut self.best {
            for _ in 0..TRIES {
                let state = ready();
                let start = Instant::now();
                let made = black_box(run(state));
                let spent = start.elapsed().as_nanos() as f64;
                drop(made);
                *best = best.min(spent);
            }
        }
    }

    /// Returns the distribution, over the rounds, of the best time of each round. All rounds do the same work, so that
    /// the percentiles reflect the machine.
    pub fn spread(self) -> Spread {
        Spread::of(self.best)
    }
}
