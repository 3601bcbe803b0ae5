//! The output circuit while a contactor connects it to the line. It advances from event to event; between two events
//! voltage and current have a closed form.
//!
//! Events are the beginning of a cycle of the line, an edge of the control pulses, light that passes its threshold, the
//! output that fires or goes off, and the switching of a contactor. Reading a voltage between two events changes
//! nothing.

mod segment;
mod triac;
mod wave;

use std::cell::Cell;

use super::{EDGE_US, SsrBoard};
use crate::world::specimen::Specimen;
use crate::world::ssr::Ssr;
use segment::Segment;
pub use segment::{Load, OnState, State};
use triac::Gate;

/// Longest time between two events, microseconds.
const LONGEST_US: f64 = 20_000.0;
/// The same while the output conducts: a small part of the time in which its junction warms, because between two events
/// its temperature does not change.
const WARMS_US: f64 = 1_000.0;

/// Marks that no state has been computed.
const UNKNOWN: (f64, State) = (
    f64::NAN,
    State {
        volts: 0.0,
        amps: 0.0,
    },
);

/// State of the circuit since the last event.
#[derive(Debug, Clone)]
pub struct Alternating {
    /// Load of the closed contactor.
    load: Load,
    segment: Segment,
    /// State computed last, with its instant, because all channels of a digitizer ask for the same one.
    known: Cell<(f64, State)>,
    /// True after a half cycle that has conducted; the next one then fires at the retrigger voltage.
    again: bool,
    /// Direction in which the output fires without light after a failed commutation; 0 for none.
    refire: f64,
    /// True once the current has exceeded the holding current since the output fired.
    risen: bool,
    /// Instant at which the current ends, microseconds; infinite when it lasts beyond the next event.
    zero_us: f64,
    /// Light to which the present input current leads.
    goal: f64,
    settled_us: f64,
    due_us: f64,
}

impl Alternating {
    /// Returns voltage and current at an instant.
    pub fn at(&self, t_us: f64) -> State {
        let (known_us, known) = self.known.get();
        if known_us == t_us {
            return known;
        }
        let state = self.segment.at(t_us);
        self.known.set((t_us, state));
        state
    }

    /// Returns the load of the closed contactor.
    pub fn load(&self) -> Load {
        self.load
    }

    /// Replaces the load from the next segment on.
    pub fn reload(&mut self, load: Load) {
        self.load = load;
    }

    /// Makes the circuit start a new segment as soon as time goes on, because something connected to it has changed.
    pub fn touch(&mut self, now_us: f64) {
        self.due_us = self.due_us.min(now_us);
    }

    /// Returns the highest voltage over the output since the last event, volts, from nine samples.
    pub fn peak_v(&self, now_us: f64) -> f64 {
        let step_us = (now_us - self.settled_us) / 8.0;
        let at = |n: u32| self.at(now_us - f64::from(n) * step_us).volts.abs();
        (0..=8).map(at).fold(0.0, f64::max)
    }
}

impl SsrBoard {
    /// Connects the line to a load, at whatever phase the line has.
    pub(super) fn begin_alternating(&mut self, load: Load, part: Option<&Ssr>) {
        self.line.advance(self.now_us);
        let begin = State {
            volts: self.socket_v,
            amps: 0.0,
        };
        let network = self.network(part);
        let cycle = self.line.cycle();
        let mut circuit = Alternating {
            load,
            segment: Segment::blocked(cycle, self.now_us, begin, load, &network),
            known: Cell::new(UNKNOWN),
            again: false,
            refire: 0.0,
            risen: false,
            zero_us: f64::INFINITY,
            goal: 0.0,
            settled_us: self.now_us,
            due_us: self.now_us,
        };
        self.plan(&mut circuit, part);
        self.alternating = Some(Box::new(circuit));
    }

    /// Advances to `t_us`, or only to the next event if that comes first.
    pub(super) fn step_alternating(&mut self, t_us: f64, mut part: Option<&mut Specimen>) {
        if self.alternating.as_ref().is_some_and(|it| it.due_us > t_us) {
            self.now_us = t_us;
            return;
        }
        let Some(mut circuit) = self.alternating.take() else {
            return;
        };
        self.now_us = self.now_us.max(circuit.due_us);
        let ssr = part.as_deref_mut().and_then(Specimen::as_ssr_mut);
        self.settle(&mut circuit, ssr);
        self.line.advance(self.now_us);
        self.plan(&mut circuit, part.as_deref().and_then(Specimen::as_ssr));
        self.alternating = Some(circuit);
    }

    /// Brings heat and light of the part, and the detector, to the present instant.
    pub(super) fn settle(&mut self, circuit: &mut Alternating, part: Option<&mut Ssr>) {
        let span = (circuit.settled_us, self.now_us);
        let peak_v = circuit.peak_v(self.now_us);
        self.detect(peak_v);
        self.socket_v = circuit.at(self.now_us).volts;
        circuit.settled_us = self.now_us;
        let dt_us = span.1 - span.0;
        let Some(part) = part.filter(|_| dt_us > 0.0) else {
            return;
        };
        let watts = match (self.meets_output(part), circuit.segment.on()) {
            (false, _) => 0.0,
            (true, Some(_)) => triac::mean(&circuit.segment, span, |it| it.volts * it.amps),
            (true, None) => {
                part.siemens() * triac::mean(&circuit.segment, span, |it| it.volts * it.volts)
            }
        };
        part.pass(dt_us, circuit.goal, watts);
    }

