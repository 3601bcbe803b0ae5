//! What stands at the coil: a source, or a clamp after switch-off.

/// One smooth piece of what stands at the coil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// A source of `volts` at `since_s`, from then on with a constant slope.
    Source {
        /// Volts at the beginning.
        volts: f64,
        /// Volts per second.
        slope: f64,
        /// Beginning, s.
        since_s: f64,
    },
    /// Nothing but a clamp that holds so many volts while current flows.
    Clamp {
        /// Diode or zener voltage.
        volts: f64,
    },
}

impl Drive {
    /// A source that stands still.
    pub fn still(volts: f64) -> Self {
        Self::Source {
            volts,
            slope: 0.0,
            since_s: 0.0,
        }
    }
}

/// Coil voltage over time: linear between points, held before the first and after the last. Two
/// points at one instant are a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Waveform(Vec<[f64; 2]>);

impl Waveform {
    /// From points of (seconds, volts).
    ///
    /// # Errors
    /// Index of the first point that is not finite or lies before its predecessor; 0 without points.
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

    /// The piece that holds at an instant, and where it ends.
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
