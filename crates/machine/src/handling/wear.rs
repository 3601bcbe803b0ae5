//! Use counts of the wearing parts.

/// Use counts of the wearing parts over some period.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Uses {
    /// Number of upward strokes of the probes.
    pub probe_touches: u64,
    /// Number of closings of the jaws.
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

    /// Returns the sum of these counts and `more`.
    pub fn with(self, more: Self) -> Self {
        Self {
            probe_touches: self.probe_touches + more.probe_touches,
            jaw_closings: self.jaw_closings + more.jaw_closings,
        }
    }
}

named! {
    /// A wearing part.
    Wearing {
        /// Probes; each touch counts as a use.
        Probes = "probes",
        /// Jaws; each closing counts as a use.
        Jaws = "jaws",
    }
}
