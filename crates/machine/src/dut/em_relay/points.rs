//! Points of the fixture that measures an electromagnetic relay: interface board, converters, sources, counters.
//!
//! This file declares the names; `config/rig.toml` wires them. [`Points`] exists only for a rig with every point that
//! a test needs.

use crate::instrument::act::Word;
use crate::rig::point::{
    AnalogInput, AnalogOutput, DigitalInput, DigitalOutput, Fixture, GatedCounter, MissingPoint,
    Quantity, Switch, Thermometer, all_wired,
};
use crate::rig::supply::{READ_BACK, RangeSelector, SELECT};
use crate::rig::wiring::Wiring;
use std::sync::Arc;

named! {
    /// Inputs from the interface board; `true` means that the named condition holds, whatever the polarity of the wire.
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
    }
}

named! {
    /// Outputs to the interface board. None of them moves anything.
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
    }
}

named! {
    /// Analog inputs that a test or its calibration reads.
    AnalogIn {
        CoilCurrent = "coil_current",
        CoilVoltageFine = "coil_voltage_fine",
        CoilCurrentFine = "coil_current_fine",
        ReferenceVoltage = "reference_voltage",
        ContactDrop = "contact_drop",
        SupplyVoltage = "supply_voltage",
        CoilCurrentHigh = "coil_current_high",
    }
}

impl AnalogIn {
    /// Returns true for an input that every rig for relays must have.
    pub const fn is_needed(self) -> bool {
        match self {
            Self::CoilCurrent
            | Self::CoilVoltageFine
            | Self::CoilCurrentFine
            | Self::ReferenceVoltage
            | Self::ContactDrop => true,
            Self::SupplyVoltage | Self::CoilCurrentHigh => false,
        }
    }
}

named! {
    /// The three outputs whose sum, amplified, is the coil supply.
    AnalogOut {
        SupplyLevel = "supply_level",
        SupplyCoarse = "supply_coarse",
        SupplyFine = "supply_fine",
    }
}

named! {
    /// Gated counters on the reference clock.
    Counter {
        Gate0 = "gate_0",
        Gate1 = "gate_1",
    }
}

/// Meaning of the bits of the signal [`BOARD`], highest first.
pub const BOARD_BITS: &str = "supply range 1 0 where the rig has ranges, \
     Kelvin NC NO COM coil B A, probes up, no compliance, NC closed, NO closed";

/// Thermometer of the magazine track, taken as that of the part.
const TRACK: &str = "track_temperature";

/// Inputs of the board that one reading samples together, from bit 0 on; the inputs that read the range back follow
/// them.
const BOARD_INPUTS: [DigitalIn; 9] = [
    DigitalIn::NoClosed,
    DigitalIn::NcClosed,
    DigitalIn::SourceCompliance,
    DigitalIn::ProbeChain,
    DigitalIn::KelvinCoilA,
    DigitalIn::KelvinCoilB,
    DigitalIn::KelvinCom,
    DigitalIn::KelvinNo,
    DigitalIn::KelvinNc,
];
/// Signal name of [`BOARD_INPUTS`].
pub const BOARD: &str = "board";

const INPUTS: [&str; DigitalIn::COUNT + READ_BACK.len()] = {
    let mut all = [READ_BACK[0]; DigitalIn::COUNT + READ_BACK.len()];
    let mut at = 0;
    while at < DigitalIn::COUNT {
        all[at] = DigitalIn::NAMES[at];
        at += 1;
    }
    all[at + 1] = READ_BACK[1];
    all
};

/// Every point of this kind that `config/rig.toml` may have; a test needs only those declared above.
pub const FIXTURE: Fixture = Fixture {
    digital_in: &INPUTS,
    digital_out: &SWITCHES,
    analog_in: &QUANTITIES,
    analog_out: AnalogOut::NAMES,
    temperature: &["nest_temperature", "ambient_temperature", TRACK],
    counter: Counter::NAMES,
};

const QUANTITIES: [Quantity; 9] = [
    Quantity {
        ranged: true,
        ..quantity("coil_voltage", "V", 1e-5)
    },
    quantity("coil_current", "A", 1e-8),
    quantity("contact_current", "A", 1e-5),
    quantity("supply_voltage", "V", 1e-5),
    COIL_VOLTAGE,
    quantity("coil_current_fine", "A", 1e-8),
    quantity("coil_current_high", "A", 1e-7),
    quantity("reference_voltage", "V", 1e-5),
    // Every test reads the contact drop, and no act sets the channel mask of its module.
    Quantity {
        enabled: true,
        ..quantity("contact_drop", "V", 1e-7)
    },
];

/// Signal of the coil voltage.
pub const COIL_VOLTAGE: Quantity = Quantity {
    ranged: true,
    ..quantity("coil_voltage_fine", "V", 1e-5)
};

const fn quantity(name: &'static str, unit: &'static str, step: f64) -> Quantity {
    Quantity {
        name,
        unit,
        step,
        enabled: false,
        ranged: false,
    }
}

