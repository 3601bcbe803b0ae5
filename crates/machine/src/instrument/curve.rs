//! What was seen of one signal, as a history gives it back.

/// Samples of one signal, in order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the point.
    pub signal: String,
    /// Unit of the values; empty for bits and counts.
    pub unit: String,
    /// When the first sample was taken, microseconds since 1970-01-01 UTC.
    pub begin_us: i64,
    /// Microseconds since then.
    pub t_us: Vec<i64>,
    /// Beside them; none where the look gave no number.
    pub values: Vec<Option<f64>>,
}

impl Curve {
    /// Instant, microseconds UTC, and value.
    pub fn samples(&self) -> impl Iterator<Item = (i64, Option<f64>)> {
        let at = self.t_us.iter().map(|t| self.begin_us + t);
        at.zip(self.values.iter().copied())
    }
}
