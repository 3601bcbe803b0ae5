//! Certificate of the thermometer chain and of the rack, and the calibration that the history keeps of it.
//!
//! A laboratory compares the reference thermometer, read through its own module, at several temperatures, and measures
//! each socket against the air. `relayrig calibrate` stores both; without them results carry the uncertainty of a raw rig.

use super::issued;
use super::response::StatedResponse;
use crate::dut::calibration::CalibrationFacts;
use crate::dut::device::Made;
use crate::gauge::Factor;
use crate::gauge::factor::Named;
use crate::rig::fault::Fault;
use chamber::budget::{Calibrations, map_k};
use serde::{Deserialize, Serialize};
use units::Unit;

/// Nominal voltage, V, that marks a calibration as valid for parts of every voltage.
pub const EVERY_PART_V: f64 = 0.0;
/// Least number of temperatures at which a laboratory compares the chain.
const LEAST_POINTS: usize = 3;

/// A temperature at which a laboratory compared the chain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ChainPoint {
    /// Reading of the rig, C.
    pub reading_c: f64,
    /// True temperature, C.
    pub true_c: f64,
}

/// Reference thermometer with its module.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chain {
    /// Temperatures, rising.
    pub points: Vec<ChainPoint>,
    /// Standard uncertainty that remains after the correction, K.
    pub u_k: f64,
}

/// Temperatures of the sockets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SocketMap {
    /// Temperature of the air above that of the room when the map was made, K; the offsets grow in proportion.
    pub excess_k: f64,
    /// Temperature of each socket above that of the air, K, in the order of their numbers.
    pub offset_k: Vec<f64>,
    /// Standard uncertainty of an offset, K.
    pub u_k: f64,
}

/// Statements of a laboratory on thermometer chain and rack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Date of issue, such as `2026-01-15`; empty only in a calibration that an older version stored.
    #[serde(default)]
    pub issued: String,
    /// Chain of the reference thermometer.
    pub chain: Chain,
    /// Temperatures of the sockets.
    pub map: SocketMap,
    /// Response of the chamber, which is no statement of a laboratory; `None` when batches identify it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chamber: Option<Box<StatedResponse>>,
}

/// The certificate as the history keeps it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    made_at_us: i64,
    due_at_us: i64,
    /// When the history stored it, microseconds since 1970 UTC: the same certificate may return after another one.
    #[serde(default)]
    stored_at_us: i64,
    simulated: bool,
    nominal_v: f64,
    /// What the laboratory states.
    pub certificate: Certificate,
}

impl Certificate {
    /// Checks the figures against each other and against the rack.
    ///
    /// # Errors
    /// Fails with the key, what was found and what was expected.
    pub fn check(&self, sockets: usize) -> Result<(), Fault> {
        if issued::begin_us(&self.issued).is_none() {
            let found = format!("\"{}\"", self.issued);
            return Err(Fault::new("issued", found, "a date such as \"2026-01-15\""));
        }
        let points = &self.chain.points;
        if points.len() < LEAST_POINTS {
            let expected = format!("at least {LEAST_POINTS} temperatures");
            return Err(Fault::new("chain.points", points.len(), expected));
        }
        let pairs = points.iter().zip(points.iter().skip(1));
        let falls = pairs
            .map(|(a, b)| a.reading_c >= b.reading_c)
            .position(|falls| falls);
        if let Some(index) = falls {
            let key = format!("chain.points.{}.reading_c", index + 1);
            let expected = format!("more than {}", points[index].reading_c);
            return Err(Fault::new(key, points[index + 1].reading_c, expected));
        }
        let found = self.map.offset_k.len();
        (found == sockets).then_some(()).ok_or_else(|| {
            let expected = format!("one for each of the {sockets} sockets");
            Fault::new("map.offset_k", format!("{found} offsets"), expected)
        })
    }

    /// Returns the temperature of a part that the reference thermometer shows; `place`: of its socket, from 0.
    pub fn correct(&self, reading_c: f64, place: usize, ambient_c: f64) -> f64 {
        let air_c = reading_c - self.chain.error_k(reading_c);
        let offset_k = self.map.offset_k.get(place).copied().unwrap_or(0.0);
        air_c + offset_k * (air_c - ambient_c) / self.map.excess_k
    }

    /// Returns the uncertainties that remain.
    pub fn remaining(&self) -> Calibrations {
        Calibrations {
            chain_k: Some(self.chain.u_k),
            map_k: Some(map_k(self.map.u_k, self.map.excess_k)),
        }
    }
}

impl Chain {
    /// Returns reading less true temperature, K: linear between the points, constant beyond them.
    fn error_k(&self, reading_c: f64) -> f64 {
        let error = |it: &ChainPoint| it.reading_c - it.true_c;
        let after = self.points.iter().position(|it| it.reading_c > reading_c);
        match after {
            None => self.points.last().map_or(0.0, error),
            Some(0) => self.points.first().map_or(0.0, error),
            Some(after) => {
                let (a, b) = (&self.points[after - 1], &self.points[after]);
                let share = (reading_c - a.reading_c) / (b.reading_c - a.reading_c);
                error(a) + share * (error(b) - error(a))
            }
        }
    }
}

