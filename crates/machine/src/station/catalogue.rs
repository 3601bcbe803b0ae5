//! Every alarm by its code, with the reaction of the machine and with what clears the alarm.
//!
//! The catalogue of texts holds cause, consequence and action as attributes of the code.

use crate::dut::promise::Promise;
use crate::handling::wear::Wearing;
use crate::rig::stroke::ActuatorKey;
use std::fmt;
use texts::{Args, Lang, Message};

named! {
    /// Reaction of the machine to an alarm; each variant says what the machine does.
    Reaction {
        /// Makes the outputs safe at once.
        Abort = "abort",
        /// Brings the line to rest at the next possible point and waits for an order.
        Hold = "hold",
        /// Brings the line to rest at the next possible point and resumes when the cause outside the machine has gone.
        Suspend = "suspend",
        /// Shows the alarm only.
        Nothing = "nothing",
    }
}

/// What clears an alarm, that is, ends its cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClearedBy {
    /// The sensor that has shown the cause, or the program once the history is written or a database has its rows.
    Sensor,
    /// The order `clear`, `unhold` or `reset`.
    Operator,
    /// Nothing: the alarm reports an instant, and its cause is over at once.
    Itself,
}

/// Reaction to an alarm, and what clears it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Reaction of the machine.
    pub reaction: Reaction,
    /// What clears the alarm.
    pub cleared_by: ClearedBy,
}

/// Declares [`AlarmCode`], one row per code: after `by` the argument that distinguishes its alarms (optional), after
/// `of` the type of its subject (optional), the id of its text, [`Reaction`], [`ClearedBy`].
macro_rules! codes {
    ($($(#[$doc:meta])* $code:ident $(by $argument:literal)? $(of $subject:ty)? = $id:literal, $reaction:ident, $by:ident;)+) => {
        /// Code of an alarm, stable over versions.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum AlarmCode { $($(#[$doc])* $code $(($subject))?,)+ }

        impl AlarmCode {
            /// Returns every code, with each of its subjects (actuators, wearing parts or promises).
            pub fn all() -> impl Iterator<Item = Self> {
                [$(each!($code $($subject)?)),+].concat().into_iter()
            }

            /// Returns the id in the catalogue of texts; the codes of all actuators share one.
            pub const fn text_id(self) -> &'static str {
                match self { $(Self::$code { .. } => $id),+ }
            }

            /// Returns the reaction of the machine, and what clears the alarm.
            pub const fn entry(self) -> Entry {
                match self {
                    $(Self::$code { .. } => Entry {
                        reaction: Reaction::$reaction,
                        cleared_by: ClearedBy::$by,
                    }),+
                }
            }

            /// Returns the name of the argument that distinguishes alarms of this code, for example `place` of a lost
            /// part; `None` for a code whose alarms share one line.
            pub(super) fn distinguished_by(self) -> Option<&'static str> {
                $($(if matches!(self, Self::$code { .. }) {
                    return Some($argument);
                })?)+
                None
            }

            /// Returns the name of the subject that the code carries (actuator, wearing part or promise), if it carries
            /// one.
            fn subject(self) -> Option<&'static str> {
                $($(if let Self::$code(subject) = self {
                    return Some(<$subject>::name(subject));
                })?)+
                None
            }
        }
    };
}

macro_rules! each {
    ($code:ident) => {
        vec![AlarmCode::$code]
    };
    ($code:ident $subject:ty) => {
        <$subject>::ALL
            .iter()
            .copied()
            .map(AlarmCode::$code)
            .collect()
    };
}

