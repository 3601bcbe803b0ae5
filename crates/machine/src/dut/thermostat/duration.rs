//! How long the batches of a recipe take, and which recipes take too long.

use super::recipe::ThermostatRecipe;
use crate::dut::recipe::Limits;
use crate::rig::fault::Fault;
use chamber::program::Pass;
use units::Span;

/// Longest planned time of the passes of a batch, slow repeats included, h.
const MOST_H: f64 = 24.0;
/// Ratio of the longest to the planned time of the passes: the set point waits for a chamber that cools slowly.
const WAITS: f64 = 1.5;
/// Longest time before the passes, s: contacts, two coolings of a warm chamber with their rests, identification.
const BEFORE_S: f64 = 4.0 * 3_600.0;

/// Planned times of a recipe with a part that waits in each pass, h.
#[derive(Debug, Clone, Copy)]
struct Planned {
    passes_h: f64,
    repeat_h: f64,
}

impl Planned {
    /// Returns the times of a batch that measures the lag; `None` when a limit has an open side.
    fn of(recipe: &ThermostatRecipe, limits: &Limits) -> Option<Self> {
        let [operate, reset] = recipe.windows(limits)?;
        let strategy = recipe.strategy();
        let passes = strategy.passes(0, false, operate, reset);
        let hours = |it: Pass| it.longest_s(recipe.part.lag_s) / 3_600.0;
        let repeat = Pass {
            rate_k_per_min: strategy.repeat,
            operate,
            reset,
        };
        Some(Self {
            passes_h: passes.into_iter().map(hours).sum(),
            repeat_h: hours(repeat),
        })
    }

    fn with(self, slow_repeats: u32) -> f64 {
        self.passes_h + f64::from(slow_repeats) * self.repeat_h
    }
}

/// Returns the longest time of a batch, after which it counts as stuck.
///
/// # Panics
/// Panics for a limit with an open side, which no feasible recipe has.
pub fn longest(recipe: &ThermostatRecipe, limits: &Limits, slow_repeats: u32) -> Span {
    let planned = Planned::of(recipe, limits)
        .unwrap_or_else(|| panic!("a recipe without windows is not feasible"));
    Span::seconds(BEFORE_S + WAITS * 3_600.0 * planned.with(slow_repeats))
}

/// Returns the fault of a recipe whose batches take longer than a day.
pub fn too_long(recipe: &ThermostatRecipe, limits: &Limits, slow_repeats: u32) -> Option<Fault> {
    let planned = Planned::of(recipe, limits)?;
    let Planned { passes_h, repeat_h } = planned;
    if passes_h > MOST_H {
        let rate = recipe.test.rate_k_per_min;
        let expected = format!(
            "passes of at most {MOST_H} h together: with limits and rates of the recipe, of which rate_k_per_min is {rate}, \
             they take {passes_h:.1} h"
        );
        return Some(Fault::new("test.passes", recipe.test.passes, expected));
    }
    let expected = format!(
        "a batch of at most {MOST_H} h: its passes take {passes_h:.1} h, and each slow repeat {repeat_h:.1} h more"
    );
    (planned.with(slow_repeats) > MOST_H)
        .then(|| Fault::new("decision.slow_repeats", slow_repeats, expected))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::dut::Recipe;
    use crate::dut::recipe::DeviceRecipe;

    const REFEREE: &str =
        include_str!("../../../../../config/rigs/thermostat/recipes/thermostat-referee.toml");

    /// Returns sections and limits of the shipped referee recipe after changes.
    fn referee(changes: &[(&str, &str)]) -> (ThermostatRecipe, Limits) {
        let text = changes.iter().fold(REFEREE.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
        let recipe: Recipe = toml::from_str(&text).unwrap();
        let DeviceRecipe::Thermostat(thermostat) = recipe.device else {
            panic!("a temperature relay");
        };
        (thermostat, recipe.limits)
    }

    #[test]
    fn a_referee_batch_with_its_repeat_ends_in_time() {
        let (recipe, limits) = referee(&[]);
        let [operate, reset] = recipe.windows(&limits).unwrap();
        let passes = recipe.strategy().passes(0, false, operate, reset);
        let planned_s: f64 = passes.iter().map(|it| it.longest_s(39.0)).sum();
        assert!((330.0..365.0).contains(&(planned_s / 60.0)), "{planned_s}");
        let longest_s = longest(&recipe, &limits, 1).as_seconds();
        assert!(longest_s > planned_s * 4.0 / 3.0 + 3_600.0, "{longest_s}");
        assert_eq!(too_long(&recipe, &limits, 1), None);
    }

    #[test]
    fn batches_of_days_are_refused() {
        let slow = [
            ("rate_k_per_min = 0.5 ", "rate_k_per_min = 0.1 "),
            ("passes = 3 ", "passes = 10 "),
        ];
        let (recipe, limits) = referee(&slow);
        let fault = too_long(&recipe, &limits, 1).unwrap();
        assert_eq!(
            (fault.key.as_str(), fault.found.as_str()),
            ("test.passes", "10")
        );
        let (recipe, limits) = referee(&[]);
        let fault = too_long(&recipe, &limits, 100).unwrap();
        assert_eq!(
            (fault.key.as_str(), fault.found.as_str()),
            ("decision.slow_repeats", "100")
        );
    }
}
