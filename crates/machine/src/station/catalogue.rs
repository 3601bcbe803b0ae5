//! Every alarm by its code, with what it stops and what clears it. What it says stands in the catalogue of texts: cause,
//! consequence and action are attributes of the code.

use crate::handling::moves::ActuatorKey;
use crate::handling::wear::Wearing;
use std::fmt;
use texts::{Args, Lang, Message};

/// What an alarm stops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stops {
    /// Outputs go safe at once.
    Abort,
    /// The sequence rests at its next point and waits for a person.
    Hold,
    /// The sequence rests and goes on by itself when the cause outside has gone.
    Suspend,
    /// Nothing; it is told.
    Nothing,
}

/// What makes the cause count as gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goes {
    /// The sensor says so.
    BySensor,
    /// A person has looked and says so with `clear` or `unhold`.
    ByClear,
    /// It is told once and gone at once.
    AtOnce,
}

/// What follows from an alarm, and when it is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// What it stops.
    pub stops: Stops,
    /// What clears it.
    pub goes: Goes,
}

/// Code of an alarm: the same over versions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AlarmCode {
    /// The emergency-stop chain is open.
    EmergencyStop,
    /// The door was opened.
    DoorOpen,
    /// Air pressure is below the switch point.
    AirLost,
    /// A stroke did not show its end in time.
    NotReached(ActuatorKey),
    /// An actuator left its end by itself.
    LeftEnd(ActuatorKey),
    /// Both end sensors of an actuator are on at once.
    BothEnds(ActuatorKey),
    /// The collision guard refused a motion.
    MotionRefused,
    /// A line or module does not answer, or has restarted.
    BusTrouble,
    /// A safety input is not read any more.
    SensorStale,
    /// A module has not confirmed its safe outputs.
    OutputsNotConfirmed,
    /// The history file cannot be written.
    HistoryLost,
    /// References or golden parts do not agree with their certificates.
    CalibrationFailed,
    /// The calibration has run out during the lot.
    CalibrationOverdue,
    /// The pusher is extended but no part is in the nest.
    PartNotInNest,
    /// A part stayed in the nest or in the fingers.
    PartStuck,
    /// The gripper lost its part on the way.
    PartDropped,
    /// The drive of the sort axis has tripped.
    AxisDrive,
    /// A step of the sequence waits for something that does not come.
    StepTooLong,
    /// The beam of a bin counted no part, or more than one.
    BinBeam,
    /// Parts wait in the track but none came into the pocket.
    PartNotArrived,
    /// The track is empty.
    MagazineEmpty,
    /// The beam of a bin stays dark.
    BinFull,
    /// A stroke did not reach its end and is tried again.
    Retried(ActuatorKey),
    /// A push button stays down.
    ButtonStuck,
    /// A module made its outputs safe because the controller was silent.
    WatchdogTripped,
    /// A calibration was cut off while the references were measured.
    CalibrationCutOff,
    /// A part that was inside is seen nowhere.
    PartLost,
    /// The program stopped while a part fell.
    FallUnseen,
    /// A part nobody knows was found inside.
    PartFound,
    /// The last golden check is longer ago than the lot allows.
    ReferenceCheckDue,
    /// A golden part does not read as its certificate says.
    ReferenceCheckFailed,
    /// The test of a golden part was cut off and begins anew.
    ReferenceRepeated,
    /// More parts have failed than the lot may have.
    LotDiscardLimit,
    /// Less of the supply reaches the coil than at the calibration.
    ProbeContact,
    /// Probes or jaws were used as often as they last.
    Worn(Wearing),
    /// The stored calibration may not be used: no lot begins.
    CalibrationInvalid,
}

/// Alarms after which nothing is measured before a new calibration.
pub const NEEDS_CALIBRATION: [AlarmCode; 2] =
    [AlarmCode::CalibrationFailed, AlarmCode::CalibrationOverdue];

