//! A stop that yields: Hertz spring with the loss of Hunt and Crossley.
//!
//! `F = k d^1.5 (1 + chi d')` while the bodies overlap by `d`, never a pull. The force grows from
//! nothing at touch-down, so the motion stays smooth enough for a method of high order. The loss
//! gives a rebound speed `v_o` in closed form: `chi v_i - ln(1 + chi v_i) = -chi v_o - ln(1 - chi v_o)`.

/// Stiffness and loss of a stop.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    /// N/m^1.5.
    pub k: f64,
    /// s/m.
    pub chi: f64,
}

impl Stop {
    /// Push at an overlap `depth` in m that grows with `speed` in m/s; none without overlap.
    #[inline]
    pub fn push(self, depth: f64, speed: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        let loss = (1.0 + self.chi * speed).max(0.0);
        self.k * depth * depth.sqrt() * loss
    }

    /// Overlap under which it carries a resting force in N, m.
    pub fn depth(self, force: f64) -> f64 {
        (force.max(0.0) / self.k).cbrt().powi(2)
    }

    /// The same from an overlap that is nearly it, by one step of Newton's method: off by the square of what it was.
    #[inline]
    pub fn nearer(self, known: f64, force: f64) -> f64 {
        let next = known / 3.0 + force / (1.5 * self.k * known.sqrt());
        match known > 0.0 && force > 0.0 && next < 4.0 * known {
            true => next,
            // Far from it, or no overlap at all.
            false => self.depth(force),
        }
    }

    /// Slope of the resting force, N/m.
    pub fn stiffness(self, depth: f64) -> f64 {
        1.5 * self.k * depth.max(0.0).sqrt()
    }
}
