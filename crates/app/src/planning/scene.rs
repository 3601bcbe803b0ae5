//! A scene as an assembly: its elements with all actuators at rest.
//!
//! - Elements on one actuator that overlap are one piece of tooling; they move as a group.
//! - The elements of a pair that `[[pair]]` ignores slide in each other. The pair comes apart along the stroke of the
//!   actuator between its elements, and blocks in every other direction.
//! - `[[mate]]` is checked against the geometry; the greedy rule of crate `plan` tries the axes of common-axis mates
//!   first.

use super::tables::Tables;
use crate::collision::{load_scene, read_scene};
use anyhow::{Context, anyhow};
use config::{Folder, scene_text};
use lpm::scene::{Format, Named, Scene};
use lpm::{Model, Move, Shape};
use plan::{Assembly, Direction, Element, Extent, Guided, Interference, Mate, Tolerance};
use std::path::Path;

/// A scene to plan with.
#[derive(Debug)]
pub struct PlanScene {
    /// Name for people: the name in the configuration, or the path of the file.
    pub name: String,
    /// The elements at their places.
    pub assembly: Assembly,
    /// Groups of elements that are one piece of tooling, by ids.
    pub groups: Vec<Vec<String>>,
    /// Mates, found from the geometry.
    pub mates: Vec<Mate>,
    /// Directions that the greedy rule of crate `plan` tries first.
    pub priority: Vec<Direction>,
}

impl PlanScene {
    /// Loads a scene file, TOML or JSON by its extension.
    ///
    /// # Errors
    /// Fails on an invalid file, an element outside `omega`, elements that overlap at the start, or a mate that the
    /// geometry does not have; the error names the file, what was found and what was expected.
    pub fn load(path: &Path, omega: Option<Extent>) -> anyhow::Result<PlanScene> {
        let (scene, text, format) = load_scene(path)?;
        let name = path.display().to_string();
        let made = Self::assembled(path, (&scene, &text, format), omega)?;
        Ok(PlanScene { name, ..made })
    }

    /// Loads a scene of a configuration by its name.
    ///
    /// # Errors
    /// Fails as [`PlanScene::load`] does.
    pub fn of_folder(
        folder: &Folder,
        name: &str,
        omega: Option<Extent>,
    ) -> anyhow::Result<PlanScene> {
        let path = &folder.path(name);
        let text = scene_text(folder, name)
            .map_err(|error| anyhow!("{}: not readable: {error}", path.display()))?;
        let (scene, format) = read_scene(path, &text)?;
        let made = Self::assembled(path, (&scene, &text, format), omega)?;
        let name = name.to_owned();
        Ok(PlanScene { name, ..made })
    }

    fn assembled(
        path: &Path,
        (scene, text, format): (&Scene, &str, Format),
        omega: Option<Extent>,
    ) -> anyhow::Result<PlanScene> {
        let named = || path.display().to_string();
        let tables = Tables::read(text, format).with_context(named)?;
        let joined = joined(scene)?;
        let mut guided = run_in_each_other(scene, &tables);
        guided.extend(joined.iter().map(|(a, b)| Guided {
            a: *a,
            b: *b,
            axis: None,
        }));
        let made = |tolerance| {
            Assembly::new(elements(scene), omega, tolerance, guided.clone()).with_context(named)
        };
        let assembly = made(Tolerance::default())?;
        let local = Interference::local(&assembly).with_context(named)?;
        let mates = plan::mates(&assembly, &local).with_context(named)?;
        for (index, mate) in tables.mate.iter().enumerate() {
            let named = || format!("{}: mate[{index}]", path.display());
            let a = assembly.number(&mate.a, "a").with_context(named)?;
            let b = assembly.number(&mate.b, "b").with_context(named)?;
            let wanted = mate.kind.wanted();
            match mate.tolerance_mm {
                None => plan::checked(&assembly, &mates, (a, b), wanted).with_context(named)?,
                Some(mate_mm) => {
                    let wider = made(Tolerance {
                        mate_mm,
                        ..Tolerance::default()
                    })?;
                    let local = Interference::local(&wider).with_context(named)?;
                    let found = plan::mates(&wider, &local).with_context(named)?;
                    plan::checked(&wider, &found, (a, b), wanted).with_context(named)?
                }
            };
        }
        Ok(PlanScene {
            name: String::new(),
            priority: plan::priority(&mates),
            groups: groups(&assembly, &joined),
            assembly,
            mates,
        })
    }
}

