//! The shape of a configuration file, as data: the check, the JSON schema and the tables of `config/README.md` use the
//! same description.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt;
use utoipa::ToSchema;

/// Change of the value of one key between two versions of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct KeyChange {
    /// Path of the key, for example `limits.operate_voltage_v.high`.
    pub key: String,
    /// Unit of both values; empty without one.
    pub unit: String,
    /// Value before the change; null when the file lacked the key.
    pub old: Value,
    /// Value after the change; null when the file no longer has the key.
    pub new: Value,
}

impl fmt::Display for KeyChange {
    /// Writes the line that every list of changes shows: `limits.operate_voltage_v.high: 9.0 V -> 8.75 V`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = |value: &Value| match value {
            Value::Null => "-".to_owned(),
            Value::String(text) => text.clone(),
            value if self.unit.is_empty() => value.to_string(),
            value => format!("{value} {}", self.unit),
        };
        write!(
            f,
            "{}: {} -> {}",
            self.key,
            said(&self.old),
            said(&self.new)
        )
    }
}

/// Shape that the value of a key must have.
#[derive(Debug, Clone, Copy)]
pub enum Form {
    /// Text, not empty.
    Text,
    /// Text that is one of these words.
    Choice(&'static [&'static str]),
    /// Hexadecimal text, upper case, with this number of digits.
    Hex(usize),
    /// A finite number.
    Number(Range),
    /// A whole number in a range that includes both ends.
    Whole {
        /// Unit, empty for a count.
        unit: &'static str,
        /// Least value.
        low: i64,
        /// Greatest value.
        high: i64,
    },
    /// One of these whole numbers.
    Listed(&'static [i64]),
    /// A boolean, `true` or `false`.
    Flag,
    /// A list with this number of numbers.
    Numbers(usize, Range),
    /// A table with these keys.
    Table(&'static [Key]),
    /// A table whose entry names are free (lower case, digits, underscore); all entries have this shape.
    Named(&'static Form),
    /// A table whose entry names are free, but these entries must be present; all entries have this shape.
    NamedWith(&'static [&'static str], &'static Form),
    /// A table with exactly these names; all entries have this shape.
    Each(&'static [&'static str], &'static Form),
    /// A table of points.
    Points(Points),
    /// A list of entries of this shape.
    List(&'static Form),
}

/// A table of points of the rig; all entries have one shape.
#[derive(Debug, Clone, Copy)]
pub struct Points {
    /// Names that every rig must have.
    pub must: &'static [&'static str],
    /// Names that a rig may lack.
    pub may: fn() -> Vec<&'static str>,
    /// True when the file may add further names.
    pub free: bool,
    /// Shape of each entry.
    pub entry: &'static Form,
}

impl Points {
    /// Returns every name except the free ones.
    pub fn names(&self) -> Vec<&'static str> {
        let must = self.must.iter().copied();
        must.chain((self.may)()).collect()
    }
}

/// The range of a number.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// Unit, as in the key's name; empty for a pure number.
    pub unit: &'static str,
    /// Lower end.
    pub low: f64,
    /// Upper end, included.
    pub high: f64,
    /// True when the range includes the lower end.
    pub low_allowed: bool,
}

/// One key of a table.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Name in the file.
    pub name: &'static str,
    /// True when the file may omit it.
    pub optional: bool,
    /// Shape of its value.
    pub form: Form,
    /// Name of the part of the program that reads the key.
    pub reader: &'static str,
    /// Meaning of the key, for the schema and the tables.
    pub meaning: &'static str,
}

/// Returns the shape of a number from `low` to `high`, both included.
pub const fn from_to(low: f64, high: f64, unit: &'static str) -> Form {
    Form::Number(Range {
        unit,
        low,
        high,
        low_allowed: true,
    })
}

/// Returns the shape of a number above zero, up to `high`.
pub const fn above_zero(high: f64, unit: &'static str) -> Form {
    Form::Number(Range {
        unit,
        low: 0.0,
        high,
        low_allowed: false,
    })
}

/// Returns the shape of a whole number from `low` to `high`.
pub const fn whole(low: i64, high: i64, unit: &'static str) -> Form {
    Form::Whole { unit, low, high }
}

/// Returns a key that the file must have.
pub const fn key(
    name: &'static str,
    form: Form,
    reader: &'static str,
    meaning: &'static str,
) -> Key {
    Key {
        name,
        optional: false,
        form,
        reader,
        meaning,
    }
}

/// Returns a key that the file may omit.
pub const fn optional(
    name: &'static str,
    form: Form,
    reader: &'static str,
    meaning: &'static str,
) -> Key {
    Key {
        name,
        optional: true,
        form,
        reader,
        meaning,
    }
}

impl Form {
    /// Returns the words that complete "expected ..." in a message.
    pub fn expected(&self) -> String {
        match self {
            Self::Text => "text".to_owned(),
            Self::Choice(words) => one_of(words),
            Self::Hex(digits) => format!(
                "{digits} hexadecimal digits as text, such as \"{:0>digits$}\"",
                "1A"
            ),
            Self::Number(range) => range.expected(),
            Self::Whole { unit, low, high } => {
                format!("a whole number{} from {low} to {high}", of(unit))
            }
            Self::Listed(values) => {
                let values: Vec<String> = values.iter().map(i64::to_string).collect();
                format!("one of {}", values.join(", "))
            }
            Self::Flag => "true or false".to_owned(),
            Self::Numbers(count, range) => format!("a list of {count}, each {}", range.expected()),
            Self::Table(_)
            | Self::Named(_)
            | Self::NamedWith(..)
            | Self::Each(..)
            | Self::Points(_) => "a table".to_owned(),
            Self::List(_) => "a list".to_owned(),
        }
    }

    /// Returns true when the value is a table.
    pub fn is_table(&self) -> bool {
        match self {
            Self::Table(_)
            | Self::Named(_)
            | Self::NamedWith(..)
            | Self::Each(..)
            | Self::Points(_) => true,
            Self::Text
            | Self::Choice(_)
            | Self::Hex(_)
            | Self::Number(_)
            | Self::Whole { .. }
            | Self::Listed(_)
            | Self::Flag
            | Self::Numbers(..)
            | Self::List(_) => false,
        }
    }
}

impl Range {
    /// Returns true when `value` is finite and in the range.
    pub fn holds(&self, value: f64) -> bool {
        let above = if self.low_allowed {
            value >= self.low
        } else {
            value > self.low
        };
        value.is_finite() && above && value <= self.high
    }

    /// Returns the range in words.
    pub fn expected(&self) -> String {
        let from = if self.low_allowed { "from" } else { "above" };
        let to = if self.low_allowed { "to" } else { "up to" };
        format!(
            "a number{} {from} {} {to} {}",
            of(self.unit),
            self.low,
            self.high
        )
    }
}

fn of(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" of {unit}")
    }
}

/// Returns words in quotation marks, joined by commas and a final "or".
pub fn one_of(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => "nothing".to_owned(),
    }
}
