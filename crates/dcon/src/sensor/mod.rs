//! Characteristics of the sensors behind the temperature inputs: Pt100 of IEC 60751, thermocouple of type K. A module
//! converts by itself; who checks one needs them, with a resistance decade or a voltage source in place of the sensor.

mod pt100;
mod type_k;

use crate::type_code::TypeCode;

/// A sensor whose characteristic is known here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sensor {
    /// Pt100 with 0.00385/K, in ohm; -200 to 850 C.
    Pt100,
    /// Thermocouple of type K with its cold junction at 0 C, in mV; 0 to 500 C.
    TypeK,
}

impl Sensor {
    /// Returns the sensor that a type code expects; `None` for any other input. Other makers give these codes other
    /// ranges, of the same sensors.
    pub fn of(code: TypeCode) -> Option<Self> {
        match code.0 {
            0x20..=0x23 | 0x2E | 0x80 => Some(Self::Pt100),
            0x0F => Some(Self::TypeK),
            _ => None,
        }
    }

    /// Returns the unit of the signal.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Pt100 => "ohm",
            Self::TypeK => "mV",
        }
    }

    /// Returns the signal at a temperature, C; `None` outside the range of the sensor.
    pub fn signal(self, celsius: f64) -> Option<f64> {
        match self {
            Self::Pt100 => pt100::ohm(celsius),
            Self::TypeK => type_k::millivolt(celsius),
        }
    }

    /// Returns the temperature for a signal, C: exact for a Pt100, within 0.05 K for a type K; `None` outside the range of
    /// the sensor.
    pub fn celsius(self, signal: f64) -> Option<f64> {
        match self {
            Self::Pt100 => pt100::celsius(signal),
            Self::TypeK => type_k::celsius(signal),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn signal_and_temperature_agree_for_each_sensor() {
        for code in [0x20, 0x22, 0x23, 0x2E, 0x80, 0x0F] {
            let sensor = Sensor::of(TypeCode(code)).unwrap();
            for celsius in [10.0, 50.0, 85.0, 150.0] {
                let signal = sensor.signal(celsius).unwrap();
                assert!((sensor.celsius(signal).unwrap() - celsius).abs() < 0.05);
            }
        }
        assert_eq!(
            [0x08, 0x24, 0x2A, 0x40].map(|it| Sensor::of(TypeCode(it))),
            [None; 4]
        );
    }
}
