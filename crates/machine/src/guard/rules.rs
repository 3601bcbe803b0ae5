//! Permission of each pair of bodies, as a table with one look-up per pair. The collision core defines the
//! permissions.

use super::actuator::Actuator;
use super::error::GuardError;
use super::settings::{GuardSettings, PairRule, PairSettings};
use lpm::Permission;

/// Permission of a pair of bodies, and the actuators to whose motion it is limited, if any.
#[derive(Debug, Clone, Copy)]
struct Allowed {
    permission: Permission,
    by: Option<[bool; 8]>,
}

/// The permissions of all pairs, indexed by the body numbers of the scene.
#[derive(Debug, Clone)]
pub(super) struct Rules {
    allowed: Vec<Allowed>,
    table: Vec<u16>,
    bodies: usize,
}

impl Rules {
    /// Makes the table from the default margin and the pairs of `settings`, of which a later one overrides an earlier
    /// one.
    pub fn of(settings: &GuardSettings, ids: &[String]) -> Result<Rules, GuardError> {
        let default = Allowed {
            permission: Permission::Forbidden {
                margin_mm: settings.guard.default_margin_mm,
            },
            by: None,
        };
        let mut rules = Rules {
            allowed: vec![default],
            table: vec![0; ids.len() * ids.len()],
            bodies: ids.len(),
        };
        for (index, pair) in settings.pair.iter().enumerate() {
            rules.allowed.push(allowed(pair, index, settings)?);
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
        self.table[a * self.bodies + b] = (self.allowed.len() - 1) as u16;
    }

    /// Returns the permission of `mover` towards `other` while `actuator` moves it.
    pub fn permission(&self, mover: usize, other: usize, actuator: Actuator) -> Permission {
        let allowed = &self.allowed[self.table[mover * self.bodies + other] as usize];
        match allowed.by {
            Some(by) if !by[actuator.index()] => self.allowed[0].permission,
            Some(_) | None => allowed.permission,
        }
    }
}

fn allowed(
    pair: &PairSettings,
    index: usize,
    settings: &GuardSettings,
) -> Result<Allowed, GuardError> {
    let member = |key, value: Option<f64>, default: f64| match value.unwrap_or(default) {
        mm if mm.is_finite() && mm >= 0.0 => Ok(mm),
        found => Err(GuardError::Number {
            path: format!("pair[{index}].{key}"),
            found,
            expected: ">= 0",
        }),
    };
    let margin_mm = member(
        "margin_mm",
        pair.margin_mm,
        settings.guard.default_margin_mm,
    )?;
    let depth_mm = member("depth_mm", pair.depth_mm, settings.guard.touch_depth_mm)?;
    let permission = match pair.rule {
        PairRule::Forbidden => Permission::Forbidden { margin_mm },
        PairRule::MayTouch => Permission::MayTouch { depth_mm },
        PairRule::Ignore => Permission::Ignored,
    };
    let by = pair
        .by
        .as_ref()
        .map(|by| Actuator::ALL.map(|actuator| by.contains(&actuator)));
    Ok(Allowed { permission, by })
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
