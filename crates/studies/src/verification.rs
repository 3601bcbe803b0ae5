//! Study `verification`: how often `calibrate --verify` fails a rig that has not changed.
//!
//! The study calibrates every rig once and verifies it on other days: the errors of the rig stay, while noise,
//! operations and temperatures of the reference parts change (fault `noise_seed`). A verification checks that every
//! factor differs from its calibration by at most [`K_JOINT`] times the standard uncertainty of the difference. With
//! independent factors and exact uncertainties, one of fifteen factors is outside in about one verification in 25. The
//! bar is that rate plus three standard deviations of a count. Further rows show the scatter of each factor divided by
//! its stated uncertainty: a ratio above 1 means that the stated uncertainty is too small.

use super::chart::Chart;
use super::figure::{Bar, Figure, rms};
use super::order::{Order, finished};
use super::output::Report;
use super::pool::{self, LOTS_AT_ONCE};
use anyhow::Context;
use app::calibration::K_JOINT;
use serde_json::Value;
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

/// Result of the verification on one day: the deviation of each factor by its name, in standard uncertainties.
type Day = BTreeMap<String, f64>;

/// Calibrates one rig per lot of the order, verifies it on as many days as a lot has parts, and makes the report.
///
/// # Errors
/// Fails when a process does not start, or when its answer does not parse.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let folder = TempDir::new()?;
    let rigs: Vec<u64> = (1..=order.lots).collect();
    let days = pool::map(&rigs, LOTS_AT_ONCE, |rig| {
        let db = folder.path().join(format!("{rig}.db"));
        calibrate(order, &db, *rig, None)?;
        let day = |day| read(&calibrate(order, &db, *rig, Some(rig * 1_000_000 + day))?);
        (1..=order.parts)
            .map(day)
            .collect::<anyhow::Result<Vec<Day>>>()
    })?;
    Ok(report(order, &days.concat()))
}

fn calibrate(order: &Order, db: &Path, rig: u64, noise: Option<u64>) -> anyhow::Result<String> {
    let mut command = order.rig_command("calibrate", db, rig);
    if let Some(noise) = noise {
        command.args(["--verify", "--fault", &format!("noise_seed={noise}")]);
    }
    let done = finished(&mut command, &[0, 1]).with_context(|| format!("rig {rig}"))?;
    Ok(String::from_utf8(done.stdout)?)
}

fn read(rows: &str) -> anyhow::Result<Day> {
    let mut day = Day::new();
    for line in rows.lines() {
        let it: Value = serde_json::from_str(line)?;
        if it["type"] == "factor" {
            let number = |key: &str| it[key].as_f64().with_context(|| key.to_string());
            let u = number("expanded_u")? / K_JOINT;
            let name = it["factor"].as_str().context("factor")?;
            day.insert(name.into(), (number("found")? - number("expected")?) / u);
        }
    }
    Ok(day)
}

/// Returns the share of verifications that fail by chance with [`K_JOINT`], when the factors are normal, independent
/// and as uncertain as stated.
fn chosen_failure_rate(factors: usize) -> f64 {
    let inside = 2.0 * Normal::standard().cdf(K_JOINT) - 1.0;
    1.0 - inside.powi(factors as i32)
}

fn report(order: &Order, days: &[Day]) -> Report {
    let n = days.len() as f64;
    let fails = |day: &&Day| day.values().any(|off| off.abs() > K_JOINT);
    let failed = days.iter().filter(fails).count() as f64;
    let chosen_failure_rate = chosen_failure_rate(days.first().map_or(0, Day::len));
    let allowed =
        chosen_failure_rate + 3.0 * (chosen_failure_rate * (1.0 - chosen_failure_rate) / n).sqrt();
    let rate = Figure::new(
        "verifications of an unchanged rig that fail",
        days.len() as u64,
        Some(100.0 * failed / n),
        "%",
    )
    .with("chosen", Some(100.0 * chosen_failure_rate))
    .bar(Bar::AtMost((1e4 * allowed).round() / 100.0));
    let names: Vec<&String> = days.first().into_iter().flat_map(Day::keys).collect();
    let scatter = |name: &&String| rms(days.iter().filter_map(|day| day.get(*name).copied()));
    let factor = |name: &&String| {
        let text = format!("{name}: scatter against stated");
        Figure::new(text, days.len() as u64, scatter(name), "")
    };
    let factors = names.iter().map(factor).collect();
    let title = "scatter of a factor from day to day against its stated uncertainty";
    let bars = names.iter().map(|name| (name.to_string(), scatter(name)));
    let chart = Chart::new(title, "", vec![1.0], bars);
    let about = format!("{} rigs on {} other days each", order.lots, order.parts);
    Report::new("verification", about, vec![vec![rate], factors], chart)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fifteen_factors_fail_an_unchanged_rig_once_in_25() {
        assert!(
            (chosen_failure_rate(15) - 0.0398).abs() < 1e-3,
            "{}",
            chosen_failure_rate(15)
        );
        assert!((chosen_failure_rate(1) - 0.0027).abs() < 1e-4);
    }

    #[test]
    fn a_deviation_counts_standard_uncertainties_of_both_measurements() {
        let rows = concat!(
            r#"{"type":"factor","factor":"contact","found":1.2,"expected":1.0,"expanded_u":0.3}"#,
            "\n",
            r#"{"type":"verification","verified":true}"#
        );
        let day = read(rows).expect("two lines of JSON");
        assert!((day["contact"] - 2.0).abs() < 1e-9 && day.len() == 1);
        assert!(read("no object").is_err());
    }
}
