//! Lag of one part and its temperatures, from all its events.
//!
//! Each event gives an equation `F = T - g d + e`: `F` is the record at the event, filtered by the present lag of the
//! part, `g` its change with the logarithm of the lag, `d` the departure from this lag, `e` the scatter of the switching
//! and the uncertain instant. The fit filters the record again by the lag that the equations give (Gauss and Newton), so
//! that a part at half or double the lag of its lot is right too. The logarithm keeps the lag above zero.

use super::{Noise, Record, Switching};

/// Least and greatest lag behind the reference sensor that a fit tries, s.
pub const LAGS_S: [f64; 2] = [1.0, 1000.0];
/// Standard uncertainty of every instant, s: the air reaches the sockets at unequal times, a lag has a shape, polls
/// take time.
const INSTANT_S: f64 = 0.5;
/// Most steps of a fit, the greatest step, and the one below which the fit is complete; steps of the logarithm of the lag.
const STEPS: usize = 16;
const GREATEST: f64 = 0.5;
const LEAST: f64 = 1e-3;
/// Departure from the expected lag, in standard deviations, beyond which a part is so rare in its lot that its events
/// count for more: the expectation widens with the departure.
const RARE: f64 = 3.0;

/// Expected lag of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Logarithm of the lag behind the air, s.
    pub ln: f64,
    /// Its standard deviation; infinite when nothing is known.
    pub sd: f64,
}

impl Expected {
    /// Returns the weight of the expectation for a part with this logarithm of its lag.
    fn weight(&self, ln: f64) -> f64 {
        let widens = ((ln - self.ln).abs() / (RARE * self.sd)).max(1.0);
        (self.sd * widens).powi(-2)
    }
}

/// An event, with the record filtered by the lag of the part.
#[derive(Debug, Clone, Copy)]
struct Event {
    celsius: f64,
    rate_k_per_s: f64,
    /// Change of the temperature with the logarithm of the lag, K.
    gradient_k: f64,
}

/// Fit of a part, with the record filtered by one lag.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Logarithm of this lag behind the air, s.
    ln: f64,
    /// Bounds of it.
    range: [f64; 2],
    /// Operate and reset.
    all: [Vec<Event>; 2],
}

/// Temperatures of one kind, operate or reset, of a part.
#[derive(Debug, Clone, Copy)]
pub struct Mean {
    /// Weighted mean at the lag of the part, C.
    pub celsius: f64,
    /// Variance of the mean at a known lag, K².
    pub variance: f64,
    /// Change with the logarithm of the lag, K.
    pub gradient_k: f64,
}

/// Solution of the equations of a part.
#[derive(Debug, Clone, Copy)]
pub struct Solution {
    /// Logarithm of the lag behind the air, s.
    pub ln: f64,
    /// Variance of the logarithm; infinite when the events do not tell it.
    pub variance: f64,
    /// Operate and reset temperature; `None` without event.
    pub means: [Option<Mean>; 2],
    /// Weighted sum of squares of the residuals of the events (chi squared).
    pub misfit: f64,
    /// Its degrees of freedom: events less estimated temperatures, less the share of the lag that comes from the events.
    pub freedom: f64,
}

/// Fits the lag of a part, from `expected` on; returns its events at that lag. Returns `None` for a part without event,
/// or with one that the record does not cover.
pub fn fitted(
    record: &Record,
    part: &Switching,
    expected: &Expected,
    noise: &Noise,
) -> Option<Fit> {
    let mut events = Fit::at(record, part, expected.ln, noise)?;
    for _ in 0..STEPS {
        let step = events.solved(expected, noise).ln - events.ln;
        if step.abs() < LEAST {
            break;
        }
        let ln = events.ln + step.clamp(-GREATEST, GREATEST);
        events = Fit::at(record, part, ln, noise)?;
    }
    Some(events)
}

