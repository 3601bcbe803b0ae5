//! The fixed names of the signals; `rig.toml` wires each signal to a terminal by its name.

/// Declares an enum by the names of its variants in files.
macro_rules! vocabulary {
    ($(#[$doc:meta])* $enum:ident { $($(#[$line:meta])* $name:ident = $text:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        #[allow(missing_docs)] // a name of config/rig.toml explains its point
        pub enum $enum { $($(#[$line])* $name),* }

        impl $enum {
            /// Every variant, in order of the enum.
            pub const ALL: &'static [$enum] = &[$($enum::$name),*];

            /// Returns the variant of this name.
            pub fn from_name(name: &str) -> Option<Self> {
                match name { $($text => Some($enum::$name),)* _ => None }
            }

            /// Returns the name in files.
            pub fn name(self) -> &'static str {
                match self { $($enum::$name => $text),* }
            }
        }
    };
}
pub(crate) use vocabulary;

vocabulary! {
    /// Signals to the controller.
    In {
        KelvinCoilA = "kelvin_coil_a", KelvinCoilB = "kelvin_coil_b", KelvinCom = "kelvin_com",
        KelvinNo = "kelvin_no", KelvinNc = "kelvin_nc", NoClosed = "no_closed",
        NcClosed = "nc_closed", Window = "window", Latch = "latch",
        SourceCompliance = "source_compliance", ProbeChain = "probe_chain",
        SupplyRange0Set = "supply_range_0_set", SupplyRange1Set = "supply_range_1_set",
        EmergencyStopOk = "emergency_stop_ok", DoorClosed = "door_closed", AirOk = "air_ok",
        EscapementHold = "escapement_hold", PocketPresent = "pocket_present",
        TrackLevel = "track_level", PusherRetracted = "pusher_retracted",
        PusherExtended = "pusher_extended", NestPresent = "nest_present",
        JawLeftOpen = "jaw_left_open", JawLeftClosed = "jaw_left_closed",
        JawRightOpen = "jaw_right_open", JawRightClosed = "jaw_right_closed",
        ProbeDown = "probe_down", ProbeUp = "probe_up", ButtonStart = "button_start",
        AxisInPosition = "axis_in_position", AxisBusy = "axis_busy", AxisAlarm = "axis_alarm",
        SortZUp = "sort_z_up", SortZDown = "sort_z_down", GripperOpen = "gripper_open",
        GripperPart = "gripper_part", ButtonStop = "button_stop", ButtonReset = "button_reset",
        BeamPass = "beam_pass", BeamCoil = "beam_coil", BeamVoltage = "beam_voltage",
        BeamTime = "beam_time", BeamContact = "beam_contact", BeamRetest = "beam_retest",
        BeamInput = "beam_input", BeamOutput = "beam_output", BeamLeakage = "beam_leakage",
        KelvinInPlus = "kelvin_in_plus", KelvinInMinus = "kelvin_in_minus",
        KelvinOut1 = "kelvin_out_1", KelvinOut2 = "kelvin_out_2",
        LineOpen = "line_open", LoopOpen = "loop_open", OutputSafe = "output_safe",
        ShortSeen = "short_seen",
    }
}

vocabulary! {
    /// Commands from the controller.
    Out {
        CoilDrive = "coil_drive", ClampDiode = "clamp_diode", SourceOn = "source_on",
        SelectNo = "select_no", SourceReverse = "source_reverse", ReferenceCoil = "reference_coil",
        ReferenceContact = "reference_contact", RampMode = "ramp_mode", Arm = "arm",
        EventNoBreak = "event_no_break", KelvinTest = "kelvin_test",
        SupplyRange0 = "supply_range_0", SupplyRange1 = "supply_range_1",
        EscapementRelease = "escapement_release", PusherExtend = "pusher_extend",
        ClampClose = "clamp_close", ClampOpen = "clamp_open", ProbeLift = "probe_lift",
        SortZLower = "sort_z_lower", GripperClose = "gripper_close",
        GripperRelease = "gripper_release", AxisPoint0 = "axis_point_0",
        AxisPoint1 = "axis_point_1", AxisPoint2 = "axis_point_2", AxisDrive = "axis_drive",
        AxisServoOn = "axis_servo_on", AxisReset = "axis_reset", LampGreen = "lamp_green",
        LampYellow = "lamp_yellow", LampRed = "lamp_red", Buzzer = "buzzer",
        LineContactor = "line_contactor", LoopContactor = "loop_contactor",
        SmuToOutput = "smu_to_output", SmuLoad = "smu_load", OutputPolarity = "output_polarity",
        DriveSelect = "drive_select", Reference0 = "reference_0", Reference1 = "reference_1",
        LoadSelect = "load_select", ShortCheck = "short_check", BleedOpen = "bleed_open",
    }
}

vocabulary! {
    /// Quantities that analog inputs measure.
    Quantity {
        CoilVoltage = "coil_voltage", CoilCurrent = "coil_current",
        ContactCurrent = "contact_current", SupplyVoltage = "supply_voltage",
        CoilVoltageFine = "coil_voltage_fine", CoilCurrentFine = "coil_current_fine",
        CoilCurrentHigh = "coil_current_high",
        ReferenceVoltage = "reference_voltage", ContactDrop = "contact_drop",
        ResidualVoltage = "residual_voltage",
    }
}

vocabulary! {
    /// Temperature sensors.
    Sensor { Nest = "nest_temperature", Ambient = "ambient_temperature", Track = "track_temperature" }
}

vocabulary! {
    /// Sources of the coil supply.
    Source { Level = "supply_level", Coarse = "supply_coarse", Fine = "supply_fine" }
}

vocabulary! {
    /// Gated counters.
    Gate { Latched = "gate_0", Contact = "gate_1" }
}

/// State of all digital commands.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Commands(u64);

impl Commands {
    /// Checks whether a command is on.
    pub fn is_on(self, out: Out) -> bool {
        self.0 >> out as u64 & 1 == 1
    }

    /// Returns the state with one command changed.
    pub fn with(self, out: Out, on: bool) -> Self {
        let bit = 1u64 << out as u64;
        Self(if on { self.0 | bit } else { self.0 & !bit })
    }

    /// Checks whether a command has switched on since `before`.
    pub fn rises(self, before: Self, out: Out) -> bool {
        self.is_on(out) && !before.is_on(out)
    }
}
