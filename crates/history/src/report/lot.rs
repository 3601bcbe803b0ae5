//! Printable report of a lot: counts, reasons, capability, use of time, results from outside of the
//! rig, alarms, answers to prompts, rejects.

use super::page::{Format, facts, head, page, sign_off};
use super::words::{figure, parameter, percent, short_hash, span, unbroken};
use super::{Paper, alarms, external, pareto};
use super::{batch, charts};
use crate::inquiry::pareto::Rejects;
use crate::{
    Alarm, Batch, ExternalResult, ExternalStanding, LotSummary, LotYield, PromptAnswer, Reopening,
};
use maud::{Markup, PreEscaped, html};
use quality::capability::{Index, by_percentiles};
use quality::effectiveness::Effectiveness;
use quality::{Capability, Limits, Ordered, Spread, capability::D2_PAIR, spread};
use texts::{Lang, Message};

/// Data of a lot report.
#[derive(Debug, Clone)]
pub struct LotReport<'a> {
    /// Name of the lot.
    pub lot: &'a str,
    /// Runs of the lot, at least one.
    pub runs: &'a [LotSummary],
    /// Decisions to open the complete lot again.
    pub reopenings: &'a [Reopening],
    /// Yield over the runs.
    pub counts: LotYield,
    /// Values of each parameter.
    pub parameters: Vec<ParameterValues>,
    /// Use of the time; `None` for an import.
    pub effectiveness: Option<Effectiveness>,
    /// Batches with the curves of their chamber; none on a rig that tests part by part.
    pub batches: &'a [Batch],
    /// Rejects with their reasons.
    pub rejects: Rejects,
    /// Results from outside of the rig.
    pub external: &'a [ExternalResult],
    /// Whether the lot is acceptable by them; `None` for a lot that has and needs none.
    pub standing: Option<ExternalStanding>,
    /// Alarms in order of time.
    pub alarms: &'a [Alarm],
    /// Answers to prompts in order of time.
    pub answers: &'a [PromptAnswer],
}

/// Values of one parameter.
#[derive(Debug, Clone)]
pub struct ParameterValues {
    /// Key of the parameter.
    pub key: String,
    /// Limits that all runs share; none when limits differ.
    pub limits: Limits,
    /// Values in order of time.
    pub values: Vec<f64>,
}

