//! Control charts for the wall: one parameter's level and spread, or the share of a bin from lot to lot.

use super::Paper;
use super::charts;
use super::page::{Format, head, page};
use super::words::{Language, figure};
use maud::{Markup, PreEscaped, html};
use quality::chart::Chart;
use quality::rules::Signal;

/// A chart with the names of its points, if they have any.
#[derive(Debug, Clone)]
pub struct Named<'a> {
    /// A parameter key, or a bin.
    pub of: &'a str,
    /// The chart.
    pub chart: &'a Chart,
    /// Under the points; numbers from 1 where there are none.
    pub names: &'a [String],
}

/// The page; of every chart the last `shown` points are drawn.
pub fn spc(paper: &Paper, about: &str, charts: &[Named<'_>], shown: usize) -> String {
    let language = paper.language;
    let heading = language.of("Control charts", "统计过程控制图");
    let body = html! {
        (head(heading, about))
        @for it in charts {
            figure.wide {
                figcaption { (title(language, it)) (cut(language, it.chart.points.len(), shown)) }
                (PreEscaped(charts::control(it.chart, shown, it.names)))
            }
        }
        (legend(language, charts))
    };
    page(language, Format::Landscape, heading, &paper.made, &body)
}

/// What the chart is of, and its kind.
fn title(language: Language, it: &Named<'_>) -> String {
    let of = match it.chart.kind {
        "share" => language.of("bin ", "料箱：").to_owned() + language.bin(it.of),
        _ => language.parameter(it.of),
    };
    format!("{of} – {}", kind(language, it.chart.kind))
}

/// Says that there are more points than are drawn.
fn cut(language: Language, points: usize, shown: usize) -> String {
    match language {
        _ if points <= shown => String::new(),
        Language::En => format!(", the last {shown} of {points} points"),
        Language::Zh => format!("，共 {points} 点，图示最后 {shown} 点"),
    }
}

/// Name of a kind of chart.
fn kind(language: Language, kind: &str) -> &str {
    match kind {
        "individuals" => language.of("individuals", "单值图 (I)"),
        "moving range" => language.of("moving range", "移动极差图 (MR)"),
        "means" => language.of("means of subgroups", "均值图 (X̄)"),
        "ranges" => language.of("ranges of subgroups", "极差图 (R)"),
        "share" => language.of("share of parts (p)", "占比图 (p)"),
        other => other,
    }
}

fn legend(language: Language, charts: &[Named<'_>]) -> Markup {
    html! { div.together {
        table {
            thead { tr {
                th { (language.of("Chart", "控制图")) } th.n { (language.of("Points", "点数")) }
                th.n { (language.of("Centre", "中心线")) } th { (language.of("Signals", "异常信号")) }
            } }
            tbody { @for it in charts { tr {
                td { (title(language, it)) }
                td.n { (it.chart.points.len()) } td.n { (figure(Some(it.chart.centre))) }
                td.text { (told(language, &it.chart.signals)) }
            } } }
        }
        p.note { (language.of(
            "Limits at three deviations from short-term variation. A red point bears the number of the rule that \
             objects: 1 beyond a limit; 2 a run on one side; 3 a trend; 4 up and down in turn; 5 two of three beyond \
             2 sd; 6 four of five beyond 1 sd; 7 all within 1 sd; 8 none within 1 sd.",
            "控制限取短期波动的三倍标准差。红点旁数字为判异准则：1 超出控制限；2 连续同侧；3 连续递增或递减；4 交替升降；5 三点中两点超 2σ；6 五点中四点超 1σ；7 连续在 1σ 内；8 连续在 1σ 外。"
        )) }
    } }
}

fn told(language: Language, signals: &[Signal]) -> String {
    if signals.is_empty() {
        return language.of("none", "无").to_owned();
    }
    let one = |rule: u8| {
        let count = signals.iter().filter(|it| it.rule == rule).count();
        let name = language.of("rule", "准则");
        (count > 0).then(|| format!("{name} {rule}: {count}"))
    };
    (1..=8).filter_map(one).collect::<Vec<_>>().join(", ")
}
