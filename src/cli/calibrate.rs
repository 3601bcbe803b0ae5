//! `relayrig calibrate`: determines or verifies the factors of a rig by its standards and reference parts.

use super::output::Output;
use super::rig::RigArgs;
use super::terminal::Terminal;
use app::calibration::{Calibrated, FactorComparison, K, K_JOINT, calibrate, date};
use app::exit::Exit;
use app::order::Files;
use machine::dut::Calibration;
use machine::gauge::factor::Named;
use serde_json::json;
use std::io::Write;

/// Calibrates a rig or verifies its calibration.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  relayrig calibrate --sim
  relayrig calibrate --sim --verify --json
  relayrig calibrate --line measure=/dev/ttyUSB0 --line motion=/dev/ttyUSB1

Exit status: 0 calibrated or verified, 1 verification failed, 2 bad input or nothing to verify, 3 the rig has trouble.")]
pub struct CalibrateArgs {
    /// The rig to calibrate.
    #[command(flatten)]
    pub rig: RigArgs,
    /// Measure again and compare with the stored calibration
    #[arg(long)]
    pub verify: bool,
    /// Recipe in config/recipes; its coil voltage selects the reference parts
    #[arg(long, value_name = "NAME", default_value = "jzc-22f-012")]
    pub recipe: String,
    /// One JSON object per factor, then a summary
    #[arg(long)]
    pub json: bool,
}

/// Runs `relayrig calibrate`; an error is bad input (exit status 2).
pub fn run(files: &Files, args: &CalibrateArgs) -> anyhow::Result<Exit> {
    let source = args.rig.source(None)?;
    let what = (args.recipe.as_str(), args.verify);
    match calibrate(files, &source, what, &mut Terminal::quiet())? {
        Calibrated::Stored(found) => stored(&found, args.json),
        Calibrated::Verified {
            compared,
            due_at_us,
        } => verified(&compared, &date(due_at_us)?, args.json),
        Calibrated::Ended(exit) => {
            if let (true, Some(cause)) = (args.json, exit.cause()) {
                let it = json!({"type": "trouble", "cause": cause});
                writeln!(std::io::stdout().lock(), "{it}")?;
            }
            Ok(exit)
        }
    }
}

fn stored(found: &Calibration, as_json: bool) -> anyhow::Result<Exit> {
    let factor = |it: &Named| json!({"type": "factor", "factor": it.name, "unit": it.unit, "value": it.factor.value, "expanded_u": K * it.factor.u});
    let row = |it: &Named| {
        let (value, u) = (it.factor.value, K * it.factor.u);
        format!("{:<18} {value:>14.6} +- {u:<10.6} {}", it.name, it.unit)
    };
    let facts = found.facts();
    let (made, due) = (date(facts.made_at_us)?, date(facts.due_at_us)?);
    let whole = json!({"type": "calibration", "made_at": made, "due_at": due, "simulated": facts.is_simulated, "nominal_v": facts.nominal_v, "k": K});
    let end = format!("made {made}, due {due}; +- is U (k = {K})");
    let mut out = Output::stdout();
    out.lines(as_json, &facts.factors, factor, row)?;
    out.line(&if as_json { whole.to_string() } else { end })?;
    Ok(Exit::Done)
}

fn verified(compared: &[FactorComparison], due: &str, as_json: bool) -> anyhow::Result<Exit> {
    let factor = |it: &FactorComparison| json!({"type": "factor", "factor": it.name, "unit": it.unit, "found": it.found, "expected": it.expected, "expanded_u": it.expanded_u, "holds": it.agrees()});
    let (verified, outcome, exit) = match compared.iter().all(FactorComparison::agrees) {
        true => (true, "verified", Exit::Done),
        false => (false, "verification failed", Exit::AnswerIsNo),
    };
    let whole = json!({"type": "verification", "verified": verified, "due_at": due, "k": K_JOINT});
    let end = format!("{outcome}, due {due}; +- is the combined U (k = {K_JOINT})");
    let mut out = Output::stdout();
    out.lines(as_json, compared, factor, FactorComparison::to_string)?;
    out.line(&if as_json { whole.to_string() } else { end })?;
    Ok(exit)
}