impl LotReport<'_> {
    /// Returns the report as HTML.
    pub fn html(&self, paper: &Paper) -> String {
        let language = paper.language;
        let title = language.text("paper-lot_report");
        let body = html! {
            (head(title, &self.about(language)))
            (self.facts(paper))
            @for it in self.reopenings { p.remark { (reopening(paper, it)) } }
            h2 { (language.text("paper-result")) }
            (external::standing(language, self.standing.as_ref()))
            (self.counts(language))
            (pareto::pareto(language, language.text("paper-reasons"), &self.rejects.reasons, Some(self.rejects.parts)))
            h2 { (language.text("paper-parameters")) }
            (self.table(language))
            p.note { (language.text("paper-capability_note")) }
            (self.histograms(language))
            (external::table(paper, self.external))
            @if let Some(it) = &self.effectiveness { (use_of_time(language, it)) }
            @if !self.batches.is_empty() { (batch::all(paper, self.batches)) }
            h2 { (language.text("paper-alarms")) }
            (alarms::ranked(language, self.alarms))
            (alarms::table(paper, self.alarms))
            @if !self.answers.is_empty() { (answers(paper, self.answers)) }
            h2 { (language.text("paper-rejects")) }
            (pareto::rejects(language, &self.rejects))
            (external::remark(language, !self.external.is_empty()))
            (sign_off(language))
        };
        let title = format!("{title} {}", self.lot);
        page(paper, Format::Portrait, &title, &body)
    }

    fn about(&self, language: Lang) -> String {
        format!("{} {}", language.text("paper-lot"), self.lot)
    }

    fn facts(&self, paper: &Paper) -> Markup {
        let language = paper.language;
        let say = |id| language.text(id);
        let all = |text: &dyn Fn(&LotSummary) -> String| {
            let mut texts: Vec<String> = self.runs.iter().map(text).collect();
            texts.dedup();
            texts.join(", ")
        };
        let calibration = |it: &LotSummary| {
            it.calibration_hash
                .as_deref()
                .map_or("–".into(), short_hash)
        };
        let open = say("paper-not_closed").to_owned();
        facts(&[
            (say("paper-recipe"), all(&|it| it.recipe.clone())),
            (
                say("paper-recipe_sha_256"),
                all(&|it| short_hash(&it.recipe_hash)),
            ),
            (say("paper-runs"), self.runs.len().to_string()),
            (say("paper-calibration_sha_256"), all(&calibration)),
            (
                say("paper-opened"),
                self.runs
                    .first()
                    .map_or(String::new(), |it| paper.time(it.opened)),
            ),
            (
                say("paper-closed"),
                self.runs
                    .last()
                    .and_then(|it| it.closed)
                    .map_or(open, |at| paper.time(at)),
            ),
            (
                say("paper-measured_on"),
                all(&|it| source(language, &it.source).to_owned()),
            ),
            (
                say("paper-reference_parts"),
                self.runs
                    .iter()
                    .map(|it| it.golden)
                    .sum::<u64>()
                    .to_string(),
            ),
        ])
    }

    fn counts(&self, language: Lang) -> Markup {
        let say = |id| language.text(id);
        let sum = |count: fn(&LotSummary) -> u64| self.runs.iter().map(count).sum::<u64>();
        let tests = sum(|it| it.counts.parts);
        let again = |it: &LotSummary| {
            if it.retest.is_some() {
                it.counts.parts
            } else {
                0
            }
        };
        let retests = sum(again);
        let verdicts = [
            ("pass", sum(|it| it.counts.pass)),
            ("fail", sum(|it| it.counts.fail)),
            ("void", sum(|it| it.counts.void)),
        ];
        html! {
            table {
                thead { tr {
                    th.n { (say("paper-tested")) } th.n { (say("paper-retests")) }
                    @for (verdict, _) in verdicts { th.n { (language.name("paper_verdict", verdict)) } }
                    th.n { (say("paper-first_pass_yield")) }
                    th.n { (say("paper-final_yield")) }
                } }
                tbody { tr {
                    td.n { (tests - retests) } td.n { (retests) }
                    @for (verdict, n) in verdicts { td.n { span class=(verdict) { (n) } } }
                    td.n { (percent(self.counts.first_pass, self.counts.parts)) }
                    td.n { (percent(self.counts.finally(), self.counts.parts)) }
                } }
            }
            (self.bins(language, tests))
        }
    }

    fn bins(&self, language: Lang, tests: u64) -> Markup {
        let mut bins = std::collections::BTreeMap::<&str, u64>::new();
        for (bin, n) in self.runs.iter().flat_map(|it| &it.bins) {
            *bins.entry(bin).or_default() += n;
        }
        let mut bins: Vec<_> = bins.into_iter().collect();
        bins.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        html! {
            table style="margin-top:2mm" {
                thead { tr {
                    th style="width:22%" { (language.text("paper-bin")) }
                    th.n style="width:14%" { (language.text("paper-tests")) }
                    th.n style="width:14%" { (language.text("paper-share")) }
                    th {}
                } }
                tbody { @for (bin, n) in bins { tr {
                    td { (language.name("bin", bin)) } td.n { (n) } td.n { (percent(n, tests)) }
                    td { (PreEscaped(charts::share(n as f64 / tests.max(1) as f64))) }
                } } }
            }
        }
    }

    fn table(&self, language: Lang) -> Markup {
        let say = |id| language.text(id);
        let tests = self.runs.iter().map(|it| it.counts.parts).sum();
        html! {
            table {
                thead { tr {
                    th { (say("paper-parameter")) } th.n { "n" }
                    th.n { (say("paper-limits")) } th.n { (say("paper-mean")) }
                    th.n { (say("paper-sd")) } th.n { (say("paper-min")) }
                    th.n { (say("paper-median")) } th.n { (say("paper-max")) }
                    th.n { "Cpk" } th.n { "Ppk" } th.n { (say("paper-skewed")) }
                } }
                tbody { @for it in &self.parameters { (row(language, it, tests)) } }
            }
        }
    }

    fn histograms(&self, language: Lang) -> Markup {
        html! {
            div.figures style="margin-top:3mm" {
                @for it in &self.parameters {
                    @if let Some(svg) = charts::histogram(&Ordered::of(&it.values), it.limits) {
                        figure { figcaption { (parameter(language, &it.key)) } (PreEscaped(svg)) }
                    }
                }
            }
        }
    }
}

