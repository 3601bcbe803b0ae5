//! Uses of what wears.

/// Uses so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Uses {
    /// Times that the probes rose.
    pub probe_touches: u64,
    /// Times that the jaws closed.
    pub jaw_closings: u64,
}

impl Uses {
    /// Each with the name of its counter.
    pub fn each(&self) -> [(&'static str, u64); 2] {
        [
            ("probe_touches", self.probe_touches),
            ("jaw_closings", self.jaw_closings),
        ]
    }

    /// Both together.
    pub fn with(self, more: Self) -> Self {
        Self {
            probe_touches: self.probe_touches + more.probe_touches,
            jaw_closings: self.jaw_closings + more.jaw_closings,
        }
    }
}

/// What wears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Wearing {
    /// Probes, by touches.
    Probes,
    /// Jaws, by closings.
    Jaws,
}

impl Wearing {
    /// Every one.
    pub const ALL: [Self; 2] = [Self::Probes, Self::Jaws];

    /// The name in alarms.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Probes => "probes",
            Self::Jaws => "jaws",
        }
    }
}
