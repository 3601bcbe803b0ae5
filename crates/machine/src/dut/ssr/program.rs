//! Queries of the test: programs of the profiles with their arguments.

use super::ac_plan::{self, AcPlan, Scales};
use super::measure::ramp::Ramp;
use super::plan::{CurrentRange, DcPlan, LOAD_OHM, LOAD_V, PERIOD_S, PULSE_OHM, Plan};
use super::points::{Device, Points};
use super::wave::staircase::Levels;
use crate::instrument::query::{Query, Shown};

/// Channel of the digitizer at the control input.
pub const CONTROL_CHANNEL: f64 = 1.0;
/// Channel of the digitizer at the output, behind the divider.
pub const DIVIDED_CHANNEL: f64 = 2.0;
/// Channel of the digitizer at the shunt of the load.
pub const SHUNT_CHANNEL: f64 = 4.0;
/// Channel of the digitizer at the output, clamped to +-10 V.
pub const OUTPUT_CHANNEL: f64 = 3.0;
/// Time after the begin of the current up to which the drop is read, s.
const DRIFT_S: f64 = 0.2;
/// Vertical divisions from the middle of the screen to its edge, with room.
const HALF_SCREEN: f64 = 3.5;
/// Horizontal divisions of a record.
const DIVISIONS: f64 = 10.0;
/// Share of a record before the trigger.
pub const BEFORE: f64 = 0.1;
/// Length of the record of an answer, divided by the time within which the output must answer.
pub const ANSWER: f64 = 2.0;
/// Samples of the record of an answer.
const ANSWER_POINTS: f64 = 1e3;
/// Samples of the record of a ramp.
const SWEEP_POINTS: f64 = 1e4;

/// Returns the number of readings of the drop over time: one period of the mains each, the last two around 200 ms.
pub fn drop_count() -> usize {
    (DRIFT_S / PERIOD_S).round() as usize + 1
}

