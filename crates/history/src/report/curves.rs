//! Curves of a part that did not pass on paper: each record of a digitizer with the instants of results, or the whole
//! test of a part without records.

use super::Paper;
use super::plot::{LIMIT, LINE, Plot, QUIET, ticked};
use crate::Part;
use machine::instrument::curve::Curve;
use maud::{Markup, PreEscaped, html};
use quality::ordered::round_step;
use texts::Lang;

/// Size of the drawing of one signal, px.
const PANEL: [f64; 2] = [720.0, 100.0];
/// Up to as many samples of a signal have a dot each: the line between them is no reading.
const DOTTED: usize = 60;
/// Marks with their colours.
const MARKS: [(&str, &str); 3] = [
    ("next_zero", QUIET),
    ("switch_on", LINE),
    ("switch_off", LIMIT),
];

/// Signals that come first, from top to bottom.
const FIRST: [&str; 4] = [
    "control_voltage",
    "load_voltage",
    "load_current",
    "output_voltage",
];

/// A record of a digitizer, or a whole test. Times are microseconds since 1970 UTC.
struct Record<'a> {
    /// Stage that has read the record; `None` for a whole test.
    stage: Option<&'a str>,
    from_us: i64,
    to_us: i64,
    /// Time from which the drawing counts: the trigger, or the begin of the test.
    zero_us: i64,
}

/// Returns the section with the curves of a part; empty for a part without any.
pub(super) fn of_part(paper: &Paper, part: &Part) -> Markup {
    let language = paper.language;
    let records = records(&part.curves);
    let figures = records.iter().map(|it| figure(language, &part.curves, it));
    html! {
        @if !records.is_empty() {
            h2 { (language.text("h-curves")) }
            @for it in figures { (it) }
            p.note { (language.text("h-curves_note")) }
        }
    }
}

/// Returns the records in order of time; the whole test of a part without records; nothing for a part without curves.
fn records(curves: &[Curve]) -> Vec<Record<'_>> {
    let mut records: Vec<Record<'_>> = Vec::new();
    for curve in curves {
        let Some(stage) = curve.signal.strip_prefix("record.") else {
            continue;
        };
        let ends: Vec<(i64, Option<f64>)> = curve.samples().collect();
        records.extend(ends.chunks_exact(2).map(|both| Record {
            stage: Some(stage),
            from_us: both[0].0,
            to_us: both[1].0,
            zero_us: both[0].0 - (both[0].1.unwrap_or(0.0) * 1e6).round() as i64,
        }));
    }
    records.sort_by_key(|it| it.from_us);
    if records.is_empty() {
        let times = || curves.iter().flat_map(Curve::samples).map(|it| it.0);
        records.extend(
            times()
                .min()
                .zip(times().max())
                .map(|(from_us, to_us)| Record {
                    stage: None,
                    from_us,
                    to_us,
                    zero_us: from_us,
                }),
        );
    }
    records
}

impl Record<'_> {
    /// Returns the samples of a curve in this record: time since its zero, ms, and value.
    fn samples(&self, curve: &Curve) -> Vec<(f64, Option<f64>)> {
        let inside = curve
            .samples()
            .filter(|(at, _)| (self.from_us..=self.to_us).contains(at));
        inside.map(|(at, value)| (self.ms(at), value)).collect()
    }

    fn ms(&self, at_us: i64) -> f64 {
        (at_us - self.zero_us) as f64 / 1e3
    }
}

/// Draws the signals of a record below each other.
fn figure(language: Lang, curves: &[Curve], record: &Record<'_>) -> Markup {
    let is_signal = |it: &&Curve| !it.unit.is_empty() && !it.signal.starts_with("record.");
    let signals = curves
        .iter()
        .filter(is_signal)
        .map(|it| (it, record.samples(it)));
    let has_line = |it: &Vec<(f64, Option<f64>)>| it.iter().filter(|it| it.1.is_some()).count() > 1;
    let mut signals: Vec<_> = signals.filter(|(_, samples)| has_line(samples)).collect();
    signals.sort_by_key(|(curve, _)| {
        let mut first = FIRST.iter();
        first
            .position(|it| *it == short_name(curve))
            .unwrap_or(FIRST.len())
    });
    let marks: Vec<(&str, &str, Vec<f64>)> = MARKS
        .iter()
        .map(|(name, colour)| {
            let own = curves
                .iter()
                .filter(|it| it.signal == format!("mark.{name}"));
            let times = own.flat_map(|it| record.samples(it)).map(|it| it.0);
            (*name, *colour, times.collect())
        })
        .filter(|(_, _, times): &(_, _, Vec<f64>)| !times.is_empty())
        .collect();
    html! {
        @for (place, (curve, samples)) in signals.iter().enumerate() {
            figure.wide style="break-inside:avoid" {
                @if place == 0 {
                    figcaption {
                        (caption(language, record))
                        @for (name, colour, _) in &marks {
                            span style={ "margin-left:6mm;color:" (colour) } { "┆ " (language.name("mark", name)) }
                        }
                    }
                }
                div.note { (name(language, curve)) }
                (PreEscaped(panel(record, samples, &marks, place + 1 == signals.len())))
            }
        }
    }
}

