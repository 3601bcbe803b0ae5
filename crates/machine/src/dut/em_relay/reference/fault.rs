//! Faults of the calibration against the references on the interface board.

use crate::rig::sample::{Quality, Sample};
use thiserror::Error;

/// Why the references do not calibrate the rig.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReferenceFault {
    /// A channel has no usable reading.
    #[error("{name} reads {raw} ({quality:?})")]
    Reads {
        /// The channel.
        name: &'static str,
        /// The reply.
        raw: String,
        /// Quality of the reading.
        quality: Quality,
    },
    /// A channel is masked out.
    #[error("{name} is not enabled")]
    NotEnabled {
        /// The channel.
        name: &'static str,
    },
    /// A channel has no scan.
    #[error("{name} was not read")]
    NotRead {
        /// The channel.
        name: &'static str,
    },
    /// Scans are missing.
    #[error("{found} scans where {expected} were expected")]
    Scans {
        /// Scans read.
        found: usize,
        /// Scans asked for.
        expected: usize,
    },
    /// The gain error exceeds 1.5 times the accuracy of the maker.
    #[error("coil converter gain is off by {off_pct:.3} %, promised {promised_pct:.3} %")]
    Gain {
        /// Found minus 1, %.
        off_pct: f64,
        /// Accuracy of the maker, half width, %.
        promised_pct: f64,
    },
    /// Too few readings between the ends of the fine ramp.
    #[error("only {readings} readings on the fine ramp")]
    FewOnRamp {
        /// Readings that count.
        readings: usize,
    },
    /// The slope of the fine ramp does not match its slew code.
    #[error("slope of the fine ramp is {v_per_s:.4} V/s where {nominal_v_per_s} V/s was expected")]
    Slope {
        /// Slope found.
        v_per_s: f64,
        /// Slope of the slew code.
        nominal_v_per_s: f64,
    },
    /// The drop of the reference contact is out of range: a fault of source or amplifier.
    #[error("reference contact drops {volts:.3} V where {expected_v:.3} V was expected")]
    Drop {
        /// Drop found, V at the terminal.
        volts: f64,
        /// Drop of the reference resistor.
        expected_v: f64,
    },
    /// Counters were not read before and after the pulses.
    #[error("gate counters not read")]
    GatesNotRead,
    /// The count of the reference pulse is out of range.
    #[error("a pulse of 1.000 ms at gate {gate} counts {each_us:.1} us")]
    Pulse {
        /// Which counter.
        gate: usize,
        /// Count of a pulse, us.
        each_us: f64,
    },
}

impl ReferenceFault {
    pub(super) fn reads(name: &'static str, sample: &Sample) -> Self {
        Self::Reads {
            name,
            raw: sample.origin.raw.to_string(),
            quality: sample.quality,
        }
    }
}
