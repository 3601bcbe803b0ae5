//! What a person asks for: what stays, what comes off, what moves together, which directions are forbidden.

use crate::assembly::Assembly;
use crate::direction::Direction;
use crate::error::PlanError;

/// Demands on a plan, by ids; an id that ends with `*` means every element whose id begins with the text before `*`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Demands {
    /// Elements that must come off; when empty, everything that does not stay.
    pub remove: Vec<String>,
    /// Elements that stay where they are.
    pub stay: Vec<String>,
    /// Groups of elements, each of which moves as one.
    pub groups: Vec<Vec<String>>,
    /// Directions in which nothing may leave, such as the side on which the operator stands.
    pub forbidden: Vec<Direction>,
    /// True when a plan takes straight ways and given units only: no ways of two steps, no subassemblies that the
    /// planner finds.
    pub straight_only: bool,
    /// True when nothing may leave while another element rests on it, so that nothing hangs in the air. An element
    /// rests on what holds it from below. Two elements that hold each other from below, such as a rod in its cylinder,
    /// do not rest on each other.
    pub keeps_supports: bool,
}

/// Demands by element numbers, free of contradictions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Resolved {
    pub(crate) remove: Vec<usize>,
    /// By element: true when it stays.
    pub(crate) stays: Vec<bool>,
    pub(crate) groups: Vec<Vec<usize>>,
    pub(crate) allowed: Vec<Direction>,
}

impl Demands {
    /// Finds the elements that the demands name. Fails when an id names no element, when two demands contradict each
    /// other, and when no direction is left.
    pub(crate) fn resolved(&self, assembly: &Assembly) -> Result<Resolved, PlanError> {
        let remove = all(assembly, &self.remove, "remove")?;
        let stay = all(assembly, &self.stay, "stay")?;
        let contradiction = |element: usize, first, second| PlanError::Contradiction {
            id: assembly.id(element).to_owned(),
            first,
            second,
        };
        if let Some(both) = remove.iter().find(|it| stay.contains(it)) {
            return Err(contradiction(*both, "remove", "stay"));
        }
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for ids in &self.groups {
            let group = all(assembly, ids, "group")?;
            let earlier = group
                .iter()
                .find(|it| groups.iter().any(|known| known.contains(it)));
            if let Some(twice) = earlier {
                return Err(contradiction(*twice, "one group", "another group"));
            }
            // A group moves as one, so it cannot leave while one of its elements stays.
            let leaves = group.iter().any(|it| remove.contains(it));
            let stays = group.iter().find(|it| stay.contains(it));
            if let (true, Some(stays)) = (leaves, stays) {
                return Err(contradiction(*stays, "a group that must come off", "stay"));
            }
            groups.push(group);
        }
        let mut stays = vec![false; assembly.len()];
        for element in stay {
            let group = groups.iter().find(|group| group.contains(&element));
            let members = group.map_or(std::slice::from_ref(&element), Vec::as_slice);
            members.iter().for_each(|it| stays[*it] = true);
        }
        let is_allowed = |it: &Direction| !self.forbidden.contains(it);
        let allowed: Vec<Direction> = Direction::ALL.into_iter().filter(is_allowed).collect();
        if allowed.is_empty() {
            return Err(PlanError::NoDirection);
        }
        Ok(Resolved {
            remove,
            stays,
            groups,
            allowed,
        })
    }
}

/// Returns the elements that ids and patterns name, in ascending order and each once.
fn all(assembly: &Assembly, ids: &[String], demand: &'static str) -> Result<Vec<usize>, PlanError> {
    let mut found = Vec::new();
    for id in ids {
        match id.strip_suffix('*') {
            None => found.push(assembly.number(id, demand)?),
            Some(stem) => {
                let before = found.len();
                let numbered = assembly.elements().iter().enumerate();
                let fitting = numbered.filter(|(_, it)| it.id.starts_with(stem));
                found.extend(fitting.map(|(number, _)| number));
                if found.len() == before {
                    return Err(PlanError::UnknownId {
                        demand,
                        found: id.clone(),
                    });
                }
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    Ok(found)
}
