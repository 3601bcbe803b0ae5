//! Values of made-up parts: the lot of the default world, one draw after the other.

use crate::dut::em_relay::Parameter;
use crate::dut::recipe::Recipe;
use crate::dut::verdict::{judge, of_part};
use crate::dut::{Judgement, Verdict};
use crate::gauge::{Budget, Reading};
use crate::history::{CurveRecord, MeasurementRecord, PartRecord, SampleRecord};
use crate::instrument::trace::Signal;
use crate::rig::point::AnalogIn;

/// Share of parts with a defect, as in the default world.
const DEFECTS: f64 = 0.04;
/// Share of values measured a second time.
const REPEATED: f64 = 0.05;

/// Scatter of one parameter.
struct Scatter {
    parameter: Parameter,
    mean: f64,
    sd: f64,
    /// Of the logarithm instead, about the logarithm of the mean.
    logarithmic: bool,
    /// Standard uncertainty of a value.
    u: f64,
    /// Budget as a run stores it.
    budget: String,
}

/// Where made-up parts come from.
pub(super) struct Line {
    recipe: Recipe,
    scatter: Vec<Scatter>,
    draws: Draws,
}

impl Line {
    /// Means from the recipe where it knows them, else those of the default world.
    pub fn new(recipe: &Recipe, seed: u64) -> Self {
        let scatter = Parameter::ALL
            .into_iter()
            .map(|it| scatter(recipe, it))
            .collect();
        Self {
            recipe: recipe.clone(),
            scatter,
            draws: Draws(seed),
        }
    }

    /// The part `seq` of a lot that began at `begin_us`.
    pub fn part(&mut self, lot: &str, seq: u64, begin_us: i64, cycle_us: i64) -> PartRecord {
        let at_us = begin_us + cycle_us * i64::try_from(seq).unwrap_or(i64::MAX / cycle_us);
        let defect = (self.draws.unit() < DEFECTS)
            .then(|| (self.draws.unit() * Parameter::ALL.len() as f64) as usize);
        let draws = &mut self.draws;
        let limits = &self.recipe.limits;
        let rule = self.recipe.decision.rule;
        let mut judged = Vec::with_capacity(Parameter::ALL.len());
        let mut measurements = Vec::with_capacity(Parameter::ALL.len() + 1);
        for (n, it) in self.scatter.iter().enumerate() {
            let limit = limits.of(it.parameter);
            let mut value = it.drawn(draws);
            if defect == Some(n) {
                value = match (limit.high, limit.low) {
                    (Some(high), _) => high * (1.05 + 0.3 * draws.unit()),
                    (None, Some(low)) => low * (0.95 - 0.3 * draws.unit()),
                    (None, None) => value,
                };
            }
            if draws.unit() < REPEATED {
                let first = value + 3.0 * it.u * draws.normal();
                measurements.push(it.record(first, limit, Judgement::Void, 1));
            }
            let reading = Reading {
                value,
                budget: Budget::default().with("all", it.u),
            };
            let judgement = judge(&reading, &limit, rule);
            let attempt = 1 + u32::from(
                measurements
                    .last()
                    .is_some_and(|before: &MeasurementRecord| before.key == it.parameter.name()),
            );
            measurements.push(it.record(value, limit, judgement, attempt));
            judged.push((it.parameter, judgement));
        }
        let verdict = of_part(&judged);
        if verdict != Verdict::Pass {
            for it in &mut measurements {
                it.samples = vec![reply(at_us), reply(at_us + 3_000)];
            }
        }
        let bin = verdict.bin();
        PartRecord {
            lot: lot.to_owned(),
            seq,
            serial: None,
            verdict: verdict.name().to_owned(),
            bin: bin.to_string(),
            reasons: verdict.reasons(),
            judged_at_us: at_us,
            test_s: 0.95 + 0.02 * draws.normal(),
            cycle_s: Some(cycle_us as f64 / 1e6),
            landed_bin: Some(bin.to_string()),
            landed_at_us: Some(at_us + 900_000),
            kind: "lot".to_owned(),
            measurements,
            curves: evidence(&verdict, at_us),
        }
    }
}

