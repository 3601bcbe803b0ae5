//! How a query is timed: alone, the cost of the clock taken off, the best of several warm passes;
//! then mean, median and 99th percentile over the queries.
//!
//! Contestants take turns, several passes each, so that all of them meet the machine in its moods: on a shared one
//! everything may take half as long again for seconds, and a ratio of two figures that were taken one after the other
//! says more about that than about either. Warm is everything then: caches, and what the processor has learned about
//! the order of these very questions.

use std::hint::black_box;
use std::time::Instant;

use super::world::Dice;

/// Turns of each contestant, and passes over all queries in a turn; the first ones also warm the caches.
pub const TURNS: usize = 4;
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

/// What reading the clock costs, ns: a query that asks nothing, timed like all others. (A clock with steps makes the
/// best of several readings small; of this one as of the others.)
pub fn clock_ns() -> f64 {
    warm(&[(); EMPTY], 0.0, |()| ()).mean
}

/// The queries of one contestant.
pub struct Timed<'a, Q> {
    queries: &'a [Q],
    clock_ns: f64,
    best: Vec<f64>,
    /// Numbers of the queries as they are asked, and what puts them in another order before each pass.
    order: Vec<usize>,
    dice: Option<Dice>,
}

impl<'a, Q> Timed<'a, Q> {
    pub fn new(queries: &'a [Q], clock_ns: f64) -> Timed<'a, Q> {
        Timed {
            queries,
            clock_ns,
            best: vec![f64::INFINITY; queries.len()],
            order: (0..queries.len()).collect(),
            dice: None,
        }
    }

    /// The same in another order in each pass: what comes next has not been learned by anybody.
    pub fn unlearned(queries: &'a [Q], clock_ns: f64) -> Timed<'a, Q> {
        Timed {
            dice: Some(Dice(7)),
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
                let (query, best) = (&self.queries[*number], &mut self.best[*number]);
                let start = Instant::now();
                black_box(ask(black_box(query)));
                let spent = start.elapsed().as_nanos() as f64 - self.clock_ns;
                *best = best.min(spent.max(0.5));
            }
        }
    }

    /// Of the best of each query.
    pub fn spread(self) -> Spread {
        Spread::of(self.best)
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

    /// All rounds; what is made `ready` for them is not counted, nor is it what they leave behind.
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

    /// Of the best of each round.
    pub fn spread(self) -> Spread {
        Spread::of(self.best)
    }
}
