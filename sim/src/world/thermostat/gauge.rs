//! A temperature sensor at the terminals of its module, with its faults.

use super::fault::SensorTrouble;
use crate::world::draw::Draw;
use crate::world::oven::{Sensor, SensorValues};

/// Factor of the noise of a sample over that of a reading: a conversion of the module averages three samples by
/// Simpson's rule, which divides the noise by the root of 2.
const NOISE_PER_SAMPLE: f64 = std::f64::consts::SQRT_2;

/// Temperature that stands for a resistance of 0 ohm, far below every range.
const SHORTED_C: f64 = -242.0;

/// A sensor with its fault.
#[derive(Debug, Clone)]
pub struct Gauge {
    sensor: Sensor,
    /// Temperature shown at the beginning of the last step, degrees Celsius.
    before_c: f64,
    trouble: Option<SensorTrouble>,
    stuck_c: f64,
}

impl Gauge {
    /// Creates a sensor that has long been at `celsius`.
    pub fn new(values: SensorValues, celsius: f64) -> Self {
        let sensor = Sensor::new(values, celsius);
        Self {
            before_c: sensor.celsius(),
            stuck_c: sensor.celsius(),
            sensor,
            trouble: None,
        }
    }

    /// Marks the beginning of a step, within which [`Self::sample`] takes the temperature as linear.
    pub fn begin_step(&mut self) {
        self.before_c = self.sensor.celsius();
    }

    /// Advances by `dt_s` to a new temperature around the sensor.
    pub fn step(&mut self, dt_s: f64, celsius: f64) {
        self.sensor.step(dt_s, celsius);
    }

    /// Begins a fault.
    pub fn fail(&mut self, trouble: SensorTrouble, drift_k_per_h: f64) {
        self.trouble = Some(trouble);
        self.stuck_c = self.sensor.celsius();
        if trouble == SensorTrouble::Drift {
            self.sensor.values.drift_k_per_h = drift_k_per_h;
        }
    }

    /// Returns a sample at this share (0 to 1) of the last step, degrees Celsius; NaN for a broken wire.
    pub fn sample(&self, share: f64, draw: &mut Draw) -> f64 {
        let shown_c = self.before_c + (self.sensor.celsius() - self.before_c) * share;
        match self.trouble {
            Some(SensorTrouble::Open) => f64::NAN,
            Some(SensorTrouble::Short) => SHORTED_C,
            Some(SensorTrouble::Stuck) => self.stuck_c,
            Some(SensorTrouble::Drift) | None => {
                draw.normal(shown_c, self.sensor.values.noise_k * NOISE_PER_SAMPLE)
            }
        }
    }
}
