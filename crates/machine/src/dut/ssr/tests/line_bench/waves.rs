//! Waveforms of a part or a reference on the line, in the loop, or fed by the SMU.

use super::LineBench;
use crate::dut::ssr::points::DigitalOut;
use std::cmp::Ordering;
use std::f64::consts::{SQRT_2, TAU};

/// State of the output while a record is simulated.
#[derive(Debug, Clone, Copy, Default)]
struct Flow {
    polarity: f64,
    has_fired: bool,
    was_lit: bool,
    current_a: f64,
    volts: f64,
}

impl LineBench {
    fn control_v(&self, at_s: f64) -> f64 {
        let before = self.control.iter().rev().find(|it| it.0 <= at_s);
        before.map_or(0.0, |it| it.1)
    }

    fn is_lit(&self, at_s: f64, was: bool) -> bool {
        let level = |at_s: f64| self.control_v(at_s);
        let least_v = if was {
            self.part.turn_off_v
        } else {
            self.part.turn_on_v
        };
        level(at_s - self.part.delay_s) >= least_v
            || (self.part.late_off_s > 0.0 && level(at_s - self.part.late_off_s) >= least_v)
    }

    fn source_v(&self, at_s: f64) -> f64 {
        let has_healed = at_s >= self.dead_s + self.part.heals_after_s;
        if at_s >= self.dead_s && !has_healed {
            return 0.0;
        }
        let omega = TAU * self.part.hz;
        let shape = (omega * at_s).sin() + 0.02 * (3.0 * omega * at_s + 0.4).sin();
        SQRT_2 * self.level_v * shape
    }

    /// Returns the rise of the source voltage, V/s.
    fn slope(&self, at_s: f64) -> f64 {
        (self.source_v(at_s + 5e-7) - self.source_v(at_s - 5e-7)) * 1e6
    }

    /// Advances the output to an instant.
    fn flows(&self, flow: &mut Flow, at_s: f64, step_s: f64) {
        let part = &self.part;
        let line = self.is_on(DigitalOut::LineContactor);
        let ohm = if line { 2300.0 } else { 4.7 };
        let source_v = if line || self.is_on(DigitalOut::LoopContactor) {
            self.source_v(at_s)
        } else {
            0.0
        };
        let lit =
            self.is_lit(at_s, flow.was_lit) || self.has_stuck || (part.sticks && flow.has_fired);
        if !lit && flow.polarity == 0.0 {
            flow.has_fired = false;
        }
        flow.was_lit = lit;
        let sign = source_v.signum();
        let drop_v = part.threshold_v + part.rise_v;
        if flow.polarity != 0.0 && source_v * flow.polarity <= drop_v {
            flow.polarity = 0.0;
        }
        let is_dead = sign == part.dead || (!line && sign == part.dead_in_loop);
        if flow.polarity == 0.0 && !is_dead {
            let rises = (self.source_v(at_s + step_s) - source_v) * sign > 0.0;
            let near = source_v.abs() < 25.0;
            let fires = match (flow.has_fired, part.zero_cross) {
                (true, _) => source_v.abs() >= part.again_v,
                (false, true) => near && rises && source_v.abs() >= part.fires_v,
                (false, false) => source_v.abs() >= 2.0,
            };
            if (lit && fires) || (sign == part.shorted && source_v.abs() > drop_v) {
                (flow.polarity, flow.has_fired) = (sign, true);
            }
        }
        let slope = self.slope(at_s);
        if flow.polarity != 0.0 {
            flow.current_a = (source_v - drop_v * flow.polarity) / (ohm + part.ohm);
            flow.volts = drop_v * flow.polarity + part.ohm * flow.current_a;
        } else {
            let farad = part.leak_f + part.stray_f;
            flow.current_a = part.leak_s * source_v + farad * slope;
            flow.volts = source_v;
        }
    }

