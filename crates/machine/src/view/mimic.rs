//! The machine as a picture: silhouettes to scale. Where the tooling stands now is in the view.

use serde::Serialize;

/// What never changes during a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Mimic {
    /// In the order of the scene, a part in each of its places last.
    pub bodies: Vec<MimicBody>,
}

/// One body with all actuators at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MimicBody {
    /// As in `scene.toml`; `part_nest` and the like for parts.
    pub id: String,
    /// Actuators by name, and the way in mm (x, y, z) for each millimetre of theirs.
    pub rides: Vec<(String, [f64; 3])>,
    /// Polygons seen from above, x and y in mm.
    pub above: Vec<Vec<[f64; 2]>>,
    /// Polygons seen from the front, x and z in mm.
    pub front: Vec<Vec<[f64; 2]>>,
}
