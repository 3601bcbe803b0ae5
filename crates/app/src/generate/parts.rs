//! Draws the measured values of made-up parts, with the distributions of the simulated rig's default lot.

use history::{CurveRecord, MeasurementRecord, PartRecord, SampleRecord};
use machine::dut::made_up::{Looks, MadeUp, Scatter};
use machine::dut::{Characteristic, Judgement, Recipe, Verdict};
use machine::gauge::{Budget, Limit, Reading, judge};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Share of parts with a defect, 0 to 1, as in the default world.
const DEFECTS: f64 = 0.04;
/// Share of values with a second attempt, 0 to 1.
const REPEATED: f64 = 0.05;

/// A characteristic with the distribution from which the generator draws its values.
struct Generated {
    of: Characteristic,
    limit: Limit,
    scatter: Scatter,
    /// Uncertainty budget as JSON, as a run stores it.
    budget: String,
}

/// Generator of parts of one recipe.
pub(super) struct PartGenerator {
    recipe: Recipe,
    characteristics: Vec<Generated>,
    looks: Vec<Looks>,
    random: Random,
}

impl PartGenerator {
    /// Creates a generator for parts of this recipe.
    pub fn new(recipe: &Recipe, seed: u64) -> Self {
        let MadeUp { scatter, looks } = recipe.device.made_up(&recipe.limits);
        let characteristics = scatter.into_iter().map(|(of, scatter)| Generated {
            of,
            limit: recipe.limits.of(of),
            budget: serde_json::to_string(&scatter.budget).unwrap_or_default(),
            scatter,
        });
        Self {
            recipe: recipe.clone(),
            characteristics: characteristics.collect(),
            looks,
            random: Random(SplitMix64::seed_from_u64(seed)),
        }
    }

    /// Draws part `seq` of a lot that began at `begin_us` (microseconds since 1970), with `cycle_us` microseconds from
    /// part to part.
    pub fn part(&mut self, lot: &str, seq: u64, begin_us: i64, cycle_us: i64) -> PartRecord {
        let at_us = begin_us + cycle_us * i64::try_from(seq).unwrap_or(i64::MAX / cycle_us);
        let defect = (self.random.unit() < DEFECTS)
            .then(|| (self.random.unit() * self.characteristics.len() as f64) as usize);
        let random = &mut self.random;
        let rule = self.recipe.decision.rule;
        let mut judged = Vec::with_capacity(self.characteristics.len());
        let mut measurements = Vec::with_capacity(self.characteristics.len() + 1);
        for (n, it) in self.characteristics.iter().enumerate() {
            let Generated { of, limit, .. } = it;
            let mut value = it.drawn(random);
            if defect == Some(n) {
                value = match (limit.high, limit.low) {
                    (Some(high), _) => high * (1.05 + 0.3 * random.unit()),
                    (None, Some(low)) => low * (0.95 - 0.3 * random.unit()),
                    (None, None) => value,
                };
            }
            if random.unit() < REPEATED {
                let first = value + 3.0 * it.scatter.u * random.normal();
                measurements.push(it.record(first, Judgement::Void, 1));
            }
            let reading = Reading {
                value,
                unit: of.unit(),
                budget: Budget::default().with("all", it.scatter.u),
            };
            let judgement = judge(&reading, limit, rule);
            let attempt = 1 + u32::from(
                measurements
                    .last()
                    .is_some_and(|before: &MeasurementRecord| before.key == of.key()),
            );
            measurements.push(it.record(value, judgement, attempt));
            judged.push((*of, judgement));
        }
        let verdict = Verdict::of(&self.recipe.device.kind().characteristics(), &judged);
        if verdict != Verdict::Pass {
            for it in &mut measurements {
                it.samples = vec![reply(at_us), reply(at_us + 3_000)];
            }
        }
        let bin = verdict.bin().to_string();
        PartRecord {
            lot: lot.to_owned(),
            seq,
            serial: None,
            verdict: verdict.name().to_owned(),
            bin: bin.to_owned(),
            reasons: verdict.reasons().to_vec(),
            judged_at_us: at_us,
            test_s: 0.95 + 0.02 * random.normal(),
            cycle_s: Some(cycle_us as f64 / 1e6),
            landed_bin: Some(bin.to_owned()),
            landed_at_us: Some(at_us + 900_000),
            kind: "lot".to_owned(),
            measurements,
            curves: match verdict {
                Verdict::Pass => Vec::new(),
                Verdict::Fail(_) | Verdict::Void(_) => {
                    self.looks.iter().map(|it| curve(it, at_us)).collect()
                }
            },
        }
    }
}

fn curve(looks: &Looks, at_us: i64) -> CurveRecord {
    let samples = (0..looks.count).map(|n| (at_us + 5_321 * n, Some((looks.value)(n))));
    CurveRecord {
        signal: looks.signal.name.to_owned(),
        unit: looks.signal.unit.to_owned(),
        step: looks.signal.step,
        samples: samples.collect(),
    }
}

impl Generated {
    fn drawn(&self, random: &mut Random) -> f64 {
        let it = &self.scatter;
        let scatter = it.sd * random.normal();
        if it.logarithmic {
            it.mean * scatter.exp()
        } else {
            (it.mean + scatter).max(0.0)
        }
    }

    fn record(&self, value: f64, judgement: Judgement, attempt: u32) -> MeasurementRecord {
        MeasurementRecord {
            key: self.of.key().to_owned(),
            value: Some(value),
            uncertainty: Some(2.0 * self.scatter.u),
            low: self.limit.low,
            high: self.limit.high,
            verdict: judgement.verdict().to_owned(),
            attempt,
            budget: Some(self.budget.clone()),
            samples: Vec::new(),
        }
    }
}

fn reply(at_us: i64) -> SampleRecord {
    SampleRecord {
        line: "measure".to_owned(),
        module: "ai".to_owned(),
        channel: "0".to_owned(),
        command: "#01".to_owned(),
        raw: ">4C532628E2D64321".to_owned(),
        at_us,
    }
}

/// Random numbers from a seed, the same on every machine.
struct Random(SplitMix64);

impl Random {
    /// Returns a uniform number in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a normal number of mean 0 and standard deviation 1 (Box and Muller).
    fn normal(&mut self) -> f64 {
        let (radius, angle) = (1.0 - self.unit(), self.unit());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }
}