    pub fn renders(&mut self) {
        let is_line = self.is_on(DigitalOut::LineContactor);
        let (record_s, points, _) = self.record;
        let (begins_s, step_s) = (self.begins_s.unwrap(), record_s / points);
        self.dead_s = match self.line_records.cmp(&self.part.dead_from) {
            Ordering::Equal if is_line => begins_s + self.part.dies_s,
            Ordering::Greater if is_line => f64::NEG_INFINITY,
            Ordering::Less | Ordering::Equal | Ordering::Greater if is_line => f64::INFINITY,
            _no_line => begins_s + self.part.loop_opens_s,
        };
        self.line_records += usize::from(is_line);
        let reference = (
            self.is_on(DigitalOut::Reference0),
            self.is_on(DigitalOut::Reference1),
        );
        let mut flow = Flow::default();
        let lead = 4000_i64;
        self.memory = vec![Vec::new(); 4];
        let step = 2e-6_f64.min(step_s);
        let many = (step_s / step).round().max(1.0) as usize;
        for index in -lead..(points as i64) * many as i64 {
            let at_s = begins_s + index as f64 * step_s / many as f64;
            self.flows(&mut flow, at_s, step);
            if index < 0 || !(index as usize).is_multiple_of(many) {
                continue;
            }
            let source_v = self.source_v(at_s);
            let slope = self.slope(at_s);
            let (volts, current_a) = match reference {
                (true, true) => (source_v * 1000.0 / 3300.0, self.referred(source_v, slope)),
                (true, false) if self.is_on(DigitalOut::SmuToOutput) => (self.smu_v, 0.0),
                (true, false) => (source_v, self.part.stray_f * slope),
                (false, true) => (0.0, 0.0),
                (false, false) => (flow.volts, flow.current_a),
            };
            let shunt = if self.is_on(DigitalOut::LoopContactor) {
                0.01
            } else {
                1.0
            };
            // The shunt channel is late: it shows an earlier current of a blocked output or of a reference.
            let late_a = match reference {
                (false, true) => 0.0,
                (true, false) if self.is_on(DigitalOut::SmuToOutput) => 0.0,
                (true, true | false) => self.delayed(at_s),
                (false, false) if flow.polarity == 0.0 => self.delayed(at_s),
                (false, false) => current_a,
            };
            let values = [
                1.015 * self.control_v(at_s) + 0.04,
                volts / 100.0 * self.part.gains[0],
                volts.clamp(-10.0, 10.0) * self.part.gains[1] + self.part.zero_v,
                late_a * shunt * self.part.gains[2],
            ];
            for (channel, value) in values.into_iter().enumerate() {
                let full = self.scales[channel];
                let noisy = value + 0.3 * full / 2048.0 * self.noise();
                let code = (noisy / full * 2048.0).round().clamp(-2048.0, 2047.0);
                self.memory[channel].push((code / 2048.0 * full) as f32);
            }
        }
        self.has_stuck |= self.part.sticks && flow.has_fired;
    }

    /// Returns the current of the reference resistor and of the stray capacitance beside it.
    fn referred(&self, source_v: f64, slope: f64) -> f64 {
        (source_v + 1000.0 * self.part.stray_f * slope) / 3300.0
    }

    /// Returns the current of a blocked output, or of the reference, as the delayed channel shows it.
    fn delayed(&self, at_s: f64) -> f64 {
        let at_s = at_s - self.part.delay_of_shunt_s;
        let source_v = self.source_v(at_s);
        let slope = self.slope(at_s);
        let reference = (
            self.is_on(DigitalOut::Reference0),
            self.is_on(DigitalOut::Reference1),
        );
        match reference {
            (true, true) => self.referred(source_v, slope),
            (true, false) => self.part.stray_f * slope,
            (false, _) => {
                self.part.leak_s * source_v + (self.part.leak_f + self.part.stray_f) * slope
            }
        }
    }

    /// Returns a random number of the standard normal distribution.
    fn noise(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.seed = self
                .seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            sum += (self.seed >> 40) as f64 / (1_u64 << 24) as f64;
        }
        sum
    }
}
