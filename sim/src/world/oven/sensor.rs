//! A temperature sensor with its module: transport delay, lag, bias, drift, noise, and the step of the reading.

use super::follow::{Delay, Lag};
use crate::world::draw::Draw;

/// Values of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorValues {
    /// Transport delay, seconds.
    pub delay_s: f64,
    /// Time constant, seconds.
    pub lag_s: f64,
    /// Constant error, kelvin.
    pub bias_k: f64,
    /// Error that grows with time, kelvin per hour.
    pub drift_k_per_h: f64,
    /// Standard deviation of one reading, kelvin.
    pub noise_k: f64,
    /// Resolution of the reading, kelvin; 0 for none.
    pub step_k: f64,
}

impl SensorValues {
    /// A Pt100 in the air of a chamber, without bias.
    pub const AIR: Self = Self {
        delay_s: 2.0,
        lag_s: 6.0,
        bias_k: 0.0,
        drift_k_per_h: 0.0,
        noise_k: 0.02,
        step_k: 0.01,
    };

    /// A Pt100 in an oil bath, without bias.
    pub const OIL: Self = Self {
        delay_s: 3.0,
        lag_s: 2.5,
        ..Self::AIR
    };

    /// A Pt100 in a metal block, without bias.
    pub const BLOCK: Self = Self {
        delay_s: 1.0,
        lag_s: 4.0,
        ..Self::AIR
    };

    /// Draws one sensor at random: bias, delay and lag, each within three standard deviations. The standard deviation
    /// of the bias is in kelvin, that of delay and lag in percent.
    #[must_use]
    pub fn drawn(self, bias_sd_k: f64, times_sd_pct: f64, draw: &mut Draw) -> Self {
        let mut near = |value: f64| {
            let off = draw.normal(0.0, 1.0).clamp(-3.0, 3.0);
            value * (1.0 + times_sd_pct / 100.0 * off).max(0.1)
        };
        let (delay_s, lag_s) = (near(self.delay_s), near(self.lag_s));
        Self {
            delay_s,
            lag_s,
            bias_k: self.bias_k + draw.normal(0.0, bias_sd_k),
            ..self
        }
    }
}

/// A sensor with its state.
#[derive(Debug, Clone)]
pub struct Sensor {
    /// Values of the sensor; a fault may change them.
    pub values: SensorValues,
    delay: Delay,
    lag: Lag,
    drift_k: f64,
}

impl Sensor {
    /// Creates a sensor that has long been at `celsius`.
    pub fn new(values: SensorValues, celsius: f64) -> Self {
        Self {
            values,
            delay: Delay::new(values.delay_s, celsius),
            lag: Lag::new(values.lag_s, celsius),
            drift_k: 0.0,
        }
    }

    /// Advances by `dt_s` to a new temperature around the sensor.
    pub fn step(&mut self, dt_s: f64, celsius: f64) {
        let delayed = self.delay.step(dt_s, celsius);
        self.lag.step(dt_s, delayed);
        self.drift_k += self.values.drift_k_per_h * dt_s / 3600.0;
    }

    /// Returns the temperature that the sensor shows without noise and resolution, degrees Celsius.
    pub fn celsius(&self) -> f64 {
        self.lag.celsius() + self.values.bias_k + self.drift_k
    }

    /// Returns a reading with noise and resolution, degrees Celsius.
    pub fn read(&self, draw: &mut Draw) -> f64 {
        let noisy = draw.normal(self.celsius(), self.values.noise_k);
        match self.values.step_k > 0.0 {
            true => (noisy / self.values.step_k).round() * self.values.step_k,
            false => noisy,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::draw::Subject;

    #[test]
    fn readings_scatter_about_the_shown_temperature_in_steps() {
        let mut draw = Draw::new(3, Subject::Rig, 0);
        let values = SensorValues {
            bias_k: 0.1,
            ..SensorValues::AIR
        };
        let sensor = Sensor::new(values, 60.0);
        let readings: Vec<f64> = (0..4000).map(|_| sensor.read(&mut draw)).collect();
        let mean = readings.iter().sum::<f64>() / 4000.0;
        let sd = (readings.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / 4000.0).sqrt();
        assert!((mean - 60.1).abs() < 0.002, "{mean}");
        assert!((sd - 0.0202).abs() < 0.001, "{sd}");
        let steps = readings[0] / 0.01;
        assert!((steps - steps.round()).abs() < 1e-6);
    }

    #[test]
    fn drift_grows_by_its_rate() {
        let values = SensorValues {
            drift_k_per_h: 0.5,
            ..SensorValues::AIR
        };
        let mut sensor = Sensor::new(values, 60.0);
        for _ in 0..3600 {
            sensor.step(1.0, 60.0);
        }
        assert!((sensor.celsius() - 60.5).abs() < 1e-9);
    }
}
