//! How a query is timed: alone, the cost of the clock taken off, the best of several warm passes;
//! then mean, median and 99th percentile over the queries.
//!
//! In the warm rows contestants take turns, several passes each, so that all of them meet the machine in its moods: on a
//! shared one everything may take half as long again for seconds, and a ratio of two figures that were taken one after
//! the other (those of the cold rows and below a missed bar) says as much about that. Warm is everything
//! then: caches, and what the processor has learned about the order of these very questions. The rows without an order
//! ask in another one in each pass, and there the median of the passes counts.
//!
//! A clock that goes by steps shows less than was spent, the best of several readings most of all: with steps of 10 ns
//! some 2 ns of a question of 50, more than of an empty one.

use std::hint::black_box;
use std::time::Instant;

use super::world::Dice;

/// Turns of each contestant.
pub const TURNS: usize = 4;
/// Passes over all queries in a turn; the first ones also warm the caches.
const PASSES: usize = 7;
/// Queries of the clock alone.
const EMPTY: usize = 2_000;
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

/// What reading the clock costs, ns: a query that asks nothing, timed like all others.
pub fn clock_ns() -> f64 {
    warm(&[(); EMPTY], 0.0, |()| ()).mean
}

/// The queries of one contestant.
pub struct Timed<'a, Q> {
    queries: &'a [Q],
    clock_ns: f64,
    /// What was read of each query.
    readings: Vec<Vec<f64>>,
    /// Numbers of the queries as they are asked.
    order: Vec<usize>,
    /// Puts them in another order before each pass.
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

    /// The same in another order in each pass: what comes next has not been learned by anybody.
    pub fn unlearned(queries: &'a [Q], clock_ns: f64) -> Timed<'a, Q> {
        Timed {
            dice: Some(Dice::new(7)),
            ..Timed::new(queries, clock_ns)
        }
    }

    /// Some passes.
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

    /// Of the best of each query; where nothing was to be learned, of the median.
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

/// One contestant alone.
pub fn warm<Q, A>(queries: &[Q], clock_ns: f64, mut ask: impl FnMut(&Q) -> A) -> Spread {
    let mut timed = Timed::new(queries, clock_ns);
    (0..TURNS).for_each(|_| timed.turn(&mut ask));
    timed.spread()
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

/// Tries of a round in each turn.
const TRIES: usize = 2;

/// Rounds of something large, each the best of all turns, ns.
pub struct Rounds {
    best: Vec<f64>,
}

impl Rounds {
    pub fn new(rounds: usize) -> Rounds {
        Rounds {
            best: vec![f64::INFINITY; rounds],
        }
    }

    /// All rounds; what is made `ready` for them is not counted, nor is what they leave behind.
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

    /// Of the best of each round: the same work every time, so its percentiles are those of the machine.
    pub fn spread(self) -> Spread {
        Spread::of(self.best)
    }
}
