//! Models that follow a temperature: a transport delay, and a first-order lag.
//!
//! Both take the temperature as linear between two calls. With calls at most 0.1 s apart the error stays below 3 mK,
//! even while the heater of the default chamber starts at full power.

use std::collections::VecDeque;

/// A transport delay.
#[derive(Debug, Clone)]
pub struct Delay {
    delay_s: f64,
    now_s: f64,
    /// Instants and values, oldest first. The first is the last one before the delayed instant.
    past: VecDeque<(f64, f64)>,
}

impl Delay {
    /// Creates a delay that has been at `celsius` for a long time.
    pub fn new(delay_s: f64, celsius: f64) -> Self {
        Self {
            delay_s: delay_s.max(0.0),
            now_s: 0.0,
            past: VecDeque::from([(-delay_s.max(0.0), celsius), (0.0, celsius)]),
        }
    }

    /// Advances by `dt_s` to a new value; returns the value of `delay_s` ago.
    pub fn step(&mut self, dt_s: f64, celsius: f64) -> f64 {
        self.now_s += dt_s;
        self.past.push_back((self.now_s, celsius));
        let at_s = self.now_s - self.delay_s;
        while self.past.get(1).is_some_and(|(t_s, _)| *t_s <= at_s) {
            self.past.pop_front();
        }
        match (self.past.front(), self.past.get(1)) {
            (Some((t0, c0)), Some((t1, c1))) => c0 + (c1 - c0) * (at_s - t0) / (t1 - t0),
            (Some((_, only)), None) => *only,
            (None, _) => celsius,
        }
    }
}

/// A first-order lag, exact for an input that moves linearly from one value to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    tau_s: f64,
    input_c: f64,
    celsius: f64,
}

impl Lag {
    /// Creates a lag at rest.
    pub fn new(tau_s: f64, celsius: f64) -> Self {
        Self {
            tau_s,
            input_c: celsius,
            celsius,
        }
    }

    /// Returns the present output.
    pub fn celsius(&self) -> f64 {
        self.celsius
    }

    /// Returns the present rate of the output, kelvin per second; 0 without lag.
    pub fn rate_k_per_s(&self) -> f64 {
        match self.tau_s > 0.0 {
            true => (self.input_c - self.celsius) / self.tau_s,
            false => 0.0,
        }
    }

    /// Advances by `dt_s` while the input moves to `input_c`; returns the output.
    pub fn step(&mut self, dt_s: f64, input_c: f64) -> f64 {
        if self.tau_s <= 0.0 {
            self.celsius = input_c;
        } else if dt_s > 0.0 {
            let slope = (input_c - self.input_c) / dt_s;
            let decay = (-dt_s / self.tau_s).exp();
            // On a linear input, the output tends to the input minus slope times tau.
            let behind = self.celsius - self.input_c + slope * self.tau_s;
            self.celsius = input_c - slope * self.tau_s + behind * decay;
        }
        self.input_c = input_c;
        self.celsius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_returns_the_past_between_uneven_calls() {
        let mut delay = Delay::new(2.0, 20.0);
        let mut t = 0.0;
        for (n, dt) in [0.1, 0.03, 0.07, 0.1].iter().cycle().take(200).enumerate() {
            t += dt;
            let out = delay.step(*dt, 20.0 + 3.0 * t);
            let expected = 20.0 + 3.0 * (t - 2.0_f64).max(0.0);
            assert!((out - expected).abs() < 1e-9, "{n}: {out} {expected}");
        }
        assert_eq!(Delay::new(0.0, 20.0).step(0.1, 25.0), 25.0);
    }

    #[test]
    fn a_lag_trails_a_ramp_by_slope_times_tau() {
        let mut lag = Lag::new(6.0, 20.0);
        for n in 1..=600 {
            lag.step(0.1, 20.0 + 0.5 * f64::from(n) * 0.1);
        }
        assert!((lag.celsius() - (50.0 - 3.0)).abs() < 2e-4);
        assert!((lag.rate_k_per_s() - 0.5).abs() < 1e-4);
    }

    #[test]
    fn the_length_of_a_step_does_not_matter() {
        let [mut fine, mut coarse] = [Lag::new(6.0, 20.0); 2];
        for n in 1..=1000 {
            fine.step(0.01, 20.0 + f64::from(n) * 0.02);
        }
        coarse.step(10.0, 40.0);
        assert!((fine.celsius() - coarse.celsius()).abs() < 1e-9);
    }
}
