//! `config/scene.toml` as the guard reads it. The text is read elsewhere; this is its shape.
//!
//! Elements are written where they stand with **every actuator at its rest end** (stroke 0). All
//! lengths are mm, x along the line with the nest at 0, y across, z up from the baseplate's top.

use super::actuator::Actuator;
use serde::Deserialize;

/// The whole file. `movers` and `mate` belong to other readers and are not looked into.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuardSettings {
    /// Must be `"mm"` when present.
    pub units: Option<String>,
    /// Margins that hold everywhere, and the places of the part.
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
    /// How far a part may be pressed into what it rests on or is pushed by, mm: flatness and
    /// mould seams, not a stroke. Used by `may_touch` pairs without `depth_mm`.
    pub touch_depth_mm: f64,
    /// The pins stand at least so far inside the outline of the body, mm.
    pub pin_inset_mm: f64,
    /// Where the next part of the magazine waits. A place is the middle of the lower rear (-x)
    /// edge of the part's body.
    pub mouth: [f64; 3],
    /// Where a part stands in the pocket, touching the retracted pusher.
    pub pocket: [f64; 3],
    /// Where it stands in the nest.
    pub nest: [f64; 3],
}

/// One `[[elements]]` table.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Element {
    /// Name used in pairs and refusals.
    pub id: String,
    /// Form of the body.
    pub kind: Kind,
    /// Half extents of a block.
    pub half: Option<[f64; 3]>,
    /// Of a cylinder.
    pub radius: Option<f64>,
    /// Of a cylinder, along its own z.
    pub height: Option<f64>,
    /// Of a compound.
    pub parts: Option<Vec<Piece>>,
    /// Where it stands with all actuators at rest.
    #[serde(default)]
    pub pose: PoseSettings,
    /// The actuator that carries it; without one it is fixed.
    pub rides: Option<Actuator>,
}

/// A part of a compound.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Piece {
    /// Form of the body.
    pub kind: Kind,
    /// Half extents of a block.
    pub half: Option<[f64; 3]>,
    /// Of a cylinder.
    pub radius: Option<f64>,
    /// Of a cylinder, along its own z.
    pub height: Option<f64>,
    /// Of a compound.
    pub parts: Option<Vec<Piece>>,
    /// Place in the compound.
    #[serde(default)]
    pub pose: PoseSettings,
}

/// Forms that tooling may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// `half`
    Block,
    /// `radius`, `height`
    Cylinder,
    /// `parts`
    Compound,
}

/// Position and unit quaternion; both optional.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PoseSettings {
    /// mm.
    pub position: [f64; 3],
    /// `[w, x, y, z]`, normalised on reading.
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
    /// Which.
    pub id: Actuator,
    /// Direction of the stroke, unit length.
    pub axis: [f64; 3],
    /// Length of the stroke, mm, > 0.
    pub stroke_mm: Option<f64>,
    /// In place of `stroke_mm`: the points of a slide, mm; its stroke is from the least to the
    /// greatest.
    pub points_mm: Option<Vec<f64>>,
    /// The actuator that carries this one.
    pub rides: Option<Actuator>,
    /// Elements that ride on this actuator but move against its axis (the other finger).
    #[serde(default)]
    pub opposed: Vec<String>,
    /// What a mechanic does to bring it to its rest end, as an order; said in refusals.
    pub to_rest: Option<String>,
    /// The same for the other end.
    pub to_end: Option<String>,
}

/// One `[[pair]]` table.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSettings {
    /// A body; a trailing `*` stands for any ending.
    pub a: String,
    /// The other body, likewise.
    pub b: String,
    /// What the two may do.
    pub rule: PairRule,
    /// Margin of a forbidden pair; the default margin without it. mm, >= 0.
    pub margin_mm: Option<f64>,
    /// How far a `may_touch` pair may press into each other, mm, >= 0.
    pub depth_mm: Option<f64>,
    /// The rule holds only while one of these actuators moves; otherwise the pair is forbidden
    /// within the default margin.
    pub by: Option<Vec<Actuator>>,
}

/// What two bodies may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairRule {
    /// Must stay further apart than the margin.
    Forbidden,
    /// May touch and press by the depth, not interpenetrate.
    MayTouch,
    /// Never tested: parts of one mechanism that are made to run in each other.
    Ignore,
}
