//! What screens are told of a run: the lot when it begins, then every judged part. What a lot has come to stays on
//! the screen until the next one begins.

use super::counts::Counts;
use super::recorder::Setup;
use super::rows;
use machine::handling::wants::Judged;
use machine::view::{LastPart, LineView, RecentPart, View};
use std::collections::BTreeMap;

/// Parts in the strip of the last ones: two rows of ten.
const RECENT: usize = 20;

/// The lot and the limits it is judged by.
pub fn begun(view: &mut View, setup: &Setup) {
    let limits = setup.recipe.limits();
    *view = View {
        simulated: setup.args.rig.sim,
        lot: setup.args.lot.clone(),
        under_way: true,
        recipe: setup.recipe.name.clone(),
        count: setup.args.count,
        limits: limits
            .map(|(parameter, limit)| (parameter.key().to_owned(), [limit.low, limit.high]))
            .collect(),
        at_us: view.at_us,
        alarms: std::mem::take(&mut view.alarms),
        machine: std::mem::take(&mut view.machine),
        ..View::default()
    };
}

/// No lot is under way, or not any more.
pub fn between(view: &mut View, setup: &Setup) {
    view.simulated = setup.args.rig.sim;
    view.under_way = false;
}

/// A beam has confirmed a part of the lot.
pub fn landed(view: &mut View, counts: &Counts) {
    view.bins.clone_from(&counts.bins);
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
    view.parts_per_hour = per_hour;
    let json = rows::json(setup, judged, None, "");
    let numbers = |key: &str| serde_json::from_value(json[key].clone()).unwrap_or_default();
    let last = LastPart {
        seq: rows::number(&judged.part.kind, 0).0,
        verdict: judged.verdict.name().into(),
        bin: judged
            .part
            .bin
            .map_or_else(String::new, |bin| bin.to_string()),
        reasons: judged.verdict.texts(),
        reason_codes: judged.verdict.reasons().to_vec(),
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