    /// Starts the next segment, and finds its end.
    fn plan(&mut self, circuit: &mut Alternating, part: Option<&Ssr>) {
        self.input = Some(self.input(part));
        circuit.goal = part.map_or(0.0, |part| self.goal(part));
        let triac = part.filter(|it| it.is_ac() && self.meets_output(it) && !self.is_shorted());
        let on = triac.and_then(|it| self.conducts(circuit, it));
        let (cycle, state) = (self.line.cycle(), circuit.at(self.now_us));
        circuit.segment = match on {
            Some(on) => Segment::conducting(cycle, self.now_us, state, circuit.load, on),
            None => {
                let network = self.network(part);
                Segment::blocked(cycle, self.now_us, state, circuit.load, &network)
            }
        };
        circuit.known.set(UNKNOWN);
        let light_us = part.and_then(|it| it.switch_us(circuit.goal));
        let edge_us = self.pulse.edge_us(self.now_us);
        let longest_us = match circuit.segment.on() {
            Some(_) => WARMS_US,
            None => LONGEST_US,
        };
        let next_us = [light_us, edge_us, Some(longest_us)].into_iter().flatten();
        let next_us = self.now_us + next_us.fold(f64::INFINITY, f64::min).max(EDGE_US);
        let span = (self.now_us, next_us.min(cycle.end_us()));
        let own_us = triac.and_then(|it| circuit.own_event_us(it, span));
        circuit.due_us = own_us.unwrap_or(span.1).max(self.now_us + EDGE_US);
    }

    /// Returns the state of the output if it conducts from the present instant on.
    fn conducts(&self, circuit: &mut Alternating, part: &Ssr) -> Option<OnState> {
        let state = circuit.at(self.now_us);
        if let Some(on) = circuit.segment.on() {
            if !circuit.is_over(part, on, state, self.now_us) {
                return Some(on_state(part, on.sign));
            }
            let farads = self.network(Some(part)).farads;
            circuit.go_off(part, self.line.cycle().volts(self.now_us), farads);
        }
        let sign = circuit.gate(part).fires(state.volts)?;
        (circuit.risen, circuit.refire) = (false, 0.0);
        Some(on_state(part, sign))
    }
}

fn on_state(part: &Ssr, sign: f64) -> OnState {
    OnState {
        sign,
        knee_v: part.knee_v(sign),
        slope_ohm: part.slope_ohm(),
    }
}

impl Alternating {
    /// Checks whether the current of the conducting output ends now.
    fn is_over(&self, part: &Ssr, on: OnState, state: State, now_us: f64) -> bool {
        let amps = on.sign * state.amps;
        let reversed = self.load.henries == 0.0 && amps < 0.0;
        reversed || amps < part.holding_a(on.sign) && (self.risen || now_us >= self.zero_us)
    }

    /// Ends the conduction at a current zero. When the commutation fails, the output will fire again without light.
    fn go_off(&mut self, part: &Ssr, line_v: f64, farads: f64) {
        let limit = part.commutation_v_per_us();
        let fails = triac::fails_to_commutate(line_v, self.load.henries, farads, limit);
        self.again = part.is_lit();
        self.refire = match fails && !part.is_lit() {
            true => line_v.signum(),
            false => 0.0,
        };
    }

    /// Returns the voltages at which the output fires.
    fn gate(&self, part: &Ssr) -> Gate {
        let window = |sign: f64| {
            let again = self.again && part.is_lit() || self.refire == sign;
            part.window(sign, again, self.refire == sign, self.load.ohms)
        };
        Gate {
            window: [window(1.0), window(-1.0)],
        }
    }

    /// Returns the instant within `span` at which the output fires, or at which its current ends.
    fn own_event_us(&mut self, part: &Ssr, span: (f64, f64)) -> Option<f64> {
        self.again &= part.is_lit();
        self.zero_us = f64::INFINITY;
        let Some(on) = self.segment.on() else {
            return triac::firing_us(&self.segment, &self.gate(part), span);
        };
        let holding_a = part.holding_a(on.sign);
        self.risen |= on.sign * self.at(span.0).amps >= holding_a;
        let extinct_us = triac::extinction_us(&self.segment, on, holding_a, span);
        // A current that fires right before its zero never exceeds the holding current; without an inductance it ends
        // when it reverses.
        let reversed = || triac::reversal_us(&self.segment, on, span);
        let reversed_us = (self.load.henries == 0.0).then(reversed).flatten();
        let ends_us = [extinct_us, reversed_us].into_iter().flatten();
        self.zero_us = ends_us.fold(f64::INFINITY, f64::min);
        self.zero_us.is_finite().then_some(self.zero_us)
    }
}
