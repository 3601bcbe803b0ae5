//! Static condensation of the leaf while it presses on a contact.
//!
//! The tip of a pressed leaf swings at some 4 kHz and is damped within milliseconds; armature and flux move ten to a
//! hundred times slower. While the tip follows them, its position `y(x)` is the static one, with
//! `dy/dx = r = k_l / (k_l + 1.5 k_c d^0.5)` at an overlap `d`. Lagrange's equation with this constraint leaves three
//! states:
//!
//! ```text
//! (m_a + m_c r^2) v' = pull - F_r0 - k_r x - k_l (x + d0 - y) - drag v + backstop - seat
//! drag               = c_a + c_l (1 - r)^2 + chi_c F r^2 + m_c r r' v
//! ```
//!
//! The condensation leaves out the swing of the tip alone. [`Model::tip_follows`] admits it while that is small, and
//! [`Model::keeps_pressing`] ends it before the force on the contact changes much within a period of the swing.

use super::coil::Drive;
use super::model::Model;
use super::modes::{Element, Modes};
use super::{State, V, W, Y};

/// Distance of the tip from its static position up to which it follows, m.
const TIP_M: f64 = 5e-8;
/// Speed of the tip relative to its static motion up to which it follows, m/s.
const TIP_M_PER_S: f64 = 1e-3;
/// Force of the leaf on a contact below which the tip moves by itself, N: a sixtieth of that at rest.
const LEAST_N: f64 = 2e-3;
/// Increase of that force with the speed of the armature, N s/m: at the limit the force falls to zero within a
/// millisecond, four periods of the tip.
const LEAST_N_S_PER_M: f64 = 1.5;

impl Model {
    /// Returns the overlap of the tip with the contact nearer to it, m.
    fn tip_overlap(&self, y: f64) -> f64 {
        match y < 0.5 * self.p.G {
            true => -y,
            false => y - self.p.G,
        }
    }

    /// Returns the share `r` of the speed of the armature that a pressed tip takes over, and the force on its contact
    /// in N.
    #[inline]
    fn pressed_tip(&self, overlap: f64) -> (f64, f64) {
        let root = overlap.max(0.0).sqrt();
        let share = self.p.k_l / (self.p.k_l + 1.5 * self.p.k_c * root);
        (share, self.p.k_c * overlap * root)
    }

    /// Returns the rates of change while the leaf is condensed; the entry of the speed of the tip is 0.
    #[inline]
    pub(super) fn condensed_rates(
        &self,
        t_s: f64,
        s: &State,
        modes: Modes,
        drive: &Drive,
    ) -> State {
        let p = &self.p;
        let [lambda, x, v, y, _] = *s;
        let (current, pull) = self.magnet(lambda, x);
        let overlap = self.tip_overlap(y);
        let (r, force) = self.pressed_tip(overlap);
        let per_mass = 1.0 / (p.m_a + p.m_c * r * r);
        let turn = 0.5 * r * r * (1.0 - r) / overlap;
        let turn = if y < 0.5 * p.G { turn } else { -turn };
        let drag =
            p.c_a + p.c_l * (1.0 - r) * (1.0 - r) + p.chi_c * force * r * r + p.m_c * r * turn * v;
        let mut load = p.F_r0 + p.k_r * x + p.k_l * (x + p.d0 - y) + drag * v;
        if modes.is_engaged(Element::Backstop) {
            load -= self.stop.push(-x, -v);
        }
        if modes.is_engaged(Element::Seat) {
            load += self.stop.push(x - p.X, v);
        }
        let armature = (pull - load) * per_mass;
        let flux = self.flux_rate(t_s, current, modes, drive);
        [flux, v, armature, r * v, 0.0]
    }

    /// Returns the state of a condensed leaf with the speed of its tip, and with the lag that the damping gives it.
    pub(super) fn with_following_tip(&self, s: &State) -> State {
        let (r, force) = self.pressed_tip(self.tip_overlap(s[Y]));
        let drag = self.p.c_l * (1.0 - r) - self.p.chi_c * force * r;
        let mut following = *s;
        following[Y] += drag * s[V] * r / self.p.k_l;
        following[W] = r * s[V];
        following
    }

    /// Checks whether the force of a condensed leaf on its contact lasts for some periods of the tip.
    pub(super) fn keeps_pressing(&self, s: &State) -> bool {
        self.presses_by(s, 1.0)
    }

    fn presses_by(&self, s: &State, factor: f64) -> bool {
        let (_, force) = self.pressed_tip(self.tip_overlap(s[Y]).max(0.0));
        force > factor * (LEAST_N + LEAST_N_S_PER_M * s[V].abs())
    }

    /// Checks whether the tip of a leaf on a contact follows the armature, so that the leaf can be condensed.
    pub(super) fn tip_follows(&self, s: &State) -> bool {
        if !self.presses_by(s, 1.5) {
            return false;
        }
        let mut still = *s;
        still[Y] = self.resting_tip(s);
        let following = self.with_following_tip(&still);
        (following[Y] - s[Y]).abs() < TIP_M && (following[W] - s[W]).abs() < TIP_M_PER_S
    }
}
