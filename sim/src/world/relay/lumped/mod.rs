//! The relay as five states: flux, armature and the leaf that carries the moving contact.
//!
//! ```text
//! lambda  flux linkage, V s: unlike the current it does not jump at switch-off
//! x v     armature, 0 at the backstop, X at the seat
//! y w     moving contact, 0 at NC, G at NO; a leaf spring couples it to the armature
//!
//! Rel    = Rr + Rc0 / (1 - |phi| / phis) + g / (mu0 A + Pf g)     phi = lambda / N, g = X - x
//! lambda'= (u - R i_s) / (1 + R k_ec / N^2)                       i_s = lambda Rel / N^2
//! off    : lambda' has -Vc for u while current flows, then eddy currents alone: -i_s N^2 / k_ec
//! m_a v' = phi^2 mu0 A / 2 (mu0 A + Pf g)^2 - F_r0 - k_r x - c_a v - leaf + backstop - seat
//! m_c w' = leaf + NC - NO                                          leaf = k_l (x + d0 - y) + c_l (v - w)
//! ```
//!
//! In reading order: [`parameters`], [`stop`] (a compliant contact), [`modes`] (engaged stops), [`coil`] (the
//! drive), [`model`] (the equations), [`condensed`] (the equations while the leaf presses), [`statics`] (equilibrium
//! and thresholds), [`dop853`] (one step), [`solver`] (from event to event), [`locate`] (instant of an event),
//! [`outcome`] (results of a transient).
//!
//! The model omits remanence, distributed eddy currents, higher modes of the leaf, arc and gravity.

pub mod coil;
mod condensed;
pub mod dop853;
mod locate;
pub mod model;
pub mod modes;
pub mod outcome;
pub mod parameters;
pub mod solver;
pub mod statics;
pub mod stop;
#[cfg(test)]
mod tests;

pub use coil::{Drive, Waveform};
pub use model::Model;
pub use modes::{Element, Modes};
pub use outcome::Outcome;
pub use parameters::Parameters;
pub use solver::{Event, SolveError, Solver};

/// The five states in SI units, in the order of the constants below.
pub type State = [f64; 5];
/// Index of the flux linkage, V s.
pub const LAMBDA: usize = 0;
/// Index of the travel of the armature, m.
pub const X: usize = 1;
/// Index of the speed of the armature, m/s.
pub const V: usize = 2;
/// Index of the travel of the moving contact, m.
pub const Y: usize = 3;
/// Index of the speed of the moving contact, m/s.
pub const W: usize = 4;

/// Result of a transient: its events and the cost of the integration.
#[derive(Debug, Clone)]
pub struct Transient {
    /// Changes of the modes, in order of time.
    pub events: Vec<Event>,
    /// State at the end.
    pub state: State,
    /// Number of evaluations of the equations.
    pub evaluations: u64,
    /// Number of steps, rejected ones included.
    pub steps: u64,
}

/// Drive of the coil over a whole transient.
#[derive(Debug, Clone, PartialEq)]
pub enum Excitation {
    /// A source.
    Source(Waveform),
    /// Switched off into a suppression of this voltage, V.
    Suppression(f64),
}

impl Excitation {
    fn piece(&self, t_s: f64) -> (Drive, f64) {
        match self {
            Self::Source(waveform) => waveform.piece(t_s),
            Self::Suppression(volts) => (Drive::Suppression { volts: *volts }, f64::INFINITY),
        }
    }
}

impl Model {
    /// Integrates from `start` at 0 to `end_s`; `relative` is the relative tolerance of a step.
    ///
    /// # Errors
    /// Fails when the state diverges, or the number of evaluations reaches its limit.
    pub fn transient(
        &self,
        start: State,
        excitation: &Excitation,
        end_s: f64,
        relative: f64,
    ) -> Result<Transient, SolveError> {
        let (mut drive, mut ends) = excitation.piece(0.0);
        let mut solver = Solver::new(self, &drive, 0.0, start, relative);
        let mut events = Vec::new();
        loop {
            while let Some(event) = solver.advance(self, &drive, ends.min(end_s))? {
                events.push(event);
            }
            if ends >= end_s {
                break;
            }
            (drive, ends) = excitation.piece(ends);
            solver.drive_changed(self, &drive);
        }
        Ok(Transient {
            events,
            state: solver.state,
            evaluations: solver.evaluations,
            steps: solver.steps,
        })
    }
}
