//! Use of the time of a lot: reads the input of [`quality::effectiveness`] from the history.

use super::Result;
use crate::{Archive, Filter, LotSummary, Moment};
use quality::Ordered;
use quality::effectiveness::{Effectiveness, Observed, effectiveness};

/// Quantile of the cycle times that replaces a missing ideal cycle time.
const QUICKEST: f64 = 0.05;

/// Computes the effectiveness (OEE) of `runs`, without imports and runs that have no end. The time from start to end of
/// a run is planned time; an alarm that was not cleared ends with its run, and set-up during an alarm counts as alarm
/// time. Returns `None` when no running time or no tested part is left.
pub(super) fn use_of_time(
    archive: &Archive,
    filter: &Filter,
    runs: &[LotSummary],
    ideal_cycle_s: Option<f64>,
) -> Result<Option<Effectiveness>> {
    let mut observed = Observed::default();
    let mut not_running = Vec::new();
    for run in runs.iter().filter(|run| run.source != "import") {
        let Some(closed) = run.closed else { continue };
        observed.planned_s += seconds(run.opened, closed);
        observed.parts += run.counts.parts;
        observed.good += run.counts.pass;
        not_running.extend(set_up(archive, run, closed)?);
    }
    let mut stood = Vec::new();
    for alarm in archive.alarms(filter)? {
        let run = runs
            .iter()
            .find(|run| Some(&run.lot) == alarm.lot.as_ref() && Some(run.run) == alarm.run);
        let closed = run.and_then(|run| run.closed);
        let end = alarm.cleared.map_or(closed, |cleared| {
            Some(closed.map_or(cleared, |closed| closed.min(cleared)))
        });
        stood.extend(end.map(|end| (alarm.raised, end)));
    }
    not_running.extend(&stood);
    observed.stopped_s = covered_s(stood);
    observed.setup_s = covered_s(not_running) - observed.stopped_s;
    observed.ideal_cycle_s = match ideal_cycle_s {
        Some(ideal) => ideal,
        None => Ordered::of(&archive.cycles(filter)?)
            .quantile(QUICKEST)
            .unwrap_or(0.0),
    };
    Ok(effectiveness(observed))
}

/// Returns the spans of a run that count as set-up: from its start, with the calibration if there is one, to the test
/// of the first production part, and the cycle of every reference part.
fn set_up(archive: &Archive, run: &LotSummary, closed: Moment) -> Result<Vec<(Moment, Moment)>> {
    let parts = |kind: &str, limit| {
        archive.query(&Filter {
            lot: Some(run.lot.clone()),
            run: Some(run.run),
            kind: Some(kind.to_owned()),
            limit,
            ..Filter::default()
        })
    };
    let first = parts("lot", Some(1))?;
    let begun = first
        .first()
        .map_or(closed, |it| before(it.time, it.test_s));
    let mut spans = vec![(run.opened, begun)];
    for it in parts("golden", None)? {
        let cycle = it.cycle_s.or(it.test_s);
        spans.push((before(it.time, cycle).max(run.opened), it.time));
    }
    Ok(spans)
}

fn before(at: Moment, seconds: Option<f64>) -> Moment {
    Moment(at.0 - (1e6 * seconds.unwrap_or(0.0)) as i64)
}

/// Returns the total time that the spans cover, seconds; time that several spans share counts once.
fn covered_s(mut spans: Vec<(Moment, Moment)>) -> f64 {
    spans.sort_unstable();
    let mut covered = 0.0;
    let mut until = Moment(i64::MIN);
    for (from, to) in spans {
        let from = from.max(until);
        if to > from {
            covered += seconds(from, to);
            until = to;
        }
    }
    covered
}

fn seconds(from: Moment, to: Moment) -> f64 {
    (to.0 - from.0) as f64 / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alarms_that_stand_together_stop_the_line_once() {
        let span = |from: i64, to: i64| (Moment(from * 1_000_000), Moment(to * 1_000_000));
        let spans = vec![
            span(50, 60),
            span(0, 10),
            span(5, 20),
            span(6, 7),
            span(30, 30),
        ];
        assert_eq!(covered_s(spans), 30.0);
        assert_eq!(covered_s(vec![span(5, 1)]), 0.0);
        assert_eq!(covered_s(Vec::new()), 0.0);
    }
}
