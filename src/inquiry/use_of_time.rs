//! How the time of a lot was used: what the history says of it, for [`crate::quality::effectiveness`].

use super::Result;
use crate::history::{Archive, Filter, LotSummary, Moment};
use crate::quality::Ordered;
use crate::quality::effectiveness::{Effectiveness, Seen, effectiveness};

/// The quickest share of cycles that stands for the ideal one when none is given.
const QUICKEST: f64 = 0.05;

/// Planned is from opening to end of each run; an alarm that never went stood to the end of its run.
/// None for imports, which have no time of their own.
pub(super) fn use_of_time(
    archive: &Archive,
    filter: &Filter,
    runs: &[LotSummary],
    ideal_cycle_s: Option<f64>,
) -> Result<Option<Effectiveness>> {
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
    seen.ideal_cycle_s = match ideal_cycle_s {
        Some(ideal) => ideal,
        None => Ordered::of(&archive.cycles(filter)?)
            .quantile(QUICKEST)
            .unwrap_or(0.0),
    };
    Ok(effectiveness(seen))
}

fn seconds(from: Moment, to: Moment) -> f64 {
    (to.0 - from.0) as f64 / 1e6
}
