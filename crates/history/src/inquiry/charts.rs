//! Control charts: level and spread of a parameter, or the share of each bin run by run.

use super::{InquiryError, Result, checks};
use crate::report::Paper;
use crate::report::spc::{NamedChart, spc};
use crate::{Archive, Filter, LotSummary};
use quality::chart::{Chart, individuals, shares, subgroups};
use quality::rules::Rules;
use serde::Serialize;
use std::collections::BTreeSet;
use utoipa::ToSchema;

/// Allowed number of parts in a subgroup; 1 gives charts of individual values.
pub const SUBGROUPS: std::ops::RangeInclusive<u8> = 1..=10;

/// A control chart of one parameter or bin.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Charted {
    /// Parameter key or name of a bin.
    pub of: String,
    /// Number of points left out before the first one.
    pub first: usize,
    /// `lot/run` of each point; empty when the points have only numbers.
    pub names: Vec<String>,
    /// The chart.
    #[serde(flatten)]
    pub chart: Chart,
}

/// Computes the charts of `param`, or of the share of each bin when `param` is absent. All points enter into the
/// control limits.
pub fn charts(
    archive: &Archive,
    filter: &Filter,
    param: Option<&str>,
    (subgroup, rules): (u8, Rules),
) -> Result<Vec<Charted>> {
    if !SUBGROUPS.contains(&subgroup) {
        let reason = format!("found {subgroup}, expected 1 to 10");
        return Err(InquiryError::member("subgroup", reason));
    }
    checks::parameters(archive, param)?;
    checks::known_runs(archive, filter)?;
    let charts = match param {
        Some(param) => of_parameter(archive, filter, param, (subgroup, rules))?,
        None => of_bins(&archive.lots(filter)?),
    };
    if charts.is_empty() {
        return Err(InquiryError::missing(
            "too few parts for a control chart: it takes two values, or two runs",
        ));
    }
    Ok(charts)
}

/// Returns the printable page with the last `shown` points of every chart.
pub fn page(paper: &Paper, about: &str, charts: &[Charted], shown: usize) -> String {
    let named: Vec<NamedChart<'_>> = charts
        .iter()
        .map(|it| NamedChart {
            of: &it.of,
            chart: &it.chart,
            names: &it.names,
        })
        .collect();
    spc(paper, about, &named, shown)
}

impl Charted {
    fn new(of: &str, chart: Chart, names: Vec<String>) -> Self {
        Self {
            of: of.to_owned(),
            first: 0,
            names,
            chart,
        }
    }

    /// Keeps the last `shown` points, with their names and rule violations; violations are numbered from the first kept
    /// point.
    #[must_use]
    pub fn last(mut self, shown: usize) -> Self {
        let left_out = self.chart.points.len().saturating_sub(shown);
        self.chart.points.drain(..left_out);
        self.names.drain(..left_out.min(self.names.len()));
        self.chart.signals.retain(|it| it.at >= left_out);
        for signal in &mut self.chart.signals {
            signal.at -= left_out;
        }
        self.first += left_out;
        self
    }
}

fn of_parameter(
    archive: &Archive,
    filter: &Filter,
    param: &str,
    (subgroup, rules): (u8, Rules),
) -> Result<Vec<Charted>> {
    let values = archive.values(param, filter)?.values;
    let charts = match subgroup {
        1 => individuals(&values, rules),
        size => subgroups(&values, usize::from(size), rules),
    };
    let charted = |chart| Charted::new(param, chart, Vec::new());
    Ok(charts.into_iter().flatten().map(charted).collect())
}

/// Computes a chart for each bin that has parts in at least one of the runs.
fn of_bins(runs: &[LotSummary]) -> Vec<Charted> {
    let bins: BTreeSet<&String> = runs.iter().flat_map(|run| run.bins.keys()).collect();
    let names: Vec<String> = runs
        .iter()
        .map(|run| format!("{}/{}", run.lot, run.run))
        .collect();
    let charted = |bin: &String| {
        let groups: Vec<(u64, u64)> = runs
            .iter()
            .map(|run| (run.counts.parts, run.bins.get(bin).copied().unwrap_or(0)))
            .collect();
        shares(&groups).map(|chart| Charted::new(bin, chart, names.clone()))
    };
    bins.into_iter().filter_map(charted).collect()
}
