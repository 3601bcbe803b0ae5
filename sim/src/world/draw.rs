//! Random draws; each subject has its own ChaCha stream, so that a part does not depend on the order of drawing.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Subject of a draw; each subject and index has its own stream.
#[derive(Debug, Clone, Copy)]
pub enum Subject {
    /// Errors of the interface board, and temperatures.
    Rig = 1,
    /// Stroke times and fall times.
    Mechanism = 2,
    /// A lot part by its index in the lot.
    LotPart = 3,
    /// A reference part.
    ReferencePart = 4,
    /// Scatter of the operations of a lot part.
    LotOperations = 5,
    /// Scatter of the operations of a reference part.
    ReferenceOperations = 6,
    /// Positions of the defects in a block of the lot.
    DefectBlock = 7,
    /// Values of a chamber, its sensors and its sockets.
    Chamber = 8,
    /// Noise of the sensors of a chamber.
    ChamberNoise = 9,
}

/// A random stream.
#[derive(Debug, Clone)]
pub struct Draw(ChaCha8Rng);

impl Draw {
    /// Opens the stream of a subject under a seed.
    pub fn new(seed: u64, subject: Subject, index: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream((subject as u64) << 48 | index);
        Self(rng)
    }

    /// Draws uniformly from [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Draws uniformly between two limits.
    pub fn between(&mut self, ends: [f64; 2]) -> f64 {
        ends[0] + (ends[1] - ends[0]) * self.uniform()
    }

    /// Draws uniformly between minus and plus `half`.
    pub fn half(&mut self, half: f64) -> f64 {
        self.between([-half, half])
    }

    /// Draws from a normal distribution (Box-Muller, one value of the pair).
    pub fn normal(&mut self, mean: f64, sd: f64) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        mean + sd * radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// Draws from a lognormal distribution with this median and standard deviation of the logarithm.
    pub fn lognormal(&mut self, median: f64, ln_sd: f64) -> f64 {
        median * self.normal(0.0, ln_sd).exp()
    }

    /// Draws a whole number below `n`.
    pub fn below(&mut self, n: u64) -> u64 {
        ((self.uniform() * n as f64) as u64).min(n.saturating_sub(1))
    }
}
