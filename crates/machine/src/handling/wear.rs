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

/// Wearing part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Wearing {
    /// Probes, by touches.
    Probes,
    /// Jaws, by closings.
    Jaws,
}

impl Wearing {
    /// Every wearing part.
    pub const ALL: [Self; 2] = [Self::Probes, Self::Jaws];

    /// Returns the name in alarms.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Probes => "probes",
            Self::Jaws => "jaws",
        }
    }
}
