//! Columns of a part in CSV, spreadsheets and on the page.
//!
//! The order is: [`COLUMNS`], then the value of each parameter, then the expanded uncertainty of each parameter,
//! then the results from outside of the rig ([`external_header`]).
//! `history import` reads the same names.

use super::report::parameter;
use super::{Moment, Part};
use machine::dut::External;
use std::borrow::Cow;
use std::fmt;
use texts::Lang;

/// Prefix of the columns that hold uncertainties.
pub(super) const UNCERTAINTY: &str = "uncertainty ";
/// Prefix of the columns that hold verdicts on results from outside of the rig.
pub(super) const VERDICT: &str = "verdict ";

/// Content of a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell<'a> {
    /// No content.
    Empty,
    /// A text; writers make sure that no spreadsheet takes it for a formula.
    Text(Cow<'a, str>),
    /// A count.
    Count(u64),
    /// A number in the unit of its column.
    Number(f64),
    /// An instant.
    Time(Moment),
}

/// A column that every part has.
pub struct Column {
    /// Name in the header.
    pub name: &'static str,
    of: fn(&Part) -> Cell<'_>,
    /// Function that converts the codes of the cell into words; `None` for a cell without codes.
    told: Option<fn(&Part, Lang) -> String>,
}

/// Columns that every part has, in order.
pub const COLUMNS: [Column; 13] = [
    column("time", |it| Cell::Time(it.time)),
    column("lot", |it| text(&it.lot)),
    column("run", |it| Cell::Count(it.run.into())),
    column("kind", |it| text(&it.kind))
        .told(|it, lang| lang.name("part_kind", &it.kind).to_owned()),
    column("seq", |it| Cell::Count(it.seq)),
    column("recipe", |it| text(&it.recipe)),
    column("serial", |it| optional_text(it.serial.as_ref())),
    column("verdict", |it| text(&it.verdict))
        .told(|it, lang| lang.name("paper_verdict", &it.verdict).to_owned()),
    column("bin", |it| optional_text(it.bin.as_ref())).told(|it, lang| bin(it.bin.as_ref(), lang)),
    column("landed_bin", |it| optional_text(it.landed_bin.as_ref()))
        .told(|it, lang| bin(it.landed_bin.as_ref(), lang)),
    column("reasons", |it| match it.reasons.as_slice() {
        [] => Cell::Empty,
        reasons => Cell::Text(Cow::Owned(reasons.join("; "))),
    })
    .told(|it, lang| {
        let reasons = it.reason_codes.iter().map(|it| it.short(lang));
        reasons.collect::<Vec<_>>().join("; ")
    }),
    column("test_s", |it| number(it.test_s)),
    column("cycle_s", |it| number(it.cycle_s)),
];

/// Returns the names of all columns.
pub fn header(parameters: &[String]) -> Vec<String> {
    let fixed = COLUMNS.iter().map(|column| column.name.to_owned());
    let doubts = parameters.iter().map(|key| format!("{UNCERTAINTY}{key}"));
    fixed
        .chain(parameters.iter().cloned())
        .chain(doubts)
        .collect()
}

/// Returns the names of all columns in the language `lang`.
pub fn header_in(lang: Lang, parameters: &[String]) -> Vec<String> {
    let fixed = COLUMNS.iter();
    let fixed = fixed.map(|column| lang.name("column", column.name).to_owned());
    let named = || parameters.iter().map(|key| parameter(lang, key));
    let doubts = named().map(|name| format!("U {name}"));
    fixed.chain(named()).chain(doubts).collect()
}

/// Returns the cells of [`COLUMNS`], with codes converted into words of the language `lang`.
pub fn texts_in(part: &Part, lang: Lang) -> impl Iterator<Item = Cell<'_>> {
    COLUMNS.iter().map(move |column| match column.told {
        Some(told) => Cell::Text(Cow::Owned(told(part, lang))),
        None => (column.of)(part),
    })
}

/// Returns the names of the columns of results from outside of the rig: value, uncertainty and verdict of each.
pub fn external_header(keys: &[External]) -> impl Iterator<Item = String> + '_ {
    let of = |key: &External| {
        [
            key.to_string(),
            format!("{UNCERTAINTY}{key}"),
            format!("{VERDICT}{key}"),
        ]
    };
    keys.iter().flat_map(of)
}

/// Returns the names of the same columns in the language `lang`.
pub fn external_header_in(lang: Lang, keys: &[External]) -> impl Iterator<Item = String> + '_ {
    let verdict = lang.name("column", "verdict");
    keys.iter().flat_map(move |key| {
        let name = parameter(lang, key.key());
        let [doubt, judged] = [
            format!("U {name}"),
            format!("{verdict}{}{name}", lang.colon()),
        ];
        [name, doubt, judged]
    })
}

/// Returns the cells of a part in the order of [`external_header`].
pub fn external<'a>(part: &'a Part, keys: &'a [External]) -> impl Iterator<Item = Cell<'a>> {
    keys.iter().flat_map(|key| {
        let mut counting = part.external.iter().filter(|it| !it.superseded);
        let found = counting.find(|it| it.key == key.key());
        [
            number(found.map(|it| it.value)),
            number(found.and_then(|it| it.uncertainty)),
            found.map_or(Cell::Empty, |it| text(it.verdict.name())),
        ]
    })
}

/// Returns the same cells with verdicts in words of the language `lang`.
pub fn external_in<'a>(
    part: &'a Part,
    keys: &'a [External],
    lang: Lang,
) -> impl Iterator<Item = Cell<'a>> {
    external(part, keys).map(move |cell| match cell {
        Cell::Text(code) => {
            let name = lang.name("paper_verdict", &code).to_owned();
            Cell::Text(Cow::Owned(name))
        }
        figure => figure,
    })
}

/// Returns the cells of a part in the order of [`header`].
pub fn row<'a>(part: &'a Part, parameters: &'a [String]) -> impl Iterator<Item = Cell<'a>> {
    let fixed = COLUMNS.iter().map(|column| (column.of)(part));
    let figures = [&part.values, &part.uncertainty]
        .into_iter()
        .flat_map(|map| {
            let of = |key: &String| number(map.get(key).and_then(serde_json::Value::as_f64));
            parameters.iter().map(of)
        });
    fixed.chain(figures)
}

impl fmt::Display for Cell<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => Ok(()),
            Self::Text(text) => f.write_str(text),
            Self::Count(count) => write!(f, "{count}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Time(at) => write!(f, "{at}"),
        }
    }
}

const fn column(name: &'static str, of: fn(&Part) -> Cell<'_>) -> Column {
    Column {
        name,
        of,
        told: None,
    }
}

impl Column {
    const fn told(self, told: fn(&Part, Lang) -> String) -> Self {
        Self {
            told: Some(told),
            ..self
        }
    }
}

fn bin(code: Option<&String>, lang: Lang) -> String {
    code.map_or_else(String::new, |code| lang.name("bin", code).to_owned())
}

fn text(text: &str) -> Cell<'_> {
    Cell::Text(Cow::Borrowed(text))
}

fn optional_text(found: Option<&String>) -> Cell<'_> {
    found.map_or(Cell::Empty, |it| text(it))
}

fn number(found: Option<f64>) -> Cell<'static> {
    let finite = found.filter(|it| it.is_finite());
    finite.map_or(Cell::Empty, Cell::Number)
}
