//! The report of a lot: what was tested, what came out, how able the process is, what went wrong.

use super::charts;
use super::page::{Format, facts, head, page, sign_off};
use super::words::{Language, figure, percent, span, unbroken};
use super::{Paper, alarms};
use crate::{Alarm, LotSummary, Passed};
use maud::{Markup, PreEscaped, html};
use quality::capability::{Index, by_percentiles};
use quality::effectiveness::Effectiveness;
use quality::{Capability, Limits, Ordered, Spread, capability::D2_PAIR, spread};

/// Everything that the report says.
#[derive(Debug, Clone)]
pub struct LotReport<'a> {
    /// Name of the lot.
    pub lot: &'a str,
    /// Its runs, at least one.
    pub runs: &'a [LotSummary],
    /// Parts that passed.
    pub passed: Passed,
    /// Values in order of time, by parameter.
    pub parameters: Vec<ParameterValues>,
    /// Use of the time, when the lot ran on a rig.
    pub effectiveness: Option<Effectiveness>,
    /// Alarms in order of time.
    pub alarms: &'a [Alarm],
}

/// What was measured of one parameter.
#[derive(Debug, Clone)]
pub struct ParameterValues {
    /// Parameter key.
    pub key: String,
    /// Limits in force.
    pub limits: Limits,
    /// Values in order of time.
    pub values: Vec<f64>,
}

impl LotReport<'_> {
    /// The report as a file of HTML.
    pub fn html(&self, paper: &Paper) -> String {
        let language = paper.language;
        let title = language.of("Lot report", "批次检验报告");
        let body = html! {
            (head(title, &self.about(language)))
            (self.facts(paper))
            h2 { (language.of("Result", "检验结果")) }
            (self.counts(language))
            h2 { (language.of("Parameters", "参数统计")) }
            (self.table(language))
            p.note { (language.of(
                "Cpk from the mean moving range, Ppk from all values, each with its 95 % interval (Bissell). \
                 Skewed: nearer limit by the percentiles 0.135, 50 and 99.865 %.",
                "Cpk 由平均移动极差估计，Ppk 由全部数据估计，括号内为 95 % 置信区间（Bissell）。偏态指数按 0.135 %、50 %、99.865 % 分位数计算。"
            )) }
            (self.histograms(language))
            @if let Some(it) = &self.effectiveness { (use_of_time(language, it)) }
            h2 { (language.of("Alarms", "报警记录")) }
            (alarms::table(paper, self.alarms))
            p.remark { (language.not_tested()) }
            (sign_off(language))
        };
        page(
            language,
            Format::Portrait,
            &format!("{title} {}", self.lot),
            &paper.made,
            &body,
        )
    }

    fn about(&self, language: Language) -> String {
        format!("{} {}", language.of("Lot", "批次"), self.lot)
    }

    fn facts(&self, paper: &Paper) -> Markup {
        let language = paper.language;
        let of = |en, zh| language.of(en, zh);
        let all = |text: &dyn Fn(&LotSummary) -> String| {
            let mut texts: Vec<String> = self.runs.iter().map(text).collect();
            texts.dedup();
            texts.join(", ")
        };
        let short = |hash: &str| hash.get(..16).unwrap_or(hash).to_owned();
        let calibration =
            |it: &LotSummary| it.calibration_hash.as_deref().map_or("–".into(), short);
        let open = of("not closed", "未关闭").to_owned();
        facts(&[
            (of("Recipe", "工艺文件"), all(&|it| it.recipe.clone())),
            (
                of("Recipe SHA-256", "工艺 SHA-256"),
                all(&|it| short(&it.recipe_hash)),
            ),
            (of("Runs", "运行次数"), self.runs.len().to_string()),
            (of("Calibration SHA-256", "校准 SHA-256"), all(&calibration)),
            (
                of("Opened", "开始时间"),
                self.runs
                    .first()
                    .map_or(String::new(), |it| paper.time(it.opened)),
            ),
            (
                of("Closed", "结束时间"),
                self.runs
                    .last()
                    .and_then(|it| it.closed)
                    .map_or(open, |at| paper.time(at)),
            ),
            (
                of("Measured on", "数据来源"),
                all(&|it| source(language, &it.source).to_owned()),
            ),
            (
                of("Golden parts", "标准件"),
                self.runs
                    .iter()
                    .map(|it| it.golden)
                    .sum::<u64>()
                    .to_string(),
            ),
        ])
    }

    fn counts(&self, language: Language) -> Markup {
        let of = |en, zh| language.of(en, zh);
        let sum = |count: fn(&LotSummary) -> u64| self.runs.iter().map(count).sum::<u64>();
        let parts = sum(|it| it.counts.parts);
        let judged = parts - sum(|it| it.counts.unjudged);
        let verdicts = [
            ("pass", sum(|it| it.counts.pass)),
            ("fail", sum(|it| it.counts.fail)),
            ("void", sum(|it| it.counts.void)),
        ];
        html! {
            table {
                thead { tr {
                    th.n { (of("Tested", "检验数")) }
                    @for (verdict, _) in verdicts { th.n { (language.verdict(verdict)) } }
                    th.n { (of("First-pass yield", "一次合格率")) }
                    th.n { (of("Final yield", "最终合格率")) }
                } }
                tbody { tr {
                    td.n { (parts) }
                    @for (verdict, n) in verdicts { td.n { span class=(verdict) { (n) } } }
                    td.n { (percent(self.passed.at_first, judged)) }
                    td.n { (percent(self.passed.finally, judged)) }
                } }
            }
            (self.bins(language, parts))
        }
    }

    fn bins(&self, language: Language, parts: u64) -> Markup {
        let mut bins = std::collections::BTreeMap::<&str, u64>::new();
        for (bin, n) in self.runs.iter().flat_map(|it| &it.bins) {
            *bins.entry(bin).or_default() += n;
        }
        let mut bins: Vec<_> = bins.into_iter().collect();
        bins.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        html! {
            table style="margin-top:2mm" {
                thead { tr {
                    th style="width:22%" { (language.of("Bin", "料箱")) }
                    th.n style="width:14%" { (language.of("Parts", "数量")) }
                    th.n style="width:14%" { (language.of("Share", "占比")) }
                    th {}
                } }
                tbody { @for (bin, n) in bins { tr {
                    td { (language.bin(bin)) } td.n { (n) } td.n { (percent(n, parts)) }
                    td { (PreEscaped(charts::share(n as f64 / parts.max(1) as f64))) }
                } } }
            }
        }
    }

    fn table(&self, language: Language) -> Markup {
        let of = |en, zh| language.of(en, zh);
        html! {
            table {
                thead { tr {
                    th { (of("Parameter", "参数")) } th.n { "n" }
                    th.n { (of("Limits", "限值")) } th.n { (of("Mean", "均值")) }
                    th.n { (of("SD", "标准差")) } th.n { (of("Min", "最小")) }
                    th.n { (of("Median", "中位数")) } th.n { (of("Max", "最大")) }
                    th.n { "Cpk" } th.n { "Ppk" } th.n { (of("skewed", "偏态")) }
                } }
                tbody { @for it in &self.parameters { (row(language, it)) } }
            }
        }
    }

    fn histograms(&self, language: Language) -> Markup {
        html! {
            div.figures style="margin-top:3mm" {
                @for it in &self.parameters {
                    @if let Some(svg) = charts::histogram(&Ordered::of(&it.values), it.limits) {
                        figure { figcaption { (language.parameter(&it.key)) } (PreEscaped(svg)) }
                    }
                }
            }
        }
    }
}

