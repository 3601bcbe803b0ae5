//! The output circuit between two events: line, load, capacitance over the output, and the output itself, which blocks
//! or conducts in one direction.

use super::wave::{Complex, Mode, Phase, Transient, Wave};
use crate::scpi::line::Cycle;
use crate::world::ssr_board::network::Network;

/// Load between line and socket.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Resistance, shunt included, ohms.
    pub ohms: f64,
    /// Inductance in series, henries.
    pub henries: f64,
    /// Shunt of the load current, ohms.
    pub shunt_ohm: f64,
}

/// A conducting output: a threshold voltage and a resistance in series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnState {
    /// Sign of the current.
    pub sign: f64,
    /// Threshold voltage, volts.
    pub knee_v: f64,
    /// Slope resistance, ohms.
    pub slope_ohm: f64,
}

impl OnState {
    /// Returns the voltage over the output at a current, volts.
    pub fn volts(&self, amps: f64) -> f64 {
        self.sign * self.knee_v + self.slope_ohm * amps
    }
}

/// Voltage over the output and load current at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct State {
    /// Volts over the output, from out1 to out2.
    pub volts: f64,
    /// Amperes through the load into out1.
    pub amps: f64,
}

/// Voltage and current between two events, in closed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    cycle: Cycle,
    from_us: f64,
    /// Voltage over the output while it blocks.
    volts: Wave,
    amps: Wave,
    /// Free oscillation or decay of voltage and current; `None` when the circuit has none.
    mode: Option<Mode>,
    on: Option<OnState>,
}

impl Segment {
    /// Starts a segment in which the output blocks; `network` is everything across the socket, the output included.
    pub fn blocked(
        cycle: Cycle,
        from_us: f64,
        begin: State,
        load: Load,
        network: &Network,
    ) -> Self {
        let Network {
            siemens,
            amps,
            farads,
            ..
        } = *network;
        let z = |omega: f64| Complex::new(load.ohms, omega * 1e6 * load.henries);
        let y = |omega: f64| Complex::new(siemens, omega * 1e6 * farads);
        let divider = |omega: f64| {
            let part = z(omega).times(y(omega));
            Complex::new(1.0 + part.re, part.im).inverse()
        };
        let constant_v = amps * load.ohms / (1.0 + load.ohms * siemens);
        let steady = Self {
            cycle,
            from_us,
            volts: Wave::steady(&cycle, constant_v, divider),
            amps: Wave::steady(&cycle, -constant_v / load.ohms, |omega| {
                y(omega).times(divider(omega))
            }),
            mode: None,
            on: None,
        };
        let now = steady.at(from_us);
        let off = State {
            volts: begin.volts - now.volts,
            amps: begin.amps - now.amps,
        };
        let (mode, volts, amps) = natural(off, load, siemens, farads);
        Self {
            volts: steady.volts.with(volts),
            amps: steady.amps.with(amps),
            mode: (off != State::default()).then_some(mode),
            ..steady
        }
    }

    /// Starts a segment in which the output conducts.
    pub fn conducting(cycle: Cycle, from_us: f64, begin: State, load: Load, on: OnState) -> Self {
        let ohms = load.ohms + on.slope_ohm;
        let gain = |omega: f64| Complex::new(ohms, omega * 1e6 * load.henries).inverse();
        let amps = Wave::steady(&cycle, -on.sign * on.knee_v / ohms, gain);
        let steady = Self {
            cycle,
            from_us,
            volts: amps,
            amps,
            mode: None,
            on: Some(on),
        };
        if load.henries == 0.0 {
            return steady;
        }
        let off_a = begin.amps - steady.at(from_us).amps;
        Self {
            amps: amps.with(Transient::exponential(off_a)),
            mode: Some(Mode::exponential(1e6 * load.henries / ohms)),
            ..steady
        }
    }

    /// Returns voltage and current at an instant, microseconds.
    pub fn at(&self, t_us: f64) -> State {
        let phase = Phase::new(self.cycle.phase_rad(t_us));
        let motion = self.mode.and_then(|mode| mode.at(t_us - self.from_us));
        let amps = self.amps.at(phase, motion);
        let volts = match self.on {
            Some(on) => on.volts(amps),
            None => self.volts.at(phase, motion),
        };
        State { volts, amps }
    }

    /// Returns the state of the conducting output; `None` while it blocks.
    pub fn on(&self) -> Option<OnState> {
        self.on
    }
}

