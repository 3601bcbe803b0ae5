//! Shows a run on the page: the lot when it begins, then every judged part. The results of a lot stay on the page until
//! the next lot begins.

use super::event::{LotEvent, Subscriber};
use super::progress::LotProgress;
use super::{LotContext, rows};
use crate::traces::Traces;
use cycle::Event;
use machine::handling::ledger::PartRole;
use machine::handling::output::Judged;
use machine::view::{LastPart, RecentPart, RunEnd, View};
use tokio::sync::watch;

/// Number of recent parts that the page shows: two rows of ten.
const RECENT: usize = 20;

/// The page's subscriber to the events of one run.
pub(super) struct Screen {
    /// Sends the view to the screens.
    pub view: watch::Sender<View>,
    /// Traffic and health of the lines.
    pub traces: Traces,
}

impl Subscriber for Screen {
    fn receive(&mut self, event: &LotEvent, lot: &LotProgress<'_>) {
        let (lines, instruments) = (|| self.traces.health(), || self.traces.instruments());
        let between = lot.context.purpose.is_between_lots();
        match event {
            LotEvent::Begun if between => self.view.send_modify(|view| {
                view.simulated = lot.context.is_simulated();
                view.under_way = false;
                view.instruments = instruments();
            }),
            LotEvent::Begun => self.view.send_modify(|view| {
                begun(view, &lot.context);
                view.instruments = instruments();
            }),
            LotEvent::Cycle(Event::Alarm(..)) => {
                let (lines, instruments) = (lines(), instruments());
                self.view.send_modify(|view| {
                    (view.lines, view.instruments) = (lines, instruments);
                });
            }
            LotEvent::Cycle(Event::Judged(it)) if is_shown(it, between) => {
                let (lines, instruments) = (lines(), instruments());
                self.view.send_modify(|view| {
                    (view.lines, view.instruments) = (lines, instruments);
                    judged(view, lot, it);
                });
            }
            LotEvent::PartDone(part, Some(_)) if is_shown(&part.judged, between) => {
                let bins = lot.counts.bins.clone();
                self.view.send_modify(|view| view.bins = bins);
            }
            LotEvent::Ended(summary) if !between => {
                let cause = summary.cause.clone();
                let (cause, cause_text) = cause.map(|it| (it.code, it.text)).unzip();
                let ended = RunEnd {
                    lot: lot.context.order.lot.clone(),
                    ended: summary.ended.to_owned(),
                    cause,
                    cause_text,
                };
                self.view.send_modify(|view| view.last_run = Some(ended));
            }
            LotEvent::Cycle(_)
            | LotEvent::PartDone(..)
            | LotEvent::TracesKept(_)
            | LotEvent::Ended(_) => {}
        }
    }
}

/// Returns true for a production part of a lot; the page shows neither reference parts nor parts judged between lots.
fn is_shown(judged: &Judged, between_lots: bool) -> bool {
    !between_lots && matches!(judged.part.role, PartRole::Lot(_))
}

/// Shows the lot and its limits.
fn begun(view: &mut View, context: &LotContext) {
    let limits = context.recipe.limits();
    *view = View {
        simulated: context.is_simulated(),
        lot: context.order.lot.clone(),
        under_way: true,
        recipe: context.recipe.name.clone(),
        count: context.order.count,
        limits: limits
            .map(|(parameter, limit)| (parameter.key().to_owned(), [limit.low, limit.high]))
            .collect(),
        at_us: view.at_us,
        alarms: std::mem::take(&mut view.alarms),
        machine: std::mem::take(&mut view.machine),
        last_run: view.last_run.take(),
        fleet: std::mem::take(&mut view.fleet),
        ..View::default()
    };
}

/// Shows the newly judged part, with the counts.
fn judged(view: &mut View, lot: &LotProgress, judged: &Judged) {
    let verdicts = lot.counts.verdicts.iter();
    view.judged = lot.counts.parts();
    view.verdicts = verdicts.map(|(name, n)| ((*name).to_owned(), *n)).collect();
    view.parts_per_hour = lot.per_hour(judged.at);
    let json = rows::json(&lot.context, judged, None, "");
    let numbers = |key: &str| {
        let all = json[key].as_object().into_iter().flatten();
        all.filter_map(|(key, value)| Some((key.clone(), value.as_f64()?)))
            .collect()
    };
    let last = LastPart {
        seq: rows::number(&judged.part.role, 0).0,
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
