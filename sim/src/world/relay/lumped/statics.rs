//! Static equilibrium of the relay, and the threshold voltages at which it ends.
//!
//! The voltage that balances the load at a travel `x` is `V = (R / N) phi Rel(phi, g)` with `phi = sqrt(2 F / mu A)
//! D(g)`. As the voltage changes slowly, the armature follows until `V` reverses: a fold. The pickup fold is where the
//! NC contact opens, the release fold where the armature leaves the seat. Both lie within 1e-9 m of the kink of the
//! load. The solver therefore finds each fold as the root of `d ln V` along the overlap of that contact (or seat),
//! where the problem is well conditioned.

use super::model::Model;
use super::{State, X, Y};

/// Relative size of a step of Newton's method after which it ends: it squares the error.
const NEWTON: f64 = 1e-9;
/// Step of the iteration of an armature on a stop after which it ends, relative to the travel: each divides the error
/// by a thousand.
const FIXED_POINT: f64 = 1e-12;

/// One point of the quasi-static equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// Voltage at the temperature of the copper, V.
    pub volts: f64,
    /// Current, A.
    pub amperes: f64,
    /// Travel of the armature, m.
    pub x: f64,
    /// Pull of the magnet, N.
    pub newtons: f64,
}

/// Travel and load along a branch of the equilibrium, with their rates along that branch.
struct Load {
    x: f64,
    x_rate: f64,
    newtons: f64,
    newtons_rate: f64,
}

impl Model {
    /// Returns the equilibrium at a travel and load.
    pub(super) fn balance(&self, x: f64, newtons: f64) -> Balance {
        let gap = self.p.X - x;
        let phi = self.flux_of(newtons, gap);
        let amperes = phi * self.reluctance(phi, gap) / self.p.N;
        Balance {
            volts: amperes * self.ohm,
            amperes,
            x,
            newtons,
        }
    }

    fn flux_of(&self, newtons: f64, gap: f64) -> f64 {
        (2.0 * newtons.max(0.0) / self.mu_a).sqrt() * self.spread(gap)
    }

    /// Returns the rate of change of `ln V` along a branch of the equilibrium.
    fn steepness(&self, load: &Load) -> f64 {
        let gap = self.p.X - load.x;
        let phi = self.flux_of(load.newtons, gap);
        let spread = self.spread(gap);
        let phi_rate = 0.5 * load.newtons_rate / load.newtons - self.p.Pf * load.x_rate / spread;
        let rest = 1.0 - phi / self.p.phis;
        let saturating = self.p.Rc0 / self.p.phis / (rest * rest) * phi * phi_rate;
        let opening = -self.mu_a / (spread * spread) * load.x_rate;
        phi_rate + (saturating + opening) / self.reluctance(phi, gap)
    }

    /// Returns the load of spring and leaf while the leaf presses on NC with this overlap.
    fn load_on_nc(&self, depth: f64) -> Load {
        let p = &self.p;
        let force = p.k_c * depth.powf(1.5);
        let stiffness = self.contact.stiffness(depth);
        let x = -p.d0 - depth - force / p.k_l;
        let x_rate = -1.0 - stiffness / p.k_l;
        Load {
            x,
            x_rate,
            newtons: p.F_r0 + p.k_r * x - force,
            newtons_rate: p.k_r * x_rate - stiffness,
        }
    }

    /// Returns the load of spring, leaf on NO and seat, with the armature `depth` into the seat.
    fn load_on_seat(&self, depth: f64) -> Load {
        let p = &self.p;
        let x = p.X + depth;
        let (force, leaf_rate) = self.leaf_on_no(x);
        Load {
            x,
            x_rate: 1.0,
            newtons: p.F_r0 + p.k_r * x + force + p.k_s * depth.powf(1.5),
            newtons_rate: p.k_r + leaf_rate + self.stop.stiffness(depth),
        }
    }

    /// Returns the force of the leaf on NO at a travel, and its rate with the travel.
    pub(super) fn leaf_on_no(&self, x: f64) -> (f64, f64) {
        let p = &self.p;
        let depth = self.leaf_overlap(x + p.d0 - p.G, 0.0);
        let stiffness = self.contact.stiffness(depth);
        let rate = if depth > 0.0 {
            p.k_l * stiffness / (p.k_l + stiffness)
        } else {
            0.0
        };
        (p.k_c * depth.powf(1.5), rate)
    }

