//! Chance, one ChaCha stream per subject, so that a part does not depend on when it is drawn.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Whose chance it is; each subject and index has a stream of its own.
#[derive(Debug, Clone, Copy)]
pub enum Subject {
    /// The rig: errors of the interface board, temperatures.
    Rig = 1,
    /// Stroke times and falls.
    Mechanism = 2,
    /// A lot part by its place in the lot.
    LotPart = 3,
    /// A golden part.
    GoldenPart = 4,
    /// Scatter of the operations of a lot part.
    LotOperations = 5,
    /// Scatter of the operations of a golden part.
    GoldenOperations = 6,
    /// Places of the defects in a block of the lot.
    DefectBlock = 7,
}

/// A stream of chance.
#[derive(Debug, Clone)]
pub struct Draw(ChaCha8Rng);

impl Draw {
    /// The stream of one subject under a seed.
    pub fn new(seed: u64, subject: Subject, index: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream((subject as u64) << 48 | index);
        Self(rng)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform between the two ends.
    pub fn between(&mut self, ends: [f64; 2]) -> f64 {
        ends[0] + (ends[1] - ends[0]) * self.uniform()
    }

    /// Uniform within plus and minus `half`.
    pub fn half(&mut self, half: f64) -> f64 {
        self.between([-half, half])
    }

    /// Normal (Box and Muller, one of the pair).
    pub fn normal(&mut self, mean: f64, sd: f64) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        mean + sd * radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// Lognormal by its median and the deviation of its logarithm.
    pub fn lognormal(&mut self, median: f64, ln_sd: f64) -> f64 {
        median * self.normal(0.0, ln_sd).exp()
    }

    /// A whole number below `n`.
    pub fn below(&mut self, n: u64) -> u64 {
        ((self.uniform() * n as f64) as u64).min(n.saturating_sub(1))
    }
}
