//! Use counts of wearing parts.

/// Counts since a start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Uses {
    /// Upward strokes of the probes.
    pub probe_touches: u64,
    /// Closings of the jaws.
    pub jaw_closings: u64,
}

impl Uses {
    /// Returns each count with the name of its counter.
    pub fn each(&self) -> [(&'static str, u64); 2] {
        [
            ("probe_touches", self.probe_touches),
            ("jaw_closings", self.jaw_closings),
        ]
    }

    /// Returns the sum of both.
    pub fn with(self, more: Self) -> Self {
        Self {
            probe_touches: self.probe_touches + more.probe_touches,
            jaw_closings: self.jaw_closings + more.jaw_closings,
        }
    }
}

named! {
    /// Wearing part.
    Wearing {
        /// Probes, by touches.
        Probes = "probes",
        /// Jaws, by closings.
        Jaws = "jaws",
    }
}
