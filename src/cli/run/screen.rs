//! What screens are told of a run: the lot when it begins, then every judged part.

use super::counts::Counts;
use super::recorder::Setup;
use super::rows;
use crate::station::wants::Judged;
use crate::view::{LastPart, LineView, RecentPart, View};
use std::collections::BTreeMap;

/// Parts in the strip of the last ones: two rows of ten.
const RECENT: usize = 20;

/// The lot and the limits it is judged by.
pub fn begun(view: &mut View, setup: &Setup) {
    view.simulated = setup.args.rig.sim;
    view.lot.clone_from(&setup.args.lot);
    view.recipe.clone_from(&setup.recipe.name);
    view.count = setup.args.count;
    let limits = setup.recipe.limits.iter();
    view.limits = limits
        .map(|(parameter, limit)| (parameter.name().to_owned(), [limit.low, limit.high]))
        .collect();
}

/// The part judged last, and the counts with it.
pub fn judged(
    view: &mut View,
    setup: &Setup,
    counts: &Counts,
    judged: &Judged,
    per_hour: Option<f64>,
    lines: Vec<LineView>,
) {
    view.lines = lines;
    view.judged = counts.parts();
    view.verdicts = named(&counts.verdicts);
    view.bins = named(&counts.bins);
    view.parts_per_hour = per_hour;
    let json = rows::json(setup, judged, None, "");
    let numbers = |key: &str| serde_json::from_value(json[key].clone()).unwrap_or_default();
    let last = LastPart {
        seq: rows::number(&judged.part.kind, 0).0,
        verdict: judged.verdict.name().into(),
        bin: judged.part.bin.map_or("", |bin| bin.name()).into(),
        reasons: judged.verdict.reasons(),
        values: numbers("values"),
        uncertainty: numbers("uncertainty"),
    };
    view.recent.push(RecentPart {
        seq: last.seq,
        verdict: last.verdict.clone(),
        bin: last.bin.clone(),
    });
    let older = view.recent.len().saturating_sub(RECENT);
    view.recent.drain(..older);
    view.last = Some(last);
}

fn named(counts: &BTreeMap<&'static str, u64>) -> BTreeMap<String, u64> {
    let named = counts.iter().map(|(name, n)| ((*name).to_owned(), *n));
    named.collect()
}
