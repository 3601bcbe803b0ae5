//! Individual errors, conversion rates and latency of one module; its data sheet states only their limits.
//!
//! The seed draws the errors once per module, uniformly within the maker's limits. Each module has its own random
//! stream, chosen by its name, so that adding or removing a module changes nothing for the others.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use crate::config::DeviceWorld;

/// Shortest latency of a module, microseconds; a shorter draw counts as this.
const QUICKEST_US: f64 = 100.0;

/// Individual errors, conversion rates and latency of one module.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerances {
    /// Mean time from the CR of the request to the first character of the reply, microseconds.
    pub latency_us: f64,
    /// Standard deviation of the latency between transactions, microseconds.
    pub latency_sd_us: f64,
    /// Relative gain error of an analog input.
    pub ai_gain: f64,
    /// Offset error of an analog input, fraction of full scale.
    pub ai_offset: f64,
    /// Noise of one conversion, standard deviation in converter steps.
    pub ai_noise_lsb: f64,
    /// Relative gain error of an analog output.
    pub ao_gain: f64,
    /// Offset error of an analog output, volts.
    pub ao_offset_v: f64,
    /// Relative error of the slew rate.
    pub ao_slope: f64,
    /// Interval between two refreshes of a ramping output, microseconds.
    pub ao_refresh_us: u64,
    /// Conversions per second in fast mode, all channels together.
    pub fast_per_s: f64,
    /// Conversions per second in normal mode, all channels together.
    pub normal_per_s: f64,
}

impl Tolerances {
    /// Creates a module without errors that answers after exactly `latency_us`.
    pub fn exact(latency_us: f64) -> Self {
        Self {
            latency_us,
            latency_sd_us: 0.0,
            ai_gain: 0.0,
            ai_offset: 0.0,
            ai_noise_lsb: 0.0,
            ao_gain: 0.0,
            ao_offset_v: 0.0,
            ao_slope: 0.0,
            ao_refresh_us: 1_000,
            fast_per_s: 75.0,
            normal_per_s: 10.0,
        }
    }

    /// Draws the individual errors of one module.
    pub fn draw(world: &DeviceWorld, rng: &mut ChaCha8Rng) -> Self {
        let mut within = |half_width: f64| half_width * (2.0 * rng.random::<f64>() - 1.0);
        Self {
            latency_us: world.latency_ms_mean * 1e3,
            latency_sd_us: world.latency_ms_sd * 1e3,
            ai_gain: within(world.ai_gain_pct / 100.0),
            ai_offset: within(world.ai_offset_pct_of_range / 100.0),
            ai_noise_lsb: world.ai_noise_lsb,
            ao_gain: within(world.ao_gain_pct / 100.0),
            ao_offset_v: within(world.ao_offset_mv / 1e3),
            ao_slope: within(world.ao_slope_pct / 100.0),
            ao_refresh_us: (world.ao_refresh_ms * 1e3).round().max(1.0) as u64,
            fast_per_s: world.conversions_per_s,
            normal_per_s: world.conversions_per_s_normal,
        }
    }

    /// Draws the latency of the next transaction, microseconds.
    pub fn next_latency_us(&self, rng: &mut ChaCha8Rng) -> u64 {
        let scatter: f64 = rng.sample(StandardNormal);
        let latency = self.latency_us + self.latency_sd_us * scatter;
        latency.max(QUICKEST_US.min(self.latency_us)).round() as u64
    }
}

/// Returns the random stream of `seed` that belongs to `name`.
pub fn stream(seed: u64, name: &str) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(fnv1a(name));
    rng
}

/// Hashes a name by 64-bit FNV-1a, which is stable across builds.
fn fnv1a(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_module_has_its_own_stream() {
        let first: u64 = stream(1, "timer").random();
        assert_eq!(first, stream(1, "timer").random::<u64>());
        assert_ne!(first, stream(1, "rtd").random::<u64>());
        assert_ne!(first, stream(2, "timer").random::<u64>());
    }

    #[test]
    fn latency_never_falls_below_a_tenth_of_a_millisecond() {
        let tolerances = Tolerances {
            latency_sd_us: 5_000.0,
            ..Tolerances::exact(2_000.0)
        };
        let mut rng = stream(3, "m");
        let least = (0..1000)
            .map(|_| tolerances.next_latency_us(&mut rng))
            .min();
        assert_eq!(least, Some(100));
    }
}
