//! The gauge study of the program itself (`run --study grr`): %GRR, the share of repeatability and reproducibility in
//! the scatter of each characteristic. Three rigs measure the same parts three times each.

use super::chart::Chart;
use super::figure::Figure;
use super::order::{Order, finished};
use super::output::Report;
use anyhow::Context;
use serde_json::Value;
use tempfile::TempDir;

/// Limits of AIAG for %GRR, percent: up to the first a gauge is acceptable, beyond the second it is not.
const AIAG_PCT: [f64; 2] = [10.0, 30.0];

/// Runs the gauge study and makes the report.
///
/// # Errors
/// Fails when the program cannot run the gauge study, or when its answer does not parse.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let folder = TempDir::new()?;
    let db = folder.path().join("history.db");
    let mut command = order.lot_command("gauge", &db, order.parts, order.from);
    let done = finished(command.args(["--study", "grr"]), &[0]).context("the gauge study")?;
    let answer = String::from_utf8(done.stdout)?;
    let rows = answer.lines().map(|line| row(line, order.parts));
    let rows: Vec<Figure> = rows.collect::<anyhow::Result<_>>()?;
    let about = format!(
        "{} parts of {}, three times on three rigs",
        order.parts, order.recipe.name
    );
    let title = format!("share of the gauge, %GRR: {about}");
    let chart = Chart::of(title, "%", AIAG_PCT.to_vec(), &rows);
    Ok(Report::new("gauge", about, vec![rows], chart))
}

/// Parses the answer line about one characteristic.
fn row(line: &str, parts: u64) -> anyhow::Result<Figure> {
    let it: Value = serde_json::from_str(line)?;
    let name = it["param"]
        .as_str()
        .with_context(|| format!("no characteristic in {line}"))?;
    let anova = &it["anova"];
    Ok(Figure::new(name, parts, anova["pct_grr"].as_f64(), "%")
        .with("categories", anova["ndc"].as_f64()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_characteristic_without_an_analysis_has_no_share() {
        let known = row(
            r#"{"type":"grr","param":"a","anova":{"pct_grr":8.3,"ndc":17}}"#,
            10,
        )
        .unwrap();
        assert_eq!((known.value, known.more[0].1), (Some(8.3), Some(17.0)));
        let unknown = row(r#"{"type":"grr","param":"a","why_not":"a gap"}"#, 10).unwrap();
        assert_eq!(unknown.value, None);
        assert!(row("{}", 10).is_err());
    }
}
