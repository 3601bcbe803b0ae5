//! True values of a temperature relay.

use serde::Serialize;

/// True values of one part; `None` for a value that the part does not have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ThermostatTruth {
    /// Mean operate temperature, degrees Celsius.
    pub operate_temperature_c: Option<f64>,
    /// Mean reset temperature, degrees Celsius.
    pub reset_temperature_c: Option<f64>,
    /// Operate minus reset temperature, kelvin.
    pub differential_k: Option<f64>,
    /// Mean resistance of the closures that carried the test current, else the median of the part, milliohm.
    pub contact_resistance_mohm: Option<f64>,
    /// Width of a slow break, kelvin; 0 for a snap.
    pub creep_k: f64,
    /// Number of changes of the contact besides those of operating and resetting, bounce excluded.
    pub chatter_edges: u64,
    /// Largest minus smallest operate temperature so far, kelvin.
    pub repeatability_k: Option<f64>,
    /// Standard deviation of a switching temperature from one event to the next, kelvin.
    pub scatter_k: f64,
    /// Time constants of body and disc, seconds.
    pub lag_s: [f64; 2],
    /// Name of the defect, if any.
    pub defect: Option<&'static str>,
}

/// One part of a batch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SocketTruth {
    /// Order of loading, from 1.
    pub seq: u64,
    /// Number of the socket on the rack.
    pub socket: u64,
    /// Number of the batch, from 1.
    pub batch: u64,
    /// True values of the part.
    #[serde(flatten)]
    pub part: ThermostatTruth,
}
