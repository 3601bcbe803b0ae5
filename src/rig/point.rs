//! The closed vocabulary of points: everything the rig can sense, switch, set, measure or count.
//!
//! A point is a name of the process ("pusher retracted"), never a terminal. Which module and channel
//! carries it is wiring, found in `config/rig.toml`, where every point of this file must appear once.

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

points! {
    /// Contacts and sensors; `true` means the named thing is so, whatever the polarity of the wire.
    DigitalIn {
        KelvinCoilA = "kelvin_coil_a",
        KelvinCoilB = "kelvin_coil_b",
        KelvinCom = "kelvin_com",
        KelvinNo = "kelvin_no",
        KelvinNc = "kelvin_nc",
        NoClosed = "no_closed",
        NcClosed = "nc_closed",
        Window = "window",
        Latch = "latch",
        SourceCompliance = "source_compliance",
        ProbeChain = "probe_chain",
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
        BeamPass = "beam_pass",
        BeamCoil = "beam_coil",
        BeamVoltage = "beam_voltage",
        BeamTime = "beam_time",
        BeamContact = "beam_contact",
        BeamRetest = "beam_retest",
    }
}

points! {
    /// Transistor outputs: the interface board, the valves, the axis, the lamps.
    DigitalOut {
        CoilDrive = "coil_drive",
        ClampDiode = "clamp_diode",
        SourceOn = "source_on",
        SelectNo = "select_no",
        SourceReverse = "source_reverse",
        ReferenceCoil = "reference_coil",
        ReferenceContact = "reference_contact",
        RampMode = "ramp_mode",
        Arm = "arm",
        EventNoBreak = "event_no_break",
        KelvinTest = "kelvin_test",
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

points! {
    /// Analog inputs of the measuring line.
    AnalogIn {
        CoilVoltage = "coil_voltage",
        CoilCurrent = "coil_current",
        ContactCurrent = "contact_current",
        SupplyVoltage = "supply_voltage",
        CoilVoltageFine = "coil_voltage_fine",
        CoilCurrentFine = "coil_current_fine",
        ReferenceVoltage = "reference_voltage",
        ContactDrop = "contact_drop",
    }
}

points! {
    /// The three outputs whose sum, amplified, is the coil supply.
    AnalogOut {
        SupplyLevel = "supply_level",
        SupplyCoarse = "supply_coarse",
        SupplyFine = "supply_fine",
    }
}

points! {
    /// Platinum resistance thermometers.
    Temperature {
        Nest = "nest_temperature",
        Ambient = "ambient_temperature",
        Track = "track_temperature",
    }
}

points! {
    /// Gated counters on the reference clock.
    Counter {
        Gate0 = "gate_0",
        Gate1 = "gate_1",
    }
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
            Self::CoilDrive
            | Self::ClampDiode
            | Self::SourceOn
            | Self::SelectNo
            | Self::SourceReverse
            | Self::ReferenceCoil
            | Self::ReferenceContact
            | Self::RampMode
            | Self::Arm
            | Self::EventNoBreak
            | Self::KelvinTest
            | Self::AxisServoOn
            | Self::AxisReset
            | Self::LampGreen
            | Self::LampYellow
            | Self::LampRed
            | Self::Buzzer => false,
        }
    }
}

impl AnalogIn {
    /// Unit of the quantity at this point, as `config/rig.toml` must state it.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::CoilVoltage
            | Self::SupplyVoltage
            | Self::CoilVoltageFine
            | Self::ReferenceVoltage
            | Self::ContactDrop => "V",
            Self::CoilCurrent | Self::ContactCurrent | Self::CoilCurrentFine => "A",
        }
    }
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
        assert_eq!(AnalogIn::from_name("coil"), None);
    }

    #[test]
    fn twelve_outputs_move_something() {
        let moving = DigitalOut::ALL.iter().filter(|out| out.moves()).count();
        assert_eq!(moving, 12);
        assert!(!DigitalOut::ClampDiode.moves());
    }
}