fn drop_arguments(plan: &DcPlan, ampere: f64) -> [(&'static str, f64); 5] {
    let (source, meter) = (&plan.drop.source, &plan.drop.meter);
    [
        ("range_a", source.full_scale),
        ("limit_v", meter.full_scale),
        ("range_v", meter.full_scale),
        ("periods", 1.0),
        ("level_a", ampere),
    ]
}

impl Points {
    fn query(
        &self,
        device: Device,
        program: &'static str,
        arguments: &[(&'static str, f64)],
    ) -> Query {
        Query {
            instrument: self.instrument(device),
            program,
            arguments: arguments.to_vec(),
            shows: Vec::new(),
        }
    }

    fn showing(
        &self,
        (channel, points): (f64, f64),
        shows: impl IntoIterator<Item = Shown>,
    ) -> Query {
        let arguments = [("channel", channel), ("points", points)];
        Query {
            shows: shows.into_iter().collect(),
            ..self.query(Device::Digitizer, "waveform", &arguments)
        }
    }

    fn ranged(
        &self,
        device: Device,
        program: &'static str,
        level_v: f64,
        range: &CurrentRange,
    ) -> Query {
        let arguments = [
            ("range_v", range.source.full_scale),
            ("limit_a", range.meter.full_scale),
            ("range_a", range.meter.full_scale),
            ("periods", range.periods),
            ("level_v", level_v),
        ];
        self.query(device, program, &arguments)
    }

    /// Sets a voltage with its ranges.
    pub fn source(&self, device: Device, level_v: f64, range: &CurrentRange) -> Query {
        self.ranged(device, "source", level_v, range)
    }

    /// Sets a voltage with its ranges and reads the current twice.
    pub fn source_and_read(&self, device: Device, level_v: f64, range: &CurrentRange) -> Query {
        self.ranged(device, "source_and_read", level_v, range)
    }

    /// Sets a voltage with its ranges and reads the current twice: briefly, then over its averaging time.
    pub fn settle_and_read(&self, device: Device, level_v: f64, range: &CurrentRange) -> Query {
        self.ranged(device, "settle_and_read", level_v, range)
    }

    /// Sets another voltage in the same ranges.
    pub fn level(&self, device: Device, level_v: f64) -> Query {
        self.query(device, "level", &[("level_v", level_v)])
    }

    /// Runs a staircase of the control voltage, `dwell_s` at each level besides the reading of its current.
    pub fn staircase(&self, levels: &Levels, dwell_s: f64) -> Query {
        let arguments = [
            ("from_v", levels.first_v),
            ("to_v", levels.last_v()),
            ("step_v", levels.step_v.abs()),
            ("dwell_s", dwell_s),
            ("points", levels.count as f64),
        ];
        self.query(Device::SmuIn, "ramp", &arguments)
    }

    /// Holds `before_v` for one reading, then sets `level_v`.
    pub fn step(&self, device: Device, before_v: f64, level_v: f64) -> Query {
        let arguments = [("before_v", before_v), ("level_v", level_v)];
        self.query(device, "step", &arguments)
    }

    /// Reads once.
    pub fn read(&self, device: Device) -> Query {
        self.query(device, "read", &[])
    }

    /// Sets a source to 0 and takes its output off.
    pub fn off(&self, device: Device) -> Query {
        self.query(device, "off", &[])
    }

    /// Reads the drop at `ampere`.
    pub fn drop_at(&self, plan: &DcPlan, ampere: f64) -> Query {
        let arguments = drop_arguments(plan, ampere);
        self.query(Device::SmuOut, "drop_at_current", &arguments)
    }

    /// Reads the drop [`drop_count`] times from the instant at which `ampere` begins.
    pub fn drops(&self, plan: &DcPlan, ampere: f64) -> Query {
        let mut arguments = drop_arguments(plan, ampere).to_vec();
        arguments.push(("count", drop_count() as f64));
        self.query(Device::SmuOut, "drops_over_time", &arguments)
    }

    /// Prepares one control pulse. `input_a` is the current of the control input, A; the program raises the level by
    /// the drop of this current in the source.
    pub fn train(&self, plan: &Plan, input_a: f64) -> Query {
        let width_s = plan.pulse_s();
        let arguments = [
            ("level_v", plan.control_v + PULSE_OHM * input_a),
            ("period_s", 2.0 * width_s),
            ("width_s", width_s),
            ("pulses", 1.0),
        ];
        self.query(Device::PulseSource, "train", &arguments)
    }

    /// Sends the pulse.
    pub fn start(&self) -> Query {
        self.query(Device::PulseSource, "start", &[])
    }

    /// Arms the digitizer.
    pub fn capture(&self, plan: &Plan) -> Query {
        let record_s = plan.record_s();
        let arguments = [
            ("control_v_per_div", plan.control_v / HALF_SCREEN),
            ("output_v_per_div", LOAD_V / HALF_SCREEN),
            ("s_per_div", record_s / DIVISIONS),
            ("offset_s", (0.5 - BEFORE) * record_s),
            ("points", plan.samples()),
            ("level_v", plan.control_v / 2.0),
        ];
        self.query(Device::Digitizer, "capture", &arguments)
    }

    /// Arms the digitizer for the step of the control voltage from one level to the other, after which the output must
    /// have answered within `within_s`.
    pub fn capture_answer(&self, step_v: (f64, f64), within_s: f64) -> Query {
        let record = (ANSWER * within_s, ANSWER_POINTS);
        self.capture_edge(step_v.0.max(step_v.1), step_v, record)
    }

    /// Arms the digitizer for a ramp that begins with the step of the control voltage from one level to the other.
    pub fn capture_sweep(&self, plan: &Plan, step_v: (f64, f64), record_s: f64) -> Query {
        self.capture_edge(plan.control_v, step_v, (record_s, SWEEP_POINTS))
    }

    /// Arms the digitizer for a step of the control voltage, which is at most `most_v` in the record, and for a record
    /// of this length and number of samples.
    fn capture_edge(
        &self,
        most_v: f64,
        (from_v, to_v): (f64, f64),
        (record_s, points): (f64, f64),
    ) -> Query {
        let program = match to_v > from_v {
            true => "capture",
            false => "capture_falling",
        };
        let arguments = [
            ("control_v_per_div", most_v / HALF_SCREEN),
            ("output_v_per_div", LOAD_V / HALF_SCREEN),
            ("s_per_div", record_s / DIVISIONS),
            ("offset_s", (0.5 - BEFORE) * record_s),
            ("points", points),
            ("level_v", f64::midpoint(from_v, to_v)),
        ];
        self.query(Device::Digitizer, program, &arguments)
    }

    /// Runs a ramp of the control voltage.
    pub fn sweep(&self, ramp: &Ramp) -> Query {
        let arguments = [
            ("from_v", ramp.first_v),
            ("to_v", ramp.last_v()),
            ("step_v", ramp.step_v.abs()),
            ("dwell_s", ramp.dwell_s),
            ("points", ramp.count as f64),
        ];
        self.query(Device::SmuIn, "ramp", &arguments)
    }

    /// Reads one channel of the record of a ramp.
    pub fn swept(&self, channel: f64) -> Query {
        self.showing((channel, SWEEP_POINTS), dc_shows(channel))
    }

    /// Reads the output in the record of an answer.
    pub fn answer(&self) -> Query {
        self.showing((OUTPUT_CHANNEL, ANSWER_POINTS), dc_shows(OUTPUT_CHANNEL))
    }

    /// Proves that the record is complete.
    pub fn complete(&self) -> Query {
        self.query(Device::Digitizer, "complete", &[])
    }

    /// Reads one channel of the record.
    pub fn waveform(&self, plan: &Plan, channel: f64) -> Query {
        self.showing((channel, plan.samples()), dc_shows(channel))
    }

    /// Sets voltage and current limit of the AC source; its output is on afterwards.
    pub fn mains(&self, plan: &AcPlan, level_v: f64, limit_a: f64) -> Query {
        let arguments = [
            ("level_v", level_v),
            ("frequency_hz", plan.mains_hz),
            ("limit_a", limit_a),
        ];
        self.query(Device::AcSource, "set", &arguments)
    }

    /// Sets voltage and current limit of the AC source anew.
    pub fn mains_level(&self, level_v: f64, limit_a: f64) -> Query {
        let arguments = [("level_v", level_v), ("limit_a", limit_a)];
        self.query(Device::AcSource, "level", &arguments)
    }

    /// Measures the voltage of the AC source.
    pub fn measure_mains(&self) -> Query {
        self.query(Device::AcSource, "voltage", &[])
    }

    /// Prepares the pulses of the train.
    pub fn pulses(&self, plan: &Plan, ac: &AcPlan, input_a: f64) -> Query {
        let arguments = [
            ("level_v", plan.control_v + PULSE_OHM * input_a),
            ("period_s", ac.period_s()),
            ("width_s", ac.pulse_s()),
            ("pulses", ac.phases),
        ];
        self.query(Device::PulseSource, "train", &arguments)
    }

    /// Arms the digitizer with the scales of all channels; the record begins [`ac_plan::BEFORE`] before the rising
    /// edge.
    pub fn capture_all(&self, plan: &Plan, scales: &Scales) -> Query {
        self.capture_step(
            plan,
            scales,
            (0.0, plan.turn_on_v.unwrap_or(plan.control_v)),
        )
    }

    /// Arms the digitizer as [`Self::capture_all`] does, around the step of the control voltage from one level to the
    /// other.
    pub fn capture_step(&self, plan: &Plan, scales: &Scales, (from_v, to_v): (f64, f64)) -> Query {
        let program = match to_v > from_v {
            true => "capture_all",
            false => "capture_all_falling",
        };
        let arguments = [
            ("control_v_per_div", plan.control_v / HALF_SCREEN),
            ("divided_v_per_div", scales.divided_v),
            ("output_v_per_div", scales.clamped_v),
            ("shunt_v_per_div", scales.shunt_v),
            ("s_per_div", scales.record_s / DIVISIONS),
            ("offset_s", (0.5 - ac_plan::BEFORE) * scales.record_s),
            ("points", scales.points),
            ("level_v", f64::midpoint(from_v, to_v)),
        ];
        self.query(Device::Digitizer, program, &arguments)
    }

    /// Proves that a record with these scales is complete, and reads channels of it.
    pub fn record(&self, scales: &Scales, channels: &[f64]) -> Vec<Query> {
        let channels = channels.iter().map(|it| self.channel(scales, *it));
        std::iter::once(self.complete()).chain(channels).collect()
    }

    /// Triggers the digitizer at once, without an edge.
    pub fn force_trigger(&self) -> Query {
        self.query(Device::Digitizer, "force_trigger", &[])
    }

    /// Reads one channel of a record with these scales.
    fn channel(&self, scales: &Scales, channel: f64) -> Query {
        self.showing((channel, scales.points), ac_shows(scales, channel))
    }
}

/// Returns a voltage that a channel shows.
const fn volts(name: &'static str, factor: f64, offset: f64) -> Shown {
    Shown {
        name,
        unit: "V",
        step: 1e-3,
        factor,
        offset,
    }
}

/// Returns what the trace shows of a load: its voltage, and its current, which follows from its resistance `ohm`.
fn load(factor: f64, offset: f64, ohm: f64) -> Vec<Shown> {
    let current = Shown {
        name: "load_current",
        unit: "A",
        step: 1e-6,
        factor: factor / ohm,
        offset: offset / ohm,
    };
    vec![volts("load_voltage", factor, offset), current]
}

/// Returns what a channel shows of a DC part. The voltage of the load is that of the source less that of the output.
fn dc_shows(channel: f64) -> Vec<Shown> {
    match channel == CONTROL_CHANNEL {
        true => vec![volts("control_voltage", 1.0, 0.0)],
        false => load(-1.0, LOAD_V, LOAD_OHM),
    }
}

/// Returns what a channel shows of an AC part, without the corrections by the references.
fn ac_shows(scales: &Scales, channel: f64) -> Vec<Shown> {
    if channel == CONTROL_CHANNEL {
        vec![volts("control_voltage", 1.0, 0.0)]
    } else if channel == DIVIDED_CHANNEL {
        vec![volts("output_voltage", ac_plan::DIVIDER, 0.0)]
    } else if channel == SHUNT_CHANNEL {
        let (ohm, shunt_ohm) = (scales.circuit.ohm(), scales.circuit.shunt_ohm());
        load(ohm / shunt_ohm, 0.0, ohm)
    } else {
        vec![volts("clamped_voltage", 1.0, 0.0)]
    }
}
