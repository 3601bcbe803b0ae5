//! The vocabulary of points: everything the rig can sense, switch, set, measure or count.
//!
//! A point is a name of the process ("pusher retracted"), never a terminal. Which module and channel
//! carries it is wiring, found in `config/rig.toml`. Three sources name points:
//! - the machine: safety, actuators, buttons, axis, lamps. A closed enum; every one must be wired.
//! - the kinds of device under test: each declares a [`Fixture`]. A rig may lack them.
//! - the bins: each names the digital input of its beam.
//!
//! The wiring resolves a name to a handle ([`DigitalInput`] and its like): an index into its table.

/// Declares one vocabulary: an enum whose variants carry their name in `config/rig.toml`.
macro_rules! points {
    ($(#[$doc:meta])* $kind:ident { $($(#[$line:meta])* $variant:ident = $name:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $kind {
            $($(#[$line])* #[doc = concat!("`", $name, "`")] $variant,)+
        }

        impl $kind {
            /// Every point of this kind, in the order of declaration.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];
            /// How many there are; [`Self::index`] is below it.
            pub const COUNT: usize = Self::ALL.len();
            /// Every name, in the order of [`Self::ALL`].
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// The name in `config/rig.toml`.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            /// The point of this name; `None` when there is none.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|point| point.name() == name)
            }

            /// Position in [`Self::ALL`].
            pub const fn index(self) -> usize {
                self as usize
            }
        }

        impl std::fmt::Display for $kind {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}
pub(crate) use points;

use thiserror::Error;

points! {
    /// Contacts and sensors of the machine; `true` means the named thing is so, whatever the polarity of the wire.
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
    }
}

points! {
    /// Transistor outputs of the machine: the valves, the axis, the lamps.
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
    }
}

/// An output that a kind declares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Switch {
    /// Its name in `config/rig.toml`.
    pub name: &'static str,
    /// Whether its changes belong to the trace of a test.
    pub traced: bool,
}

/// What an analog input that a kind declares measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Its name in `config/rig.toml`.
    pub name: &'static str,
    /// Its unit, as `config/rig.toml` must state it: `V` or `A`.
    pub unit: &'static str,
    /// Step that its values are kept in, in its unit: a tenth or less of a step of its converter.
    pub step: f64,
    /// Whether its channel must be enabled from the start: no act ever asks for its mask.
    pub enabled: bool,
}

/// The points that one kind of device declares. A rig may lack them; a recipe that needs one is then refused.
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
            /// The handle of a place in the table.
            pub(super) fn at(index: usize) -> Self {
                assert!(index < usize::from(u16::MAX), "no rig has so many points");
                Self(index as u16)
            }

            /// Place in the table of the wiring that resolved it.
            pub fn index(self) -> usize {
                self.0.into()
            }
        }
    )+ };
}

handles! {
    /// A wired digital input: of the machine, of a fixture, or the beam of a bin.
    DigitalInput,
    /// A wired digital output, of the machine or of a fixture.
    DigitalOutput,
    /// A wired analog input.
    AnalogInput,
    /// A wired analog output.
    AnalogOutput,
    /// A wired platinum resistance thermometer.
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
    /// The output of the machine that this is; `None` for one of a fixture.
    pub fn of_machine(self) -> Option<DigitalOut> {
        DigitalOut::ALL.get(self.index()).copied()
    }
}

/// A point that is read.
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
    /// Whether switching this output makes something move, so that only a cleared motion may do it.
    ///
    /// `axis_servo_on` and `axis_reset` are not among them: the slide travels only on a rising
    /// edge of `axis_drive`; servo on holds it where it is.
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
            | Self::Buzzer => false,
        }
    }
}

/// A point that a test needs and the rig does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("no [{section}].{name} in rig.toml")]
pub struct MissingPoint {
    /// Section of `config/rig.toml` where it would stand.
    pub section: &'static str,
    /// Name of the first point that is missing.
    pub name: &'static str,
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
