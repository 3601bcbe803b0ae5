//! Checks the parts of a scene that only the rig needs: carriers, actuators, pairs, mates and the table of the guard.
//!
//! The guard applies these parts; this module only checks them, so that whichever program reads the file first reports
//! a mistake. The guard itself checks what else it requires (its eight actuators, an axis of unit length, a free
//! stroke), and the planner of tooling whether two mated elements touch as their mate says.

use super::Scene;
use super::field::{Field, SceneError, Table, expected_id, refuse};
use super::moves::{distance, known};
use super::node::Node;
use crate::LARGEST_COORDINATE_MM;
use std::collections::HashSet;

const RULES: &str = "\"forbidden\", \"may_touch\" or \"ignore\"";
/// Keys of an actuator; `points` is the short name of `points_mm`.
const ACTUATOR: &[&str] = &[
    "id",
    "axis",
    "stroke_mm",
    "points_mm",
    "points",
    "rides",
    "opposed",
    "sensor_off_mm",
    "to_rest",
    "to_end",
];
const PAIR: &[&str] = &["a", "b", "rule", "margin_mm", "depth_mm", "by"];
const MATE: &[&str] = &["a", "b", "kind", "tolerance_mm"];
const MATES: &str = "\"plane\", \"align\" or \"axis\"";
/// Greatest gap of a mate, mm.
const WIDEST_MATE_MM: f64 = 10.0;
const MARGINS: &[&str] = &["default_margin_mm", "touch_depth_mm", "pin_inset_mm"];
const PLACES: &[&str] = &["mouth", "pocket", "nest"];

/// Names that a scene may use without describing them, because its rig has them.
#[derive(Debug, Clone, Copy, Default)]
pub struct RigNames<'a> {
    /// Names of actuators.
    pub actuators: &'a [&'a str],
    /// Names of bodies that are not elements, such as the part under test.
    pub bodies: &'a [&'a str],
}

/// All names that `rides`, `opposed`, `by` and the pairs may use.
struct Names<'a> {
    actuators: Vec<&'a str>,
    bodies: Vec<&'a str>,
}

/// Fails on the first invalid entry in the parts of a scene for the rig.
pub(super) fn check(root: &Table, scene: &Scene, rig_names: &RigNames) -> Result<(), SceneError> {
    let actuators = actuators(root)?;
    let bodies = scene.elements.iter().chain(&scene.movers);
    let names = Names {
        actuators: joined(actuators.iter().map(|(id, _)| *id), rig_names.actuators),
        bodies: joined(bodies.map(|body| body.id.as_str()), rig_names.bodies),
    };
    for (list, bodies) in [("elements", &scene.elements), ("movers", &scene.movers)] {
        for (index, body) in bodies.iter().enumerate() {
            if let Some(carrier) = &body.rides {
                names.actuator(format!("{list}[{index}].rides"), carrier)?;
            }
        }
    }
    for (_, table) in &actuators {
        carrying(table, &names)?;
    }
    for field in listed(root, "pair")? {
        pair(&field, &names)?;
    }
    for field in listed(root, "mate")? {
        mate(&field, scene)?;
    }
    root.optional("guard").map_or(Ok(()), |table| guard(&table))
}

fn joined<'a>(described: impl Iterator<Item = &'a str>, others: &[&'a str]) -> Vec<&'a str> {
    described.chain(others.iter().copied()).collect()
}

fn listed<'a>(table: &Table<'a>, key: &str) -> Result<Vec<Field<'a>>, SceneError> {
    table.optional(key).map_or(Ok(Vec::new()), |it| it.list())
}

impl Names<'_> {
    fn actuator(&self, path: String, found: &str) -> Result<(), SceneError> {
        if self.actuators.contains(&found) {
            return Ok(());
        }
        let expected = expected_id(
            "an actuator of the scene or its rig",
            "actuators",
            &self.actuators,
        );
        refuse(path, Node::Text(found.to_owned()).to_string(), expected)
    }

    /// Fails unless a body has this name; a `*` at the end of the name matches any ending.
    fn body(&self, field: &Field) -> Result<(), SceneError> {
        let found = field.text()?;
        let is_known = match found.strip_suffix('*') {
            Some(stem) => self.bodies.iter().any(|id| id.starts_with(stem)),
            None => self.bodies.contains(&found),
        };
        if is_known {
            return Ok(());
        }
        field.refuse(expected_id(
            "a body of the scene or its rig",
            "bodies",
            &self.bodies,
        ))
    }
}