fn elements(scene: &Scene) -> Vec<Element> {
    let element = |it: &Named| Element {
        id: it.id.clone(),
        shape: it.shape.clone(),
        pose: it.pose,
    };
    scene.elements.iter().map(element).collect()
}

/// Returns the pairs of overlapping elements that ride on the same actuator.
fn joined(scene: &Scene) -> anyhow::Result<Vec<(usize, usize)>> {
    let depth_mm = Tolerance::default().contact_mm;
    let mut found = Vec::new();
    for (a, one) in scene.elements.iter().enumerate() {
        for (b, other) in scene.elements.iter().enumerate().skip(a + 1) {
            if one.rides.is_none() || one.rides != other.rides {
                continue;
            }
            let mut model = Model::new();
            model.insert(&other.id, &other.shape, &other.pose)?;
            let thin: Shape = one.shape.less(depth_mm);
            let rest = Move {
                from: one.pose,
                to: one.pose,
                margin_mm: 0.0,
                ignore: &[],
            };
            if model.any_hit(&thin, &rest).is_some() {
                found.push((a, b));
            }
        }
    }
    Ok(found)
}

/// Returns the pairs of elements that `[[pair]]` ignores, each with the axis of the actuator between its elements.
fn run_in_each_other(scene: &Scene, tables: &Tables) -> Vec<Guided> {
    let fitting = |pattern: &str| -> Vec<usize> {
        let fits = |id: &str| match pattern.strip_suffix('*') {
            Some(stem) => id.starts_with(stem),
            None => id == pattern,
        };
        let numbered = scene.elements.iter().enumerate();
        numbered
            .filter(|(_, it)| fits(&it.id))
            .map(|(number, _)| number)
            .collect()
    };
    let mut found = Vec::new();
    for pair in tables.pair.iter().filter(|it| it.rule == "ignore") {
        for a in fitting(&pair.a) {
            for b in fitting(&pair.b) {
                let axis = between(&scene.elements[a], &scene.elements[b], tables);
                found.push(Guided { a, b, axis });
            }
        }
    }
    found
}

/// Returns the axis along which two elements move against each other: the axis of the actuator that carries only one of
/// them; `None` without such an actuator, and for a slanted axis.
fn between(a: &Named, b: &Named, tables: &Tables) -> Option<usize> {
    match (&a.rides, &b.rides) {
        (Some(one), None) | (None, Some(one)) => tables.axis(one),
        (Some(one), Some(other)) if tables.is_carried(one, other) => tables.axis(one),
        (Some(one), Some(other)) if tables.is_carried(other, one) => tables.axis(other),
        (Some(_), Some(_)) | (None, None) => None,
    }
}

/// Returns the groups that overlapping pairs form, each as the ids of its elements.
fn groups(assembly: &Assembly, joined: &[(usize, usize)]) -> Vec<Vec<String>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (a, b) in joined {
        let (touched, mut others): (Vec<_>, Vec<_>) = groups
            .into_iter()
            .partition(|group| group.contains(a) || group.contains(b));
        let mut whole: Vec<usize> = touched.into_iter().flatten().chain([*a, *b]).collect();
        whole.sort_unstable();
        whole.dedup();
        others.push(whole);
        groups = others;
    }
    let ids = |group: Vec<usize>| group.iter().map(|it| assembly.id(*it).to_owned()).collect();
    groups.into_iter().map(ids).collect()
}
