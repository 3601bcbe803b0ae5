//! Serial numbers of the parts of a lot: counted by the rig, read at the pocket, or scanned by a person.
//!
//! A code reader reads the part in the pocket, which lies there from the signal of the sensor `pocket_present` to the
//! stroke of the pusher. Its readings count from the release of the part on, because the reader may be faster than the
//! scan of the sensor. The pusher waits for a reading, at most [`Source::Reader::timeout`] from the arrival on.
//!
//! A person scans the code of a part before loading it; the escapement releases a part only while a scan waits, and the
//! part gets the oldest scan. Scans that wait at the end of a run are dropped: the history raises an alarm with their
//! numbers, and the station takes no scan until a person has acknowledged it.
//!
//! The part gets its number once it is in the nest. A part without a reading, with two different ones, or with the
//! number of another part goes to retest without a test. A number is free again when its part lands in retest, so that
//! the same part may come again.

use super::ledger::{Ledger, PartRole};
use super::place::Place;
use crate::dut::reason::SerialFault;
use crate::rig::bin::Bin;
use serde::Deserialize;
use std::collections::{BTreeSet, VecDeque};
use units::{RigTime, Span};

/// Greatest number of characters of a serial number.
pub const LONGEST: usize = 64;
/// Greatest number of scans that wait for their parts to come into the pocket.
const MOST_WAITING: usize = 100;

/// Source of serial numbers, as `lot.toml` names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SourceName {
    /// The rig numbers the parts.
    Counted,
    /// A reader on a serial line reads the code of the part in the pocket.
    Reader,
    /// A person scans the code of each part before loading it.
    Wedge,
}

/// Settings `[serial]` of `lot.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct SerialSettings {
    /// Source of the serial numbers.
    pub source: SourceName,
    /// Form of a counted number, see [`counted`].
    #[serde(default = "usual_template")]
    pub template: String,
}

fn usual_template() -> String {
    "{lot}-{number:06}".to_owned()
}

/// Returns the serial number of a counted part: `template` with the name of the lot for `{lot}`, and `number` for
/// `{number}`, with leading zeros for `{number:06}`. `None` when the template lacks one of the two or has other braces.
pub fn counted(template: &str, lot: &str, number: u64) -> Option<String> {
    let (before, rest) = template.split_once("{number")?;
    let (width, after) = rest.split_once('}')?;
    let width = match width {
        "" => 0,
        zeros => zeros
            .strip_prefix(":0")?
            .parse()
            .ok()
            .filter(|it| *it <= 20)?,
    };
    let text = format!("{before}{number:0width$}{after}");
    let is_whole = text.matches(['{', '}']).count() == 2 && text.contains("{lot}");
    is_whole.then(|| text.replace("{lot}", lot))
}

/// Returns the text of a reading or scan without surrounding blanks; `None` unless it has 1 to [`LONGEST`] printable
/// ASCII characters.
pub fn readable(text: &str) -> Option<&str> {
    let text = text.trim();
    let fits = (1..=LONGEST).contains(&text.len());
    let plain = text.bytes().all(|byte| matches!(byte, b' '..=b'~'));
    (fits && plain).then_some(text)
}

/// Source of the serial numbers in a run.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Source {
    /// The parts of the lot have no serial numbers.
    #[default]
    None,
    /// The rig counts.
    Counted {
        /// Form of a number, see [`counted`].
        template: String,
        /// Name of the lot.
        lot: String,
        /// Numbers that earlier runs of the lot have given.
        given: u64,
    },
    /// A reader looks at the pocket.
    Reader {
        /// Longest wait for a reading, from the arrival of the part on.
        timeout: Span,
    },
    /// A person scans.
    Wedge,
}

/// Reason why a scan is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScanRefused {
    /// The lot takes no scans, or no scan waits for its part.
    NotScanned,
    /// The text is no serial number.
    Unreadable,
    /// A part of the lot has the number already.
    Repeated,
    /// Too many scanned parts wait.
    TooMany,
}

/// Serial numbers of the parts of a run.
#[derive(Debug, Clone, Default)]
pub struct Serials {
    source: Source,
    /// Numbers of parts that landed in a bin other than retest, in this run and in earlier ones of the lot.
    taken: BTreeSet<String>,
    /// Scans whose parts have not come into the pocket, the oldest first.
    waiting: VecDeque<String>,
    /// Readings of the part in the pocket, without duplicates.
    read: Vec<String>,
    /// Time at which the part came into the pocket; `None` once no further reading is expected.
    expected_since: Option<RigTime>,
    /// True from the opening of the escapement until a part is in the pocket, however late.
    is_released: bool,
}

impl Serials {
    /// Returns the serial numbers of a run; `taken` are those of earlier runs.
    pub fn new(source: Source, taken: BTreeSet<String>) -> Self {
        Self {
            source,
            taken,
            ..Self::default()
        }
    }

    /// Returns the scans whose parts have not come, the oldest first; `None` in a lot without scans.
    pub fn waiting(&self) -> Option<impl Iterator<Item = &String>> {
        (self.source == Source::Wedge).then(|| self.waiting.iter())
    }

