//! Study `ssr`: seconds against error of the methods for solid-state relays, and kills of a controller with the line
//! on.
//!
//! The study applies the arithmetic of the controller to a model of the signals, so that only the error of the method
//! remains: sampling, resolution and noise of the digitizer, the delay of the part near its threshold and, where a row
//! says so, the errors of the source. `seconds` is the rig time of the method: dwell and record, and for searches the
//! commands of each step.

mod kill;
mod mains;
mod scope;
mod threshold;
mod timing;

use super::chart::Chart;
use super::dice::Dice;
use super::figure::{Figure, mean, rms};
use super::output::Report;

/// Default number of parts behind each row; `--seeds` gives another.
pub const PARTS: u64 = 400;

/// Number of kills of the controller.
const KILLS: u64 = 200;

/// Makes the report from `parts` made-up parts for each row, and from kills of the controller.
///
/// # Errors
/// Fails when the rig that comes with the program does not load.
pub fn study(parts: u64) -> anyhow::Result<Report> {
    let mut groups = methods(parts);
    let title = "turn-on voltage at the zero of the mains: rms error of one turn-on";
    let chart = Chart::of(title, "V", vec![0.5], &groups[1]);
    groups.push(kill::figures(KILLS)?);
    let about = format!(
        "{parts} made-up parts for each row, instruments without errors unless a row says so"
    );
    Ok(Report::new("ssr", about, groups, chart))
}

/// Returns the rows of each method.
fn methods(parts: u64) -> Vec<Vec<Figure>> {
    let thresholds = threshold::methods(parts);
    let crossings = mains::zero_crossings(parts);
    vec![
        thresholds,
        crossings,
        mains::leakages(parts),
        mains::drops(parts),
        timing::edges(parts),
    ]
}

/// Returns a row of error: root mean square, bias and greatest, and the seconds of the method.
fn row(name: String, errors: &[f64], unit: &'static str, seconds: f64) -> Figure {
    let each = || errors.iter().copied();
    let greatest = each().map(f64::abs).reduce(f64::max);
    Figure::new(name, errors.len() as u64, rms(each()), unit)
        .with("bias", mean(each()))
        .with("max", greatest)
        .with("seconds", Some(seconds))
}

/// Draws a number from `low` to `high`.
fn uniform(dice: &mut Dice, low: f64, high: f64) -> f64 {
    const PLACES: u64 = 1 << 52;
    low + (high - low) * dice.below(PLACES) as f64 / PLACES as f64
}

/// Draws from a normal distribution.
fn normal(dice: &mut Dice, mean: f64, sd: f64) -> f64 {
    let (length, turn) = (uniform(dice, 1e-12, 1.0), uniform(dice, 0.0, 1.0));
    mean + sd * (-2.0 * length.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finer_samples_give_a_smaller_error() {
        let rows = mains::zero_crossings(40);
        let of = |name: &str| {
            let row = rows.iter().find(|it| it.name.contains(name));
            row.and_then(|it| it.value).expect(name)
        };
        for bits in [8, 12] {
            let rates =
                [20, 50, 100, 250, 1000].map(|rate| of(&format!(", {rate} kS/s, {bits} bits")));
            // Where noise dominates, more samples reduce the error no further.
            let is_finer = rates[..4].is_sorted_by(|one, other| one > other);
            assert!(is_finer && rates[4] < rates[2], "{bits} bits: {rates:?}");
        }
        // Half of a sampling interval, divided by the root of three.
        assert!((of("100 kS/s, 12 bits") - 0.3).abs() < 0.1);
    }

    #[test]
    fn a_killed_controller_leaves_every_contactor_open_in_time() {
        let found = kill::kills(24).expect("kills");
        assert_eq!((found.closed, found.ended), (0, 0), "{found:?}");
        assert!(found.open_us.len() >= 8, "{found:?}");
        assert!(
            found.open_us.iter().all(|it| *it <= found.limit_us),
            "{found:?}"
        );
    }

    #[test]
    fn the_split_finds_what_the_rms_value_hides() {
        let rows = mains::leakages(20);
        let of = |name: &str| {
            rows.iter()
                .find(|it| it.name.starts_with(name))
                .and_then(|it| it.value)
        };
        assert!(of("split, 3 periods").expect("split") < 1.0);
        assert!(of("rms, 3 periods").expect("rms") > 10.0);
    }

    #[test]
    fn every_row_has_a_value_and_its_seconds() {
        for figure in methods(20).into_iter().flatten() {
            assert!(figure.value.is_some(), "{}", figure.name);
            assert!(
                figure
                    .more
                    .iter()
                    .any(|it| it.0 == "seconds" && it.1.is_some()),
                "{}",
                figure.name
            );
        }
    }
}
