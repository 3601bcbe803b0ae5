//! `relayrig lot`: shows the state of a lot; holds, releases, closes or reopens it.
//!
//! A decision is an order like one at a screen: the audit of orders records it with the name of the person who
//! decides.

use super::person;
use anyhow::{Context, anyhow};
use app::exit::Exit;
use app::lot_decision::{self, AboutLot};
use history::report::external_sentence;
use history::{Archive, Decision, Filter};
use machine::view::Order;
use serde_json::json;
use std::io::Write;
use std::path::Path;
use texts::Lang;

/// Shows, holds, releases, closes or reopens a lot.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig lot show A
  relayrig lot hold A --by li --reason 'wrong label on the reel'
  relayrig lot release A --by li --reason 'label was corrected'
  relayrig lot close A --by li
  relayrig lot reopen A --by zhao --reason 'forty parts were found behind the feeder'

A lot that is held takes no run. A run that is under way goes on to its end.")]
pub struct LotArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// State, recipe and calibration by their hashes, first and final yield, reference checks, suspect parts
    #[command(after_help = "Example: relayrig lot show A --json")]
    Show {
        /// Name of the lot
        lot: String,
        /// One JSON object
        #[arg(long)]
        json: bool,
    },
    /// Refuse runs of the lot until a person releases it
    #[command(after_help = "Example: relayrig lot hold A --by li --reason 'wrong label'")]
    Hold(Decided),
    /// Allow runs of the lot again
    #[command(
        after_help = "Example: relayrig lot release A --by li --reason 'reference part cleaned'"
    )]
    Release(Decided),
    /// Close the lot as it is
    #[command(
        after_help = "Example: relayrig lot close A --by li --reason 'rest of the reel returned'"
    )]
    Close(Decided),
    /// Allow runs of a complete lot again, with the recipe of the lot
    #[command(
        after_help = "Example: relayrig lot reopen A --by zhao --reason 'forty parts were found'"
    )]
    Reopen(Decided),
}

/// A decision about a lot.
#[derive(Debug, clap::Args)]
struct Decided {
    /// Name of the lot
    lot: String,
    /// Person who decides
    #[arg(long, value_name = "NAME")]
    by: String,
    /// Reason
    #[arg(long, value_name = "TEXT", default_value = "")]
    reason: String,
}

/// Runs `relayrig lot`; an error is bad input (exit status 2).
pub fn run(db: &Path, args: &LotArgs) -> anyhow::Result<Exit> {
    match &args.action {
        Action::Show { lot, json } => show(&Archive::open(db)?, lot, *json)?,
        Action::Hold(it) => decide(db, it, Decision::Hold)?,
        Action::Release(it) => decide(db, it, Decision::Release)?,
        Action::Close(it) => decide(db, it, Decision::Close)?,
        Action::Reopen(it) => decide(db, it, Decision::Reopen)?,
    }
    Ok(Exit::Done)
}

fn decide(db: &Path, it: &Decided, decision: Decision) -> anyhow::Result<()> {
    let by = person(&it.by)?;
    let (lot, reason) = (it.lot.clone(), it.reason.clone());
    let order = match decision {
        Decision::Hold => Order::HoldLot { lot, reason },
        Decision::Reopen => Order::ReopenLot { lot, reason },
        Decision::Release => Order::ReleaseLot {
            lot,
            reason: Some(reason),
        },
        Decision::Close => Order::CloseLot {
            lot,
            reason: Some(reason),
        },
    };
    let about = AboutLot {
        decision,
        lot: &it.lot,
        reason: &it.reason,
    };
    lot_decision::write(db, &order, &by, about).map_err(|why| anyhow!("{}", why.say(Lang::En)))
}

fn known(archive: &Archive, lot: &str) -> anyhow::Result<history::LotStatus> {
    archive
        .standing(lot)?
        .with_context(|| format!("no lot {lot:?}; see `relayrig history list`"))
}

fn show(archive: &Archive, lot: &str, as_json: bool) -> anyhow::Result<()> {
    let standing = known(archive, lot)?;
    let filter = Filter {
        lot: Some(lot.to_owned()),
        ..Filter::default()
    };
    let (runs, counts) = (archive.lots(&filter)?, archive.lot_yield(&filter)?);
    let checks = archive.reference_checks(&filter)?;
    let reopenings = archive.reopenings(lot)?;
    let mut out = std::io::stdout().lock();
    if as_json {
        let it = json!({"lot": lot, "standing": standing, "yield": counts, "runs": runs, "golden_checks": checks, "reopenings": reopenings,
            "external": archive.external_standing(lot)?});
        writeln!(out, "{it}")?;
        return Ok(());
    }
    let why = standing
        .why
        .map_or_else(String::new, |why| format!(": {why}"));
    writeln!(
        out,
        "lot {lot} {} since {}{why}",
        standing.state.name(),
        standing.since.local()
    )?;
    for run in &runs {
        let calibration = run.calibration_hash.as_deref().map_or("none", short);
        let consent = run.retest.as_ref();
        let retest = consent.map_or_else(String::new, |who| format!(", retest agreed to by {who}"));
        let cause = run.cause.as_ref().zip(run.cause_text.as_ref());
        let cause = cause.map_or_else(String::new, |(code, text)| {
            format!(", ended by {code}: {text}")
        });
        writeln!(
            out,
            "run {}: recipe {} {}, calibration {calibration}, {} of {} passed{retest}{cause}",
            run.run,
            run.recipe,
            short(&run.recipe_hash),
            run.counts.pass,
            run.counts.parts
        )?;
    }
    for it in &reopenings {
        writeln!(
            out,
            "reopened at {} by {}: {}",
            it.at.local(),
            it.who,
            it.why
        )?;
    }
    let percent = |n: u64| 100.0 * n as f64 / counts.parts.max(1) as f64;
    writeln!(
        out,
        "first-pass yield {:.2} % of {}, final {:.2} %, {} suspect",
        percent(counts.first_pass),
        counts.parts,
        percent(counts.finally()),
        counts.suspect
    )?;
    if let Some(it) = archive.external_standing(lot)? {
        writeln!(out, "{}", external_sentence(Lang::En, &it))?;
    }
    for it in &checks {
        let outcome = if it.passed { "good" } else { "FAILED" };
        writeln!(
            out,
            "reference check of run {} at {}: {outcome}, {}",
            it.run,
            it.at.local(),
            it.text
        )?;
    }
    Ok(())
}

fn short(hash: &str) -> &str {
    hash.get(..12).unwrap_or(hash)
}
