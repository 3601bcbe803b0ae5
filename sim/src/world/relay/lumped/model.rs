//! The equations of motion, with precomputed constants.

use super::coil::Drive;
use super::modes::{Element, Modes, StopPositions};
use super::parameters::Parameters;
use super::stop::Stop;
use super::{LAMBDA, State, X};

/// A relay model that is ready for integration.
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) p: Parameters,
    pub(super) mu_a: f64,
    pub(super) ohm: f64,
    per_turns: f64,
    per_turns2: f64,
    eddy: f64,
    per_phis: f64,
    per_mass: [f64; 2],
    /// Positions of the stops of the relay, m.
    pub stops: StopPositions,
    /// Stiffness and loss of backstop and seat.
    pub stop: Stop,
    pub(super) contact: Stop,
}

impl Model {
    /// Creates the model from its parameters.
    pub fn new(p: &Parameters) -> Self {
        let ohm = p.coil_ohm();
        let per_turns2 = 1.0 / (p.N * p.N);
        Self {
            p: *p,
            mu_a: p.mu0 * p.A,
            ohm,
            per_turns: 1.0 / p.N,
            per_turns2,
            per_phis: 1.0 / p.phis,
            per_mass: [1.0 / p.m_a, 1.0 / p.m_c],
            eddy: 1.0 / (1.0 + ohm * p.k_ec * per_turns2),
            stops: StopPositions { seat: p.X, no: p.G },
            stop: Stop {
                k: p.k_s,
                chi: p.chi_s,
            },
            contact: Stop {
                k: p.k_c,
                chi: p.chi_c,
            },
        }
    }

    /// Returns the parameters of the model.
    pub fn parameters(&self) -> &Parameters {
        &self.p
    }

    /// Returns the coil resistance at the temperature of the copper, ohm.
    pub fn ohm(&self) -> f64 {
        self.ohm
    }

    /// Changes the temperature of the copper; the argument is the coil resistance at that temperature, ohm.
    pub fn set_ohm(&mut self, ohm: f64) {
        self.ohm = ohm;
        self.eddy = 1.0 / (1.0 + ohm * self.p.k_ec * self.per_turns2);
    }

    /// Returns `mu0` times the pole area, widened by fringing at this gap: `mu0 A + Pf g`.
    #[inline]
    pub(super) fn spread(&self, gap: f64) -> f64 {
        self.mu_a + self.p.Pf * gap
    }

    /// Returns the reluctance at a flux and a gap, 1/H; NaN at and beyond saturation.
    #[inline]
    pub(super) fn reluctance(&self, phi: f64, gap: f64) -> f64 {
        let rest = 1.0 - phi.abs() / self.p.phis;
        if rest <= 0.0 {
            return f64::NAN;
        }
        self.p.Rr + self.p.Rc0 / rest + gap / self.spread(gap)
    }

    /// Returns the pull on the armature, N.
    #[inline]
    pub(super) fn pull(&self, phi: f64, gap: f64) -> f64 {
        let spread = self.spread(gap);
        0.5 * phi * phi * self.mu_a / (spread * spread)
    }

    /// Returns the coil current that holds the flux of this state constant, A.
    #[inline]
    fn still_current(&self, s: &State) -> f64 {
        s[LAMBDA] * self.reluctance(s[LAMBDA] / self.p.N, self.p.X - s[X]) * self.per_turns2
    }

    /// Returns the rate of change of the flux linkage, V.
    #[inline]
    pub(super) fn flux_rate(&self, t_s: f64, current: f64, modes: Modes, drive: &Drive) -> f64 {
        match *drive {
            Drive::Source {
                volts,
                slope,
                since_s,
            } => (volts + slope * (t_s - since_s) - self.ohm * current) * self.eddy,
            Drive::Suppression { volts } => match modes.is_engaged(Element::CoilBlocked) {
                true => self.blocked_rate(current),
                false => (-volts - self.ohm * current) * self.eddy,
            },
        }
    }

    /// Returns the rate of change of the flux linkage while eddy currents alone carry the flux, V.
    #[inline]
    fn blocked_rate(&self, current: f64) -> f64 {
        -current * self.p.N * self.p.N / self.p.k_ec
    }

