//! The bodies of the rig as `scene.toml` describes them, read anew: elements, actuators, and who may touch whom.

use std::path::Path;

use serde::Deserialize;

use crate::config::{ConfigError, content, read_text};

/// A body that rides on an actuator, or stands.
#[derive(Debug, Clone, Deserialize)]
pub struct Element {
    /// Name.
    pub id: String,
    /// Actuator it rides on.
    pub rides: Option<String>,
    /// Form and place.
    #[serde(flatten)]
    pub body: Body,
}

/// A form at a place.
#[derive(Debug, Clone, Deserialize)]
pub struct Body {
    /// Form.
    #[serde(flatten)]
    pub form: Form,
    /// Place; where its owner is when nothing is said.
    #[serde(default)]
    pub pose: Place,
}

/// Forms, mm.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Form {
    /// Half edges.
    Block { half: [f64; 3] },
    /// Along its own z, centred.
    Cylinder { radius: f64, height: f64 },
    /// Several in one.
    Compound { parts: Vec<Body> },
}

/// Where something is, mm and a quaternion w, x, y, z.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(default)]
pub struct Place {
    /// Of the centre.
    pub position: [f64; 3],
    /// Of its axes.
    pub rotation: [f64; 4],
}

impl Default for Place {
    fn default() -> Self {
        Self {
            position: [0.0; 3],
            rotation: [1.0, 0.0, 0.0, 0.0],
        }
    }
}

/// What moves bodies.
#[derive(Debug, Clone, Deserialize)]
pub struct Actuator {
    /// Name.
    pub id: String,
    /// Direction from rest to the far end.
    pub axis: [f64; 3],
    /// Stroke; none where it has points.
    pub stroke_mm: Option<f64>,
    /// Actuator it rides on itself.
    pub rides: Option<String>,
    /// Elements that go the other way.
    #[serde(default)]
    pub opposed: Vec<String>,
}

/// Two bodies, or two groups of bodies, and what they may do.
#[derive(Debug, Clone, Deserialize)]
pub struct Pair {
    /// One; a trailing `*` stands for any ending.
    pub a: String,
    /// The other.
    pub b: String,
    /// What they may do.
    pub rule: Rule,
    /// How deep they may press into each other, mm.
    pub depth_mm: Option<f64>,
    /// Actuators that may press them together; empty: any.
    #[serde(default)]
    pub by: Vec<String>,
}

/// What two bodies may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// Not touch.
    Forbidden,
    /// Touch.
    MayTouch,
    /// Run in each other by construction.
    Ignore,
}

/// Places of a part: the middle of the lower rear edge of its body; and how deep a touch may be.
#[derive(Debug, Clone, Deserialize)]
pub struct Places {
    /// Depth of a touch that is none, mm.
    pub touch_depth_mm: f64,
    /// How far inside of the outline of the body the pins stand, mm.
    pub pin_inset_mm: f64,
    /// Before the pusher.
    pub pocket: [f64; 3],
    /// Under test.
    pub nest: [f64; 3],
}

/// The file.
#[derive(Debug, Clone, Deserialize)]
pub struct Scene {
    /// Places of parts.
    pub guard: Places,
    /// What moves.
    pub actuator: Vec<Actuator>,
    /// What there is.
    pub elements: Vec<Element>,
    /// Who may touch whom.
    #[serde(default)]
    pub pair: Vec<Pair>,
}

impl Scene {
    /// Stroke of an actuator, mm; 0 for one that has points.
    pub fn stroke_mm(&self, actuator: &str) -> f64 {
        let own = self.actuator.iter().find(|it| it.id == actuator);
        own.and_then(|it| it.stroke_mm).unwrap_or(0.0)
    }
}

impl Pair {
    /// It speaks of these two, in either order.
    pub fn is_of(&self, one: &str, other: &str) -> bool {
        let fits = |pattern: &str, name: &str| match pattern.strip_suffix('*') {
            Some(start) => name.starts_with(start),
            None => name == pattern,
        };
        (fits(&self.a, one) && fits(&self.b, other)) || (fits(&self.a, other) && fits(&self.b, one))
    }
}

/// Size of the parts of a recipe, mm.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct Size {
    /// Along x, y, z without pins.
    pub body_mm: [f64; 3],
    /// Below the body.
    pub pin_length_mm: f64,
}

#[derive(Deserialize)]
struct RecipeFile {
    part: Size,
}

/// Reads the scene and the size of the recipe's parts.
///
/// # Errors
/// A file cannot be read or lacks what is asked of it.
pub fn read(dir: &Path, recipe: &str) -> Result<(Scene, Size), ConfigError> {
    let path = dir.join("scene.toml");
    let text = read_text(&path)?;
    let scene: Scene = toml::from_str(&text).map_err(|e| content(&path, &text, &e))?;
    let path = dir.join("recipes").join(format!("{recipe}.toml"));
    let text = read_text(&path)?;
    let file: RecipeFile = toml::from_str(&text).map_err(|e| content(&path, &text, &e))?;
    Ok((scene, file.part))
}
