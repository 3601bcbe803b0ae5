//! What any two bodies may do, as a table: one look-up per pair, no search at run time.

use super::actuator::Actuator;
use super::error::GuardError;
use super::settings::{GuardSettings, PairRule, PairSettings};

/// What one body must keep from another while a certain actuator moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Keep {
    /// Further apart than this, mm.
    Apart(f64),
    /// Not pressed in deeper than this, mm.
    Depth(f64),
    /// The pair is not tested.
    Nothing,
}

#[derive(Debug, Clone, Copy)]
struct Permission {
    keep: Keep,
    by: Option<[bool; 8]>,
}

/// The table; bodies are numbered as in the scene.
#[derive(Debug, Clone)]
pub(super) struct Rules {
    permissions: Vec<Permission>,
    table: Vec<u16>,
    bodies: usize,
}

impl Rules {
    /// Lays the pairs of `settings` over the default margin, in their order.
    pub fn of(settings: &GuardSettings, ids: &[String]) -> Result<Rules, GuardError> {
        let default = Permission {
            keep: Keep::Apart(settings.guard.default_margin_mm),
            by: None,
        };
        let mut rules = Rules {
            permissions: vec![default],
            table: vec![0; ids.len() * ids.len()],
            bodies: ids.len(),
        };
        for (index, pair) in settings.pair.iter().enumerate() {
            rules.permissions.push(permission(pair, index, settings)?);
            let first = matching(&pair.a, ids, index)?;
            let second = matching(&pair.b, ids, index)?;
            for a in &first {
                for b in &second {
                    rules.allow(*a, *b);
                    rules.allow(*b, *a);
                }
            }
        }
        Ok(rules)
    }

    fn allow(&mut self, a: usize, b: usize) {
        self.table[a * self.bodies + b] = (self.permissions.len() - 1) as u16;
    }

    /// What `mover` must keep from `other` while `actuator` moves it.
    pub fn keep(&self, mover: usize, other: usize, actuator: Actuator) -> Keep {
        let permission = &self.permissions[self.table[mover * self.bodies + other] as usize];
        match permission.by {
            Some(by) if !by[actuator.index()] => self.permissions[0].keep,
            Some(_) | None => permission.keep,
        }
    }
}

fn permission(
    pair: &PairSettings,
    index: usize,
    settings: &GuardSettings,
) -> Result<Permission, GuardError> {
    let member = |key, value: Option<f64>, default: f64| match value.unwrap_or(default) {
        mm if mm.is_finite() && mm >= 0.0 => Ok(mm),
        found => Err(GuardError::Number {
            path: format!("pair[{index}].{key}"),
            found,
            expected: ">= 0",
        }),
    };
    let margin = member(
        "margin_mm",
        pair.margin_mm,
        settings.guard.default_margin_mm,
    )?;
    let depth = member("depth_mm", pair.depth_mm, settings.guard.touch_depth_mm)?;
    let keep = match pair.rule {
        PairRule::Forbidden => Keep::Apart(margin),
        PairRule::MayTouch => Keep::Depth(depth),
        PairRule::Ignore => Keep::Nothing,
    };
    let by = pair
        .by
        .as_ref()
        .map(|by| Actuator::ALL.map(|actuator| by.contains(&actuator)));
    Ok(Permission { keep, by })
}

fn matching(pattern: &str, ids: &[String], index: usize) -> Result<Vec<usize>, GuardError> {
    let fits = |id: &str| match pattern.strip_suffix('*') {
        Some(stem) => id.starts_with(stem),
        None => id == pattern,
    };
    let found: Vec<usize> = (0..ids.len()).filter(|i| fits(&ids[*i])).collect();
    if found.is_empty() {
        return Err(GuardError::UnknownBody {
            path: format!("pair[{index}]"),
            found: pattern.to_owned(),
        });
    }
    Ok(found)
}