/// Alarms of which each is about another body: told anew even while the one before it stands.
pub const ABOUT_A_BODY: [AlarmCode; 1] = [AlarmCode::BinBeam];

impl AlarmCode {
    /// Every code.
    pub fn all() -> impl Iterator<Item = Self> {
        let of_actuators = ActuatorKey::ALL.into_iter().flat_map(|key| {
            [
                Self::NotReached(key),
                Self::LeftEnd(key),
                Self::BothEnds(key),
                Self::Retried(key),
            ]
        });
        let worn = Wearing::ALL.into_iter().map(Self::Worn);
        SINGLE.into_iter().chain(of_actuators).chain(worn)
    }

    /// The code of this name; none for one of another version.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|code| code.name() == name)
    }

    /// Its name in rows, views and orders; those of an actuator begin with its key: `pusher_not_reached`.
    pub fn name(self) -> String {
        let text = self.text_id();
        match self {
            Self::NotReached(key)
            | Self::LeftEnd(key)
            | Self::BothEnds(key)
            | Self::Retried(key) => {
                format!("{}_{text}", key.name())
            }
            Self::Worn(wearing) => format!("{}_{text}", wearing.name()),
            Self::EmergencyStop
            | Self::DoorOpen
            | Self::AirLost
            | Self::MotionRefused
            | Self::BusTrouble
            | Self::SensorStale
            | Self::OutputsNotConfirmed
            | Self::HistoryLost
            | Self::CalibrationFailed
            | Self::CalibrationOverdue
            | Self::PartNotInNest
            | Self::PartStuck
            | Self::PartDropped
            | Self::AxisDrive
            | Self::StepTooLong
            | Self::BinBeam
            | Self::PartNotArrived
            | Self::MagazineEmpty
            | Self::BinFull
            | Self::ButtonStuck
            | Self::WatchdogTripped
            | Self::CalibrationCutOff
            | Self::PartLost
            | Self::FallUnseen
            | Self::PartFound
            | Self::ReferenceCheckDue
            | Self::ReferenceCheckFailed
            | Self::ReferenceRepeated
            | Self::LotDiscardLimit
            | Self::ProbeContact
            | Self::CalibrationInvalid => text.to_owned(),
        }
    }

    /// Its name in the catalogue of texts, which says the same of every actuator.
    pub const fn text_id(self) -> &'static str {
        match self {
            Self::EmergencyStop => "emergency_stop",
            Self::DoorOpen => "door_open",
            Self::AirLost => "air_lost",
            Self::NotReached(_) => "not_reached",
            Self::LeftEnd(_) => "left_end",
            Self::BothEnds(_) => "both_ends",
            Self::MotionRefused => "motion_refused",
            Self::BusTrouble => "bus_trouble",
            Self::SensorStale => "sensor_stale",
            Self::OutputsNotConfirmed => "outputs_not_confirmed",
            Self::HistoryLost => "history_lost",
            Self::CalibrationFailed => "calibration_failed",
            Self::CalibrationOverdue => "calibration_overdue",
            Self::PartNotInNest => "part_not_in_nest",
            Self::PartStuck => "part_stuck",
            Self::PartDropped => "part_dropped",
            Self::AxisDrive => "axis_drive",
            Self::StepTooLong => "step_too_long",
            Self::BinBeam => "bin_beam",
            Self::PartNotArrived => "part_not_arrived",
            Self::MagazineEmpty => "magazine_empty",
            Self::BinFull => "bin_full",
            Self::Retried(_) => "retried",
            Self::ButtonStuck => "button_stuck",
            Self::WatchdogTripped => "watchdog_tripped",
            Self::CalibrationCutOff => "calibration_cut_off",
            Self::PartLost => "part_lost",
            Self::FallUnseen => "fall_unseen",
            Self::PartFound => "part_found",
            Self::ReferenceCheckDue => "golden_check_due",
            Self::ReferenceCheckFailed => "golden_check_failed",
            Self::ReferenceRepeated => "golden_repeated",
            Self::LotDiscardLimit => "lot_discard_limit",
            Self::ProbeContact => "probe_contact",
            Self::Worn(_) => "worn",
            Self::CalibrationInvalid => "calibration_invalid",
        }
    }

    /// What it stops and what clears it.
    pub const fn entry(self) -> Entry {
        let (stops, goes) = match self {
            Self::EmergencyStop | Self::DoorOpen | Self::AirLost | Self::SensorStale => {
                (Stops::Abort, Goes::BySensor)
            }
            Self::NotReached(_)
            | Self::LeftEnd(_)
            | Self::BothEnds(_)
            | Self::MotionRefused
            | Self::BusTrouble
            | Self::OutputsNotConfirmed
            | Self::HistoryLost
            | Self::CalibrationFailed
            | Self::CalibrationOverdue
            | Self::PartNotInNest
            | Self::PartStuck
            | Self::PartDropped
            | Self::AxisDrive
            | Self::StepTooLong
            | Self::CalibrationInvalid => (Stops::Abort, Goes::ByClear),
            Self::BinBeam
            | Self::PartNotArrived
            | Self::ReferenceCheckDue
            | Self::ReferenceCheckFailed
            | Self::LotDiscardLimit => (Stops::Hold, Goes::ByClear),
            Self::MagazineEmpty | Self::BinFull => (Stops::Suspend, Goes::BySensor),
            Self::Retried(_)
            | Self::WatchdogTripped
            | Self::CalibrationCutOff
            | Self::PartLost
            | Self::FallUnseen
            | Self::PartFound => (Stops::Nothing, Goes::AtOnce),
            Self::ButtonStuck => (Stops::Nothing, Goes::BySensor),
            Self::ReferenceRepeated | Self::ProbeContact | Self::Worn(_) => {
                (Stops::Nothing, Goes::ByClear)
            }
        };
        Entry { stops, goes }
    }

    /// Its text with these arguments.
    pub fn message(self, args: Args) -> Message {
        Message::of("alarm", self.text_id(), args)
    }

    /// Why it happens, what follows and what to do.
    pub fn help(self, lang: Lang) -> [&'static str; 3] {
        let id = self.message(Args::default()).id();
        ["cause", "consequence", "action"].map(|it| lang.attribute(&id, it))
    }
}

