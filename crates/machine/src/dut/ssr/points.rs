//! Points and instruments of the fixture that measures a solid-state relay. `rig.toml` wires them.

use crate::instrument::act::Word;
use crate::instrument::query::Instrument;
use crate::rig::point::{
    AnalogInput, DigitalInput, DigitalOutput, Fixture, MissingPoint, Quantity, Switch, all_wired,
};
use crate::rig::wiring::Wiring;
use std::sync::Arc;

named! {
    /// Inputs from the fixture; `true` means that the named condition holds, whatever the polarity of the wire.
    DigitalIn {
        KelvinInPlus = "kelvin_in_plus",
        KelvinInMinus = "kelvin_in_minus",
        KelvinOut1 = "kelvin_out_1",
        KelvinOut2 = "kelvin_out_2",
        LineOpen = "line_open",
        LoopOpen = "loop_open",
        OutputSafe = "output_safe",
        ShortSeen = "short_seen",
        ProbeChain = "probe_chain",
    }
}

named! {
    /// Outputs to the fixture; all are off when the rig is safe.
    DigitalOut {
        LineContactor = "line_contactor",
        LoopContactor = "loop_contactor",
        SmuToOutput = "smu_to_output",
        SmuLoad = "smu_load",
        OutputPolarity = "output_polarity",
        DriveSelect = "drive_select",
        Reference0 = "reference_0",
        Reference1 = "reference_1",
        LoadSelect = "load_select",
        ShortCheck = "short_check",
        KelvinTest = "kelvin_test",
        BleedOpen = "bleed_open",
    }
}

named! {
    /// Instruments of the fixture, by their names in `rig.toml`.
    Device {
        SmuIn = "smu_in",
        SmuOut = "smu_out",
        Digitizer = "digitizer",
        PulseSource = "pulse_source",
        AcSource = "ac_source",
    }
}

/// Input that reads the voltage at the socket without any instrument.
const RESIDUAL: &str = "residual_voltage";
/// Name of the word that holds all inputs of the fixture, a bit each.
pub const FIXTURE_SIGNAL: &str = "fixture";

/// Every point of this kind that `rig.toml` may have.
pub const FIXTURE: Fixture = Fixture {
    digital_in: DigitalIn::NAMES,
    digital_out: &SWITCHES,
    analog_in: &[Quantity {
        name: RESIDUAL,
        unit: "V",
        step: 1e-2,
        enabled: true,
        ranged: false,
    }],
    analog_out: &[],
    temperature: &[
        "nest_temperature",
        "ambient_temperature",
        "track_temperature",
    ],
    counter: &[],
};

const SWITCHES: [Switch; DigitalOut::COUNT] = {
    let mut all = [Switch {
        name: "",
        traced: true,
    }; DigitalOut::COUNT];
    let mut at = 0;
    while at < DigitalOut::COUNT {
        all[at].name = DigitalOut::NAMES[at];
        at += 1;
    }
    all
};

/// Points and instruments as this rig has wired them.
#[derive(Debug, Clone)]
pub struct Points {
    inputs: [DigitalInput; DigitalIn::COUNT],
    outputs: [DigitalOutput; DigitalOut::COUNT],
    instruments: [Option<Instrument>; Device::COUNT],
    /// Input that reads the voltage at the socket.
    pub residual: AnalogInput,
    /// Every digital input, read together.
    pub fixture: Arc<Word>,
}

impl Points {
    /// Resolves every point and instrument; only an output for an AC load needs the AC source.
    ///
    /// # Errors
    /// Fails with the first point or instrument that the rig lacks.
    pub fn resolve(wiring: &Wiring, needs_ac: bool) -> Result<Self, MissingPoint> {
        let inputs = all_wired("digital_in", DigitalIn::NAMES, |it| {
            wiring.digital_input(it)
        })?;
        let outputs = all_wired("digital_out", DigitalOut::NAMES, |it| {
            wiring.digital_output(it)
        })?;
        let [residual] = all_wired("analog_in", &[RESIDUAL], |it| wiring.analog_input(it))?;
        let mut instruments = [None; Device::COUNT];
        for device in Device::ALL {
            instruments[device.index()] = wiring.instrument_named(device.name());
        }
        let needed = |it: &&Device| **it != Device::AcSource || needs_ac;
        let mut all = Device::ALL.iter().filter(needed);
        if let Some(missing) = all.find(|it| instruments[it.index()].is_none()) {
            let (section, name) = ("instrument", missing.name());
            return Err(MissingPoint { section, name });
        }
        let fixture = Arc::new(Word {
            name: FIXTURE_SIGNAL,
            inputs: inputs.to_vec(),
        });
        Ok(Self {
            inputs,
            outputs,
            instruments,
            residual,
            fixture,
        })
    }

    /// Returns an input of the fixture.
    pub fn input(&self, point: DigitalIn) -> DigitalInput {
        self.inputs[point.index()]
    }

    /// Returns every output of the fixture with its state; those in `on` are on.
    pub fn outputs(&self, on: &[DigitalOut]) -> Vec<(DigitalOutput, bool)> {
        let all = DigitalOut::ALL.iter();
        all.map(|it| (self.outputs[it.index()], on.contains(it)))
            .collect()
    }

    /// Returns an instrument.
    ///
    /// # Panics
    /// Panics for an instrument that the rig lacks; resolving has checked all that the recipe needs.
    pub fn instrument(&self, device: Device) -> Instrument {
        let Some(instrument) = self.instruments[device.index()] else {
            panic!("a test without need for {device} asks for it");
        };
        instrument
    }

    /// Returns true when the rig has the instrument.
    pub fn has(&self, device: Device) -> bool {
        self.instruments[device.index()].is_some()
    }
}
