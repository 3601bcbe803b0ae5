//! Traffic and health of the instruments of a run, for pages and alarm files.

use bus::arrow;
use bus::instrument::LinkLog;
use machine::view::{InstrumentView, LineTraffic, Message};
use std::fmt::Write;

/// Traffic and health of one instrument, with what `rig.toml` says about it.
#[derive(Debug, Clone)]
pub(super) struct InstrumentLog {
    /// Name in `rig.toml`.
    pub name: String,
    /// Name of the instrument's profile.
    pub profile: String,
    /// Address of the link, in the notation of `rig.toml`.
    pub link: String,
    /// Last messages and health of the link.
    pub log: LinkLog,
}

impl InstrumentLog {
    /// Returns the last messages, at most `last`.
    pub fn messages(&self, last: usize) -> LineTraffic {
        let all = self.log.traffic();
        let entries = all[all.len().saturating_sub(last)..].iter();
        let entries = entries.map(|it| Message {
            at_us: it.at.0,
            way: arrow(it.direction).to_string(),
            text: it.text(),
            ..Message::default()
        });
        LineTraffic {
            line: self.name.clone(),
            entries: entries.collect(),
        }
    }

    /// Returns the health of the link as screens show it; latencies in milliseconds.
    pub fn health(&self) -> InstrumentView {
        let health = self.log.health();
        let ms = |share| {
            let span = health.latency.percentile(share);
            span.map(|span| span.as_seconds() * 1e3)
        };
        let failures = health.failures.iter();
        InstrumentView {
            name: self.name.clone(),
            profile: self.profile.clone(),
            link: self.link.clone(),
            programs: health.programs,
            p50_ms: ms(0.5),
            p99_ms: ms(0.99),
            failures: failures.map(|(code, n)| ((*code).to_owned(), *n)).collect(),
            identity: health.identity,
        }
    }

    /// Returns the last traffic as the text of an alarm file: a line about the instrument, then a line for each message
    /// with rig time in microseconds, numbers of program and connection, direction, bytes.
    pub fn text(&self) -> String {
        let identity = self.log.health().identity;
        let identity = identity.as_deref().unwrap_or("not identified");
        let (name, profile, link) = (&self.name, &self.profile, &self.link);
        let mut text = format!("# instrument {name} {profile} {link} {identity}\n");
        for message in self.log.traffic() {
            let _ = writeln!(text, "{message}");
        }
        text
    }
}
