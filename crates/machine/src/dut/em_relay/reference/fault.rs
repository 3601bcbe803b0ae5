//! Faults of the calibration against the references on the interface board.

use crate::rig::sample::Sample;
use crate::rig::supply::RangeMismatch;
use texts::{Lang, Message};
use thiserror::Error;

/// Reason why the references do not calibrate the rig.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}", self.message().say(Lang::En))]
pub enum ReferenceFault {
    /// A channel has no usable reading.
    Reads {
        /// Name of the channel.
        name: &'static str,
        /// The raw reply.
        raw: String,
    },
    /// A channel is masked out, that is, not enabled in its module.
    NotEnabled {
        /// Name of the channel.
        name: &'static str,
    },
    /// A channel has no scan.
    NotRead {
        /// Name of the channel.
        name: &'static str,
    },
    /// The number of scans differs from the number that the acts request.
    Scans {
        /// Scans read.
        found: usize,
        /// Scans that the acts request.
        expected: usize,
    },
    /// The gain error exceeds 1.5 times the maker's accuracy.
    Gain {
        /// Gain found minus 1, %.
        off_pct: f64,
        /// The maker's accuracy, half width, %.
        promised_pct: f64,
    },
    /// The board is in another supply range than the one selected.
    Range(RangeMismatch),
    /// The supply and the coil channel disagree, so the range relays are not where their read-back says.
    Supply {
        /// Supply in front of the drive, V.
        supply_v: f64,
        /// Coil voltage of the reference, V.
        coil_v: f64,
    },
    /// Too few readings between the ends of the fine ramp.
    FewOnRamp {
        /// Readings used for the slope.
        readings: usize,
    },
    /// The slope of the fine ramp does not match its slew code.
    Slope {
        /// Slope found, volts per second.
        v_per_s: f64,
        /// Nominal slope of the slew code, volts per second.
        nominal_v_per_s: f64,
    },
    /// The drop of the reference contact is out of range: a fault of source or amplifier.
    Drop {
        /// Drop found, V at the terminal.
        volts: f64,
        /// Drop expected across the reference resistor, V at the terminal.
        expected_v: f64,
    },
    /// No counter readings before and after the pulses.
    GatesNotRead,
    /// The count of the reference pulse is out of range.
    Pulse {
        /// Gate of the counter: 0 (latched time) or 1 (open while the contact is open).
        gate: usize,
        /// Mean count of one pulse, us.
        each_us: f64,
    },
}

impl ReferenceFault {
    pub(super) fn reads(name: &'static str, sample: &Sample) -> Self {
        Self::Reads {
            name,
            raw: sample.origin.raw.to_string(),
        }
    }

    /// Returns the fault as a text of the family `fault`, with its figures.
    pub fn message(&self) -> Message {
        let of = |code| Message::new("fault", code);
        match self {
            Self::Reads { name, raw } => of("reads").with("name", name).with("raw", raw),
            Self::NotEnabled { name } => of("not_enabled").with("name", name),
            Self::NotRead { name } => of("not_read").with("name", name),
            Self::Scans { found, expected } => {
                of("scans").with("found", found).with("expected", expected)
            }
            Self::Gain {
                off_pct,
                promised_pct,
            } => of("gain")
                .with("off_pct", format!("{off_pct:.3}"))
                .with("promised_pct", format!("{promised_pct:.3}")),
            Self::Range(RangeMismatch { selected, found }) => of("supply_range")
                .with("selected", selected)
                .with("found", found),
            Self::Supply { supply_v, coil_v } => of("supply_voltage")
                .with("supply_v", format!("{supply_v:.2}"))
                .with("coil_v", format!("{coil_v:.2}")),
            Self::FewOnRamp { readings } => of("few_on_ramp").with("readings", readings),
            Self::Slope {
                v_per_s,
                nominal_v_per_s,
            } => of("slope")
                .with("v_per_s", format!("{v_per_s:.4}"))
                .with("nominal_v_per_s", nominal_v_per_s),
            Self::Drop { volts, expected_v } => of("drop")
                .with("volts", format!("{volts:.3}"))
                .with("expected_v", format!("{expected_v:.3}")),
            Self::GatesNotRead => of("gates_not_read"),
            Self::Pulse { gate, each_us } => of("pulse")
                .with("gate", gate)
                .with("each_us", format!("{each_us:.1}")),
        }
    }
}