fn row(language: Language, it: &ParameterValues) -> Markup {
    let moments = Spread::of(&it.values);
    let ordered = Ordered::of(&it.values);
    let within = spread::mean_moving_range(&it.values).map(|range| range / D2_PAIR);
    let able = Capability::of(it.limits, moments.n(), moments.mean(), within, moments.sd());
    let figures = [
        moments.mean(),
        moments.sd(),
        moments.min(),
        ordered.quantile(0.5),
        moments.max(),
    ];
    html! { tr {
        td { (unbroken(&language.parameter(&it.key))) } td.n { (moments.n()) }
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

/// As a mathematician writes it.
pub(super) fn limits(limits: Limits) -> String {
    match (limits.low, limits.high) {
        (None, None) => "–".to_owned(),
        (Some(low), None) => format!("≥ {}", figure(Some(low))),
        (None, Some(high)) => format!("≤ {}", figure(Some(high))),
        (Some(low), Some(high)) => format!("{} … {}", figure(Some(low)), figure(Some(high))),
    }
}

/// Where the values of a run come from.
pub(super) fn source(language: Language, source: &str) -> &str {
    match source {
        "rig" => language.of("test rig", "测试台"),
        "simulated" => language.of("SIMULATED RIG", "仿真台（非实测）"),
        "import" => language.of("imported file", "导入文件"),
        other => other,
    }
}

fn use_of_time(language: Language, it: &Effectiveness) -> Markup {
    let of = |en, zh| language.of(en, zh);
    let share = |part: f64| format!("{:.1} %", 100.0 * part);
    html! {
        h2 { (of("Use of the time (OEE)", "设备综合效率 (OEE)")) }
        table {
            thead { tr {
                th.n { "OEE" } th.n { (of("Availability", "时间开动率")) }
                th.n { (of("Performance", "性能开动率")) } th.n { (of("Quality", "合格品率")) }
                th.n { (of("Lost to alarms", "停机损失")) } th.n { (of("Lost to slow cycles", "速度损失")) }
                th.n { (of("Lost to rejects", "不良损失")) }
            } }
            tbody { tr {
                td.n { (share(it.oee)) } td.n { (share(it.availability)) }
                td.n { (share(it.performance)) } td.n { (share(it.quality)) }
                td.n { (span(it.stopped_s)) } td.n { (span(it.slow_s)) } td.n { (span(it.rejected_s)) }
            } }
        }
    }
}
