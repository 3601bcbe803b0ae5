//! Whether a recipe may judge the stored values of a part that another recipe measured, and how to convert them.

use super::keys::REFERENCE_TEMPERATURE;
use super::{Characteristic, Kind, Recipe};
use units::Celsius;

/// Conditions to which stored values refer, from the recipe of their test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Basis {
    /// Kind of the part.
    pub kind: Kind,
    /// Nominal voltage of the part, V; `None` for a kind without one.
    pub nominal_v: Option<f64>,
    /// Temperature that results are converted to.
    pub reference: Celsius,
}

/// Key of `[part]` for the nominal voltage, in the kinds that have one.
const NOMINAL: &str = "nominal_v";
/// Key of `[part]` for the temperature that results are converted to, in the kinds that convert them.
const REFERENCE: &str = REFERENCE_TEMPERATURE.name;
/// Temperature of results that no kind converts.
pub const UNCONVERTED: Celsius = Celsius(25.0);

/// Why a recipe cannot judge stored values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Misfit {
    /// What the recipe demands: the first half of a sentence.
    pub wanted: String,
    /// The condition under which the values were measured: the second half of the sentence.
    pub found: String,
}

impl Basis {
    /// Returns the basis from the stored text of a recipe; `None` when a key is missing. A text without a kind
    /// describes a relay.
    pub fn of(recipe: &str) -> Option<Self> {
        let recipe: toml::Table = recipe.parse().ok()?;
        let kind = recipe.get("kind").and_then(toml::Value::as_str);
        let part = recipe.get("part")?;
        let number = |key: &str| {
            let value = part.get(key)?;
            value.as_float().or(value.as_integer().map(|it| it as f64))
        };
        let kind = kind.map_or(Some(Kind::EmRelay), Kind::from_name)?;
        Some(Self {
            kind,
            nominal_v: match kind.sections().part.iter().any(|it| it.name == NOMINAL) {
                true => Some(number(NOMINAL)?),
                false => None,
            },
            reference: match kind.sections().part.iter().any(|it| it.name == REFERENCE) {
                true => Celsius(number(REFERENCE)?),
                false => UNCONVERTED,
            },
        })
    }

    /// Returns the basis of a loaded recipe.
    pub fn of_recipe(recipe: &Recipe) -> Self {
        Self {
            kind: recipe.device.kind(),
            nominal_v: recipe.device.part().nominal_v,
            reference: recipe.device.part().reference,
        }
    }

    /// Returns why `recipe` cannot judge values on this basis; `None` when it can.
    pub fn misfit(&self, recipe: &Recipe) -> Option<Misfit> {
        let (name, kind) = (&recipe.name, recipe.device.kind());
        if self.kind != kind {
            return Some(Misfit {
                wanted: format!("{name} is about kind {}", kind.name()),
                found: format!("was of kind {}", self.kind.name()),
            });
        }
        let (wanted_v, measured_v) = (recipe.device.part().nominal_v?, self.nominal_v?);
        let fits = (measured_v - wanted_v).abs() < 1e-6 * measured_v;
        (!fits).then(|| Misfit {
            wanted: format!("{name} is rated {wanted_v} V"),
            found: format!("was measured at {measured_v} V"),
        })
    }

    /// Returns the factor that converts a stored value to the one that a test by `recipe` would have stored.
    pub fn factor(&self, of: Characteristic, recipe: &Recipe) -> f64 {
        let wanted = recipe.device.part().reference;
        of.conversion(self.reference, wanted)
    }
}
