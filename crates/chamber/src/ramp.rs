//! The set point: ramps of an S shape, which wait for a chamber that cannot follow.
//!
//! The rate of the set point changes linearly, within [`BLEND_S`] from one cruising rate to the next, and falls the same
//! way before the end. Feedback therefore never meets a step of the rate, only one of its derivative.

/// Time in which the rate of the set point changes from one value to another, s.
pub const BLEND_S: f64 = 60.0;
/// The set point waits while it leads the measured temperature by more than this, K.
pub const LONGEST_LEAD_K: f64 = 3.0;

/// The set point of one second.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SetPoint {
    /// Temperature that the chamber shall have, C.
    pub value_c: f64,
    /// Rate of the set point, K/s.
    pub rate_k_per_s: f64,
    /// Change of the rate in this second, K/s².
    pub bend_k_per_s2: f64,
    /// True while the set point waits for the chamber.
    pub waits: bool,
}

impl SetPoint {
    /// Returns a set point that stays.
    pub fn hold(value_c: f64) -> Self {
        Self {
            value_c,
            ..Self::default()
        }
    }

    /// Returns true on a stretch of constant rate: neither at rest, nor bending, nor waiting.
    pub fn cruises(&self) -> bool {
        self.rate_k_per_s != 0.0 && self.bend_k_per_s2 == 0.0 && !self.waits
    }
}

/// Generator of set points, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp {
    now: SetPoint,
    end_c: f64,
    cruise_k_per_s: f64,
    bend_k_per_s2: f64,
}

impl Ramp {
    /// Starts at rest.
    pub fn at(value_c: f64) -> Self {
        Self {
            now: SetPoint::hold(value_c),
            end_c: value_c,
            cruise_k_per_s: 0.0,
            bend_k_per_s2: 0.0,
        }
    }

    /// Heads for `end_c` at a cruising rate, K/min without sign; a ramp that heads elsewhere turns.
    pub fn head_for(&mut self, end_c: f64, cruise_k_per_min: f64) {
        let cruise = cruise_k_per_min.abs() / 60.0;
        let signed = cruise * (end_c - self.now.value_c).signum();
        let change = (signed - self.now.rate_k_per_s).abs().max(cruise);
        self.end_c = end_c;
        self.cruise_k_per_s = cruise;
        self.bend_k_per_s2 = change / BLEND_S;
    }

    /// Returns the set point of the last second.
    pub fn now(&self) -> SetPoint {
        self.now
    }

    /// Returns true when the set point rests at the end.
    pub fn is_at_end(&self) -> bool {
        self.now.rate_k_per_s == 0.0 && self.now.value_c == self.end_c
    }

    /// Advances by a second and returns the set point. On the way to its end the set point waits while it leads the
    /// measured temperature by more than [`LONGEST_LEAD_K`]; while it still moves away from its end it does not wait.
    pub fn step(&mut self, measured_c: f64) -> SetPoint {
        let left = self.end_c - self.now.value_c;
        let lead = (self.now.value_c - measured_c) * self.now.rate_k_per_s.signum();
        if left * self.now.rate_k_per_s > 0.0 && lead > LONGEST_LEAD_K {
            self.now.bend_k_per_s2 = 0.0;
            self.now.waits = true;
            return self.now;
        }
        let wanted = left.signum() * self.fastest(left.abs()).min(self.cruise_k_per_s);
        let most = self.bend_k_per_s2;
        let bend = (wanted - self.now.rate_k_per_s).clamp(-most, most);
        self.now = SetPoint {
            value_c: self.now.value_c + self.now.rate_k_per_s + bend,
            rate_k_per_s: self.now.rate_k_per_s + bend,
            bend_k_per_s2: if bend.abs() < 1e-12 { 0.0 } else { bend },
            waits: false,
        };
        let passed = (self.end_c - self.now.value_c) * left <= 0.0;
        if passed && self.now.rate_k_per_s.abs() <= 2.0 * most {
            self.now = SetPoint::hold(self.end_c);
        }
        self.now
    }

    /// Returns the highest rate, K/s, from which the set point still stops within `left_k`.
    fn fastest(&self, left_k: f64) -> f64 {
        let bend = self.bend_k_per_s2;
        (bend * bend / 4.0 + 2.0 * bend * left_k).sqrt() - bend / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(ramp: &mut Ramp) -> Vec<SetPoint> {
        let mut all = Vec::new();
        while !ramp.is_at_end() && all.len() < 10_000 {
            all.push(ramp.step(ramp.now().value_c));
        }
        all
    }

    #[test]
    fn a_ramp_takes_its_distance_and_one_blend() {
        for (rate, kelvin) in [(1.0, 60.0), (5.0, 60.0), (10.0, -40.0)] {
            let mut ramp = Ramp::at(40.0);
            ramp.head_for(40.0 + kelvin, rate);
            let all = run(&mut ramp);
            let expected = kelvin.abs() / rate * 60.0 + BLEND_S;
            assert!((all.len() as f64 - expected).abs() <= 3.0, "{}", all.len());
            let fastest = all
                .iter()
                .map(|it| it.rate_k_per_s.abs())
                .fold(0.0, f64::max);
            assert!((fastest - rate / 60.0).abs() < 1e-9);
            let bend = all
                .iter()
                .map(|it| it.bend_k_per_s2.abs())
                .fold(0.0, f64::max);
            assert!(bend <= rate / 3600.0 + 1e-9);
        }
    }

    #[test]
    fn a_short_ramp_never_passes_its_end() {
        let mut ramp = Ramp::at(40.0);
        ramp.head_for(40.7, 5.0);
        let all = run(&mut ramp);
        assert!(ramp.is_at_end());
        assert!(all.iter().all(|it| it.value_c <= 40.7 + 1e-9));
    }

    #[test]
    fn the_set_point_waits_for_a_cold_chamber() {
        let mut ramp = Ramp::at(40.0);
        ramp.head_for(100.0, 5.0);
        let reached: Vec<SetPoint> = (0..600).map(|_| ramp.step(40.0)).collect();
        let last = reached[599];
        assert!(last.waits && last.value_c - 40.0 < LONGEST_LEAD_K + 0.1);
        assert!(!ramp.step(last.value_c - 1.0).waits);
    }

    #[test]
    fn a_turn_reverses_the_rate_in_one_blend() {
        let mut ramp = Ramp::at(40.0);
        ramp.head_for(100.0, 2.0);
        for _ in 0..300 {
            ramp.step(ramp.now().value_c);
        }
        ramp.head_for(40.0, 2.0);
        let turn: Vec<SetPoint> = (0..61).map(|_| ramp.step(ramp.now().value_c)).collect();
        assert!((turn[60].rate_k_per_s + 2.0 / 60.0).abs() < 1e-9);
    }

    #[test]
    fn a_waiting_set_point_turns() {
        let mut ramp = Ramp::at(40.0);
        ramp.head_for(100.0, 10.0);
        while !ramp.step(ramp.now().value_c.min(86.0)).waits {}
        ramp.head_for(40.0, 10.0);
        let highest_c = ramp.now().value_c + 3.0;
        let back: Vec<SetPoint> = (0..600)
            .map(|_| ramp.step(ramp.now().value_c.min(86.0)))
            .collect();
        assert!(ramp.is_at_end(), "{:?}", ramp.now());
        assert!(back.iter().all(|it| it.value_c < highest_c && !it.waits));
    }
}
