//! A recorded signal, as the history returns it.

/// Samples of one signal, in order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the point.
    pub signal: String,
    /// Unit of the values; empty for bits and counts.
    pub unit: String,
    /// Time of the first sample, microseconds since 1970-01-01 UTC.
    pub begin_us: i64,
    /// Times of the samples, microseconds since `begin_us`.
    pub t_us: Vec<i64>,
    /// Values of the samples; `None` where the converter gave no number.
    pub values: Vec<Option<f64>>,
}

impl Curve {
    /// Yields time (microseconds UTC) and value.
    pub fn samples(&self) -> impl Iterator<Item = (i64, Option<f64>)> {
        let at = self.t_us.iter().map(|t| self.begin_us + t);
        at.zip(self.values.iter().copied())
    }
}
