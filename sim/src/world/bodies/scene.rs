//! Bodies, actuators and contact rules of the rig, read from `scene.toml` for the simulated rig alone.

use serde::Deserialize;

use crate::config::{ConfigError, Files};

/// A body that is fixed or moves with an actuator.
#[derive(Debug, Clone, Deserialize)]
pub struct Element {
    /// Name.
    pub id: String,
    /// Actuator that carries it.
    pub rides: Option<String>,
    /// Shape and pose.
    #[serde(flatten)]
    pub body: Body,
}

/// A shape with its pose.
#[derive(Debug, Clone, Deserialize)]
pub struct Body {
    /// Shape.
    #[serde(flatten)]
    pub form: Form,
    /// Pose in the machine, or in the compound that contains the shape; identity by default.
    #[serde(default)]
    pub pose: Placement,
}

/// Shapes; lengths in mm.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Form {
    /// Box with these half edges.
    Block { half: [f64; 3] },
    /// Cylinder along its own z, centred.
    Cylinder { radius: f64, height: f64 },
    /// Union of several bodies.
    Compound { parts: Vec<Body> },
}

/// Position in mm and rotation as a quaternion w, x, y, z.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(default)]
pub struct Placement {
    /// Position of the centre, mm.
    pub position: [f64; 3],
    /// Rotation of the axes.
    pub rotation: [f64; 4],
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            position: [0.0; 3],
            rotation: [1.0, 0.0, 0.0, 0.0],
        }
    }
}

/// An actuator that moves bodies.
#[derive(Debug, Clone, Deserialize)]
pub struct Actuator {
    /// Name.
    pub id: String,
    /// Direction from rest to the far end.
    pub axis: [f64; 3],
    /// Stroke, mm; `None` for an actuator with points.
    pub stroke_mm: Option<f64>,
    /// Actuator that carries this one.
    pub rides: Option<String>,
    /// Elements that move in the opposite direction.
    #[serde(default)]
    pub opposed: Vec<String>,
}

/// Rule for two bodies or two groups of bodies.
#[derive(Debug, Clone, Deserialize)]
pub struct Pair {
    /// First body; a trailing `*` matches any ending.
    pub a: String,
    /// Second body, in the same form.
    pub b: String,
    /// Contact rule of the two.
    pub rule: Rule,
    /// Depth to which the two may press into each other, mm.
    pub depth_mm: Option<f64>,
    /// Actuators that may press them together; empty for any.
    #[serde(default)]
    pub by: Vec<String>,
}

/// Contact rule of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// The bodies must not touch.
    Forbidden,
    /// The bodies may touch.
    MayTouch,
    /// The bodies overlap by design and are never checked.
    Ignore,
}

/// Places of a part (middle of the lower rear edge of its body), its contact depth and the inset of its pins.
#[derive(Debug, Clone, Deserialize)]
pub struct PartPlaces {
    /// Depth up to which a contact does not count, mm.
    pub touch_depth_mm: f64,
    /// Distance of the pins from the outline of the body, mm.
    pub pin_inset_mm: f64,
    /// Part in the pocket, before the pusher.
    pub pocket: [f64; 3],
    /// Part in the nest.
    pub nest: [f64; 3],
}

/// Content of `scene.toml`.
#[derive(Debug, Clone, Deserialize)]
pub struct Scene {
    /// Places of a part, from the table `[guard]`.
    pub guard: PartPlaces,
    /// All actuators.
    pub actuator: Vec<Actuator>,
    /// All elements.
    pub elements: Vec<Element>,
    /// Contact rules.
    #[serde(default)]
    pub pair: Vec<Pair>,
}

impl Scene {
    /// Returns the stroke of an actuator, mm; 0 for an actuator with points.
    pub fn stroke_mm(&self, actuator: &str) -> f64 {
        let own = self.actuator.iter().find(|it| it.id == actuator);
        own.and_then(|it| it.stroke_mm).unwrap_or(0.0)
    }
}

impl Pair {
    /// Checks whether the rule applies to these two bodies, in either order.
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
    /// Extent along x, y, z without pins.
    pub body_mm: [f64; 3],
    /// Length of the pins below the body.
    pub pin_length_mm: f64,
}

#[derive(Deserialize)]
struct RecipeFile {
    part: Size,
}

/// Reads the scene and the part size of a recipe.
///
/// # Errors
/// Fails when a file cannot be read or lacks a required key.
pub fn read(files: &Files, recipe: &str) -> Result<(Scene, Size), ConfigError> {
    let scene: Scene = files.read("scene.toml")?.parse()?;
    let file: RecipeFile = files.recipe(recipe)?;
    Ok((scene, file.part))
}
