//! What a configuration file may hold, as data: one description serves the check, the JSON schema
//! and the tables of `config/README.md`.

/// What a value must look like.
#[derive(Debug, Clone, Copy)]
pub enum Form {
    /// Any text that is not empty.
    Text,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Hexadecimal text, upper case, of exactly so many digits.
    Hex(usize),
    /// A finite number.
    Number(Range),
    /// A whole number, both ends allowed.
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
    /// `true` or `false`.
    Flag,
    /// A list of exactly so many numbers.
    Numbers(usize, Range),
    /// A table with these keys.
    Table(&'static [Key]),
    /// A table of entries with free names (lower case, digits, underscore), all of one form.
    Named(&'static Form),
    /// The same, with these names among them.
    NamedWith(&'static [&'static str], &'static Form),
    /// A table with exactly these names, all of one form.
    Each(&'static [&'static str], &'static Form),
    /// A table of points.
    Points(Points),
    /// A list of entries of one form.
    List(&'static Form),
}

/// A table of points of the rig, all of one form.
#[derive(Debug, Clone, Copy)]
pub struct Points {
    /// Those that every rig has.
    pub must: &'static [&'static str],
    /// Those that a rig may lack.
    pub may: fn() -> Vec<&'static str>,
    /// Whether the file itself may name others.
    pub free: bool,
    /// What each entry must look like.
    pub entry: &'static Form,
}

impl Points {
    /// Every name but the free ones.
    pub fn names(&self) -> Vec<&'static str> {
        let must = self.must.iter().copied();
        must.chain((self.may)()).collect()
    }
}

/// The range of a number.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// Unit as in the key's name; empty for a pure number.
    pub unit: &'static str,
    /// Lower end.
    pub low: f64,
    /// Upper end, allowed itself.
    pub high: f64,
    /// Whether the lower end itself is allowed.
    pub low_allowed: bool,
}

/// One key of a table.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Its name in the file.
    pub name: &'static str,
    /// Whether it may be left out.
    pub optional: bool,
    /// What its value must look like.
    pub form: Form,
    /// Which part of the program reads it.
    pub reader: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

/// A number from `low` to `high`, both allowed.
pub const fn from_to(low: f64, high: f64, unit: &'static str) -> Form {
    Form::Number(Range {
        unit,
        low,
        high,
        low_allowed: true,
    })
}

/// A number above zero, up to `high`.
pub const fn above_zero(high: f64, unit: &'static str) -> Form {
    Form::Number(Range {
        unit,
        low: 0.0,
        high,
        low_allowed: false,
    })
}

/// A whole number from `low` to `high`.
pub const fn whole(low: i64, high: i64, unit: &'static str) -> Form {
    Form::Whole { unit, low, high }
}

/// A key that must be there.
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

/// A key that may be left out.
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
    /// What is expected, in words that complete "expected ...".
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

    /// Whether the value is a table.
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
    /// Whether the value is finite and inside.
    pub fn holds(&self, value: f64) -> bool {
        let above = if self.low_allowed {
            value >= self.low
        } else {
            value > self.low
        };
        value.is_finite() && above && value <= self.high
    }

    /// The range in words.
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

/// Words in quotation marks, joined by commas and a final "or".
pub fn one_of(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => "nothing".to_owned(),
    }
}
