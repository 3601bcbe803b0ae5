//! `relayrig chamber`: the response of a chamber to its heater, and settings of its controller.

use super::output::Output;
use super::rig::RigArgs;
use super::terminal::Terminal;
use app::exit::Exit;
use app::experiment::experiment;
use app::order::Files;
use machine::dut::experiment::{Experiment, Figure};
use serde_json::json;

/// Coverage factor of the printed uncertainty.
const K: f64 = 2.0;

/// Measures the response of a chamber to its heater.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  relayrig --config config/rigs/thermostat chamber identify --sim
  relayrig chamber identify
  relayrig chamber tune --json

The rack stays empty; the door is locked while the chamber is hot. An identification takes a quarter of an hour from the
cold chamber, a tuning some minutes more. The tables printed at the end belong into rack.toml: the batches of a run then
need no identification of their own.

Exit status: 0 done, 2 bad input, 3 the rig has trouble, 4 stopped by the operator.")]
pub struct ChamberArgs {
    /// What to find
    #[arg(value_enum)]
    pub what: What,
    /// The rig of the chamber.
    #[command(flatten)]
    pub rig: RigArgs,
    /// Recipe in config/recipes whose limits give the range of temperatures [default: thermostat-ksd9700 where the rig
    /// has it, else its first one]
    #[arg(long, value_name = "NAME")]
    pub recipe: Option<String>,
    /// One JSON object per figure
    #[arg(long)]
    pub json: bool,
}

/// Result of the experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum What {
    /// Response of the air to a step of the heater
    Identify,
    /// Response to a step, then settings of the controller from an oscillation (relay auto-tune)
    Tune,
}

/// Runs `relayrig chamber`; an error is bad input (exit status 2).
pub fn run(files: &Files, args: &ChamberArgs) -> anyhow::Result<Exit> {
    let source = args.rig.source(None)?;
    let what = match args.what {
        What::Identify => Experiment::Identify,
        What::Tune => Experiment::Tune,
    };
    let usual = || super::rig::usual_recipe(&files.config);
    let recipe = args.recipe.clone().unwrap_or_else(usual);
    let order = (recipe.as_str(), what);
    match experiment(files, &source, order, &mut Terminal::quiet())? {
        Ok(found) => {
            let mut out = Output::stdout();
            out.lines(args.json, &found, object, row)?;
            if !args.json {
                out.line(&format!(
                    "+- is U (k = {K}). For rack.toml:\n{}",
                    tables(&found)
                ))?;
            }
            Ok(Exit::Done)
        }
        Err(exit) => {
            if let (true, Some(cause)) = (args.json, exit.cause()) {
                let it = json!({"type": "trouble", "cause": cause});
                Output::stdout().line(&it.to_string())?;
            }
            Ok(exit)
        }
    }
}

fn object(it: &Figure) -> serde_json::Value {
    let expanded_u = it.u.map(|u| K * u);
    json!({"type": "figure", "table": it.table, "key": it.key, "value": it.value, "expanded_u": expanded_u})
}

fn row(it: &Figure) -> String {
    let name = format!("{}.{}", it.table, it.key);
    let u =
        it.u.map_or_else(String::new, |u| format!("+- {}", significant(K * u)));
    format!("{name:<38} {:>12} {u}", significant(it.value))
}

/// Returns the figures as tables of a TOML file.
fn tables(found: &[Figure]) -> String {
    let mut text = String::new();
    for group in found.chunk_by(|a, b| a.table == b.table) {
        text += &group
            .first()
            .map_or_else(String::new, |it| format!("\n[{}]\n", it.table));
        for it in group {
            text += &format!("{} = {}\n", it.key, significant(it.value));
        }
    }
    text
}

/// Returns a number with five significant digits, as TOML writes it.
fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value:.1}");
    }
    let before_point = value.abs().log10().floor() as i32 + 1;
    let decimals = usize::try_from((5 - before_point).clamp(1, 9)).unwrap_or(1);
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_become_tables_of_toml() {
        let figure = |table, key, value| Figure {
            table,
            key,
            value,
            u: None,
        };
        let found = [
            figure("chamber", "gain_k", 30.6123),
            figure("chamber", "loss_per_k", 0.001_683_21),
            figure("chamber.first_order", "delay_s", 4.2),
        ];
        let text = tables(&found);
        let read: toml::Table = text.parse().expect("TOML");
        assert_eq!(read["chamber"]["gain_k"].as_float(), Some(30.612));
        assert_eq!(read["chamber"]["loss_per_k"].as_float(), Some(0.001_683_2));
        assert_eq!(
            read["chamber"]["first_order"]["delay_s"].as_float(),
            Some(4.2)
        );
    }
}