/// Reads the actuators with their ids; leaves references between them to a later check, when all names are known.
fn actuators<'a>(root: &Table<'a>) -> Result<Vec<(&'a str, Table<'a>)>, SceneError> {
    let mut known = HashSet::new();
    let mut actuators = Vec::new();
    for field in listed(root, "actuator")? {
        let table = field.table(ACTUATOR)?;
        let id = table.required("id", "a name")?;
        if !known.insert(id.text()?) {
            let found = format!("{} again", id.node);
            return refuse(id.path, found, "a name that no other actuator has");
        }
        let axis = table.required("axis", "a direction")?;
        if axis.numbers::<3>()? == [0.0; 3] {
            return refuse(axis.path, "[0, 0, 0]".into(), "a direction");
        }
        stroke(&table)?;
        for key in ["to_rest", "to_end"] {
            table.optional(key).map_or(Ok(""), |words| words.text())?;
        }
        actuators.push((id.text()?, table));
    }
    Ok(actuators)
}

fn stroke(table: &Table) -> Result<(), SceneError> {
    let points = table
        .optional("points_mm")
        .or_else(|| table.optional("points"));
    match (table.optional("stroke_mm"), points) {
        (Some(_), Some(points)) => points.refuse("either a stroke or points"),
        (None, Some(points)) => {
            let list = points.list()?;
            if list.is_empty() {
                return points.refuse("at least one point in mm");
            }
            list.iter().try_for_each(|point| point.number().map(drop))
        }
        (_, None) => {
            let stroke = table.required("stroke_mm", "a stroke in mm, or points_mm")?;
            let mm = stroke.number()?;
            if mm > 0.0 && mm <= LARGEST_COORDINATE_MM {
                return Ok(());
            }
            stroke.refuse("a stroke above 0 and at most 1e6 mm")
        }
    }
}

/// Checks the names of the actuator that carries this one (`rides`) and of the bodies that move against it (`opposed`).
fn carrying(actuator: &Table, names: &Names) -> Result<(), SceneError> {
    if let Some(rides) = actuator.optional("rides") {
        names.actuator(rides.path.clone(), rides.text()?)?;
    }
    listed(actuator, "opposed")?
        .iter()
        .try_for_each(|id| names.body(id))
}

fn pair(field: &Field, names: &Names) -> Result<(), SceneError> {
    let table = field.table(PAIR)?;
    for key in ["a", "b"] {
        names.body(&table.required(key, "the id of a body")?)?;
    }
    let rule = table.required("rule", RULES)?;
    if !["forbidden", "may_touch", "ignore"].contains(&rule.text()?) {
        return rule.refuse(RULES);
    }
    for key in ["margin_mm", "depth_mm"] {
        table.optional(key).map_or(Ok(0.0), |mm| distance(&mm))?;
    }
    listed(&table, "by")?
        .iter()
        .try_for_each(|id| names.actuator(id.path.clone(), id.text()?))
}

fn mate(field: &Field, scene: &Scene) -> Result<(), SceneError> {
    let table = field.table(MATE)?;
    for key in ["a", "b"] {
        known(
            &table.required(key, "the id of an element")?,
            &scene.elements,
            ["an element of the scene", "elements"],
        )?;
    }
    let kind = table.required("kind", MATES)?;
    if !["plane", "align", "axis"].contains(&kind.text()?) {
        return kind.refuse(MATES);
    }
    let Some(tolerance) = table.optional("tolerance_mm") else {
        return Ok(());
    };
    if (0.0..=WIDEST_MATE_MM).contains(&tolerance.number()?) {
        return Ok(());
    }
    tolerance.refuse("a gap of 0 to 10 mm")
}

fn guard(field: &Field) -> Result<(), SceneError> {
    let table = field.table(&[MARGINS, PLACES].concat())?;
    for key in MARGINS {
        table.optional(key).map_or(Ok(0.0), |mm| distance(&mm))?;
    }
    for key in PLACES {
        table
            .optional(key)
            .map_or(Ok([0.0; 3]), |place| place.numbers())?;
    }
    Ok(())
}