impl Calibration {
    /// Makes the calibration of a rig from its certificate, which holds from its date on; on the simulated rig from now
    /// on.
    pub fn new(certificate: Certificate, made: Made) -> Self {
        let issued_us = issued::begin_us(&certificate.issued).filter(|_| !made.simulated);
        let made_at_us = issued_us.unwrap_or(made.at_us);
        Self {
            made_at_us,
            due_at_us: made_at_us + made.valid_us,
            stored_at_us: made.at_us,
            simulated: made.simulated,
            nominal_v: EVERY_PART_V,
            certificate: Certificate {
                chamber: None,
                ..certificate
            },
        }
    }

    /// Returns the data that every kind of calibration has.
    pub fn facts(&self) -> CalibrationFacts {
        let Certificate { chain, map, .. } = &self.certificate;
        let named = |name, value, u| Named {
            name,
            unit: Unit::Kelvin,
            factor: Factor::new(value, u),
        };
        let errors = chain.points.iter().map(|it| it.reading_c - it.true_c);
        let mean_k = errors.sum::<f64>() / chain.points.len() as f64;
        let widest = |it: f64, other: &f64| if other.abs() > it.abs() { *other } else { it };
        let widest_k = map.offset_k.iter().fold(0.0, widest);
        CalibrationFacts {
            made_at_us: self.made_at_us,
            due_at_us: self.due_at_us,
            is_simulated: self.simulated,
            nominal_v: self.nominal_v,
            range_factor: 1.0,
            is_complete: true,
            factors: vec![
                named("thermometer_error", mean_k, chain.u_k),
                named("socket_offset", widest_k, map.u_k),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn certificate() -> Certificate {
        let point = |reading_c, true_c| ChainPoint { reading_c, true_c };
        let points = vec![point(40.1, 40.0), point(80.2, 80.0), point(120.2, 120.0)];
        Certificate {
            issued: "2026-01-15".into(),
            chain: Chain { points, u_k: 0.05 },
            map: SocketMap {
                excess_k: 75.0,
                offset_k: vec![0.3, -0.3],
                u_k: 0.1,
            },
            chamber: None,
        }
    }

    #[test]
    fn readings_are_corrected_between_and_beyond_the_points() {
        let it = Certificate {
            map: SocketMap {
                offset_k: vec![0.0],
                ..certificate().map
            },
            ..certificate()
        };
        for (reading_c, expected_c) in [(30.0, 29.9), (60.15, 60.0), (130.0, 129.8)] {
            let found_c = it.correct(reading_c, 0, 25.0);
            assert!((found_c - expected_c).abs() < 1e-9, "{found_c}");
        }
    }

    #[test]
    fn offsets_of_sockets_grow_with_the_excess() {
        let it = certificate();
        assert!((it.correct(100.2, 0, 25.0) - 100.3).abs() < 1e-9);
        assert!((it.correct(100.2, 1, 25.0) - 99.7).abs() < 1e-9);
        assert!((it.correct(62.655, 0, 25.0) - 62.65).abs() < 0.01);
    }

    #[test]
    fn uncertainty_of_a_map_holds_at_its_own_excess() {
        for excess_k in [30.0, 75.0] {
            let mut it = certificate();
            it.map.excess_k = excess_k;
            let found = it.remaining().of_temperature(excess_k, 0.0).map_k;
            assert!((found - 0.1).abs() < 1e-9, "{excess_k}: {found}");
        }
    }

    #[test]
    fn a_wrong_certificate_names_key_and_figure() {
        let mut it = certificate();
        let said = |it: &Certificate, sockets| it.check(sockets).err().map(|it| it.to_string());
        assert_eq!(said(&it, 2), None);
        assert!(said(&it, 40).is_some_and(|it| it.contains("40 sockets")));
        it.issued = "15 January".into();
        assert!(said(&it, 2).is_some_and(|it| it.contains("issued: found \"15 January\"")));
        it.issued = "2026-01-15".into();
        it.chain.points.swap(0, 1);
        assert!(said(&it, 2).is_some_and(|it| it.contains("chain.points.1.reading_c")));
        it.chain.points.truncate(2);
        assert!(said(&it, 2).is_some_and(|it| it.contains("at least 3")));
    }

    #[test]
    fn a_certificate_holds_from_its_date_on() {
        let made = |simulated| Made {
            at_us: 1_800_000_000_000_000,
            valid_us: 10,
            simulated,
        };
        let due_us = |simulated| {
            let made = Calibration::new(certificate(), made(simulated));
            made.facts().due_at_us
        };
        assert_eq!(due_us(false), 1_768_435_200_000_010);
        assert_eq!(due_us(true), 1_800_000_000_000_010);
    }

    #[test]
    fn a_stored_calibration_reads_as_one_of_a_rack() {
        let made = Made {
            at_us: 5,
            valid_us: 10,
            simulated: true,
        };
        let made = Calibration::new(certificate(), made);
        let text = serde_json::to_string(&made).unwrap_or_default();
        let read: Option<crate::dut::Calibration> = serde_json::from_str(&text).ok();
        assert_eq!(read, Some(crate::dut::Calibration::Thermostat(made)));
    }
}