/// Returns the mode of the circuit, and the transients of voltage and current; `off` is their distance from the steady
/// waves.
fn natural(off: State, load: Load, siemens: f64, farads: f64) -> (Mode, Transient, Transient) {
    let (g_c, one_c) = (1e-6 * siemens / farads, 1e-6 / farads);
    if load.henries == 0.0 {
        let tau_us = 1e6 * farads / (siemens + 1.0 / load.ohms);
        let volts = Transient::exponential(off.volts);
        let amps = Transient::exponential(-off.volts / load.ohms);
        return (Mode::exponential(tau_us), volts, amps);
    }
    let (r_l, one_l) = (1e-6 * load.ohms / load.henries, 1e-6 / load.henries);
    let decay = 0.5 * (r_l + g_c);
    let ring_squared = one_l * one_c * (1.0 + load.ohms * siemens) - decay * decay;
    let mode = Mode {
        decay,
        ring_squared,
    };
    let transient = |at_zero: f64, slope: f64| Transient { at_zero, slope };
    let volts = transient(off.volts, one_c * off.amps + (decay - g_c) * off.volts);
    let amps = transient(off.amps, (decay - r_l) * off.amps - one_l * off.volts);
    (mode, volts, amps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const LINE: Cycle = Cycle {
        zero_us: 0.0,
        omega: TAU * 50e-6,
        peak_v: 325.269,
        harmonics: [0.017, 0.01],
    };
    const RESISTIVE: Load = Load {
        ohms: 2_300.0,
        henries: 0.0,
        shunt_ohm: 1.0,
    };
    const LAGGING: Load = Load {
        henries: 3.0,
        ..RESISTIVE
    };

    fn snubber(farads: f64) -> Network {
        Network {
            siemens: 2e-8,
            amps: 0.0,
            farads,
        }
    }

    /// Integrates a circuit in small steps and compares it with the closed form.
    fn agree(segment: &Segment, begin: State, load: Load, network: &Network) {
        let mut state = begin;
        let dt_us = 0.02;
        for n in 0..500_000u32 {
            let t_us = f64::from(n) * dt_us;
            let line_v = LINE.volts(t_us);
            let amps = match load.henries > 0.0 {
                true => state.amps,
                false => (line_v - state.volts) / load.ohms,
            };
            if n % 5_000 == 0 {
                let closed = segment.at(t_us);
                let (dv, di) = (closed.volts - state.volts, closed.amps - amps);
                assert!(dv.abs() < 0.05 && di.abs() < 2e-5, "{t_us}: {dv} V {di} A");
            }
            let into_a = amps + network.amps - network.siemens * state.volts;
            // The current goes first: this pair of steps keeps the energy of a ringing circuit.
            if load.henries > 0.0 {
                let over_v = line_v - state.volts - load.ohms * state.amps;
                state.amps += 1e-6 * dt_us * over_v / load.henries;
            }
            state.volts += 1e-6 * dt_us * into_a / network.farads;
        }
    }

    #[test]
    fn a_blocked_output_follows_its_differential_equation() {
        let begin = State {
            volts: 1.5,
            amps: 0.0,
        };
        let checked = Network {
            amps: 0.01,
            ..snubber(2.1e-8)
        };
        for network in [snubber(2.1e-8), snubber(1.2e-9), snubber(1e-7), checked] {
            for load in [RESISTIVE, LAGGING] {
                let segment = Segment::blocked(LINE, 0.0, begin, load, &network);
                agree(&segment, begin, load, &network);
            }
        }
        // Overdamped: a small inductance and a big capacitance.
        let load = Load {
            henries: 0.01,
            ..RESISTIVE
        };
        let segment = Segment::blocked(LINE, 0.0, begin, load, &snubber(1e-7));
        agree(&segment, begin, load, &snubber(1e-7));
    }

    #[test]
    fn a_snubber_takes_its_current_beside_the_leakage() {
        for (farads, hz, volts, expected_ma) in [
            (2e-8, 50.0, 230.0, 1.445),
            (1e-7, 50.0, 230.0, 7.226),
            (1e-7, 60.0, 280.0, 10.556),
        ] {
            let cycle = Cycle {
                zero_us: 0.0,
                omega: TAU * hz * 1e-6,
                peak_v: volts * std::f64::consts::SQRT_2,
                harmonics: [0.0; 2],
            };
            // The load takes no voltage, because the truth states the current at the full voltage.
            let load = Load {
                ohms: 1e-3,
                ..RESISTIVE
            };
            let segment = Segment::blocked(cycle, 0.0, State::default(), load, &snubber(farads));
            let squares: f64 = (1..=1_000)
                .map(|n| segment.at(f64::from(n) * 1e3 / hz).amps.powi(2))
                .sum();
            let rms_ma = (squares / 1_000.0).sqrt() * 1e3;
            assert!((rms_ma / expected_ma - 1.0).abs() < 1e-3, "{rms_ma}");
        }
    }

    #[test]
    fn a_conducting_output_has_the_rms_voltage_of_its_formula() {
        let on = OnState {
            sign: 1.0,
            knee_v: 0.85,
            slope_ohm: 0.045,
        };
        let load = Load {
            ohms: 4.6,
            ..RESISTIVE
        };
        let segment = Segment::conducting(LINE, 0.0, State::default(), load, on);
        let state = segment.at(5_000.0);
        let line_v = LINE.volts(5_000.0);
        assert!((state.amps * 4.645 - (line_v - 0.85)).abs() < 1e-9);
        assert!((state.volts - (0.85 + 0.045 * state.amps)).abs() < 1e-9);
        // With 3 H the current lags by 22.3 degrees, so 123 V return when it ends.
        let sine = Cycle {
            harmonics: [0.0; 2],
            ..LINE
        };
        let lagging = Segment::conducting(sine, 0.0, State::default(), LAGGING, on);
        let zero_us = 40_000.0 + 22.28 / 0.018;
        assert!(lagging.at(zero_us).amps.abs() < 5e-4);
        assert!((sine.volts(zero_us).abs() - 123.3).abs() < 0.5);
    }
}
