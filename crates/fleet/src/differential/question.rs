//! One question, and its answer as text.

use super::draw::Draw;
use history::inquiry::rejudge::Rejudging;
use history::inquiry::{InquiryError, charts, comparison, export, figures, paper, pareto};
use history::report::Paper;
use history::{Archive, Filter, OrderChoice, Part};
use jiff::tz::TimeZone;
use machine::dut::Recipe;
use quality::rules::Rules;
use serde::Serialize;
use texts::Lang;

/// A question; its members are the arguments of a command.
#[derive(Debug, Clone)]
pub(super) enum Question {
    Parts(Filter),
    Count(Filter),
    Csv(Filter, Vec<String>),
    Figures(Filter, String),
    Histogram(Filter, String),
    Charts(Filter, Option<String>, u8),
    Compare(String, Vec<String>),
    Rejects(Filter),
    AlarmPareto(Filter),
    Runs(Filter),
    Yield(Filter),
    Alarms(Filter),
    Orders(Filter, OrderChoice),
    Part(String, u64, &'static str),
    Serial(String),
    LotState(String),
    LotReport(Filter),
    Certificate(Filter, u64),
    AlarmList(Filter),
    Rejudge(String, usize),
}

/// Number of kinds of questions.
const KINDS: usize = 20;

/// Refusal of a question, in words.
#[derive(Debug, thiserror::Error)]
#[error("refused: {0}")]
pub(super) struct Refused(String);

type Answer = Result<String, Refused>;

impl Question {
    /// Draws a question.
    pub fn draw(draw: &mut Draw, recipes: usize) -> Self {
        let lot = |draw: &mut Draw| Filter {
            lot: Some(draw.lot()),
            ..Filter::default()
        };
        match draw.below(KINDS) {
            0 => Self::Parts(draw.parts()),
            1 => Self::Count(draw.parts()),
            2 => Self::Csv(draw.parts(), draw.parameters.clone()),
            3 => Self::Figures(draw.parts(), draw.parameter()),
            4 => Self::Histogram(draw.parts(), draw.parameter()),
            5 => {
                let param = (!draw.once_in(3)).then(|| draw.parameter());
                Self::Charts(draw.parts(), param, 1 + draw.below(5) as u8)
            }
            6 => Self::Compare(draw.parameter(), vec![draw.lot(), draw.lot()]),
            7 => Self::Rejects(draw.parts()),
            8 => Self::AlarmPareto(draw.runs()),
            9 => Self::Runs(draw.runs()),
            10 => Self::Yield(draw.runs()),
            11 => Self::Alarms(draw.runs()),
            12 => Self::Orders(draw.runs(), orders(draw)),
            13 | 14 => match draw.part() {
                Some(part) if draw.once_in(2) => match part.serial {
                    Some(serial) => Self::Serial(serial),
                    None => Self::Serial("no such serial".to_owned()),
                },
                Some(part) => {
                    let kind = if part.kind == "lot" { "lot" } else { "golden" };
                    Self::Part(part.lot, part.seq, kind)
                }
                None => Self::Serial("no such serial".to_owned()),
            },
            15 => Self::LotState(draw.lot()),
            16 => Self::LotReport(lot(draw)),
            17 => Self::Certificate(lot(draw), 1 + draw.below(20) as u64),
            18 => Self::AlarmList(draw.runs()),
            _ if recipes > 0 => Self::Rejudge(draw.lot(), draw.below(recipes)),
            _ => Self::Runs(draw.runs()),
        }
    }

    /// Asks `archive`; returns the answer or the refusal as text.
    pub fn answer(&self, archive: &Archive, recipes: &[Recipe]) -> Answer {
        match self {
            Self::Parts(filter) => parts(archive.query(filter)),
            Self::Count(filter) => text(archive.count_parts(filter)),
            Self::Csv(filter, parameters) => {
                let mut out = Vec::new();
                export::csv_lines(archive, filter, parameters, &mut out).map_err(said)?;
                Ok(String::from_utf8_lossy(&out).into_owned())
            }
            Self::Figures(filter, param) => {
                let found = figures::figures(archive, param, filter, None).map_err(said)?;
                Ok(format!("{} {}", json(&found.summary), found.limits_differ))
            }
            Self::Histogram(filter, param) => text(figures::histogram(archive, param, filter)),
            Self::Charts(filter, param, size) => {
                let how = (*size, Rules::Nelson);
                text(charts::charts(archive, filter, param.as_deref(), how))
            }
            Self::Compare(param, lots) => text(comparison::compare(archive, param, lots)),
            Self::Rejects(filter) => {
                let found = pareto::rejects(archive, filter, 10).map_err(said)?;
                Ok(json(&found) + &parts(Ok::<_, InquiryError>(found.first))?)
            }
            Self::AlarmPareto(filter) => text(pareto::alarms(archive, filter)),
            Self::Runs(filter) => {
                let mut runs = archive.lots(filter).map_err(said)?;
                runs.iter_mut().for_each(|it| it.rig = None);
                Ok(json(&runs))
            }
            Self::Yield(filter) => text(archive.lot_yield(filter)),
            Self::Alarms(filter) => text(archive.alarms(filter)),
            Self::Orders(filter, choice) => text(archive.orders(filter, choice)),
            Self::Part(lot, seq, kind) => parts(archive.show(lot, *seq, kind)),
            Self::Serial(serial) => parts(archive.of_serial(serial)),
            Self::LotState(lot) => {
                let state = text(archive.standing(lot))?;
                Ok(state + &text(archive.reopenings(lot))?)
            }
            Self::LotReport(filter) => {
                paper::lot_report(archive, filter, None, &sheet()).map_err(said)
            }
            Self::Certificate(filter, seq) => {
                paper::part_certificate(archive, filter, *seq, &sheet()).map_err(said)
            }
            Self::AlarmList(filter) => paper::alarm_list(archive, filter, &sheet()).map_err(said),
            Self::Rejudge(lot, recipe) => rejudge(archive, lot, &recipes[*recipe]),
        }
    }
}

fn orders(draw: &mut Draw) -> OrderChoice {
    OrderChoice {
        who: draw.once_in(4).then(|| "li".to_owned()),
        order: draw.once_in(3).then(|| "start".to_owned()),
        without_people: draw.once_in(3),
    }
}

/// Returns settings for printed pages without a time of printing, so that two prints are equal.
fn sheet() -> Paper {
    Paper {
        language: Lang::En,
        zone: TimeZone::UTC,
        made: String::new(),
        simulated: true,
    }
}

fn rejudge(archive: &Archive, lot: &str, recipe: &Recipe) -> Answer {
    let question = Rejudging::of(archive, lot.to_owned(), None, recipe.clone()).map_err(said)?;
    let mut all = String::new();
    let changes = question.each::<InquiryError>(archive, |part| {
        all += &json(&part);
        Ok(())
    });
    Ok(all + &json(&changes.map_err(said)?.map_err(said)?))
}

/// Returns parts as JSON, without the rig, which a file does not name.
fn parts<E: std::fmt::Display>(found: Result<Vec<Part>, E>) -> Answer {
    let mut parts = found.map_err(said)?;
    parts.iter_mut().for_each(|it| it.rig = None);
    Ok(json(&parts))
}

fn text<T: Serialize, E: std::fmt::Display>(found: Result<T, E>) -> Answer {
    found.map(|it| json(&it)).map_err(said)
}

fn json(it: &impl Serialize) -> String {
    serde_json::to_string(it).unwrap_or_else(|error| error.to_string())
}

fn said(error: impl std::fmt::Display) -> Refused {
    Refused(error.to_string())
}
