//! The points of the chamber: heater and vent, thermometers, hard-wired safety chain, multiplexer of the sockets.

use crate::rig::point::{
    AnalogInput, AnalogOutput, DigitalInput, DigitalOutput, Fixture, MissingPoint, Quantity,
    Switch, Thermometer, all_wired,
};
use crate::rig::rack::Socket;
use crate::rig::wiring::Wiring;

/// Inputs of the hard-wired safety chain, which cuts the heater.
const CHAIN: &[&str] = &["limiter_ok", "airflow_ok", "mains_ok"];
/// Bits that give the multiplexer the number of a socket, lowest first.
const SELECT: &[&str] = &[
    "socket_select_0",
    "socket_select_1",
    "socket_select_2",
    "socket_select_3",
    "socket_select_4",
    "socket_select_5",
];
const CONTACTOR: &str = "main_contactor";
const FAN: &str = "fan";
const CURRENT: &str = "contact_current";
const DROP: &str = "socket_drop";
const HEATER: &str = "heater_power";
const VENT: &str = "vent_opening";
const CONTROL: &str = "control_temperature";
const REFERENCE: &str = "reference_temperature";
/// Surface of the heater; a rig may lack it.
const SURFACE: &str = "heater_temperature";

/// The points that `config/rig.toml` of a rig with a chamber must wire.
pub const FIXTURE: Fixture = Fixture {
    digital_in: CHAIN,
    digital_out: &[
        switch(CONTACTOR),
        switch(FAN),
        switch(SELECT[0]),
        switch(SELECT[1]),
        switch(SELECT[2]),
        switch(SELECT[3]),
        switch(SELECT[4]),
        switch(SELECT[5]),
        switch(CURRENT),
    ],
    analog_in: &[Quantity {
        name: DROP,
        unit: "V",
        step: 1e-6,
        enabled: true,
        ranged: false,
    }],
    analog_out: &[HEATER, VENT],
    temperature: &[CONTROL, REFERENCE, SURFACE],
    counter: &[],
};

const fn switch(name: &'static str) -> Switch {
    Switch {
        name,
        traced: false,
    }
}

/// Points as this rig has wired them.
#[derive(Debug, Clone)]
pub struct Points {
    /// Inputs of the hard-wired safety chain. All must be on; else the chain cuts the heater.
    pub chain: [DigitalInput; 3],
    /// Contactor of the heater.
    pub contactor: DigitalOutput,
    /// Fan of the chamber.
    pub fan: DigitalOutput,
    /// Bits that give the multiplexer the number of a socket, lowest first.
    pub select: [DigitalOutput; 6],
    /// Switches the test current through the contact of the selected socket.
    pub current: DigitalOutput,
    /// Voltage across the contact of the selected socket.
    pub drop: AnalogInput,
    /// Volts at the terminal per volt across the contact.
    pub drop_gain: f64,
    /// Power of the heater, 0 to 10 V.
    pub heater: AnalogOutput,
    /// Opening of the vent, 0 to 10 V.
    pub vent: AnalogOutput,
    /// Control thermometer, at the controller.
    pub control: Thermometer,
    /// Reference thermometer, beside the parts.
    pub reference: Thermometer,
    /// Thermometer on the surface of the heater; `None` on a rig without one.
    pub surface: Option<Thermometer>,
    /// Thermometer in the rack; `None` on a rig without a rack.
    pub rack: Option<Thermometer>,
    /// Sockets of the rack.
    pub sockets: Vec<Socket>,
}

impl Points {
    /// Resolves every point.
    ///
    /// # Errors
    /// Fails with the first point that the rig lacks.
    pub fn resolve(wiring: &Wiring) -> Result<Self, MissingPoint> {
        let out = |it: &str| wiring.digital_output(it);
        let [contactor, fan, current] = all_wired("digital_out", &[CONTACTOR, FAN, CURRENT], out)?;
        let [heater, vent] =
            all_wired("analog_out", &[HEATER, VENT], |it| wiring.analog_output(it))?;
        let [control, reference] = all_wired("temperature", &[CONTROL, REFERENCE], |it| {
            wiring.thermometer(it)
        })?;
        let [drop] = all_wired("analog_in", &[DROP], |it| wiring.analog_input(it))?;
        Ok(Self {
            chain: all_wired("digital_in", CHAIN, |it| wiring.digital_input(it))?,
            contactor,
            fan,
            select: all_wired("digital_out", SELECT, out)?,
            current,
            drop_gain: wiring.analog_in(drop).gain,
            drop,
            heater,
            vent,
            control,
            reference,
            surface: wiring.thermometer(SURFACE),
            rack: wiring.rack().map(|it| it.thermometer),
            sockets: wiring.rack().map_or(Vec::new(), |it| it.sockets().to_vec()),
        })
    }

    /// Returns the socket of a contact.
    pub fn of_contact(&self, contact: DigitalInput) -> Option<Socket> {
        self.sockets
            .iter()
            .find(|it| it.contact == contact)
            .copied()
    }

    /// Returns the outputs that select a socket by its number at the multiplexer.
    pub fn selecting(&self, select: u8) -> Vec<(DigitalOutput, bool)> {
        let bits = self.select.into_iter().enumerate();
        bits.map(|(bit, point)| (point, select >> bit & 1 == 1))
            .collect()
    }
}
