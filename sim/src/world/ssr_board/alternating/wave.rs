//! Voltage or current of a linear circuit on the line, in closed form: the steady response to each harmonic, a
//! constant, and a decaying transient.

use crate::scpi::line::Cycle;

/// Multiples of the line frequency.
const ORDERS: [f64; 3] = [1.0, 3.0, 5.0];

/// A complex number: gain and phase of a circuit at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// Creates a number from its parts.
    pub fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// Returns the product.
    pub fn times(self, by: Self) -> Self {
        Self::new(
            self.re * by.re - self.im * by.im,
            self.re * by.im + self.im * by.re,
        )
    }

    /// Returns the reciprocal.
    pub fn inverse(self) -> Self {
        let squared = self.re * self.re + self.im * self.im;
        Self::new(self.re / squared, -self.im / squared)
    }
}

/// Free motion of a circuit: `exp(-decay t)` times cosine and sine of `ring t`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Mode {
    /// Decay, 1 per microsecond.
    pub decay: f64,
    /// Square of the angular frequency, per microsecond squared; negative for a circuit that does not ring.
    pub ring_squared: f64,
}

/// State of the free motion at one instant, the same for voltage and current.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    scale: f64,
    even: f64,
    odd: f64,
    ring: f64,
}

impl Mode {
    /// Exponent from which a transient counts as gone.
    const GONE: f64 = 60.0;

    /// Creates an exponential decay with a time constant, microseconds.
    pub fn exponential(tau_us: f64) -> Self {
        Self {
            decay: 1.0 / tau_us,
            ring_squared: 0.0,
        }
    }

    /// Returns the free motion after a time; `None` once it is gone.
    pub fn at(&self, t_us: f64) -> Option<Motion> {
        let ring = self.ring_squared.abs().sqrt();
        let slowest = match self.ring_squared < 0.0 {
            true => self.decay - ring,
            false => self.decay,
        };
        if slowest * t_us > Self::GONE {
            return None;
        }
        let motion = |scale, even, odd, ring| Motion {
            scale,
            even,
            odd,
            ring,
        };
        if ring * t_us < 1e-9 {
            return Some(motion((-self.decay * t_us).exp(), 1.0, t_us, 1.0));
        }
        if self.ring_squared > 0.0 {
            let (sin, cos) = (ring * t_us).sin_cos();
            return Some(motion((-self.decay * t_us).exp(), cos, sin, ring));
        }
        let [slow, fast] = [ring - self.decay, -ring - self.decay].map(|it| (it * t_us).exp());
        Some(motion(0.5, slow + fast, slow - fast, ring))
    }
}

/// Share of a quantity in the free motion of its circuit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Transient {
    /// Value at the beginning.
    pub at_zero: f64,
    /// Slope at the beginning plus decay times value, per microsecond.
    pub slope: f64,
}

impl Transient {
    /// Creates the transient of an exponential decay.
    pub fn exponential(at_zero: f64) -> Self {
        Self {
            at_zero,
            slope: 0.0,
        }
    }

    fn at(&self, motion: Motion) -> f64 {
        let Motion {
            scale,
            even,
            odd,
            ring,
        } = motion;
        scale * (self.at_zero * even + self.slope * odd / ring)
    }
}

/// One quantity (a voltage or a current) while nothing switches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    sin: [f64; 3],
    cos: [f64; 3],
    constant: f64,
    transient: Transient,
}

impl Wave {
    /// Creates the steady response of a circuit that has this gain at each angular frequency, radians per microsecond.
    pub fn steady(cycle: &Cycle, constant: f64, gain: impl Fn(f64) -> Complex) -> Self {
        let [third, fifth] = cycle.harmonics;
        let shares = [1.0, third, fifth].map(|share| share * cycle.peak_v);
        let gains = ORDERS.map(|order| gain(order * cycle.omega));
        Self {
            sin: std::array::from_fn(|n| shares[n] * gains[n].re),
            cos: std::array::from_fn(|n| shares[n] * gains[n].im),
            constant,
            transient: Transient::default(),
        }
    }

    /// Adds a transient that starts with the segment.
    pub fn with(self, transient: Transient) -> Self {
        Self { transient, ..self }
    }

    /// Returns the value at a phase of the line (sine and cosine), with the present motion of the circuit.
    pub fn at(&self, phase: Phase, motion: Option<Motion>) -> f64 {
        let steady: f64 = (0..3)
            .map(|n| self.sin[n] * phase.sin[n] + self.cos[n] * phase.cos[n])
            .sum();
        let moving = motion.map_or(0.0, |it| self.transient.at(it));
        steady + self.constant + moving
    }
}

/// Sine and cosine of the first, third and fifth multiple of a phase.
#[derive(Debug, Clone, Copy)]
pub struct Phase {
    sin: [f64; 3],
    cos: [f64; 3],
}

impl Phase {
    /// Computes sines and cosines for a phase in radians.
    pub fn new(rad: f64) -> Self {
        let (s, c) = rad.sin_cos();
        let (s2, c2) = (s * s, c * c);
        Self {
            sin: [s, s * (3.0 - 4.0 * s2), s * (5.0 - s2 * (20.0 - 16.0 * s2))],
            cos: [c, c * (4.0 * c2 - 3.0), c * (5.0 - c2 * (20.0 - 16.0 * c2))],
        }
    }
}
