//! The points of the rig: everything that it can sense, switch, set, measure or count.
//!
//! A point is a name of the process ("pusher retracted"), never a terminal; `config/rig.toml` wires it to a module and
//! channel. Four sources name points:
//! - the machine: safety, actuators, buttons, axis, lamps, door. Closed enums; a rig wires those that its handling
//!   needs ([`DigitalIn::OF_FEEDER`], [`DigitalIn::OF_RACK`]) and no other.
//! - the kinds of device under test: each declares a [`Fixture`]. A rig may lack them.
//! - the bins: each names the digital input of its beam, the light barrier in its chute.
//! - the sockets of a rack: each has a digital input, its contact.
//!
//! The wiring resolves a name to a handle ([`DigitalInput`] and its like): an index into its table.

use thiserror::Error;

named! {
    /// Contacts and sensors of the machine, by their names in `config/rig.toml`; `true` means that the named state
    /// holds, whatever the polarity of the wire.
    DigitalIn {
        EmergencyStopOk = "emergency_stop_ok",
        DoorClosed = "door_closed",
        AirOk = "air_ok",
        EscapementHold = "escapement_hold",
        PocketPresent = "pocket_present",
        TrackLevel = "track_level",
        PusherRetracted = "pusher_retracted",
        PusherExtended = "pusher_extended",
        NestPresent = "nest_present",
        JawLeftOpen = "jaw_left_open",
        JawLeftClosed = "jaw_left_closed",
        JawRightOpen = "jaw_right_open",
        JawRightClosed = "jaw_right_closed",
        ProbeDown = "probe_down",
        ProbeUp = "probe_up",
        ButtonStart = "button_start",
        AxisInPosition = "axis_in_position",
        AxisBusy = "axis_busy",
        AxisAlarm = "axis_alarm",
        SortZUp = "sort_z_up",
        SortZDown = "sort_z_down",
        GripperOpen = "gripper_open",
        GripperPart = "gripper_part",
        ButtonStop = "button_stop",
        ButtonReset = "button_reset",
        DoorLocked = "door_locked",
    }
}

named! {
    /// Digital outputs of the machine, by their names in `config/rig.toml`: the valves, the axis, the lamps, the lock.
    DigitalOut {
        EscapementRelease = "escapement_release",
        PusherExtend = "pusher_extend",
        ClampClose = "clamp_close",
        ClampOpen = "clamp_open",
        ProbeLift = "probe_lift",
        SortZLower = "sort_z_lower",
        GripperClose = "gripper_close",
        GripperRelease = "gripper_release",
        AxisPoint0 = "axis_point_0",
        AxisPoint1 = "axis_point_1",
        AxisPoint2 = "axis_point_2",
        AxisDrive = "axis_drive",
        AxisServoOn = "axis_servo_on",
        AxisReset = "axis_reset",
        LampGreen = "lamp_green",
        LampYellow = "lamp_yellow",
        LampRed = "lamp_red",
        Buzzer = "buzzer",
        DoorLockRelease = "door_lock_release",
        LampReady = "lamp_ready",
        LampTesting = "lamp_testing",
        LampUnload = "lamp_unload",
    }
}

impl DigitalIn {
    /// Inputs that a rig with a feeder must have: all but the lock of a rack.
    pub const OF_FEEDER: &'static [Self] = Self::ALL.split_at(Self::DoorLocked as usize).0;
    /// Inputs that a rig with a rack must have.
    pub const OF_RACK: &'static [Self] =
        &[Self::EmergencyStopOk, Self::DoorClosed, Self::DoorLocked];
    /// Names of [`Self::OF_FEEDER`].
    pub const NAMES_OF_FEEDER: &'static [&'static str] =
        Self::NAMES.split_at(Self::OF_FEEDER.len()).0;
    /// Names of [`Self::OF_RACK`].
    pub const NAMES_OF_RACK: &'static [&'static str] = &[
        Self::EmergencyStopOk.name(),
        Self::DoorClosed.name(),
        Self::DoorLocked.name(),
    ];
}

impl DigitalOut {
    /// Outputs that a rig with a feeder must have: all up to the last one of the stack light.
    pub const OF_FEEDER: &'static [Self] = Self::ALL.split_at(Self::DoorLockRelease as usize).0;
    /// Outputs that a rig with a rack must have: all others.
    pub const OF_RACK: &'static [Self] = Self::ALL.split_at(Self::DoorLockRelease as usize).1;
    /// Names of [`Self::OF_FEEDER`].
    pub const NAMES_OF_FEEDER: &'static [&'static str] =
        Self::NAMES.split_at(Self::OF_FEEDER.len()).0;
    /// Names of [`Self::OF_RACK`].
    pub const NAMES_OF_RACK: &'static [&'static str] =
        Self::NAMES.split_at(Self::OF_FEEDER.len()).1;
}

/// A digital output declared by a kind of device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Switch {
    /// Name in `config/rig.toml`.
    pub name: &'static str,
    /// True when the trace of a test includes its changes.
    pub traced: bool,
}

