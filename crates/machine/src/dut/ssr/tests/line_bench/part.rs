//! AC parts for tests: true values, and errors of the fixture.

use crate::dut::ssr::points::{Device, DigitalIn, DigitalOut};

/// True values of an AC part, and errors of the fixture.
#[derive(Debug, Clone)]
pub struct Part {
    pub input_a: f64,
    pub turn_on_v: f64,
    pub turn_off_v: f64,
    /// True when the part fires only at a zero of the mains.
    pub zero_cross: bool,
    /// Voltage at which the part fires first, V.
    pub fires_v: f64,
    /// Voltage at which the part fires at later half cycles, V.
    pub again_v: f64,
    /// Delay between the rising control edge and the light, s.
    pub delay_s: f64,
    /// Delay between the falling control edge and the end of the light, s, when it is longer than `delay_s`; else 0.
    pub late_off_s: f64,
    pub threshold_v: f64,
    pub ohm: f64,
    /// Polarity that never conducts; 0 for none.
    pub dead: f64,
    /// Polarity that always conducts on the mains; 0 for none. Above 1.5 the short check finds a short, too.
    pub shorted: f64,
    /// Polarity that does not conduct in the loop, 0 for none.
    pub dead_in_loop: f64,
    pub leak_s: f64,
    pub leak_f: f64,
    /// True when the output conducts for good once it has conducted.
    pub sticks: bool,
    /// Rise of the drop from cold to warm, V.
    pub rise_v: f64,
    /// Gains of the channels.
    pub gains: [f64; 3],
    /// Delay of the shunt channel, s.
    pub delay_of_shunt_s: f64,
    /// Zero of the clamped channel, V.
    pub zero_v: f64,
    pub stray_f: f64,
    /// Inputs that the fixture never reports as on.
    pub stuck: Vec<DigitalIn>,
    /// Contactors that do not close.
    pub broken: Vec<DigitalOut>,
    /// Number of the record on the line, from 0, from which on the line is dead.
    pub dead_from: usize,
    /// Time into that record at which the line dies, s; below 0 before it.
    pub dies_s: f64,
    /// Time into the record of the loop at which the loop opens, s; infinite for a loop that stays closed.
    pub loop_opens_s: f64,
    /// Time after which a dead line or an open loop is whole again, s.
    pub heals_after_s: f64,
    /// True for a short in the socket.
    pub is_socket_shorted: bool,
    pub failing: Option<(Device, &'static str)>,
    /// Ratio of the voltage that the source has to the one asked of it.
    pub source: f64,
    pub hz: f64,
}

/// A zero-cross part inside every limit.
pub fn good() -> Part {
    Part {
        input_a: 3.8e-3,
        turn_on_v: 2.4,
        turn_off_v: 2.2,
        zero_cross: true,
        fires_v: 12.3,
        again_v: 4.2,
        delay_s: 15e-6,
        late_off_s: 0.0,
        threshold_v: 0.85,
        ohm: 0.02,
        dead: 0.0,
        shorted: 0.0,
        dead_in_loop: 0.0,
        leak_s: 4e-6 / 230.0,
        leak_f: 20e-9,
        sticks: false,
        rise_v: -6e-3,
        gains: [1.012, 0.991, 1.015],
        delay_of_shunt_s: 3e-6,
        zero_v: 0.011,
        stray_f: 1e-9,
        stuck: Vec::new(),
        broken: Vec::new(),
        dead_from: usize::MAX,
        dies_s: f64::NEG_INFINITY,
        loop_opens_s: f64::INFINITY,
        heals_after_s: f64::INFINITY,
        is_socket_shorted: false,
        failing: None,
        source: 1.0,
        hz: 49.98,
    }
}
