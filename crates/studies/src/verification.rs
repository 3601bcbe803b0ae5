//! How often `calibrate --verify` fails a rig that has not changed.
//!
//! Every rig is calibrated once and verified on other days: its errors stay, noise, operations and the temperatures of
//! the golden parts are drawn anew (fault `noise_seed`). A verification asks of every factor that it lies within
//! [`K_OF_ALL`] standard uncertainties of both measurements together; if those were independent and exact, so many
//! factors at once would fail once in some thirty times. That is the bar, with three standard deviations of a count.
//! Beside it stands each factor's own scatter against what was stated, as a ratio: above 1 its uncertainty would be too
//! small.

use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::fleet::{Folder, Order};
use super::output::Report;
use anyhow::{Context, bail};
use app::calibration::K_OF_ALL;
use app::progress::{PIECES, progress};
use serde_json::Value;
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// One day on a rig: name of every factor with what was off, in standard uncertainties.
type Day = BTreeMap<String, f64>;

/// Calibrates as many rigs as the order has lots, verifies each as often as a lot has parts, and makes the report.
///
/// # Errors
/// A process that could not be started or whose answer could not be read.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let folder = Folder::new()?;
    let mut days = Vec::new();
    let bar = progress(Some(order.lots), PIECES);
    for rig in 1..=order.lots {
        let db = folder.0.join(format!("{rig}.db"));
        calibrate(order, &db, rig, None)?;
        for day in 1..=order.parts {
            let noise = rig * 1_000_000 + day;
            days.push(read(&calibrate(order, &db, rig, Some(noise))?)?);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(report(order, &days))
}

fn calibrate(order: &Order, db: &Path, rig: u64, noise: Option<u64>) -> anyhow::Result<String> {
    let mut command = Command::new(&order.program);
    command.arg("--config").arg(&order.config).arg("--db");
    command
        .arg(db)
        .args(["--log", "error", "calibrate", "--sim", "--json"]);
    command.args(["--recipe", &order.recipe, "--seed", &rig.to_string()]);
    if let Some(world) = &order.world {
        command.arg("--world").arg(world);
    }
    if let Some(noise) = noise {
        command.args(["--verify", "--fault", &format!("noise_seed={noise}")]);
    }
    let done = command.output().context("calibrate")?;
    if !matches!(done.status.code(), Some(0 | 1)) {
        bail!("rig {rig}: {}", String::from_utf8_lossy(&done.stderr));
    }
    Ok(String::from_utf8(done.stdout)?)
}

fn read(told: &str) -> anyhow::Result<Day> {
    let mut day = Day::new();
    for line in told.lines() {
        let it: Value = serde_json::from_str(line)?;
        if it["type"] == "factor" {
            let number = |key: &str| it[key].as_f64().with_context(|| key.to_string());
            let u = number("expanded_u")? / K_OF_ALL;
            let name = it["factor"].as_str().context("factor")?;
            day.insert(name.into(), (number("found")? - number("expected")?) / u);
        }
    }
    Ok(day)
}

/// Share of verifications that fail when so many factors are normal, independent and as uncertain as stated.
fn chosen(factors: usize) -> f64 {
    let inside = 2.0 * Normal::standard().cdf(K_OF_ALL) - 1.0;
    1.0 - inside.powi(factors as i32)
}

fn report(order: &Order, days: &[Day]) -> Report {
    let n = days.len() as f64;
    let fails = |day: &&Day| day.values().any(|off| off.abs() > K_OF_ALL);
    let failed = days.iter().filter(fails).count() as f64;
    let chosen = chosen(days.first().map_or(0, Day::len));
    let allowed = chosen + 3.0 * (chosen * (1.0 - chosen) / n).sqrt();
    let rate = Figure::new(
        "verifications of an unchanged rig that fail",
        days.len() as u64,
        Some(100.0 * failed / n),
        "%",
    )
    .with("chosen", Some(100.0 * chosen))
    .bar(Bar::AtMost((1e4 * allowed).round() / 100.0));
    let names: Vec<&String> = days.first().into_iter().flat_map(Day::keys).collect();
    let scatter = |name: &&String| {
        let squares = days
            .iter()
            .filter_map(|day| day.get(*name))
            .map(|off| off * off);
        (squares.sum::<f64>() / n).sqrt()
    };
    let factors = names.iter().map(|name| {
        Figure::new(
            format!("{name}: scatter against stated"),
            days.len() as u64,
            Some(scatter(name)),
            "",
        )
    });
    Report {
        study: "verification",
        about: format!("{} rigs on {} other days each", order.lots, order.parts),
        groups: vec![vec![rate], factors.collect()],
        notes: Vec::new(),
        chart: Chart {
            title: "scatter of a factor from day to day against its stated uncertainty".into(),
            unit: "",
            from: 0.0,
            marks: vec![1.0],
            bars: names
                .iter()
                .map(|name| (name.to_string(), Some(scatter(name))))
                .collect(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fifteen_factors_at_three_sigma_fail_one_rig_in_25() {
        assert!((chosen(15) - 0.0398).abs() < 1e-3, "{}", chosen(15));
        assert!((chosen(1) - 0.0027).abs() < 1e-4);
    }

    #[test]
    fn what_is_off_is_told_in_standard_uncertainties_of_both() {
        let told = concat!(
            r#"{"type":"factor","factor":"contact","found":1.2,"expected":1.0,"expanded_u":0.3}"#,
            "\n",
            r#"{"type":"verification","verified":true}"#
        );
        let day = read(told).expect("two lines of JSON");
        assert!((day["contact"] - 2.0).abs() < 1e-9 && day.len() == 1);
        assert!(read("no object").is_err());
    }
}