/// An analog input declared by a kind of device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Name in `config/rig.toml`.
    pub name: &'static str,
    /// Unit, which `config/rig.toml` must repeat: `V` or `A`.
    pub unit: &'static str,
    /// Resolution of stored values in that unit: a tenth of a step of the converter, or less.
    pub step: f64,
    /// True when its channel must be enabled from the start, because no act sets the channel mask of its module.
    pub enabled: bool,
    /// True when the rig divides its gain by the factor of the supply range.
    pub ranged: bool,
}

/// The points that one kind of device declares. A rig may lack them; loading a recipe that needs a missing one fails.
#[derive(Debug, Clone, Copy)]
pub struct Fixture {
    /// Digital inputs.
    pub digital_in: &'static [&'static str],
    /// Digital outputs.
    pub digital_out: &'static [Switch],
    /// Analog inputs.
    pub analog_in: &'static [Quantity],
    /// Sources: analog outputs.
    pub analog_out: &'static [&'static str],
    /// Thermometers.
    pub temperature: &'static [&'static str],
    /// Gated counters on the reference clock.
    pub counter: &'static [&'static str],
}

/// Declares the handle of a wired point: an index into one table of the wiring.
macro_rules! handles {
    ($($(#[$doc:meta])* $handle:ident,)+) => { $(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $handle(pub(super) u16);

        impl $handle {
            /// Makes the handle of the point at a table index.
            pub(super) fn at(index: usize) -> Self {
                assert!(index < usize::from(u16::MAX), "more points than an index can count");
                Self(index as u16)
            }

            /// Returns the index in the table of the wiring that made the handle.
            pub fn index(self) -> usize {
                self.0.into()
            }
        }
    )+ };
}

handles! {
    /// A wired digital input: of the machine or a fixture, the beam of a bin, or the contact of a socket.
    DigitalInput,
    /// A wired digital output, of the machine or of a fixture.
    DigitalOutput,
    /// A wired analog input.
    AnalogInput,
    /// A wired analog output.
    AnalogOutput,
    /// A wired thermometer.
    Thermometer,
    /// A wired gated counter.
    GatedCounter,
}

/// The points of the machine come first in their table, in the order of the enum.
impl From<DigitalIn> for DigitalInput {
    fn from(point: DigitalIn) -> Self {
        Self(point as u16)
    }
}

impl From<DigitalOut> for DigitalOutput {
    fn from(point: DigitalOut) -> Self {
        Self(point as u16)
    }
}

impl DigitalOutput {
    /// Returns the machine's output with this handle; `None` for one of a fixture.
    pub fn of_machine(self) -> Option<DigitalOut> {
        DigitalOut::ALL.get(self.index()).copied()
    }
}

/// A point to read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Point {
    /// A digital input, with all others of its module.
    Input(DigitalInput),
    /// An analog input.
    Analog(AnalogInput),
    /// A thermometer.
    Temperature(Thermometer),
    /// A gated counter.
    Count(GatedCounter),
}

impl DigitalOut {
    /// Returns true when switching this output moves something, which needs a cleared motion.
    ///
    /// False for `axis_servo_on` and `axis_reset`: the slide travels only on a rising edge of `axis_drive`; servo on
    /// holds it in place.
    pub const fn moves(self) -> bool {
        match self {
            Self::EscapementRelease
            | Self::PusherExtend
            | Self::ClampClose
            | Self::ClampOpen
            | Self::ProbeLift
            | Self::SortZLower
            | Self::GripperClose
            | Self::GripperRelease
            | Self::AxisPoint0
            | Self::AxisPoint1
            | Self::AxisPoint2
            | Self::AxisDrive => true,
            Self::AxisServoOn
            | Self::AxisReset
            | Self::LampGreen
            | Self::LampYellow
            | Self::LampRed
            | Self::Buzzer
            | Self::DoorLockRelease
            | Self::LampReady
            | Self::LampTesting
            | Self::LampUnload => false,
        }
    }
}

/// A point that a test needs and the rig lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("no [{section}].{name} in rig.toml")]
pub struct MissingPoint {
    /// Section of `config/rig.toml` that would declare it.
    pub section: &'static str,
    /// Name of the first missing point.
    pub name: &'static str,
}

/// Returns the handle of every name, in order.
///
/// # Errors
/// Fails with the first name for which `handle` has none.
///
/// # Panics
/// Panics unless there are `N` names.
pub fn all_wired<T: Copy, const N: usize>(
    section: &'static str,
    names: &[&'static str],
    handle: impl Fn(&str) -> Option<T>,
) -> Result<[T; N], MissingPoint> {
    assert_eq!(names.len(), N, "a handle for each name");
    let mut found = Vec::with_capacity(N);
    for name in names {
        found.push(handle(name).ok_or(MissingPoint { section, name })?);
    }
    Ok(std::array::from_fn(|at| found[at]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_finds_its_point_again() {
        for &point in DigitalIn::ALL {
            assert_eq!(DigitalIn::from_name(point.name()), Some(point));
            assert_eq!(DigitalIn::ALL[point.index()], point);
        }
        for &point in DigitalOut::ALL {
            assert_eq!(DigitalOut::from_name(point.name()), Some(point));
        }
        assert_eq!(DigitalIn::from_name("coil"), None);
    }

    #[test]
    fn twelve_outputs_move_something() {
        let moving = DigitalOut::ALL.iter().filter(|out| out.moves()).count();
        assert_eq!(moving, 12);
        assert!(!DigitalOut::AxisServoOn.moves());
    }
}
