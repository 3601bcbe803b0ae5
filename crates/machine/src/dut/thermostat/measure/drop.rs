//! Measures contact resistances before the batch is heated: four-wire, one socket after the other.
//!
//! The test reads each contact without and with current; the difference is free of offset and thermal EMF.

use crate::dut::accuracy::{AccuracySettings, LSB_V};
use crate::dut::thermostat::points::Points;
use crate::gauge::budget::{rectangular, resolution};
use crate::gauge::{Budget, Reading};
use crate::instrument::act::{Act, Read};
use crate::instrument::readings::Readings;
use crate::rig::point::Point;
use crate::rig::rack::Socket;
use crate::rig::sample::{Quality, Sample};
use units::{Span, Unit};

/// Test current through the contact, A; the next number is its half width as a share.
const CURRENT_A: f64 = 0.1;
const CURRENT_SHARE: f64 = 0.001;
/// Settling time of multiplexer, current and amplifier.
const SETTLES: Span = Span::ms(40);
/// Number of conversions to wait after settling; the last of them counts.
const CONVERSIONS: f64 = 2.1;

/// Returns the acts that read the contacts of these sockets.
pub fn acts(points: &Points, sockets: &[Socket], accuracy: &AccuracySettings) -> Vec<Act> {
    let converts = Span::seconds(CONVERSIONS / accuracy.conversions_per_s);
    let read = || {
        [
            Act::Wait(SETTLES + converts),
            Act::Read(Read::points([Point::Analog(points.drop)])),
        ]
    };
    let one = |socket: &Socket| {
        let mut acts = vec![Act::Set(points.selecting(socket.select))];
        acts.extend(read());
        acts.push(Act::Set(vec![(points.current, true)]));
        acts.extend(read());
        acts.push(Act::Set(vec![(points.current, false)]));
        acts
    };
    sockets.iter().flat_map(one).collect()
}

/// A reading of the contact voltage has no value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unreadable;

/// A resistance with its samples; `None` for a contact whose drop is over the range.
pub type Found = Option<(Reading, [Sample; 2])>;

/// Returns the resistances of the sockets in the order of [`acts`]; fails when a reading has no value.
pub fn resistances(
    points: &Points,
    readings: &Readings,
    accuracy: &AccuracySettings,
) -> Result<Vec<Found>, Unreadable> {
    let samples: Vec<&Sample> = readings.analog(points.drop).collect();
    let one = |pair: &[&Sample]| {
        let [off, on] = pair else {
            return Err(Unreadable);
        };
        match (off.quality, on.quality) {
            (Quality::Good, Quality::Good) if (on.value - off.value).is_finite() => {
                let ohm = (on.value - off.value) / CURRENT_A;
                let reading = reading(ohm * 1e3, accuracy, points.drop_gain);
                Ok(Some((reading, [(*off).clone(), (*on).clone()])))
            }
            (Quality::Good, Quality::OverRange) => Ok(None),
            (
                Quality::Good | Quality::OverRange | Quality::UnderRange | Quality::Blank,
                Quality::Good | Quality::OverRange | Quality::UnderRange | Quality::Blank,
            ) => Err(Unreadable),
        }
    };
    samples.chunks(2).map(one).collect()
}

fn reading(mohm: f64, accuracy: &AccuracySettings, volt_gain: f64) -> Reading {
    let step_mohm = LSB_V / volt_gain / CURRENT_A * 1e3;
    let noise = (accuracy.ai_noise_lsb * step_mohm).hypot(resolution(step_mohm));
    Reading {
        value: mohm,
        unit: Unit::Milliohm,
        budget: Budget::default()
            .with("gain", mohm * rectangular(accuracy.ai_gain_pct / 100.0))
            .with("current", mohm * rectangular(CURRENT_SHARE))
            .with_random("noise", noise * 2f64.sqrt()),
    }
}
