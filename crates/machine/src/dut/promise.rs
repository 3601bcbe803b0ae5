//! Promises: standard deviations that `config/rig.toml` or a recipe states, and that a kind of device checks while it
//! measures.

use serde::{Deserialize, Serialize};

named! {
    /// A promised standard deviation that a kind observes.
    #[derive(Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    Promise {
        /// Noise of the analog inputs.
        AiNoise = "ai_noise",
        /// Scatter of a threshold from operation to operation.
        OperationScatter = "operation_scatter",
        /// Scatter of a contact resistance from closure to closure.
        ClosureScatter = "closure_scatter",
        /// Difference between the temperatures of part and magazine track.
        PartMinusTrack = "part_minus_track",
    }
}

impl Promise {
    /// Returns the file and the key that hold the promise; the key ends with its unit.
    pub const fn key(self) -> &'static str {
        match self {
            Self::AiNoise => "rig.toml accuracy.ai_noise_lsb",
            Self::OperationScatter => "rig.toml accuracy.operation_scatter_mv",
            Self::ClosureScatter => "recipe test.strategy.contact.closure_scatter_pct",
            Self::PartMinusTrack => "rig.toml accuracy.part_minus_track_k",
        }
    }
}

/// A promise that measurements have disproved, with the standard deviations in the unit of its key.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Broken {
    /// Promise that does not hold.
    pub promise: Promise,
    /// Value that the file promises.
    pub promised: f64,
    /// Value that the residuals show.
    pub seen: f64,
    /// Ends of the 95 % interval of `seen`.
    pub interval: (f64, f64),
    /// Degrees of freedom of the estimate `seen`.
    pub freedom: f64,
    /// Standard deviation that budgets use from now on: `seen`, widened by Student's t.
    pub used: f64,
}
