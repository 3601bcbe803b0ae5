//! `GET /metrics`: the view as Prometheus text (exposition format 0.0.4).
//!
//! Figures of the lot are gauges, for they begin anew with each lot. A figure that is not known is
//! left out; zero would be a statement.

use super::router::Desk;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use machine::view::{ModuleView, View};
use std::collections::BTreeMap;
use std::fmt::{Display, Write};
use std::sync::atomic::Ordering;

/// `GET /metrics`.
pub(super) async fn metrics(State(desk): State<Desk>) -> impl IntoResponse {
    let alive = desk.shared.view.has_changed().is_ok();
    let screens = desk.screens.load(Ordering::Relaxed);
    let text = text(&desk.shared.view.borrow(), alive, screens);
    (
        [(CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")],
        text,
    )
}

fn text(view: &View, alive: bool, screens: usize) -> String {
    let mut out = Figures::default();
    let about = [
        ("lot", view.lot.as_str()),
        ("recipe", &view.recipe),
        ("state", &view.state),
    ];
    out.named(
        "relayrig_info",
        "What is being done; always 1.",
        &[(&about, 1)],
    );
    out.one(
        "relayrig_up",
        "1 while a controller makes views.",
        u8::from(alive),
    );
    out.one(
        "relayrig_simulated",
        "1 if the rig is simulated.",
        u8::from(view.simulated),
    );
    out.one("relayrig_screens", "Open streams of events.", screens);
    out.one(
        "relayrig_lot_parts_judged",
        "Parts of the lot judged.",
        view.judged,
    );
    if let Some(count) = view.count {
        out.one(
            "relayrig_lot_parts_wanted",
            "Parts of the lot wanted.",
            count,
        );
    }
    out.one(
        "relayrig_parts_inside",
        "Parts between pocket and beam.",
        view.inside,
    );
    out.one(
        "relayrig_parts_came_in",
        "Parts that came in, golden ones too.",
        view.came_in,
    );
    out.one(
        "relayrig_parts_went_out",
        "Parts a beam confirmed, golden ones too.",
        view.went_out,
    );
    if let Some(rate) = view.parts_per_hour.filter(|it| it.is_finite()) {
        out.one(
            "relayrig_lot_parts_per_hour",
            "Parts per hour of rig time.",
            rate,
        );
    }
    out.each(
        "relayrig_lot_parts_in_bin",
        "Confirmed parts of the lot.",
        "bin",
        &view.bins,
    );
    out.each(
        "relayrig_lot_verdicts",
        "Verdicts of the lot.",
        "verdict",
        &view.verdicts,
    );
    out.each(
        "relayrig_alarms",
        "Alarms shown, by code.",
        "code",
        &alarms(view),
    );
    out.each(
        "relayrig_cycle_seconds",
        "Wall time of the cycle in each phase of its turns.",
        "phase",
        &view.machine.phases_s,
    );
    bus(&mut out, view);
    out.0
}

/// How the modules are doing, one row for each.
fn bus(out: &mut Figures, view: &View) {
    /// Name, help, and the figure; none is left out.
    type Figure = (&'static str, &'static str, fn(&ModuleView) -> Option<f64>);
    const FIGURES: [Figure; 8] = [
        ("transactions", "Tries, repeats included.", |it| {
            Some(it.transactions as f64)
        }),
        (
            "latency_p50_ms",
            "Median latency, wire time left out.",
            |it| it.p50_ms,
        ),
        ("latency_p99_ms", "Latency that 99 of 100 keep.", |it| {
            it.p99_ms
        }),
        ("time_outs", "Tries without a whole reply in time.", |it| {
            Some(it.time_outs as f64)
        }),
        ("checksum_errors", "Replies that did not add up.", |it| {
            Some(it.checksum_errors as f64)
        }),
        ("other_errors", "Replies wrong in another way.", |it| {
            Some(it.other_errors as f64)
        }),
        ("refusals", "Answers that said no.", |it| {
            Some(it.refusals as f64)
        }),
        ("resets", "Restarts that were noticed.", |it| {
            Some(it.resets as f64)
        }),
    ];
    let modules = || {
        let lines = view.lines.iter();
        lines.flat_map(|line| line.modules.iter().map(move |module| (line, module)))
    };
    for (name, help, figure) in FIGURES {
        let rows: Vec<([Label<'_>; 2], f64)> = modules()
            .filter_map(|(line, module)| {
                let labels = [("line", line.name.as_str()), ("address", &*module.address)];
                Some((labels, figure(module)?))
            })
            .collect();
        if !rows.is_empty() {
            let rows: Vec<(&[Label<'_>], f64)> = rows
                .iter()
                .map(|(labels, value)| (&labels[..], *value))
                .collect();
            out.named(&format!("relayrig_module_{name}"), help, &rows);
        }
    }
    let lost: Vec<_> = view
        .lines
        .iter()
        .map(|line| ([("line", line.name.as_str())], line.ports_lost))
        .collect();
    if !lost.is_empty() {
        let rows: Vec<(&[Label<'_>], u64)> = lost
            .iter()
            .map(|(labels, value)| (&labels[..], *value))
            .collect();
        out.named(
            "relayrig_line_ports_lost",
            "Transactions that found no port.",
            &rows,
        );
    }
}

fn alarms(view: &View) -> BTreeMap<String, u64> {
    let mut by_code = BTreeMap::new();
    for alarm in &view.alarms {
        *by_code.entry(alarm.code.clone()).or_default() += 1;
    }
    by_code
}

/// A label and its value.
type Label<'a> = (&'static str, &'a str);

#[derive(Default)]
struct Figures(String);

impl Figures {
    fn one(&mut self, name: &str, help: &str, value: impl Display) {
        self.named(name, help, &[(&[], value)]);
    }

    fn each(
        &mut self,
        name: &str,
        help: &str,
        label: &'static str,
        by: &BTreeMap<String, impl Display>,
    ) {
        let labels: Vec<_> = by
            .iter()
            .map(|(key, value)| ([(label, key.as_str())], value))
            .collect();
        let rows: Vec<(&[Label<'_>], _)> =
            labels.iter().map(|(it, value)| (&it[..], *value)).collect();
        self.named(name, help, &rows);
    }

    fn named(&mut self, name: &str, help: &str, rows: &[(&[Label<'_>], impl Display)]) {
        self.line(format_args!("# HELP {name} {help}"));
        self.line(format_args!("# TYPE {name} gauge"));
        for (labels, value) in rows {
            let labels: Vec<String> = labels.iter().map(label).collect();
            match labels.is_empty() {
                true => self.line(format_args!("{name} {value}")),
                false => self.line(format_args!("{name}{{{}}} {value}", labels.join(","))),
            }
        }
    }

    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        writeln!(self.0, "{line}").expect("a String takes every text");
    }
}

fn label((name, value): &Label<'_>) -> String {
    let value = value
        .replace('\\', "\\\\")
        .replace('"', "\\\"")
        .replace('\n', "\\n");
    format!("{name}=\"{value}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_a_type_and_unknown_ones_are_left_out() {
        let view = View {
            judged: 7,
            ..View::default()
        };
        let text = text(&view, true, 2);
        assert!(
            text.contains("# TYPE relayrig_lot_parts_judged gauge\nrelayrig_lot_parts_judged 7\n")
        );
        assert!(text.contains("relayrig_up 1\n") && text.contains("relayrig_screens 2\n"));
        assert!(!text.contains("wanted") && !text.contains("per_hour"));
    }

    #[test]
    fn a_lot_with_quotes_breaks_no_line() {
        let view = View {
            lot: "a\"b\\c\nd".into(),
            ..View::default()
        };
        assert!(text(&view, true, 0).contains(r#"lot="a\"b\\c\nd""#));
    }
}
