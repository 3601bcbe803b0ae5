//! A finding of the doctor: what was checked, what was found and expected, and what to do.

use serde::Serialize;

/// What is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Check {
    /// All files of the configuration.
    Configuration,
    /// Folder of the history: there and writable.
    DataFolder,
    /// Free space in that folder.
    DiskSpace,
    /// History: whole, owner, size.
    History,
    /// File of people and sessions: owner, readable by its owner alone.
    People,
    /// Age of the newest backup.
    Backup,
    /// Serial port of a line.
    Port,
    /// Latency of a USB converter.
    Latency,
    /// Wall clock, which dates every row.
    Clock,
    /// Calibration for one coil voltage.
    Calibration,
    /// Right to run the cycle before other programs.
    RealTime,
    /// Right to keep the program in memory.
    LockedMemory,
}

impl Check {
    /// Returns the name for a person, for example `disk space`.
    pub const fn label(self) -> &'static str {
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
        }
    }
}

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Health {
    /// As expected.
    Ok,
    /// Could not be checked.
    Unknown,
    /// The rig works, but less safely or less precisely than it could.
    Warning,
    /// The rig cannot work, or data are in danger.
    Fault,
}

/// A checked thing with what was found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What was checked.
    pub check: Check,
    /// Path or name of the checked thing.
    pub subject: String,
    /// How bad it is.
    pub health: Health,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
    /// What to do; `None` when all is as expected.
    pub remedy: Option<String>,
}

/// A thing under check, before something was found.
#[derive(Debug, Clone)]
pub(super) struct Subject {
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