fn caption(language: Lang, record: &Record<'_>) -> String {
    match record.stage {
        None => language.text("curve-test").to_owned(),
        Some(stage) => {
            let stage = language.name("stage", stage);
            format!("{} · {stage}", language.text("curve-record"))
        }
    }
}

/// Returns the name of a signal without that of its instrument.
fn short_name(curve: &Curve) -> &str {
    curve.signal.rsplit('.').next().unwrap_or(&curve.signal)
}

/// Returns the name of a signal with its unit.
fn name(language: Lang, curve: &Curve) -> String {
    let name = language.name("curve", short_name(curve));
    format!("{name} / {}", curve.unit)
}

fn panel(
    record: &Record<'_>,
    samples: &[(f64, Option<f64>)],
    marks: &[(&str, &str, Vec<f64>)],
    is_last: bool,
) -> String {
    let x = [record.ms(record.from_us), record.ms(record.to_us)];
    let values = || samples.iter().filter_map(|it| it.1);
    let range = values().reduce(f64::min).zip(values().reduce(f64::max));
    let (low, high) = range.unwrap_or((0.0, 1.0));
    let room = 0.08 * (high - low);
    let mut plot = Plot::new(PANEL, x, [low - room, high + room]);
    for (_, colour, times) in marks {
        times
            .iter()
            .for_each(|it| plot.vertical_line(*it, colour, ""));
    }
    let points = samples.iter().copied();
    plot.path(points, LINE);
    for (at, value) in samples.iter().filter(|_| samples.len() <= DOTTED) {
        if let Some(value) = value {
            let place = [plot.at_x(*at), plot.at_y(*value)];
            plot.svg.circle(place, 2.2, &format!("fill=\"{LINE}\""));
        }
    }
    let step = round_step((x[1] - x[0]) / 8.0).unwrap_or(1.0);
    let ticks = (x[0] / step).ceil() as i64..=(x[1] / step).floor() as i64;
    for tick in ticks.filter(|_| is_last) {
        let at = tick as f64 * step;
        plot.under(at, &format!("{} ms", ticked(at, step)));
    }
    plot.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use jiff::tz::TimeZone;

    fn curve(signal: &str, unit: &str, begin_us: i64, values: &[f64]) -> Curve {
        Curve {
            signal: signal.to_owned(),
            unit: unit.to_owned(),
            begin_us,
            t_us: (0..values.len() as i64).map(|it| it * 1000).collect(),
            values: values.iter().copied().map(Some).collect(),
        }
    }

    fn drawn(curves: Vec<Curve>) -> String {
        let paper = Paper {
            language: Lang::En,
            zone: TimeZone::UTC,
            made: String::new(),
            simulated: true,
        };
        let part = Part {
            curves,
            ..Part::fixture("A", 1, "fail")
        };
        of_part(&paper, &part).into_string()
    }

    #[test]
    fn a_record_is_drawn_from_its_trigger_with_marks() {
        let page = drawn(vec![
            curve("digitizer.load_voltage", "V", 5_000, &[0.0, 0.0, 8.0]),
            curve("digitizer.control_voltage", "V", 5_000, &[0.0, 5.0, 5.0]),
            curve("mark.switch_on", "", 5_700, &[1.0]),
            curve("mark.switch_off", "", 60_000, &[1.0]),
            curve("record.Timing", "s", 5_000, &[-0.0005, 0.0015]),
            curve("smu_in.read", "", 5_500, &[0.1, 0.2]),
        ]);
        // The second sample of a record is 1 ms behind the first one here; the record has two samples of each signal.
        assert_eq!(page.matches("<svg").count(), 2);
        assert!(page.contains("times") && page.contains("Load voltage / V"));
        assert!(page.contains("switch-on") && !page.contains("switch-off"));
        assert!(page.contains("0 ms"), "{page}");
    }

    #[test]
    fn a_part_without_records_shows_its_whole_test() {
        let page = drawn(vec![
            curve("coil_voltage", "V", 5_000, &[0.0, 5.0, 9.0]),
            curve("board", "", 5_000, &[1.0, 2.0]),
        ]);
        assert_eq!(page.matches("<svg").count(), 1);
        assert!(page.contains("whole test") && page.contains("Coil voltage"));
        assert_eq!(drawn(Vec::new()), "");
    }
}
