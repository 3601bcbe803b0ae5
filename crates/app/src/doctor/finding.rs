//! A finding of `doctor` or `host check`: subject, found and expected state, and what to do.

use serde::Serialize;
use std::fmt;

/// Subject of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Check {
    /// Files of the configuration: complete, without a fault.
    Configuration,
    /// Folder of the history: exists, writable.
    DataFolder,
    /// Free space in the folder of the history.
    DiskSpace,
    /// History: whole, owner, size.
    History,
    /// File of people and sessions: owner, readable by its owner alone.
    People,
    /// Age of the newest backup.
    Backup,
    /// Serial port of a line or of an instrument.
    Port,
    /// Latency of a USB converter.
    Latency,
    /// Wall clock, which dates every row.
    Clock,
    /// Calibration for one coil voltage, or of a rack.
    Calibration,
    /// Right of the cycle's thread to a real-time priority.
    RealTime,
    /// Right to lock the program's memory, so that it is never paged out.
    LockedMemory,
    /// Cause of late waits; only `host check` looks for it.
    Lateness,
}

impl Check {
    /// Returns the name for a person, for example `disk space`.
    const fn label(self) -> &'static str {
        match self {
            Self::Configuration => "configuration",
            Self::DataFolder => "data folder",
            Self::DiskSpace => "disk space",
            Self::History => "history",
            Self::People => "people",
            Self::Backup => "backup",
            Self::Port => "port",
            Self::Latency => "latency",
            Self::Clock => "clock",
            Self::Calibration => "calibration",
            Self::RealTime => "real time",
            Self::LockedMemory => "locked memory",
            Self::Lateness => "lateness",
        }
    }
}

/// Severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Health {
    /// As expected.
    Ok,
    /// The check was not possible.
    Unknown,
    /// The rig works, but less safely or less precisely than it could.
    Warning,
    /// The rig cannot work, or data are in danger.
    Fault,
}

/// Result of one check.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Kind of the check.
    pub check: Check,
    /// Path or name of the subject.
    pub subject: String,
    /// Severity of the finding.
    pub health: Health,
    /// State that the check found.
    pub found: String,
    /// State that a healthy rig has.
    pub expected: String,
    /// What to do; `None` when all is as expected.
    pub remedy: Option<String>,
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = match self.health {
            Health::Ok => "ok",
            Health::Unknown => "unknown",
            Health::Warning => "WARNING",
            Health::Fault => "FAULT",
        };
        let (label, subject) = (self.check.label(), &self.subject);
        let (found, expected) = (&self.found, &self.expected);
        write!(
            out,
            "{word:<8} {label} {subject}: found {found}, expected {expected}"
        )?;
        match &self.remedy {
            Some(remedy) => write!(out, "\n         do: {remedy}"),
            None => Ok(()),
        }
    }
}

/// Subject of a check that has no finding yet.
#[derive(Debug, Clone)]
pub(crate) struct Subject {
    check: Check,
    name: String,
    expected: String,
}

impl Subject {
    pub fn new(check: Check, name: impl ToString, expected: impl ToString) -> Self {
        Self {
            check,
            name: name.to_string(),
            expected: expected.to_string(),
        }
    }

    pub fn ok(self, found: impl ToString) -> Finding {
        self.found(Health::Ok, found, None)
    }

    pub fn unknown(self, found: impl ToString, remedy: impl ToString) -> Finding {
        self.found(Health::Unknown, found, Some(remedy.to_string()))
    }

    pub fn warning(self, found: impl ToString, remedy: impl ToString) -> Finding {
        self.found(Health::Warning, found, Some(remedy.to_string()))
    }

    pub fn fault(self, found: impl ToString, remedy: impl ToString) -> Finding {
        self.found(Health::Fault, found, Some(remedy.to_string()))
    }

    fn found(self, health: Health, found: impl ToString, remedy: Option<String>) -> Finding {
        Finding {
            check: self.check,
            subject: self.name,
            health,
            found: found.to_string(),
            expected: self.expected,
            remedy,
        }
    }
}