const SWITCHES: [Switch; DigitalOut::COUNT + SELECT.len()] = {
    let mut all = [Switch {
        name: SELECT[0],
        traced: false,
    }; DigitalOut::COUNT + SELECT.len()];
    let mut at = 0;
    while at < DigitalOut::COUNT {
        let output = DigitalOut::ALL[at];
        all[at].name = output.name();
        all[at].traced = matches!(output, DigitalOut::CoilDrive);
        at += 1;
    }
    all[at + 1].name = SELECT[1];
    all
};

/// Points of a test as this rig has wired them.
#[derive(Debug, Clone)]
pub struct Points {
    inputs: [DigitalInput; DigitalIn::COUNT],
    outputs: [DigitalOutput; DigitalOut::COUNT],
    /// Analog inputs, each with its gain, volts at the terminal per unit.
    analog: [Option<(AnalogInput, f64)>; AnalogIn::COUNT],
    sources: [AnalogOutput; AnalogOut::COUNT],
    counters: [GatedCounter; Counter::COUNT],
    /// Thermometer of the magazine track, whose temperature counts as that of the part.
    pub track: Thermometer,
    /// Inputs of the board that one reading samples together.
    pub board: Arc<Word>,
    /// Points that select the range of the supply; `None` on a rig with one range.
    pub range: Option<RangeSelector>,
}

impl Points {
    /// Resolves every point.
    ///
    /// # Errors
    /// Fails with the first point that the rig lacks.
    pub fn resolve(wiring: &Wiring) -> Result<Self, MissingPoint> {
        let inputs = all_wired("digital_in", DigitalIn::NAMES, |it| {
            wiring.digital_input(it)
        })?;
        let outputs = all_wired("digital_out", DigitalOut::NAMES, |it| {
            wiring.digital_output(it)
        })?;
        let gained = |input| (input, wiring.analog_in(input).gain);
        let analog = AnalogIn::NAMES.iter().map(|it| wiring.analog_input(it));
        let analog: Vec<Option<(AnalogInput, f64)>> = analog.map(|it| it.map(gained)).collect();
        let mut lacks = AnalogIn::ALL.iter().zip(&analog);
        if let Some((point, _)) = lacks.find(|(it, at)| it.is_needed() && at.is_none()) {
            return Err(MissingPoint {
                section: "analog_in",
                name: point.name(),
            });
        }
        let sources = all_wired("analog_out", AnalogOut::NAMES, |it| {
            wiring.analog_output(it)
        })?;
        let counters = all_wired("counter", Counter::NAMES, |it| wiring.gated_counter(it))?;
        let [track] = all_wired("temperature", &[TRACK], |it| wiring.thermometer(it))?;
        let range = wiring.range_selector();
        let board = BOARD_INPUTS.map(|it| inputs[it.index()]).into_iter();
        let board = Arc::new(Word {
            name: BOARD,
            inputs: board.chain(range.iter().flat_map(|it| it.inputs)).collect(),
        });
        Ok(Self {
            inputs,
            outputs,
            analog: std::array::from_fn(|at| analog[at]),
            range,
            sources,
            counters,
            track,
            board,
        })
    }

    /// Returns an input of the board.
    pub fn input(&self, point: DigitalIn) -> DigitalInput {
        self.inputs[point.index()]
    }

    /// Returns an output of the board.
    pub fn output(&self, point: DigitalOut) -> DigitalOutput {
        self.outputs[point.index()]
    }

    /// Returns an analog input; panics for one that the rig lacks.
    pub fn analog(&self, point: AnalogIn) -> AnalogInput {
        let Some(input) = self.wired_analog(point) else {
            panic!("a rig without {point} is read");
        };
        input
    }

    /// Returns an analog input; `None` where the rig lacks it.
    pub fn wired_analog(&self, point: AnalogIn) -> Option<AnalogInput> {
        self.analog[point.index()].map(|(input, _)| input)
    }

    /// Returns the gain of an analog input, volts at the terminal per unit; `None` where the rig lacks it.
    pub fn gain(&self, point: AnalogIn) -> Option<f64> {
        self.analog[point.index()].map(|(_, gain)| gain)
    }

    /// Returns one of the three outputs of the supply.
    pub fn source(&self, point: AnalogOut) -> AnalogOutput {
        self.sources[point.index()]
    }

    /// Returns a counter.
    pub fn counter(&self, point: Counter) -> GatedCounter {
        self.counters[point.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_analog_input_of_a_test_is_declared() {
        for name in AnalogIn::NAMES {
            let declared = QUANTITIES.iter().any(|it| it.name == *name);
            assert!(declared, "{name}");
        }
    }

    #[test]
    fn every_digital_point_has_a_word_on_the_screen() {
        for name in DigitalIn::NAMES.iter().chain(DigitalOut::NAMES) {
            let id = format!("signal-{name}");
            assert!(texts::plain().any(|it| it.id == id), "{name}");
        }
    }
}
