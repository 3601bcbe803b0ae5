//! Drive of the coil: a source, or the suppression after switch-off.

/// One smooth section of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// A source with `volts` at `since_s` and a constant slope from then on.
    Source {
        /// Voltage at the start, V.
        volts: f64,
        /// Slope, V/s.
        slope: f64,
        /// Start, s.
        since_s: f64,
    },
    /// No source; the suppression holds this voltage while current flows.
    Suppression {
        /// Voltage of the diode or zener, V.
        volts: f64,
    },
}

impl Drive {
    /// Creates a source of constant voltage.
    pub fn still(volts: f64) -> Self {
        Self::Source {
            volts,
            slope: 0.0,
            since_s: 0.0,
        }
    }
}

/// Coil voltage over time: linear between points, constant before the first and after the last. Two points at one
/// instant form a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Waveform(Vec<[f64; 2]>);

impl Waveform {
    /// Creates a waveform from points of (seconds, volts).
    ///
    /// # Errors
    /// Fails with the index of the first point that is not finite or precedes its predecessor; with 0 for an empty
    /// list.
    pub fn new(points: Vec<[f64; 2]>) -> Result<Self, usize> {
        let finite = |p: &[f64; 2]| p[0].is_finite() && p[1].is_finite();
        if points.is_empty() {
            return Err(0);
        }
        if let Some(at) = points.iter().position(|p| !finite(p)) {
            return Err(at);
        }
        match points.windows(2).position(|w| w[1][0] < w[0][0]) {
            Some(at) => Err(at + 1),
            None => Ok(Self(points)),
        }
    }

    /// Returns the drive at `t_s`, and the time at which that section of the waveform ends, s (infinite for the last).
    pub fn piece(&self, t_s: f64) -> (Drive, f64) {
        let next = self.0.partition_point(|p| p[0] <= t_s);
        let end = self.0.get(next).map_or(f64::INFINITY, |p| p[0]);
        let Some(from) = next.checked_sub(1).map(|i| self.0[i]) else {
            return (Drive::still(self.0[0][1]), end);
        };
        let slope = match self.0.get(next) {
            Some(to) => (to[1] - from[1]) / (to[0] - from[0]),
            None => 0.0,
        };
        let drive = Drive::Source {
            volts: from[1],
            slope,
            since_s: from[0],
        };
        (drive, end)
    }
}
