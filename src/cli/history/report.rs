//! `history report`: lot report, certificate of a part, list of alarms.

use super::filter::{RunArgs, limits_seen};
use super::paper::PaperArgs;
use crate::history::{Archive, Filter, LotSummary, Moment};
use crate::quality::Ordered;
use crate::quality::effectiveness::{Effectiveness, Seen, effectiveness};
use crate::report::alarms;
use crate::report::certificate::certificate;
use crate::report::lot::{LotReport, ParameterValues};
use anyhow::Context;
use clap::Args;

#[derive(Debug, Args)]
pub(super) struct ReportArgs {
    #[command(flatten)]
    runs: RunArgs,
    /// The certificate of this part of the lot instead
    #[arg(long, value_name = "SEQ", requires = "lot", conflicts_with = "alarms")]
    part: Option<u64>,
    /// Only the list of alarms; without --lot, of all lots
    #[arg(long)]
    alarms: bool,
    /// Shortest cycle the line can keep, for the use of the time; the quickest 5 % when absent
    #[arg(long, value_name = "S")]
    ideal_cycle_s: Option<f64>,
    #[command(flatten)]
    paper: PaperArgs,
}

pub(super) fn run(archive: &Archive, args: &ReportArgs) -> anyhow::Result<()> {
    let filter = args.runs.filter();
    let runs = archive.lots(&filter)?;
    anyhow::ensure!(
        !runs.is_empty(),
        "no run has this lot, run and recipe; `history list` shows those there are"
    );
    let page = match (args.part, args.alarms) {
        (Some(seq), _) => one_part(archive, args, &runs, seq)?,
        (None, true) => {
            let about = args.runs.lot.as_deref().unwrap_or_default();
            alarms::list(&args.paper.paper(), about, &archive.alarms(&filter)?)
        }
        (None, false) => whole_lot(archive, args, &filter, &runs)?,
    };
    args.paper.write(&page)
}

fn one_part(
    archive: &Archive,
    args: &ReportArgs,
    runs: &[LotSummary],
    seq: u64,
) -> anyhow::Result<String> {
    let lot = args.runs.lot.as_deref().unwrap_or_default();
    let parts = archive.show(lot, seq, "lot")?;
    let part = parts
        .iter()
        .rfind(|part| args.runs.run.is_none_or(|run| part.run == run))
        .with_context(|| format!("lot {lot:?} has no part {seq}"))?;
    let run = runs
        .iter()
        .find(|run| run.lot == part.lot && run.run == part.run)
        .with_context(|| format!("part {seq} is not of the recipe asked for"))?;
    Ok(certificate(&args.paper.paper(), part, run))
}

fn whole_lot(
    archive: &Archive,
    args: &ReportArgs,
    filter: &Filter,
    runs: &[LotSummary],
) -> anyhow::Result<String> {
    let lot = args
        .runs
        .lot
        .as_deref()
        .context("a lot report needs --lot; --alarms lists the alarms of all lots")?;
    let alarms = archive.alarms(filter)?;
    let mut parameters = Vec::new();
    for key in archive.parameters()? {
        let found = archive.values(&key, filter)?;
        if found.values.is_empty() {
            continue;
        }
        parameters.push(ParameterValues {
            limits: limits_seen(found.limits),
            values: found.values,
            key,
        });
    }
    let report = LotReport {
        lot,
        runs,
        passed: archive.passed(filter)?,
        parameters,
        effectiveness: use_of_time(archive, args, filter, runs)?,
        alarms: &alarms,
    };
    Ok(report.html(&args.paper.paper()))
}

/// Planned is from opening to end of each run; an alarm that never went stood to the end of its run.
/// None for imports, which have no time of their own.
fn use_of_time(
    archive: &Archive,
    args: &ReportArgs,
    filter: &Filter,
    runs: &[LotSummary],
) -> anyhow::Result<Option<Effectiveness>> {
    let mut seen = Seen::default();
    for run in runs.iter().filter(|run| run.source != "import") {
        let Some(closed) = run.closed else { continue };
        seen.planned_s += seconds(run.opened, closed);
        seen.parts += run.counts.parts;
        seen.good += run.counts.pass;
    }
    for alarm in archive.alarms(filter)? {
        let run = runs
            .iter()
            .find(|run| Some(&run.lot) == alarm.lot.as_ref() && Some(run.run) == alarm.run);
        let end = alarm.cleared.or(run.and_then(|run| run.closed));
        seen.stopped_s += end.map_or(0.0, |end| seconds(alarm.raised, end).max(0.0));
    }
    seen.ideal_cycle_s = match args.ideal_cycle_s {
        Some(ideal) => {
            anyhow::ensure!(
                ideal > 0.0,
                "--ideal-cycle-s: found {ideal}, expected more than 0"
            );
            ideal
        }
        None => Ordered::of(&archive.cycles(filter)?)
            .quantile(0.05)
            .unwrap_or(0.0),
    };
    Ok(effectiveness(seen))
}

fn seconds(from: Moment, to: Moment) -> f64 {
    (to.0 - from.0) as f64 / 1e6
}
