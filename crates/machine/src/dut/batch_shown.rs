//! What pages show of the test of a batch: the air over time, and when each contact has switched.

use serde::Serialize;
use utoipa::ToSchema;

/// Seconds between two points of a new curve.
const STEP_S: u32 = 5;
/// Number of points above which the curve in a view drops every second one; a view holds the whole curve.
const MOST_POINTS: usize = 300;
/// Number of points above which the curve in the history drops every second one: 4 hours at the first step.
const MOST_KEPT: usize = 2_880;
/// Number of latest switchings that a view shows of a socket; an intermittent contact has thousands.
const MOST_SWITCHED: usize = 12;

/// Temperature of the air during the test of a batch; the members have equal lengths.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct AirCurve {
    /// Time since the first reading, s.
    pub t_s: Vec<u32>,
    /// Set point, C; null before the passes.
    pub set_c: Vec<Option<f64>>,
    /// Reference thermometer, C.
    pub reference_c: Vec<f64>,
    /// Slope of the reference thermometer over a minute, K/min; `None` in the first minute. Only the history stores it.
    #[serde(skip)]
    pub rate_k_per_min: Vec<Option<f64>>,
    /// Seconds between two points.
    #[serde(skip)]
    step_s: u32,
    /// Number of points above which the curve drops every second one.
    #[serde(skip)]
    most: usize,
}

/// The air in one second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirSecond {
    /// Time since the first reading, s.
    pub t_s: u32,
    /// Set point, C; `None` before the passes.
    pub set_c: Option<f64>,
    /// Reference thermometer, C.
    pub reference_c: f64,
    /// Slope of the reference thermometer over a minute, K/min; `None` in the first minute.
    pub rate_k_per_min: Option<f64>,
}

/// Switchings of the contact of a socket.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct SocketSwitched {
    /// Number of the socket.
    pub socket: u16,
    /// Times at which the contact opened, s of the curve; the last twelve.
    pub opened_s: Vec<f64>,
    /// Times at which the contact closed, s of the curve; the last twelve.
    pub closed_s: Vec<f64>,
}

/// The test of a batch, as pages show it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct BatchShown {
    /// Number of the pass, from 1; null before the first one and after the last one.
    pub pass: Option<usize>,
    /// Number of passes; null before the first one.
    pub passes: Option<usize>,
    /// Set point, C; null outside of the passes.
    pub set_c: Option<f64>,
    /// Reference thermometer, C; null before the first reading.
    pub reference_c: Option<f64>,
    /// Slope of the reference thermometer over a minute, K/min; null in the first minute.
    pub rate_k_per_min: Option<f64>,
    /// Power of the heater, percent.
    pub heater_pct: f64,
    /// Opening of the vent, percent.
    pub vent_pct: f64,
    /// The air since the first reading.
    pub curve: AirCurve,
    /// Sockets of the batch, by number.
    pub switched: Vec<SocketSwitched>,
}

impl Default for AirCurve {
    /// Makes an empty curve for a view.
    fn default() -> Self {
        Self {
            t_s: Vec::new(),
            set_c: Vec::new(),
            reference_c: Vec::new(),
            rate_k_per_min: Vec::new(),
            step_s: STEP_S,
            most: MOST_POINTS,
        }
    }
}

impl AirCurve {
    /// Makes an empty curve for the history, which has more points.
    pub fn kept() -> Self {
        Self {
            most: MOST_KEPT,
            ..Self::default()
        }
    }

    /// Adds the air of this second if at least one step has passed since the last point.
    pub fn push(&mut self, now: &AirSecond) {
        let next = self.t_s.last().map(|last| last + self.step_s);
        if next.is_some_and(|next| now.t_s < next) {
            return;
        }
        self.t_s.push(now.t_s);
        self.set_c.push(now.set_c.map(hundredths));
        self.reference_c.push(hundredths(now.reference_c));
        self.rate_k_per_min.push(now.rate_k_per_min.map(hundredths));
        if self.t_s.len() > self.most {
            self.thin();
        }
    }

    /// Drops every second point.
    fn thin(&mut self) {
        self.step_s *= 2;
        every_second(&mut self.t_s);
        every_second(&mut self.set_c);
        every_second(&mut self.reference_c);
        every_second(&mut self.rate_k_per_min);
    }
}

impl SocketSwitched {
    /// Makes the switchings of a socket; keeps the last ones, to a tenth of a second.
    pub fn new(
        socket: u16,
        opened_s: impl DoubleEndedIterator<Item = f64>,
        closed_s: impl DoubleEndedIterator<Item = f64>,
    ) -> Self {
        Self {
            socket,
            opened_s: last(opened_s),
            closed_s: last(closed_s),
        }
    }
}

fn last(all: impl DoubleEndedIterator<Item = f64>) -> Vec<f64> {
    let tenths = |it: f64| (it * 10.0).round() / 10.0;
    let mut kept: Vec<f64> = all.rev().take(MOST_SWITCHED).map(tenths).collect();
    kept.reverse();
    kept
}

fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn every_second<T>(all: &mut Vec<T>) {
    let mut place = 0;
    all.retain(|_| {
        place += 1;
        place % 2 == 1
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_of_hours_keeps_few_points_evenly() {
        let mut curve = AirCurve::default();
        for t_s in 0..20_000 {
            curve.push(&AirSecond {
                t_s,
                set_c: (t_s > 900).then_some(40.0),
                reference_c: f64::from(t_s) / 200.0,
                rate_k_per_min: None,
            });
        }
        let gaps = curve.t_s.windows(2).map(|it| it[1] - it[0]);
        assert!(
            (150..=300).contains(&curve.t_s.len()),
            "{}",
            curve.t_s.len()
        );
        assert!(gaps.clone().max() == gaps.min());
        assert_eq!(
            (curve.set_c.len(), curve.reference_c.len()),
            (curve.t_s.len(), curve.t_s.len())
        );
    }

    #[test]
    fn an_intermittent_contact_shows_its_last_switchings() {
        let shown = SocketSwitched::new(7, (0..500).map(f64::from), std::iter::empty());
        assert_eq!(
            shown.opened_s.first().zip(shown.opened_s.last()),
            Some((&488.0, &499.0))
        );
    }
}