    /// Returns the rate of change of the flux linkage while the armature rests, V; the state itself, not a flag,
    /// decides whether the suppression conducts.
    pub fn resting_flux_rate(&self, t_s: f64, s: &State, drive: &Drive) -> f64 {
        let blocked = self.gap(Element::CoilBlocked, s, drive) > 0.0;
        self.branch_flux_rate(t_s, s, drive, blocked)
    }

    /// Returns the rate of change of the flux linkage while the suppression conducts, or while it is `blocked`, V.
    pub fn branch_flux_rate(&self, t_s: f64, s: &State, drive: &Drive, blocked: bool) -> f64 {
        let mut modes = Modes::default();
        modes.set(Element::CoilBlocked, blocked);
        self.flux_rate(t_s, self.still_current(s), modes, drive)
    }

    /// Returns the time constant of the flux linkage while the armature rests, s: that of winding and eddy currents
    /// together, or of eddy currents alone while the suppression is `blocked`.
    pub fn flux_time_s(&self, s: &State, blocked: bool) -> f64 {
        let reluctance = self.reluctance(s[LAMBDA] / self.p.N, self.p.X - s[X]);
        let eddy = self.p.k_ec / reluctance;
        match blocked {
            true => eddy,
            false => eddy + self.p.N * self.p.N / (self.ohm * reluctance),
        }
    }

    /// Returns the coil current for a rate of change of the flux linkage, A.
    pub fn current_at(&self, s: &State, flux_rate: f64) -> f64 {
        self.still_current(s) + self.p.k_ec * self.per_turns2 * flux_rate
    }

    /// Returns the current that holds a flux linkage constant, A, and the pull of the magnet, N.
    #[inline]
    pub(super) fn magnet(&self, lambda: f64, x: f64) -> (f64, f64) {
        let p = &self.p;
        let (phi, gap) = (lambda * self.per_turns, p.X - x);
        let rest = 1.0 - phi.abs() * self.per_phis;
        let per_spread = 1.0 / self.spread(gap);
        let reluctance = match rest > 0.0 {
            true => (p.Rr + gap * per_spread) + p.Rc0 / rest,
            false => f64::NAN,
        };
        let across = phi * per_spread;
        let pull = 0.5 * self.mu_a * across * across;
        (lambda * self.per_turns2 * reluctance, pull)
    }

    /// Returns the rates of change of the five states.
    #[inline]
    pub fn rates(&self, t_s: f64, s: &State, modes: Modes, drive: &Drive) -> State {
        let p = &self.p;
        let [lambda, x, v, y, w] = *s;
        let (current, pull) = self.magnet(lambda, x);
        let leaf = p.k_l * (x + p.d0 - y) + p.c_l * (v - w);
        let mut load = p.F_r0 + p.k_r * x + p.c_a * v + leaf;
        let mut tip = leaf;
        if modes.is_engaged(Element::Backstop) {
            load -= self.stop.push(-x, -v);
        }
        if modes.is_engaged(Element::Seat) {
            load += self.stop.push(x - p.X, v);
        }
        if modes.is_engaged(Element::Nc) {
            tip += self.contact.push(-y, -w);
        }
        if modes.is_engaged(Element::No) {
            tip -= self.contact.push(y - p.G, w);
        }
        let armature = pull - load;
        let flux = self.flux_rate(t_s, current, modes, drive);
        let [per_armature, per_tip] = self.per_mass;
        [flux, v, armature * per_armature, w, tip * per_tip]
    }

    /// Returns the gap function of an element; a value above zero means that the element is engaged.
    #[inline]
    pub fn gap(&self, element: Element, s: &State, drive: &Drive) -> f64 {
        match (element, drive) {
            (Element::CoilBlocked, Drive::Source { .. }) => -1.0,
            (Element::CoilBlocked, Drive::Suppression { volts }) => {
                let current = self.still_current(s);
                self.blocked_rate(current) - (-volts - self.ohm * current) * self.eddy
            }
            _ => self.stops.overlap(element, s),
        }
    }

    /// Returns the flags that belong to a state.
    pub fn modes(&self, s: &State, drive: &Drive) -> Modes {
        let mut modes = Modes::default();
        for element in Element::TOUCHING.into_iter().chain([Element::CoilBlocked]) {
            modes.set(element, self.gap(element, s, drive) > 0.0);
        }
        modes
    }
}