impl Fit {
    /// Filters the record by a lag, given by its logarithm behind the air.
    fn at(record: &Record, part: &Switching, ln: f64, noise: &Noise) -> Option<Self> {
        let range = LAGS_S.map(|it| noise.ln_of(it));
        let ln = ln.clamp(range[0], range[1]);
        let filtered = record.filtered(noise.lag_s(ln));
        let event = |instant_s: f64| {
            let now = filtered.at(instant_s)?;
            Some(Event {
                celsius: now.celsius,
                rate_k_per_s: now.rate_k_per_s,
                gradient_k: now.per_lag_k_per_s * ln.exp(),
            })
        };
        let [operate, reset] = [&part.operate, &part.reset].map(|all| {
            all.iter()
                .map(|it| event(it.first_s))
                .collect::<Option<_>>()
        });
        let all: [Vec<Event>; 2] = [operate?, reset?];
        (!all.iter().all(Vec::is_empty)).then_some(Self { ln, range, all })
    }

    /// Solves the equations at this lag.
    pub fn solved(&self, expected: &Expected, noise: &Noise) -> Solution {
        let (mut squares, mut crossed, mut own) = (0.0, 0.0, 0.0);
        let means = self.all.each_ref().map(|all| {
            let weighted = |it: &Event| (noise.weight(it.rate_k_per_s * INSTANT_S), *it);
            let all: Vec<(f64, Event)> = all.iter().map(weighted).collect();
            let mean = Mean::of(&all)?;
            for (weight, it) in all {
                let off_k = it.celsius - mean.celsius;
                let turns_k = it.gradient_k - mean.gradient_k;
                squares += weight * off_k * off_k;
                crossed += weight * off_k * turns_k;
                own += weight * turns_k * turns_k;
            }
            Some(mean)
        });
        let prior = expected.weight(self.ln);
        let asked = expected.ln - self.ln;
        let weight = own + prior;
        let free = if weight > 0.0 {
            (prior * asked - crossed) / weight
        } else {
            0.0
        };
        let ln = (self.ln + free).clamp(self.range[0], self.range[1]);
        let departure = ln - self.ln;
        let events = squares + departure * (2.0 * crossed + departure * own);
        Solution {
            ln,
            variance: weight.recip(),
            means: means.map(|it| it.map(|mean| mean.departed(departure))),
            misfit: events.max(0.0),
            freedom: self.repeated() - if own > 0.0 { own / weight } else { 0.0 },
        }
    }

    /// Returns the number of events less that of the estimated temperatures.
    fn repeated(&self) -> f64 {
        let each = self.all.iter().map(|it| it.len().saturating_sub(1));
        each.sum::<usize>() as f64
    }

    /// Returns the wider of the ranges of operate and reset temperature, K; `None` when the part switched only once each
    /// way.
    pub fn range_k(&self) -> Option<f64> {
        let range = |all: &Vec<Event>| {
            let high = all.iter().map(|it| it.celsius).fold(f64::MIN, f64::max);
            let low = all.iter().map(|it| it.celsius).fold(f64::MAX, f64::min);
            (all.len() >= 2).then_some(high - low)
        };
        self.all.iter().filter_map(range).reduce(f64::max)
    }
}

impl Mean {
    /// Returns the mean of events with their weights, 1/K²; `None` without event.
    fn of(all: &[(f64, Event)]) -> Option<Self> {
        let weight: f64 = all.iter().map(|(weight, _)| weight).sum();
        let mean = |of: fn(&Event) -> f64| {
            let sum: f64 = all.iter().map(|(weight, it)| weight * of(it)).sum();
            sum / weight
        };
        (!all.is_empty()).then(|| Self {
            celsius: mean(|it| it.celsius),
            variance: weight.recip(),
            gradient_k: mean(|it| it.gradient_k),
        })
    }

    /// Returns the mean at a departure of the logarithm of the lag.
    fn departed(self, departure: f64) -> Self {
        Self {
            celsius: self.celsius + self.gradient_k * departure,
            ..self
        }
    }
}
