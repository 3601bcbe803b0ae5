//! What a specimen really was and where its body went: the record that judges the controller.

use serde::Serialize;

use crate::world::relay::Levels;

/// True values of one lot part; absent where the part never showed the quantity.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PartTruth {
    /// Order of entering the nest, from 1; golden parts are not counted.
    pub seq: u64,
    /// Coil resistance at the reference temperature; absent for an open coil.
    pub coil_resistance_ohm: Option<f64>,
    /// Quasi-static operate threshold at the reference temperature.
    pub operate_voltage_v: Option<f64>,
    /// Quasi-static release threshold at the reference temperature.
    pub release_voltage_v: Option<f64>,
    /// Last operation at full voltage, drive on to first make.
    pub operate_time_ms: Option<f64>,
    /// Last release from full voltage, drive off to first make of NC.
    pub release_time_ms: Option<f64>,
    /// Open time of NO after its first make in that operation.
    pub operate_bounce_ms: Option<f64>,
    /// Open time of NC after its first make in that release.
    pub release_bounce_ms: Option<f64>,
    /// Mean over the closures of NO on which the source was on.
    pub contact_resistance_no_mohm: Option<f64>,
    /// Mean over the closures of NC on which the source was on.
    pub contact_resistance_nc_mohm: Option<f64>,
    /// Resistance of a dummy at the reference temperature; absent for an open one. Relays have no such key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resistance_ohm: Option<f64>,
    /// Operations of a relay at full voltage, from rest to the first make of NO. Dummies have no such key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operations: Option<u64>,
    /// Name of the defect.
    pub defect: Option<&'static str>,
    /// Bin in which the body came to rest.
    pub landed_in: Option<String>,
    /// How its motion was computed: rig time held in equilibrium, and with all five states.
    pub levels: Levels,
}

/// Somewhere between magazine and bin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Before the pusher.
    Pocket,
    /// In front of a pusher that is under way.
    Pusher,
    /// In the nest.
    Nest,
    /// Between fingers that have lifted it.
    Gripper,
    /// Falling down a chute.
    Air,
    /// Come to rest in this bin.
    Bin(String),
    /// Come to rest beside every bin.
    Floor,
}

/// One body, golden parts included.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyTruth {
    /// A golden part.
    pub golden: bool,
    /// It clung to the body before it, went wherever that went, and was never tested.
    pub clung: bool,
    /// Where it came to and when, rig time in microseconds, in order of time.
    pub path: Vec<(u64, Place)>,
    /// What it was.
    pub part: PartTruth,
}

impl BodyTruth {
    /// Where it was at an instant; none before it left the magazine.
    pub fn at(&self, t_us: u64) -> Option<&Place> {
        let earlier = self.path.iter().rev();
        earlier
            .map(|(since, place)| (*since, place))
            .find(|(since, _)| *since <= t_us)
            .map(|(_, place)| place)
    }
}
