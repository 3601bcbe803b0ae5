//! Makes printable pages from the history.

use super::figures::agreed;
use super::use_of_time::use_of_time;
use super::{InquiryError, Result, checks, pareto};
use crate::report::certificate::certificate;
use crate::report::lot::{LotReport, ParameterValues};
use crate::report::{Lang, Paper, alarms};
use crate::store::PROGRAM;
use crate::{Archive, Filter};
use jiff::{Timestamp, tz::TimeZone};

/// Largest number of rejects that a lot report lists.
const LISTED: usize = 200;

/// Returns the settings of a page about the selected runs; the page is marked SIMULATION when one of the runs was on
/// the simulated rig.
pub fn paper_of(archive: &Archive, filter: &Filter, language: Lang) -> Result<Paper> {
    Ok(Paper {
        simulated: archive.is_simulated(filter)?,
        ..paper(language)
    })
}

/// Returns the settings of a page that is not marked SIMULATION: time zone of this computer, time and version at the
/// foot.
pub fn paper(language: Lang) -> Paper {
    let zone = TimeZone::system();
    let now = Timestamp::now().to_zoned(zone.clone());
    let made = format!("{} · {PROGRAM}", now.strftime("%Y-%m-%d %H:%M %:z"));
    Paper {
        language,
        zone,
        made,
        simulated: false,
    }
}

/// Returns the report of a lot. `ideal_cycle_s` is the shortest cycle that the line can keep, seconds; `None` takes
/// the 5 % quantile of the cycle times.
pub fn lot_report(
    archive: &Archive,
    filter: &Filter,
    ideal_cycle_s: Option<f64>,
    paper: &Paper,
) -> Result<String> {
    let Some(lot) = filter.lot.as_deref() else {
        return Err(InquiryError::member(
            "lot",
            "missing: a lot report is about one lot",
        ));
    };
    if let Some(ideal) = ideal_cycle_s.filter(|it| !(it.is_finite() && *it > 0.0)) {
        let reason = format!("found {ideal}, expected more than 0");
        return Err(InquiryError::member("ideal_cycle_s", reason));
    }
    checks::known_runs(archive, filter)?;
    let runs = archive.lots(filter)?;
    checks::one_rig(&runs)?;
    let report = LotReport {
        lot,
        runs: &runs,
        reopenings: &archive.reopenings(lot)?,
        counts: archive.lot_yield(filter)?,
        parameters: measured(archive, filter)?,
        effectiveness: use_of_time(archive, filter, &runs, ideal_cycle_s)?,
        batches: &archive.batches(filter)?,
        rejects: pareto::rejects(archive, filter, LISTED)?,
        external: &archive.external_results(lot)?,
        standing: archive.external_standing(lot)?,
        alarms: &archive.alarms(filter)?,
        answers: &archive.answers(filter)?,
    };
    Ok(report.html(paper))
}

fn measured(archive: &Archive, filter: &Filter) -> Result<Vec<ParameterValues>> {
    let mut measured = Vec::new();
    for key in archive.parameters()? {
        let found = archive.values(&key, filter)?;
        if !found.values.is_empty() {
            measured.push(ParameterValues {
                limits: agreed(found.limits),
                values: found.values,
                key,
            });
        }
    }
    Ok(measured)
}

/// Returns the certificate of part `seq` of the lot, from its latest run unless the filter names a run.
pub fn part_certificate(
    archive: &Archive,
    filter: &Filter,
    seq: u64,
    paper: &Paper,
) -> Result<String> {
    let Some(lot) = filter.lot.as_deref() else {
        return Err(InquiryError::member(
            "lot",
            "missing: a part is one of a lot",
        ));
    };
    checks::known_runs(archive, filter)?;
    let runs = archive.lots(filter)?;
    checks::one_rig(&runs)?;
    let of_part = |part: &&crate::Part| {
        let mut runs = runs.iter();
        runs.any(|run| run.lot == part.lot && run.run == part.run)
    };
    let parts = archive.show(lot, seq, "lot")?;
    let part = parts.iter().rfind(of_part);
    let run = part.and_then(|part| runs.iter().find(|run| run.run == part.run));
    match (part, run) {
        (Some(part), Some(run)) => {
            let tested_in = archive.batch_of(part)?;
            let results = archive.external_results(lot)?;
            let standing = archive.external_standing(lot)?;
            let external = (results.as_slice(), standing.as_ref());
            Ok(certificate(paper, part, run, tested_in.as_ref(), external))
        }
        _ => Err(InquiryError::missing(format!(
            "lot {lot:?} has no part {seq} (in this run and of this recipe)"
        ))),
    }
}

/// Returns a page that lists the selected alarms.
pub fn alarm_list(archive: &Archive, filter: &Filter, paper: &Paper) -> Result<String> {
    checks::known_runs(archive, filter)?;
    let about = filter.lot.as_deref().unwrap_or_default();
    Ok(alarms::list(paper, about, &archive.alarms(filter)?))
}
