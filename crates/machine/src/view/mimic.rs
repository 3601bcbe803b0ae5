//! The machine as a picture: silhouettes to scale, all actuators at rest. The view holds the current positions.

use serde::Serialize;

/// The picture, constant during a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Mimic {
    /// Bodies in the order of the scene, then a part in each of its places.
    pub bodies: Vec<MimicBody>,
}

/// One body, with all actuators at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MimicBody {
    /// Id in `scene.toml`; `part_nest` and the like for parts.
    pub id: String,
    /// Actuators that carry the body, by name, each with the body's displacement in mm (x, y, z) per millimetre of
    /// stroke.
    pub rides: Vec<(String, [f64; 3])>,
    /// Silhouettes from above, x and y in mm.
    pub above: Vec<Vec<[f64; 2]>>,
    /// Silhouettes from the front, x and z in mm.
    pub front: Vec<Vec<[f64; 2]>>,
}