    /// Returns the overlap at a contact when the leaf is bent by `bent` beyond the touch: `k_c d^1.5 + k_l d =
    /// k_l bent`. The search starts at `known`; 0 or less means no start value.
    fn leaf_overlap(&self, bent: f64, known: f64) -> f64 {
        let p = &self.p;
        if bent <= 0.0 {
            return 0.0;
        }
        let mut depth = match known > 0.0 {
            true => known,
            false => self.contact.depth(p.k_l * bent),
        }
        .min(bent);
        for _ in 0..60 {
            let excess = p.k_c * depth * depth.sqrt() + p.k_l * (depth - bent);
            let next = depth - excess / (self.contact.stiffness(depth) + p.k_l);
            let done = (next - depth).abs() <= NEWTON * depth;
            depth = next.max(0.0);
            if done {
                break;
            }
        }
        depth
    }

    /// Returns the quasi-static pickup: the first fold from rest.
    pub fn pickup(&self) -> Balance {
        let deepest = self.leaf_overlap(-self.p.d0, 0.0);
        let depth = root(deepest, |depth| self.steepness(&self.load_on_nc(depth)));
        let load = self.load_on_nc(depth);
        self.balance(load.x, load.newtons)
    }

    /// Returns the quasi-static release: the fold at which the armature leaves the seat. Where the load falls faster
    /// with the travel than the pull, the armature first follows the voltage and the fold lies before the seat: the
    /// release is then the fold at the greatest travel.
    pub fn release(&self) -> Balance {
        let deepest = self.stop.depth(1e3);
        let depth = root(deepest, |depth| -self.steepness(&self.load_on_seat(depth)));
        let load = self.load_on_seat(depth);
        self.balance(load.x, load.newtons)
    }

    /// Returns the flux that a current sustains at a gap, Wb: `phi Rel(phi, g) = N i` in closed form.
    fn flux_at(&self, amperes: f64, gap: f64) -> f64 {
        let turns = self.p.N * amperes.abs();
        let linear = self.p.Rr + gap / self.spread(gap);
        let a = linear / self.p.phis;
        let b = linear + self.p.Rc0 + turns / self.p.phis;
        let phi = 2.0 * turns / (b + (b * b - 4.0 * a * turns).max(0.0).sqrt());
        phi.copysign(amperes)
    }

    /// Returns the state at rest on the backstop at this coil voltage, which must be below pickup.
    pub fn at_rest(&self, volts: f64) -> State {
        self.settled(volts, 0.0)
    }

    /// Returns the state on the seat at this coil voltage, which must hold the armature.
    pub fn sealed(&self, volts: f64) -> State {
        self.settled(volts, self.p.X)
    }

    /// Iterates travel, leaf and flux of an armature on a stop to equilibrium.
    fn settled(&self, volts: f64, from: f64) -> State {
        let mut s = [0.0, from, 0.0, 0.0, 0.0];
        for _ in 0..200 {
            let before = s;
            s[0] = self.p.N * self.flux_at(volts / self.ohm, self.p.X - s[X]);
            self.pressed(&mut s);
            if (0..3).all(|i| (s[i] - before[i]).abs() <= 1e-15 * s[i].abs()) {
                break;
            }
        }
        s
    }

    /// Returns the position of the tip, m, that balances the leaf on the contact nearer to it.
    pub(super) fn resting_tip(&self, s: &State) -> f64 {
        let p = &self.p;
        let bent = s[X] + p.d0;
        match s[Y] < 0.5 * p.G {
            true => -self.leaf_overlap(-bent, -s[Y]),
            false => p.G + self.leaf_overlap(bent - p.G, s[Y] - p.G),
        }
    }

    /// Sets travel and leaf of an armature on a stop under the flux of the state; returns the force on that stop,
    /// N, negative where the stop would have to pull.
    pub fn pressed(&self, s: &mut State) -> f64 {
        let p = &self.p;
        let seated = s[X] > 0.5 * p.X;
        let mut push = 0.0;
        for _ in 0..20 {
            let before = s[X];
            let bent = s[X] + p.d0;
            s[Y] = match bent {
                on_nc if on_nc < 0.0 => -self.leaf_overlap(-on_nc, -s[Y]),
                on_no if on_no > p.G => p.G + self.leaf_overlap(on_no - p.G, s[Y] - p.G),
                free => free,
            };
            let leaf = p.k_l * (s[X] + p.d0 - s[Y]);
            let free = self.pull(s[0] / p.N, p.X - s[X]) - p.F_r0 - p.k_r * s[X] - leaf;
            push = if seated { free } else { -free };
            let known = if seated { s[X] - p.X } else { -s[X] };
            let depth = self.stop.refine(known, push);
            s[X] = if seated { p.X + depth } else { -depth };
            if (s[X] - before).abs() <= FIXED_POINT * p.X {
                break;
            }
        }
        push
    }
}

/// Returns the root of a falling function between 0 and `high`, searched on a logarithmic scale; 0 when the function is
/// never positive.
fn root(high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (high * 1e-18, high);
    if f(low) <= 0.0 {
        return 0.0;
    }
    while high / low > 1.0 + 1e-9 {
        let middle = (low * high).sqrt();
        if f(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
