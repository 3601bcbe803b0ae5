//! `GET /metrics`: the view as Prometheus text (exposition format 0.0.4).
//!
//! Figures of the lot are gauges, because each lot starts them at zero. An unknown figure is absent rather than zero.

use super::answers::{As, Prometheus};
use super::router::App;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use machine::view::{FleetView, LatenessView, ModuleView, View};
use prometheus_client::collector::Collector;
use prometheus_client::encoding::text::encode_registry;
use prometheus_client::encoding::{DescriptorEncoder, EncodeGaugeValue, NoLabelSet};
use prometheus_client::metrics::MetricType;
use prometheus_client::registry::Registry;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::Ordering;

/// `GET /metrics`.
pub(super) async fn metrics(State(app): App) -> As<Prometheus, impl IntoResponse> {
    let alive = app.shared.view.has_changed().is_ok();
    let streams = app.streams.load(Ordering::Relaxed);
    let view = app.shared.view.borrow().clone();
    let media_type = [(CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")];
    let text = text(Scrape {
        view,
        alive,
        streams,
    });
    As::new((media_type, text))
}

fn text(scrape: Scrape) -> String {
    let mut registry = Registry::default();
    registry.register_collector(Box::new(scrape));
    let mut text = String::new();
    // `encode` would add `# EOF`, the end mark of OpenMetrics, which the Prometheus format does not have.
    encode_registry(&mut text, &registry).expect("writing to a String cannot fail");
    text
}

/// State of rig and program that one request for metrics reports.
#[derive(Debug)]
struct Scrape {
    view: View,
    /// True while a controller publishes views.
    alive: bool,
    streams: usize,
}

impl Collector for Scrape {
    fn encode(&self, encoder: DescriptorEncoder<'_>) -> fmt::Result {
        let mut out = Figures(encoder);
        self.program(&mut out)?;
        parts(&mut out, &self.view)?;
        modules(&mut out, &self.view)?;
        let lines = self.view.lines.iter();
        let lost = lines.map(|line| ([("line", line.name.as_str())], line.ports_lost));
        let help = "Transactions that found no port.";
        out.known("relayrig_line_ports_lost", help, lost)?;
        instruments(&mut out, &self.view)?;
        fleet(&mut out, &self.view)?;
        out.lateness(&self.view.host.lateness)
    }
}

impl Scrape {
    fn program(&self, out: &mut Figures<'_>) -> fmt::Result {
        let view = &self.view;
        let about = [
            ("lot", view.lot.as_str()),
            ("recipe", &view.recipe),
            ("state", &view.state),
        ];
        let help = "What is being done; always 1.";
        out.each("relayrig_info", help, [(about, 1_u64)])?;
        let (up, simulated) = (u64::from(self.alive), u64::from(view.simulated));
        out.one("relayrig_up", "1 while a controller makes views.", up)?;
        let help = "1 if the rig is simulated.";
        out.one("relayrig_simulated", help, simulated)?;
        out.one("relayrig_screens", "Open streams of events.", self.streams)
    }
}

fn instruments(out: &mut Figures<'_>, view: &View) -> fmt::Result {
    let each = view.instruments.iter();
    let programs = each.map(|it| ([("instrument", it.name.as_str())], it.programs));
    let help = "Programs of an instrument.";
    out.known("relayrig_instrument_programs", help, programs)?;
    let failures = view.instruments.iter().flat_map(|it| {
        let kinds = it.failures.iter();
        kinds.map(|(kind, n)| ([("instrument", it.name.as_str()), ("kind", kind)], *n))
    });
    let help = "Failed programs of an instrument, by kind.";
    out.known("relayrig_instrument_failures", help, failures)
}

/// Writes the parts that each database of `fleet.toml` lacks, and the state of sending.
fn fleet(out: &mut Figures<'_>, view: &View) -> fmt::Result {
    fn of(it: &FleetView) -> [Label<'_>; 1] {
        [("target", it.url.as_str())]
    }
    let each = || view.fleet.iter();
    let help = "Parts that a database of the fleet lacks.";
    let lag = each().map(|it| (of(it), it.lag_parts));
    out.each("relayrig_fleet_lag_parts", help, lag)?;
    let help = "Age of the oldest part that a database of the fleet lacks.";
    let lag = each().map(|it| (of(it), it.lag_s));
    out.each("relayrig_fleet_lag_seconds", help, lag)?;
    let help = "1 when that age is past alarm_after_s.";
    let late = each().map(|it| (of(it), u64::from(it.late)));
    out.each("relayrig_fleet_late", help, late)?;
    let help = "1 when the last attempt to send to a database of the fleet failed.";
    let failed = each().map(|it| (of(it), u64::from(it.last_error.is_some())));
    out.each("relayrig_fleet_failing", help, failed)
}

fn parts(out: &mut Figures<'_>, view: &View) -> fmt::Result {
    let help = "Parts of the lot judged.";
    out.one("relayrig_lot_parts_judged", help, view.judged)?;
    if let Some(count) = view.count {
        out.one(
            "relayrig_lot_parts_wanted",
            "Parts of the lot wanted.",
            count,
        )?;
    }
    let help = "Parts between pocket and beam.";
    out.one("relayrig_parts_inside", help, view.inside)?;
    let help = "Parts that came in, reference parts too.";
    out.one("relayrig_parts_came_in", help, view.came_in)?;
    let help = "Parts a beam confirmed, reference parts too.";
    out.one("relayrig_parts_went_out", help, view.went_out)?;
    if let Some(rate) = view.parts_per_hour.filter(|it| it.is_finite()) {
        out.one(
            "relayrig_lot_parts_per_hour",
            "Parts per hour of rig time.",
            rate,
        )?;
    }
    let help = "Confirmed parts of the lot.";
    out.each("relayrig_lot_parts_in_bin", help, by("bin", &view.bins))?;
    let help = "Verdicts of the lot.";
    out.each("relayrig_lot_verdicts", help, by("verdict", &view.verdicts))?;
    let help = "Alarms shown, by code.";
    out.each("relayrig_alarms", help, by("code", &alarms(view)))?;
    let help = "Wall time of the cycle in each phase of its turns.";
    let phases = by("phase", &view.machine.phases_s);
    out.each("relayrig_cycle_seconds", help, phases)
}

/// A figure of each module: name without the common prefix, help text, and the function that returns the value.
type Figure<V> = (&'static str, &'static str, fn(&ModuleView) -> V);

const COUNTS: [Figure<u64>; 6] = [
    ("transactions", "Tries, repeats included.", |it| {
        it.transactions
    }),
    ("time_outs", "Tries without a whole reply in time.", |it| {
        it.time_outs
    }),
    ("checksum_errors", "Replies that did not add up.", |it| {
        it.checksum_errors
    }),
    ("other_errors", "Replies wrong in another way.", |it| {
        it.other_errors
    }),
    ("refusals", "Answers that said no.", |it| it.refusals),
    ("resets", "Restarts that were noticed.", |it| it.resets),
];
const LATENCIES: [Figure<Option<f64>>; 2] = [
    (
        "latency_p50_ms",
        "Median latency, wire time left out.",
        |it| it.p50_ms,
    ),
    ("latency_p99_ms", "Latency that 99 of 100 keep.", |it| {
        it.p99_ms
    }),
];

/// Writes the health of the modules: every figure with one row per module.
fn modules(out: &mut Figures<'_>, view: &View) -> fmt::Result {
    let labelled = || {
        view.lines.iter().flat_map(|line| {
            let rows = line.modules.iter();
            rows.map(|it| ([("line", &*line.name), ("address", &*it.address)], it))
        })
    };
    for (name, help, figure) in COUNTS {
        let rows = labelled().map(|(labels, it)| (labels, figure(it)));
        out.known(&format!("relayrig_module_{name}"), help, rows)?;
    }
    for (name, help, figure) in LATENCIES {
        let rows = labelled().filter_map(|(labels, it)| Some((labels, figure(it)?)));
        out.known(&format!("relayrig_module_{name}"), help, rows)?;
    }
    Ok(())
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

/// Returns one row for each entry of a table, with the key as value of `label`.
fn by<'a, V: Copy>(
    label: &'static str,
    table: &'a BTreeMap<String, V>,
) -> impl Iterator<Item = ([Label<'a>; 1], V)> {
    let rows = table.iter();
    rows.map(move |(key, value)| ([(label, key.as_str())], *value))
}

struct Figures<'a>(DescriptorEncoder<'a>);

impl Figures<'_> {
    fn one(&mut self, name: &str, help: &str, value: impl EncodeGaugeValue) -> fmt::Result {
        let mut figure = self
            .0
            .encode_descriptor(name, help, None, MetricType::Gauge)?;
        figure.encode_gauge(&value)
    }

    /// Writes the lateness of the cycle as a histogram; virtual time has none.
    fn lateness(&mut self, it: &LatenessView) -> fmt::Result {
        if it.waits == 0 {
            return Ok(());
        }
        let (name, help) = (
            "relayrig_cycle_lateness_seconds",
            "How late the cycle woke.",
        );
        let mut figure = self
            .0
            .encode_descriptor(name, help, None, MetricType::Histogram)?;
        let mut buckets: Vec<(f64, u64)> = it
            .buckets
            .iter()
            .map(|it| (it.up_to_ms / 1e3, it.count))
            .collect();
        let counted: u64 = buckets.iter().map(|it| it.1).sum();
        buckets.push((f64::INFINITY, it.waits - counted));
        figure.encode_histogram::<NoLabelSet>(it.sum_ms / 1e3, it.waits, &buckets, None)
    }

    /// Writes a figure, with one row for each set of labels.
    fn each<'a, const N: usize, V: EncodeGaugeValue>(
        &mut self,
        name: &str,
        help: &str,
        rows: impl IntoIterator<Item = ([Label<'a>; N], V)>,
    ) -> fmt::Result {
        let mut figure = self
            .0
            .encode_descriptor(name, help, None, MetricType::Gauge)?;
        for (labels, value) in rows {
            figure.encode_family(&labels)?.encode_gauge(&value)?;
        }
        Ok(())
    }

    /// Writes as [`Self::each`] does, but omits a figure without rows.
    fn known<'a, const N: usize, V: EncodeGaugeValue>(
        &mut self,
        name: &str,
        help: &str,
        rows: impl Iterator<Item = ([Label<'a>; N], V)>,
    ) -> fmt::Result {
        let mut rows = rows.peekable();
        match rows.peek() {
            Some(_) => self.each(name, help, rows),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use machine::view::{Bucket, InstrumentView};

    #[test]
    fn figures_have_a_type_and_unknown_ones_are_absent() {
        let view = View {
            judged: 7,
            ..View::default()
        };
        let text = text(Scrape {
            view,
            alive: true,
            streams: 2,
        });
        assert!(
            text.contains("# TYPE relayrig_lot_parts_judged gauge\nrelayrig_lot_parts_judged 7\n")
        );
        assert!(text.contains("relayrig_up 1\n") && text.contains("relayrig_screens 2\n"));
        assert!(!text.contains("wanted") && !text.contains("per_hour"));
    }

    #[test]
    fn lateness_is_a_histogram() {
        let mut view = View::default();
        let bucket = |up_to_ms, count| Bucket { up_to_ms, count };
        view.host.lateness = LatenessView {
            waits: 10,
            sum_ms: 5.0,
            buckets: vec![bucket(0.064, 7), bucket(0.128, 2)],
            ..LatenessView::default()
        };
        let text = text(Scrape {
            view,
            alive: true,
            streams: 0,
        });
        let name = "relayrig_cycle_lateness_seconds";
        for row in [
            "_sum 0.005",
            "_count 10",
            "_bucket{le=\"0.000064\"} 7",
            "_bucket{le=\"0.000128\"} 9",
            "_bucket{le=\"+Inf\"} 10",
        ] {
            assert!(text.contains(&format!("{name}{row}\n")), "{row}: {text}");
        }
    }

    #[test]
    fn an_instrument_has_programs_and_failures_by_kind() {
        let meter = InstrumentView {
            name: "meter".into(),
            programs: 12,
            failures: [("timeout".to_owned(), 2)].into(),
            ..InstrumentView::default()
        };
        let view = View {
            instruments: vec![meter],
            ..View::default()
        };
        let text = text(Scrape {
            view,
            alive: true,
            streams: 0,
        });
        for row in [
            "relayrig_instrument_programs{instrument=\"meter\"} 12\n",
            "relayrig_instrument_failures{instrument=\"meter\",kind=\"timeout\"} 2\n",
        ] {
            assert!(text.contains(row), "{row}: {text}");
        }
    }

    #[test]
    fn a_lot_with_quotes_breaks_no_line() {
        let view = View {
            lot: "a\"b\\c\nd".into(),
            ..View::default()
        };
        let text = text(Scrape {
            view,
            alive: true,
            streams: 0,
        });
        assert!(text.contains(r#"lot="a\"b\\c\nd""#));
    }
}
