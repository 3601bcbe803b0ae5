//! The guard's part of `config/scene.toml`, as types; another module parses the text.
//!
//! An element's pose is the one with **every actuator at its rest end** (stroke 0). All lengths are mm, x along the
//! line with the nest at 0, y across, z up from the baseplate's top.

use super::actuator::Actuator;
use serde::Deserialize;

/// Contents of `config/scene.toml`; other modules read and check its tables `movers` and `mate`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuardSettings {
    /// Must be `"mm"` when present.
    pub units: Option<String>,
    /// Default margins and the places of the part.
    pub guard: Policy,
    /// Fixed parts and tooling.
    pub elements: Vec<Element>,
    /// The eight actuators.
    pub actuator: Vec<ActuatorSettings>,
    /// Exceptions from the default margin; a later one overrides an earlier one.
    #[serde(default)]
    pub pair: Vec<PairSettings>,
    #[serde(default, rename = "movers")]
    _movers: Option<serde::de::IgnoredAny>,
    #[serde(default, rename = "mate")]
    _mates: Option<serde::de::IgnoredAny>,
}

/// The table `[guard]`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Policy {
    /// Distance that any two bodies without a pair rule must exceed, mm, >= 0.
    pub default_margin_mm: f64,
    /// How far a part may be pressed into its support or its pusher, mm: it covers flatness and mould seams. The
    /// default of `depth_mm` in pairs that may touch.
    pub touch_depth_mm: f64,
    /// Least distance of the pins from the outline of the body, mm.
    pub pin_inset_mm: f64,
    /// Place where the next part waits in the magazine, mm. The coordinates of a place are those of the middle of the
    /// lower rear (-x) edge of the part's body.
    pub mouth: [f64; 3],
    /// Place of a part in the pocket, touching the retracted pusher.
    pub pocket: [f64; 3],
    /// Place of a part in the nest.
    pub nest: [f64; 3],
}

/// One `[[elements]]` table.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Element {
    /// Name used in pairs and refusals.
    pub id: String,
    /// Form of the body.
    pub kind: ShapeKind,
    /// Half extents of a block, mm.
    pub half: Option<[f64; 3]>,
    /// Radius of a cylinder, mm.
    pub radius: Option<f64>,
    /// Height of a cylinder along its own z, mm.
    pub height: Option<f64>,
    /// Pieces of a compound.
    pub parts: Option<Vec<Piece>>,
    /// Pose with all actuators at rest.
    #[serde(default)]
    pub pose: PoseSettings,
    /// Actuator that carries the element; `None` for a fixed one.
    pub rides: Option<Actuator>,
}

/// A piece of a compound.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Piece {
    /// Form of the piece.
    pub kind: ShapeKind,
    /// Half extents of a block, mm.
    pub half: Option<[f64; 3]>,
    /// Radius of a cylinder, mm.
    pub radius: Option<f64>,
    /// Height of a cylinder along its own z, mm.
    pub height: Option<f64>,
    /// Pieces of a compound.
    pub parts: Option<Vec<Piece>>,
    /// Pose in the compound.
    #[serde(default)]
    pub pose: PoseSettings,
}

/// Forms that tooling may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeKind {
    /// A box; takes `half`.
    Block,
    /// A cylinder; takes `radius` and `height`.
    Cylinder,
    /// A union of pieces; takes `parts`.
    Compound,
}

/// Position and unit quaternion; both optional.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PoseSettings {
    /// Position, mm.
    pub position: [f64; 3],
    /// Rotation `[w, x, y, z]`, normalised on reading.
    pub rotation: [f64; 4],
}

impl Default for PoseSettings {
    fn default() -> Self {
        PoseSettings {
            position: [0.0; 3],
            rotation: [1.0, 0.0, 0.0, 0.0],
        }
    }
}

/// One `[[actuator]]` table.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ActuatorSettings {
    /// The actuator.
    pub id: Actuator,
    /// Direction of the stroke, unit length.
    pub axis: [f64; 3],
    /// Length of the stroke, mm, > 0; absent for a slide with `points_mm`.
    pub stroke_mm: Option<f64>,
    /// Positions of a slide with several stops, mm, instead of `stroke_mm`; the stroke runs from the least to the
    /// greatest.
    pub points_mm: Option<Vec<f64>>,
    /// The actuator that carries this one.
    pub rides: Option<Actuator>,
    /// Elements on this actuator that move against its axis (the other finger).
    #[serde(default)]
    pub opposed: Vec<String>,
    /// Least distance from an end, mm, at which the sensor of that end goes off; 0, when absent, proves nothing.
    #[serde(default)]
    pub sensor_off_mm: f64,
    /// Instruction to a mechanic that brings the actuator to its rest end, as shown in refusals.
    pub to_rest: Option<String>,
    /// Instruction to a mechanic that brings the actuator to its other end.
    pub to_end: Option<String>,
}

/// One `[[pair]]` table.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSettings {
    /// Id of a body; a trailing `*` matches any ending.
    pub a: String,
    /// Id of the other body, with the same wildcard.
    pub b: String,
    /// Permission of the pair.
    pub rule: PairRule,
    /// Margin of a forbidden pair, mm, >= 0; the default margin if absent.
    pub margin_mm: Option<f64>,
    /// How far the bodies of a `may_touch` pair may press into each other, mm, >= 0; `touch_depth_mm` if absent.
    pub depth_mm: Option<f64>,
    /// Actuators during whose motion the rule holds; at other times the pair is forbidden, with the default margin.
    pub by: Option<Vec<Actuator>>,
}

/// Permission of a pair of bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairRule {
    /// The two stay further apart than the margin.
    Forbidden,
    /// The two may touch and press by the depth, not interpenetrate.
    MayTouch,
    /// The pair is never tested: parts of one mechanism that run in each other.
    Ignore,
}