codes! {
    /// The emergency-stop chain is open.
    EmergencyStop = "emergency_stop", Abort, Sensor;
    /// The door is open.
    DoorOpen = "door_open", Abort, Sensor;
    /// Air pressure is below the switch point.
    AirLost = "air_lost", Abort, Sensor;
    /// An actuator misses its end sensor within the stroke time.
    NotReached of ActuatorKey = "not_reached", Abort, Operator;
    /// An actuator has left its end without a command.
    LeftEnd of ActuatorKey = "left_end", Abort, Operator;
    /// Both end sensors of an actuator are on.
    BothEnds of ActuatorKey = "both_ends", Abort, Operator;
    /// The collision guard refuses a motion.
    MotionRefused = "motion_refused", Abort, Operator;
    /// A line or module does not answer, or has restarted.
    BusTrouble = "bus_trouble", Abort, Operator;
    /// An instrument does not answer, or is not the one of the wiring.
    InstrumentTrouble by "instrument" = "instrument_trouble", Abort, Operator;
    /// An instrument has not confirmed its safe state in time.
    InstrumentNotSafe by "instrument" = "instrument_not_safe", Abort, Operator;
    /// A safety input has no fresh sample.
    SensorStale = "sensor_stale", Abort, Sensor;
    /// A reply or a sample is missing, and the lateness of this computer explains it.
    HostLate = "host_late", Abort, Sensor;
    /// A module has not confirmed its safe outputs in time.
    OutputsNotConfirmed = "outputs_not_confirmed", Abort, Operator;
    /// The program cannot write the history file.
    HistoryLost = "history_lost", Abort, Sensor;
    /// The supply is in another range than the one selected.
    SupplyRange = "supply_range", Abort, Operator;
    /// A test has ended without proof that the socket is free of dangerous voltage.
    SocketLive = "socket_live", Abort, Operator;
    /// The closed door of the rack does not report that it is locked.
    DoorNotLocked = "door_not_locked", Abort, Operator;
    /// The thermometer in the rack has had no usable reading for too long; the door stays locked.
    RackUnread = "rack_unread", Abort, Operator;
    /// The reading of the thermometer in the rack stands still while the temperature of the air changes; the door stays
    /// locked.
    RackStuck = "rack_stuck", Nothing, Operator;
    /// The rack has not cooled in time; it goes on cooling behind the locked door.
    CoolsSlowly = "cools_slowly", Nothing, Itself;
    /// A thermometer of the air has no usable reading.
    ThermometerBroken = "thermometer_broken", Hold, Operator;
    /// A thermometer moves faster than the air can.
    ThermometerJump = "thermometer_jump", Hold, Operator;
    /// The two thermometers of the air disagree.
    ThermometersDiffer = "thermometers_differ", Hold, Operator;
    /// The reading of a thermometer does not change although the heater has power.
    ThermometerStuck = "thermometer_stuck", Hold, Operator;
    /// The air does not warm or cool as its power demands.
    EnergyBalance = "energy_balance", Hold, Operator;
    /// The air warms without power.
    HeatWithoutCommand = "heat_without_command", Hold, Operator;
    /// The air is far above its set point.
    OverSetPoint = "over_set_point", Hold, Operator;
    /// The air does not follow a rising set point.
    RampNotReached = "ramp_not_reached", Hold, Operator;
    /// The air warms or cools faster than the recipe allows.
    RampTooFast = "ramp_too_fast", Hold, Operator;
    /// The air does not follow a falling set point.
    CoolingTooSlow = "cooling_too_slow", Hold, Operator;
    /// The identification finds no usable response of the air to the heater.
    HeatingNotIdentified = "heating_not_identified", Hold, Operator;
    /// The limiter on the heater has tripped.
    LimiterTripped = "limiter_tripped", Hold, Operator;
    /// The airflow switch is open while the fan is on.
    AirflowLost = "airflow_lost", Hold, Operator;
    /// The mains of the heater have failed.
    MainsLost = "mains_lost", Hold, Operator;
    /// Limiter, airflow switch or mains relay has no fresh reading.
    ChainNotRead = "chain_not_read", Hold, Operator;
    /// The contacts of sockets were open before heating.
    SocketsOpen = "sockets_open", Nothing, Itself;
    /// The lag of a lot is far from the one that earlier batches or the recipe state.
    LagUnexpected = "lag_unexpected", Nothing, Itself;
    /// References or reference parts do not agree with their certificates.
    CalibrationFailed = "calibration_failed", Abort, Operator;
    /// The calibration has expired during the lot.
    CalibrationOverdue = "calibration_overdue", Abort, Operator;
    /// The pusher is extended but no part is in the nest.
    PartNotInNest = "part_not_in_nest", Abort, Operator;
    /// A part sticks in the nest or in the fingers.
    PartStuck = "part_stuck", Abort, Operator;
    /// The gripper has lost its part during the transfer.
    PartDropped = "part_dropped", Abort, Operator;
    /// The drive of the sort axis reports an alarm.
    AxisDrive = "axis_drive", Abort, Operator;
    /// A step of the sequence has exceeded its timeout.
    StepTooLong = "step_too_long", Abort, Operator;
    /// The beam of a bin has counted no part, or more than one.
    BinBeam by "bin" = "bin_beam", Hold, Operator;
    /// Parts wait in the track but none has come into the pocket.
    PartNotArrived = "part_not_arrived", Hold, Operator;
    /// The track is empty.
    MagazineEmpty = "magazine_empty", Suspend, Sensor;
    /// The port of the code reader is lost.
    SerialReaderLost = "serial_reader_lost", Suspend, Sensor;
    /// The beam of a bin stays dark.
    BinFull by "bin" = "bin_full", Suspend, Sensor;
    /// A stroke has not reached its end; the machine repeats the stroke once.
    Retried of ActuatorKey = "retried", Nothing, Itself;
    /// A push button stays down.
    ButtonStuck by "input" = "button_stuck", Nothing, Sensor;
    /// The host watchdog of a module has made its outputs safe.
    WatchdogTripped by "module" = "watchdog_tripped", Nothing, Itself;
    /// The previous run ended while it measured the references.
    CalibrationCutOff by "module" = "calibration_cut_off", Nothing, Itself;
    /// No sensor shows a part that was inside.
    PartLost by "place" = "part_lost", Nothing, Itself;
    /// The previous run ended while a part fell into its bin.
    FallUnseen by "bin" = "fall_unseen", Nothing, Itself;
    /// Scanned parts have not come before the end of their run, which has dropped their numbers.
    ScansDropped by "serials" = "scans_dropped", Nothing, Itself;
    /// A sensor shows a part that the ledger does not have.
    PartFound by "place" = "part_found", Nothing, Itself;
    /// The last reference check is older than the lot allows.
    ReferenceCheckDue = "golden_check_due", Hold, Operator;
    /// A reference part disagrees with its certificate.
    ReferenceCheckFailed = "golden_check_failed", Hold, Operator;
    /// The test of a reference part was interrupted and begins again.
    ReferenceRepeated by "serial" = "golden_repeated", Nothing, Operator;
    /// More parts have failed than the reject-rate limit of the lot allows.
    RejectRateLimit = "lot_discard_limit", Hold, Operator;
    /// The contact of the probes at the coil exceeds its limit.
    ProbeContact = "probe_contact", Nothing, Operator;
    /// The use count of the probes or the jaws has reached its limit.
    Worn of Wearing = "worn", Nothing, Operator;
    /// The rig scatters more than `rig.toml` or the recipe promises.
    PromiseBroken of Promise = "promise_broken", Nothing, Operator;
    /// A database of the fleet lacks parts for longer than it may.
    FleetLate by "database" = "fleet_late", Nothing, Sensor;
    /// The stored calibration is not valid for a lot.
    CalibrationInvalid = "calibration_invalid", Abort, Operator;
}

/// Alarms after which the station tests no part until it has a new calibration.
pub const NEEDS_CALIBRATION: [AlarmCode; 2] =
    [AlarmCode::CalibrationFailed, AlarmCode::CalibrationOverdue];

/// Alarms that each concern one part: the station records each, even while an earlier one is active.
pub const PER_PART: [AlarmCode; 1] = [AlarmCode::BinBeam];

impl AlarmCode {
    /// Returns the code of this name; `None` for a name of another version.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|code| code.name() == name)
    }

    /// Returns the name in rows, views and orders; it begins with the subject: `pusher_not_reached`.
    pub fn name(self) -> String {
        let id = self.text_id();
        let subject = self.subject();
        subject.map_or(id.to_owned(), |subject| format!("{subject}_{id}"))
    }

    /// Returns the message of this code with these arguments.
    pub fn message(self, args: Args) -> Message {
        Message::of("alarm", self.text_id(), args)
    }

    /// Returns cause, consequence and action.
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