    /// Takes the scan of a part that a person is about to load.
    ///
    /// # Errors
    /// Fails when the lot takes no scans, or when the text is no serial number for one more part: malformed,
    /// already taken, or one scan too many.
    pub fn scan(&mut self, text: &str, ledger: &Ledger) -> Result<(), ScanRefused> {
        if self.source != Source::Wedge {
            return Err(ScanRefused::NotScanned);
        }
        let serial = readable(text).ok_or(ScanRefused::Unreadable)?;
        if self.is_taken(serial, ledger) {
            return Err(ScanRefused::Repeated);
        }
        if self.waiting.len() >= MOST_WAITING {
            return Err(ScanRefused::TooMany);
        }
        self.waiting.push_back(serial.to_owned());
        Ok(())
    }

    /// Forgets the newest scan.
    ///
    /// # Errors
    /// Fails when no scan waits for its part.
    pub fn unscan(&mut self) -> Result<(), ScanRefused> {
        let newest = self.waiting.pop_back();
        newest.map(|_| ()).ok_or(ScanRefused::NotScanned)
    }

    /// Returns true unless the next part of the lot needs a scan first, and none waits.
    pub fn may_release(&self) -> bool {
        self.source != Source::Wedge || !self.waiting.is_empty()
    }

    /// Forgets the readings of the last part, because the escapement opens for the next one.
    pub fn released(&mut self) {
        self.read.clear();
        self.expected_since = None;
        self.is_released = true;
    }

    /// Notes that a part has come into the pocket; `of_lot`: it belongs to the lot and is no reference part. A part
    /// that lay there before the escapement opened takes no scan.
    pub fn arrived(&mut self, now: RigTime, of_lot: bool) {
        let expected = std::mem::take(&mut self.is_released) && of_lot;
        match self.source {
            Source::None | Source::Counted { .. } => {}
            Source::Reader { .. } => {
                if !expected {
                    self.read.clear();
                }
                let is_open = expected && self.read.is_empty();
                self.expected_since = is_open.then_some(now);
            }
            Source::Wedge => {
                let scan = expected.then(|| self.waiting.pop_front()).flatten();
                self.read = scan.into_iter().collect();
            }
        }
    }

    /// Takes readings of the part in the pocket; `None` is a reading without a code.
    pub fn readings(&mut self, readings: &[Option<String>]) {
        for reading in readings {
            self.expected_since = None;
            let text = reading.as_deref().and_then(readable);
            if let Some(text) = text.filter(|it| !self.read.iter().any(|known| known == it)) {
                self.read.push(text.to_owned());
            }
        }
    }

    /// Returns true when the pusher need not wait any longer for a reading of the part in the pocket.
    pub fn is_settled(&self, now: RigTime) -> bool {
        let Source::Reader { timeout } = self.source else {
            return true;
        };
        self.expected_since
            .is_none_or(|since| now.since(since) > timeout)
    }

    /// Gives the part that has just come into `place` its number, if it is a part of the lot.
    pub fn assign(&mut self, ledger: &mut Ledger, place: Place) {
        let read = std::mem::take(&mut self.read);
        self.expected_since = None;
        let Some(PartRole::Lot(seq)) = ledger.part(place).map(|part| part.role.clone()) else {
            return;
        };
        let (serial, fault) = match (&self.source, &read[..]) {
            (Source::None, _) => return,
            (Source::Counted { .. }, _) => (self.count(seq), None),
            (Source::Reader { .. } | Source::Wedge, []) => (None, Some(SerialFault::Missing)),
            (Source::Reader { .. } | Source::Wedge, [one]) => {
                let repeated = self.is_taken(one, ledger).then_some(SerialFault::Repeated);
                (Some(one.clone()), repeated)
            }
            (Source::Reader { .. } | Source::Wedge, _) => (None, Some(SerialFault::Ambiguous)),
        };
        if let Some(part) = ledger.part_mut(place).filter(|it| it.interrupted.is_none()) {
            part.serial = serial;
            part.serial_fault = fault.map(|it| (it, read.join(", ")));
        }
    }

    fn count(&self, seq: u64) -> Option<String> {
        match &self.source {
            Source::Counted {
                template,
                lot,
                given,
            } => counted(template, lot, given + seq),
            Source::None | Source::Reader { .. } | Source::Wedge => None,
        }
    }

    /// Notes the bin in which a part has landed.
    pub fn landed(&mut self, serial: Option<&String>, bin: Bin) {
        if bin != Bin::RETEST && !matches!(self.source, Source::None | Source::Counted { .. }) {
            self.taken.extend(serial.cloned());
        }
    }

    fn is_taken(&self, serial: &str, ledger: &Ledger) -> bool {
        let mut inside = ledger
            .each()
            .filter_map(|(_, part)| part?.serial.as_deref());
        self.taken.contains(serial)
            || self.waiting.iter().any(|it| it == serial)
            || inside.any(|it| it == serial)
    }
}
