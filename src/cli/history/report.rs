//! `history report`: lot report, certificate of a part, list of alarms.

use super::filter::RunArgs;
use super::paper::PaperArgs;
use clap::Args;
use history::Archive;
use history::inquiry::paper;

#[derive(Debug, Args)]
pub(super) struct ReportArgs {
    #[command(flatten)]
    runs: RunArgs,
    /// Certificate of this part instead of the lot report
    #[arg(long, value_name = "SEQ", requires = "lot", conflicts_with = "alarms")]
    part: Option<u64>,
    /// Only the list of alarms; without --lot, of all lots
    #[arg(long)]
    alarms: bool,
    /// Shortest cycle that the line can keep, s, for the OEE; when absent, the 5 % quantile of the lot
    #[arg(long, value_name = "S")]
    ideal_cycle_s: Option<f64>,
    #[command(flatten)]
    paper: PaperArgs,
}

pub(super) fn run(archive: &Archive, args: &ReportArgs) -> anyhow::Result<()> {
    let filter = args.runs.filter();
    let on = args.paper.paper_of(archive, &filter)?;
    let page = match (args.part, args.alarms) {
        (Some(seq), _) => paper::part_certificate(archive, &filter, seq, &on)?,
        (None, true) => paper::alarm_list(archive, &filter, &on)?,
        (None, false) => paper::lot_report(archive, &filter, args.ideal_cycle_s, &on)?,
    };
    args.paper.write(&page)
}
