//! What pages show of the test of a batch: the air over time, and when each contact has switched.

use serde::Serialize;
use utoipa::ToSchema;

/// Seconds between two points of a new curve.
const STEP_S: u32 = 5;
/// Points above which a curve keeps every second one: a view holds the whole curve.
const MOST_POINTS: usize = 300;
/// Switchings that a socket shows, the last ones: an intermittent contact has thousands.
const MOST_SWITCHED: usize = 12;

/// Temperature of the air during the test of a batch; the members have equal lengths.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct AirCurve {
    /// Time since the first reading, s.
    pub t_s: Vec<u32>,
    /// Set point, C; null before the passes.
    pub set_c: Vec<Option<f64>>,
    /// Reference thermometer, C.
    pub reference_c: Vec<f64>,
    /// Seconds between two points; 0 for the first step.
    #[serde(skip)]
    step_s: u32,
}

/// Switchings of the contact of a socket.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct SocketSwitched {
    /// Number of the socket.
    pub socket: u16,
    /// Times at which the contact opened, s of the curve; the last twelve.
    pub opened_s: Vec<f64>,
    /// Times at which it closed, s of the curve; the last twelve.
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

impl AirCurve {
    /// Takes the temperatures of a second, C, and keeps those that the present step wants.
    pub fn push(&mut self, t_s: u32, set_c: Option<f64>, reference_c: f64) {
        let step_s = self.step_s.max(STEP_S);
        if self.t_s.last().is_some_and(|last| t_s < last + step_s) {
            return;
        }
        self.t_s.push(t_s);
        self.set_c.push(set_c.map(hundredths));
        self.reference_c.push(hundredths(reference_c));
        self.step_s = step_s;
        if self.t_s.len() > MOST_POINTS {
            self.thin();
        }
    }

    /// Drops every second point.
    fn thin(&mut self) {
        self.step_s *= 2;
        every_second(&mut self.t_s);
        every_second(&mut self.set_c);
        every_second(&mut self.reference_c);
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
            curve.push(t_s, (t_s > 900).then_some(40.0), f64::from(t_s) / 200.0);
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
