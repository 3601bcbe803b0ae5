//! Settings of a link: which instrument it must find, and the time limits.

use super::framing::{Framing, Terminator};
use super::program::Program;
use super::status::Identity;
use serde::Deserialize;
use std::fmt;
use units::Span;

/// How a link proves that replies and queries are in step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Echo {
    /// A number that the link writes to the standard event status enable register; the instrument returns it, and loses
    /// it when switched off.
    #[default]
    Ese,
    /// The identity alone, for an instrument without that register. After doubt the link waits for a silence as long as
    /// the default time of a query.
    Identity,
}

/// Instruments that a link accepts, by maker and model, the first two fields of `*IDN?`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct ExpectedIdentity {
    /// Accepted beginnings of the maker's name; upper and lower case are the same.
    pub makers: Vec<String>,
    /// Accepted beginnings of the model.
    pub models: Vec<String>,
}

impl ExpectedIdentity {
    /// Returns true when the identity is acceptable.
    pub fn accepts(&self, identity: &Identity) -> bool {
        let begins = |found: &str, wanted: &[String]| {
            let head = |it: &String| {
                found
                    .get(..it.len())
                    .is_some_and(|head| head.eq_ignore_ascii_case(it))
            };
            wanted.iter().any(head)
        };
        begins(&identity.maker, &self.makers) && begins(&identity.model, &self.models)
    }
}

impl fmt::Display for ExpectedIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (makers, models) = (self.makers.join(" or "), self.models.join(" or "));
        write!(f, "maker {makers}, model {models}")
    }
}

/// Settings of a link. The set-up must contain every setting of the instrument that matters, because a
/// resynchronisation restores no other.
#[derive(Debug, Clone)]
pub struct LinkSettings {
    /// Instruments that the link accepts; `None` for any.
    pub identity: Option<ExpectedIdentity>,
    /// Command that ends local mode; the link sends it first. Many instruments need it on RS-232.
    pub remote: Option<String>,
    /// Set-up, which the link sends after every resynchronisation.
    pub set_up: Program,
    /// Proof that the link is in step.
    pub echo: Echo,
    /// Number of entries that the error queue holds.
    pub error_depth: u8,
    /// Framing of messages between stream and instrument.
    pub framing: Framing,
    /// True when the link opens a new connection after doubt; false on serial ports.
    pub reopen: bool,
    /// Longest wait for the reply to a query that sets no limit of its own.
    pub limit: Span,
    /// Longest time for opening a connection.
    pub open_limit: Span,
    /// Length of the silence that ends the discarding of old replies.
    pub silence: Span,
    /// Longest time for a resynchronisation with all its attempts.
    pub sync_limit: Span,
    /// Greatest number of attempts of a resynchronisation.
    pub attempts: u8,
    /// Wait after the first failed attempt to open; it doubles with each failure.
    pub backoff_first: Span,
    /// Longest wait between two attempts to open.
    pub backoff_longest: Span,
}

impl Default for LinkSettings {
    fn default() -> Self {
        Self {
            identity: None,
            remote: None,
            set_up: Program::default(),
            echo: Echo::Ese,
            error_depth: 32,
            framing: Framing::Direct(Terminator::Lf),
            reopen: true,
            limit: Span::ms(1000),
            open_limit: Span::ms(2000),
            silence: Span::ms(50),
            sync_limit: Span::ms(15_000),
            attempts: 3,
            backoff_first: Span::ms(200),
            backoff_longest: Span::ms(5000),
        }
    }
}

impl LinkSettings {
    /// Returns the longest time that `program` can take, including a resynchronisation and the set-up before it.
    pub fn longest(&self, program: &Program) -> Span {
        let usual = self.limit;
        let ending = Span(usual.0 * (u64::from(self.error_depth) + 4));
        let steps = self.set_up.longest(usual) + program.longest(usual);
        self.sync_limit + steps + ending + ending
    }
}
