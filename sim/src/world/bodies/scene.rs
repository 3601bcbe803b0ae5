//! Bodies, actuators and contact rules of the rig; this reader of `scene.toml` serves the simulated rig only.

use crate::config::{ConfigError, Files};
use crate::table::{Entry, Read, read_fields, read_words};

/// A body that is fixed or moves with an actuator.
#[derive(Debug, Clone)]
pub struct Element {
    /// Name.
    pub id: String,
    /// Actuator that carries the element; `None` for a fixed body.
    pub rides: Option<String>,
    /// Shape and pose.
    pub body: Body,
}

/// A shape with its pose.
#[derive(Debug, Clone)]
pub struct Body {
    /// Shape.
    pub form: Form,
    /// Pose in the machine, or in the compound that contains the shape; identity by default.
    pub pose: Placement,
}

/// Shapes; lengths in mm.
#[derive(Debug, Clone)]
pub enum Form {
    /// Box with these half edge lengths along x, y, z.
    Block { half: [f64; 3] },
    /// Cylinder along its own z, centred.
    Cylinder { radius: f64, height: f64 },
    /// Union of several bodies.
    Compound { parts: Vec<Body> },
}

/// Position in mm and rotation as a quaternion w, x, y, z.
#[derive(Debug, Clone, Copy)]
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
#[derive(Debug, Clone)]
pub struct Actuator {
    /// Name.
    pub id: String,
    /// Direction from rest to the far end.
    pub axis: [f64; 3],
    /// Stroke, mm; `None` for an actuator with a point table.
    pub stroke_mm: Option<f64>,
    /// Actuator that carries this one; `None` for a fixed actuator.
    pub rides: Option<String>,
    /// Elements that move in the opposite direction.
    pub opposed: Vec<String>,
}

/// Rule for two bodies or two groups of bodies.
#[derive(Debug, Clone)]
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
    pub by: Vec<String>,
}

/// Contact rule of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// The bodies must not touch.
    Forbidden,
    /// The bodies may touch, down to the permitted depth.
    MayTouch,
    /// The bodies overlap by design and are never checked.
    Ignore,
}

/// Places of a part (its reference point is the middle of the lower rear edge), contact depth, and inset of the pins.
#[derive(Debug, Clone)]
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
#[derive(Debug, Clone)]
pub struct Scene {
    /// Places of a part, from the table `[guard]`.
    pub guard: PartPlaces,
    /// All actuators.
    pub actuator: Vec<Actuator>,
    /// All elements.
    pub elements: Vec<Element>,
    /// Pairs of bodies, each with the rule whether the two may touch.
    pub pair: Vec<Pair>,
}

impl Scene {
    /// Returns the stroke of an actuator, mm; 0 for an actuator with a point table.
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
#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// Extent along x, y, z without pins.
    pub body_mm: [f64; 3],
    /// Length of the pins below the body.
    pub pin_length_mm: f64,
}

/// Reads the scene and the part size of a recipe.
///
/// # Errors
/// Fails when a file cannot be read or lacks a required key.
pub fn read(files: &Files, recipe: &str) -> Result<(Scene, Size), ConfigError> {
    let scene = Scene::read(&files.read("scene.toml")?.into_entry())?;
    Ok((scene, files.recipe(recipe)?.get("part")?))
}

read_fields!(Scene { guard, actuator, elements, pair = Vec::new() });
read_fields!(PartPlaces {
    touch_depth_mm,
    pin_inset_mm,
    pocket,
    nest
});
read_fields!(Actuator { id, axis, stroke_mm, rides, opposed = Vec::new() });
read_fields!(Pair { a, b, rule, depth_mm, by = Vec::new() });
read_fields!(Size {
    body_mm,
    pin_length_mm
});
read_fields!(Placement { position = Self::default().position, rotation = Self::default().rotation });

impl Read for Element {
    const FORM: &'static str = "a table";

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        let keys = entry.table()?;
        Ok(Self {
            id: keys.get("id")?,
            rides: keys.get("rides")?,
            body: Body::read(entry)?,
        })
    }
}

impl Read for Body {
    const FORM: &'static str = "a table";

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        let keys = entry.table()?;
        let form = match keys.get::<String>("kind")?.as_str() {
            "block" => Form::Block {
                half: keys.get("half")?,
            },
            "cylinder" => Form::Cylinder {
                radius: keys.get("radius")?,
                height: keys.get("height")?,
            },
            "compound" => Form::Compound {
                parts: keys.get("parts")?,
            },
            _ => return Err(keys.wrong("kind", "block, cylinder or compound")),
        };
        Ok(Self {
            form,
            pose: keys.get_or("pose", Placement::default())?,
        })
    }
}

read_words!(Rule {
    "forbidden" => Self::Forbidden,
    "may_touch" => Self::MayTouch,
    "ignore" => Self::Ignore,
});
