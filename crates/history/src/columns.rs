//! The columns of a part as one row: the one list of CSV, spreadsheets and screens.
//!
//! [`COLUMNS`] first, then a column per parameter with its value, then one per parameter with its
//! expanded uncertainty. `history import` reads the same names back.

use super::{Moment, Part};
use std::borrow::Cow;
use std::fmt;

/// What stands in one cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell<'a> {
    /// Nothing.
    Empty,
    /// A text, never a formula.
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
    /// In the header.
    pub name: &'static str,
    of: fn(&Part) -> Cell<'_>,
}

/// In the order they are written in.
pub const COLUMNS: [Column; 13] = [
    column("time", |it| Cell::Time(it.time)),
    column("lot", |it| text(&it.lot)),
    column("run", |it| Cell::Count(it.run.into())),
    column("kind", |it| text(&it.kind)),
    column("seq", |it| Cell::Count(it.seq)),
    column("recipe", |it| text(&it.recipe)),
    column("serial", |it| perhaps(it.serial.as_ref())),
    column("verdict", |it| text(&it.verdict)),
    column("bin", |it| perhaps(it.bin.as_ref())),
    column("landed_bin", |it| perhaps(it.landed_bin.as_ref())),
    column("reasons", |it| match it.reasons.as_slice() {
        [] => Cell::Empty,
        reasons => Cell::Text(Cow::Owned(reasons.join("; "))),
    }),
    column("test_s", |it| number(it.test_s)),
    column("cycle_s", |it| number(it.cycle_s)),
];

/// Names of all columns.
pub fn header(parameters: &[String]) -> Vec<String> {
    let fixed = COLUMNS.iter().map(|column| column.name.to_owned());
    let doubts = parameters.iter().map(|key| format!("uncertainty {key}"));
    fixed
        .chain(parameters.iter().cloned())
        .chain(doubts)
        .collect()
}

/// Cells of a part, as many as [`header`] has names.
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
    Column { name, of }
}

fn text(text: &str) -> Cell<'_> {
    Cell::Text(Cow::Borrowed(text))
}

fn perhaps(found: Option<&String>) -> Cell<'_> {
    found.map_or(Cell::Empty, |it| text(it))
}

fn number(found: Option<f64>) -> Cell<'static> {
    let finite = found.filter(|it| it.is_finite());
    finite.map_or(Cell::Empty, Cell::Number)
}
