//! A compliant stop: Hertz spring with Hunt-Crossley damping.
//!
//! `F = k d^1.5 (1 + chi d')` while the bodies overlap by `d`; the force is never a pull. It grows from zero at
//! the touch, so the motion is smooth enough for a method of high order. The rebound speed `v_o` has the closed
//! form `chi v_i - ln(1 + chi v_i) = -chi v_o - ln(1 - chi v_o)`.

/// Stiffness and loss of a stop.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    /// Stiffness, N/m^1.5.
    pub k: f64,
    /// Loss coefficient, s/m.
    pub chi: f64,
}

impl Stop {
    /// Returns the force at an overlap of `depth` (m) whose rate of change is `speed` (m/s), N; zero without overlap.
    #[inline]
    pub fn push(self, depth: f64, speed: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        let loss = (1.0 + self.chi * speed).max(0.0);
        self.k * depth * depth.sqrt() * loss
    }

    /// Returns the elastic energy at an overlap of `depth` (m), J; zero without overlap.
    pub fn energy(self, depth: f64) -> f64 {
        0.4 * self.k * depth.max(0.0).powf(2.5)
    }

    /// Returns the overlap that carries a static force in N, m.
    pub fn depth(self, force: f64) -> f64 {
        (force.max(0.0) / self.k).cbrt().powi(2)
    }

    /// Refines an approximate overlap by one step of Newton's method, which squares the error.
    #[inline]
    pub fn refine(self, known: f64, force: f64) -> f64 {
        let next = known / 3.0 + force / (1.5 * self.k * known.sqrt());
        match known > 0.0 && force > 0.0 && next < 4.0 * known {
            true => next,
            // The start value is far off, or the force needs no overlap.
            false => self.depth(force),
        }
    }

    /// Returns the slope of the static force, N/m.
    pub fn stiffness(self, depth: f64) -> f64 {
        1.5 * self.k * depth.max(0.0).sqrt()
    }
}