fn answers(paper: &Paper, answers: &[PromptAnswer]) -> Markup {
    let say = |id| paper.language.text(id);
    html! {
        h2 { (say("paper-answers")) }
        table {
            thead { tr {
                th { (say("paper-answered")) } th.n { (say("paper-run")) } th { (say("paper-prompt")) }
                th { (say("paper-answer")) } th { (say("paper-answered_by")) }
            } }
            tbody { @for it in answers { tr {
                td { (paper.time(it.at)) } td.n { @if let Some(run) = it.run { (run) } }
                td.text { (it.prompt) } td.text { (it.choice) } td.text { (it.who) }
            } } }
        }
    }
}

fn reopening(paper: &Paper, it: &Reopening) -> String {
    Message::new("paper", "reopened")
        .with("at", paper.time(it.at))
        .with("who", &it.who)
        .with("why", &it.why)
        .say(paper.language)
}

fn row(language: Lang, it: &ParameterValues, tests: u64) -> Markup {
    let moments = Spread::of(&it.values);
    let ordered = Ordered::of(&it.values);
    let within = spread::mean_moving_range(&it.values).map(|range| range / D2_PAIR);
    let able = Capability::of(it.limits, moments.n(), moments.mean(), within, moments.sd());
    let n = match moments.n() {
        n if n < tests => format!("{n} / {tests}"),
        n => n.to_string(),
    };
    let figures = [
        moments.mean(),
        moments.sd(),
        moments.min(),
        ordered.quantile(0.5),
        moments.max(),
    ];
    html! { tr {
        td { (unbroken(&parameter(language, &it.key))) } td.n { (unbroken(&n)) }
        td.n { (limits(it.limits)) }
        @for value in figures { td.n { (figure(value)) } }
        td.n { (index(able.cpk)) } td.n { (index(able.ppk)) }
        td.n { (by_percentiles(it.limits, &ordered).map_or("–".to_owned(), |it| format!("{it:.2}"))) }
    } }
}

fn index(index: Option<Index>) -> Markup {
    html! {
        @if let Some(it) = index {
            (format!("{:.2}", it.value))
            @if let Some(ends) = it.interval {
                br; span.note { (format!("{:.2}…{:.2}", ends.low, ends.high)) }
            }
        } @else { "–" }
    }
}

/// Formats limits as `≥ low`, `≤ high` or `low … high`.
pub(super) fn limits(limits: Limits) -> String {
    match (limits.low, limits.high) {
        (None, None) => "–".to_owned(),
        (Some(low), None) => format!("≥ {}", figure(Some(low))),
        (None, Some(high)) => format!("≤ {}", figure(Some(high))),
        (Some(low), Some(high)) => format!("{} … {}", figure(Some(low)), figure(Some(high))),
    }
}

/// Returns the name of the source of a run.
pub(super) fn source(language: Lang, source: &str) -> &str {
    match source {
        "rig" => language.text("paper-test_rig"),
        "simulated" => language.text("paper-simulated_rig"),
        "import" => language.text("paper-imported_file"),
        other => other,
    }
}

fn use_of_time(language: Lang, it: &Effectiveness) -> Markup {
    let say = |id| language.text(id);
    let share = |part: f64| format!("{:.1} %", 100.0 * part);
    html! {
        h2 { (say("paper-oee")) }
        table {
            thead { tr {
                th.n { "OEE" } th.n { (say("paper-availability")) }
                th.n { (say("paper-performance")) } th.n { (say("paper-quality")) }
                th.n { (say("paper-lost_alarms")) } th.n { (say("paper-lost_setup")) }
                th.n { (say("paper-lost_slow_cycles")) } th.n { (say("paper-lost_rejects")) }
            } }
            tbody { tr {
                td.n { (share(it.oee)) } td.n { (share(it.availability)) }
                td.n { (share(it.performance)) } td.n { (share(it.quality)) }
                td.n { (span(it.stopped_s)) } td.n { (span(it.setup_s)) } td.n { (span(it.slow_s)) }
                td.n { (span(it.rejected_s)) }
            } }
        }
    }
}
