//! What the part on the fixture does with voltages, and what instruments see of it.

use super::Bench;
use crate::dut::ssr::points::DigitalOut;
use crate::instrument::query::Waveform;

impl Bench {
    pub(super) fn input_a(&self, volts: f64) -> f64 {
        match volts == 0.0 {
            true => 0.0,
            false if volts < 0.0 => -self.part.reverse_a,
            false => self.part.input_a,
        }
    }

    pub(super) fn control(&mut self, volts: f64) {
        let (before_v, was_lit) = (std::mem::replace(&mut self.control_v, volts), self.is_lit);
        self.switches(volts);
        let crosses = |(level_v, falls): (f64, bool)| match falls {
            true => before_v >= level_v && volts < level_v,
            false => before_v < level_v && volts >= level_v,
        };
        if self.waits.is_some_and(crosses) {
            (self.waits, self.answer) = (None, (was_lit, self.is_lit));
        }
    }

    fn switches(&mut self, volts: f64) {
        if volts >= self.part.turn_on_v {
            self.is_lit = true;
            let is_loaded = self.on.contains(&DigitalOut::SmuLoad);
            let loaded = is_loaded && volts >= self.part.sticks_loaded_v;
            self.is_stuck |= loaded || volts >= self.part.sticks_at_v;
        } else if volts < self.part.turn_off_v {
            self.is_lit = self.is_stuck;
        }
    }

    fn is_lead_open(&self) -> bool {
        self.jobs > self.lead_opens_after && self.jobs <= self.lead_heals_after
    }

    /// Returns the drop at a current without the limit of the source, V.
    pub(super) fn drop_v(&self, ampere: f64) -> f64 {
        match self.is_lead_open() {
            true => f64::INFINITY,
            false => self.part.ohm * ampere,
        }
    }

    /// Returns the voltage at the socket while the source is there without its load, else what is left of it, V.
    pub(super) fn socket_v(&self) -> f64 {
        let is_fed = self.on.contains(&DigitalOut::SmuToOutput) && !self.is_lead_open();
        match is_fed && !self.on.contains(&DigitalOut::SmuLoad) {
            true => self.source_v,
            false => self.part.residual_v,
        }
    }

    pub(super) fn output_a(&self) -> f64 {
        let is_on = |output| self.on.contains(&output);
        assert!(is_on(DigitalOut::SmuToOutput) && is_on(DigitalOut::BleedOpen));
        let load_ohm = f64::from(u8::from(is_on(DigitalOut::SmuLoad))) * 1000.0;
        if self.is_lead_open() {
            return 0.0;
        }
        if is_on(DigitalOut::Reference1) {
            return self.source_v / (load_ohm + 1e-3);
        }
        if self.part.is_turned {
            let forward = !is_on(DigitalOut::OutputPolarity);
            return f64::from(u8::from(forward)) * 1.9e-3;
        }
        match (self.is_lit, self.is_heated) {
            (true, _) => self.source_v / (load_ohm + self.part.ohm),
            (false, true) => self.part.hot_leakage_a * self.source_v.signum(),
            (false, false) => self.part.leakage_a * self.source_v.signum(),
        }
    }

    pub(super) fn waveform(&self, channel: f64) -> Waveform {
        let (record_s, points) = self.record_s;
        let (step_s, start_s) = (record_s / points, -0.1 * record_s);
        let (part, edge_s) = (&self.part, 20e-6);
        let at = |index: usize| start_s + (index as f64 + 0.3) * step_s;
        let pulse = |at_s: f64| f64::from(u8::from((0.0..self.pulse_s).contains(&at_s)));
        let answered = |at_s: f64| {
            let (before, after) = self.answer;
            let delay_s = if after { part.on_s } else { part.off_s };
            let now = if at_s < part.weak_s.unwrap_or(delay_s) {
                before
            } else {
                after
            };
            f64::from(u8::from(now))
        };
        let load = |at_s: f64| {
            if !self.on.contains(&DigitalOut::DriveSelect) {
                return answered(at_s);
            }
            let on = (at_s - part.on_s) / edge_s + 0.9;
            let off = 0.1 - (at_s - self.pulse_s - part.off_s) / edge_s;
            on.clamp(0.0, 1.0).min(off.clamp(0.0, 1.0))
        };
        let level_s = 0.7 * record_s / self.ramp.len() as f64;
        let ramp = |at_s: f64| {
            let number = (at_s / level_s).floor() + 1.0;
            let number = (number.max(0.0) as usize).min(self.ramp.len() - 1);
            self.ramp[number]
        };
        let volts = |at_s: f64| match channel {
            1.0 if !self.ramp.is_empty() => ramp(at_s).0,
            3.0 if self.is_lead_open() => 0.0,
            3.0 if !self.ramp.is_empty() => 8.0 - 7.99 * f64::from(u8::from(ramp(at_s).1)),
            1.0 => 5.0 * pulse(at_s),
            3.0 => 8.0 - 7.99 * load(at_s),
            other => panic!("channel {other}"),
        };
        Waveform {
            start_s: start_s + 0.3 * step_s,
            step_s,
            volts: (0..points as usize)
                .map(|it| volts(at(it)) as f32)
                .collect(),
        }
    }
}
