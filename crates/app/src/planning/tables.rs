//! The tables of a scene file that plans need beside the bodies: actuators, pairs and mates.
//!
//! The reader of scenes has already checked each entry.

use anyhow::Context;
use lpm::scene::Format;
use plan::MateWanted;
use serde::Deserialize;

/// The tables of one scene file.
#[derive(Debug, Default, Deserialize)]
pub(super) struct Tables {
    #[serde(default)]
    pub(super) actuator: Vec<ActuatorTable>,
    #[serde(default)]
    pub(super) pair: Vec<PairTable>,
    #[serde(default)]
    pub(super) mate: Vec<MateTable>,
}

/// The keys of `[[actuator]]` that a plan needs.
#[derive(Debug, Deserialize)]
pub(super) struct ActuatorTable {
    pub(super) id: String,
    /// Direction of the stroke.
    pub(super) axis: [f64; 3],
    pub(super) rides: Option<String>,
}

/// The keys of `[[pair]]` that a plan needs.
#[derive(Debug, Deserialize)]
pub(super) struct PairTable {
    pub(super) a: String,
    pub(super) b: String,
    pub(super) rule: String,
}

/// `[[mate]]`: two elements that are held to each other.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MateTable {
    pub(super) a: String,
    pub(super) b: String,
    pub(super) kind: MateKind,
    /// Gap up to which the elements count as mated, mm.
    pub(super) tolerance_mm: Option<f64>,
}

/// Kind of a mate, as the file names it.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum MateKind {
    Plane,
    Align,
    Axis,
}

impl MateKind {
    pub(super) fn wanted(self) -> MateWanted {
        match self {
            MateKind::Plane => MateWanted::Plane,
            MateKind::Align => MateWanted::Align,
            MateKind::Axis => MateWanted::Axis,
        }
    }
}

impl Tables {
    /// Reads the tables of a scene file that the reader of scenes has accepted.
    pub(super) fn read(text: &str, format: Format) -> anyhow::Result<Tables> {
        let text = text.trim_start_matches('\u{feff}');
        match format {
            Format::Toml => toml::from_str(text).context("tables of the plan"),
            Format::Json => serde_json::from_str(text).context("tables of the plan"),
        }
    }

    /// Returns the axis along which `actuator` moves, 0 to 2 for x to z; `None` for a slanted stroke.
    pub(super) fn axis(&self, actuator: &str) -> Option<usize> {
        let table = self.actuator.iter().find(|it| it.id == actuator)?;
        let moves = |axis: &usize| table.axis[*axis] != 0.0;
        let mut axes = (0..3).filter(moves);
        axes.next().filter(|_| axes.next().is_none())
    }

    /// Returns true when `carrier` carries `actuator`, directly or through other actuators.
    pub(super) fn is_carried(&self, actuator: &str, carrier: &str) -> bool {
        let above = |id: &str| {
            let table = self.actuator.iter().find(|it| it.id == id);
            table.and_then(|it| it.rides.clone())
        };
        let chain = std::iter::successors(above(actuator), |id| above(id));
        chain.take(self.actuator.len()).any(|it| it == carrier)
    }
}
