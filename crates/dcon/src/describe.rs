//! Describes requests, replies and errors by codes with arguments; the program that shows them has a text for every
//! code in each of its languages.

mod reply;
mod request;

use std::fmt;

/// Description of a request, a reply or an error: a code with arguments.
///
/// Arguments need no translation: numbers with units, lists of channels (`0 2 7`, or `-` for none), the name or version
/// that a module reports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// The code, in snake case.
    pub code: &'static str,
    /// Arguments by name.
    pub args: Vec<(&'static str, String)>,
}

impl Description {
    pub(super) fn new(code: &'static str) -> Self {
        Self {
            code,
            args: Vec::new(),
        }
    }

    pub(super) fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.args.push((name, value.to_string()));
        self
    }
}

impl fmt::Display for Description {
    /// Writes the code and its arguments: `read_input channel=2`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.code)?;
        let mut args = self.args.iter();
        args.try_for_each(|(name, value)| write!(f, " {name}={value}"))
    }
}

/// Lists the channels whose bit is set, as `0 2 7`; bit 0 is channel `from`.
fn channels(bits: u16, from: u8) -> String {
    let set = (0..16).filter(|bit| bits >> bit & 1 != 0);
    let list: Vec<String> = set.map(|bit: u8| (from + bit).to_string()).collect();
    match list.is_empty() {
        true => "-".to_owned(),
        false => list.join(" "),
    }
}

/// Writes a number of tenths with one decimal: 15 as `1.5`.
fn decimal(tenths: impl Into<f64>) -> String {
    format!("{:.1}", tenths.into() / 10.0)
}