impl fmt::Display for AlarmCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name())
    }
}

/// Codes that name neither actuator nor wear.
const SINGLE: [AlarmCode; 31] = [
    AlarmCode::EmergencyStop,
    AlarmCode::DoorOpen,
    AlarmCode::AirLost,
    AlarmCode::MotionRefused,
    AlarmCode::BusTrouble,
    AlarmCode::SensorStale,
    AlarmCode::OutputsNotConfirmed,
    AlarmCode::HistoryLost,
    AlarmCode::CalibrationFailed,
    AlarmCode::CalibrationOverdue,
    AlarmCode::PartNotInNest,
    AlarmCode::PartStuck,
    AlarmCode::PartDropped,
    AlarmCode::AxisDrive,
    AlarmCode::StepTooLong,
    AlarmCode::BinBeam,
    AlarmCode::PartNotArrived,
    AlarmCode::MagazineEmpty,
    AlarmCode::BinFull,
    AlarmCode::ButtonStuck,
    AlarmCode::WatchdogTripped,
    AlarmCode::CalibrationCutOff,
    AlarmCode::PartLost,
    AlarmCode::FallUnseen,
    AlarmCode::PartFound,
    AlarmCode::ReferenceCheckDue,
    AlarmCode::ReferenceCheckFailed,
    AlarmCode::ReferenceRepeated,
    AlarmCode::LotDiscardLimit,
    AlarmCode::ProbeContact,
    AlarmCode::CalibrationInvalid,
];