/// As many looks as a test of the default recipe has: 30 polls of a contact, 120 samples of a voltage.
fn evidence(verdict: &Verdict, at_us: i64) -> Vec<CurveRecord> {
    if *verdict == Verdict::Pass {
        return Vec::new();
    }
    let curve = |signal: Signal, samples: i64, value: fn(i64) -> f64| CurveRecord {
        signal: signal.name().to_owned(),
        unit: signal.unit().to_owned(),
        step: signal.step(),
        samples: (0..samples)
            .map(|n| (at_us + 5_321 * n, Some(value(n))))
            .collect(),
    };
    vec![
        curve(Signal::Board, 30, |n| (500 + n % 2) as f64),
        curve(Signal::Input(AnalogIn::CoilVoltageFine), 120, |n| {
            5.0 + 0.031_7 * n as f64
        }),
    ]
}

impl Scatter {
    fn drawn(&self, draws: &mut Draws) -> f64 {
        let scatter = self.sd * draws.normal();
        if self.logarithmic {
            self.mean * scatter.exp()
        } else {
            (self.mean + scatter).max(0.0)
        }
    }

    fn record(
        &self,
        value: f64,
        limit: crate::dut::recipe::Limit,
        judgement: Judgement,
        attempt: u32,
    ) -> MeasurementRecord {
        MeasurementRecord {
            key: self.parameter.name().to_owned(),
            value: Some(value),
            uncertainty: Some(2.0 * self.u),
            low: limit.low,
            high: limit.high,
            verdict: match judgement {
                Judgement::Pass => "pass",
                Judgement::Fail(_) | Judgement::Conditional(_) => "fail",
                Judgement::Void => "void",
            }
            .to_owned(),
            attempt,
            budget: Some(self.budget.clone()),
            samples: Vec::new(),
        }
    }
}

fn scatter(recipe: &Recipe, parameter: Parameter) -> Scatter {
    let (test, part) = (&recipe.test, &recipe.part);
    let (mean, sd, logarithmic, u) = match parameter {
        Parameter::CoilResistance => {
            let nominal = part.nominal_coil_ohm;
            (nominal, 0.015 * nominal, false, 0.001 * nominal)
        }
        Parameter::OperateVoltage => (
            test.expected_operate_v,
            test.expected_operate_sd_v,
            false,
            0.006,
        ),
        Parameter::ReleaseVoltage => (
            test.expected_release_v,
            test.expected_release_sd_v,
            false,
            0.006,
        ),
        Parameter::OperateTime => (4.7, 0.25, false, 0.01),
        Parameter::ReleaseTime => (2.9, 0.15, false, 0.01),
        Parameter::OperateBounce => (0.4, 0.4, true, 0.01),
        Parameter::ReleaseBounce => (0.5, 0.4, true, 0.01),
        Parameter::ContactResistanceNo => (18.0, 0.25, true, 0.3),
        Parameter::ContactResistanceNc => (22.0, 0.25, true, 0.3),
    };
    let budget = Budget::default()
        .with_random("reading", 0.6 * u)
        .with("offset", 0.3 * u)
        .with("reference resistor", 0.2 * u)
        .with("coil temperature", 0.7 * u);
    Scatter {
        parameter,
        mean,
        sd,
        logarithmic,
        u,
        budget: serde_json::to_string(&budget).unwrap_or_default(),
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

/// SplitMix64: small, seeded, the same everywhere.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut it = self.0;
        it = (it ^ (it >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        it = (it ^ (it >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        it ^ (it >> 31)
    }

    /// From 0 up to, but not including, 1.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Mean 0, deviation 1 (Box and Muller).
    fn normal(&mut self) -> f64 {
        let (radius, angle) = (1.0 - self.unit(), self.unit());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }
}
