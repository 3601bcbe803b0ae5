//! A recipe of a solid-state relay on a rig.

use super::learned::Learned;
use super::measure::Test;
use super::plan::Plan;
use super::points::Points;
use super::recipe::{Output, SsrRecipe};
use super::references::Fixture;
use crate::dut::device::{DeviceUnderTest, Rig, TestOrder};
use crate::dut::record::{Own, Stop};
use crate::dut::{Procedure, Recipe, TestRecord};
use crate::rig::point::MissingPoint;
use std::sync::Arc;
use units::RigTime;

/// A recipe on a rig, with the thresholds and corrections that the lot has shown so far.
#[derive(Debug, Clone)]
pub struct Device {
    /// The recipe.
    pub recipe: Arc<Recipe>,
    /// Levels, ranges and times.
    pub plan: Arc<Plan>,
    /// Points and instruments.
    pub points: Arc<Points>,
    /// Thresholds of earlier parts.
    pub learned: Learned,
    /// Number of parts of the lot that have been judged.
    pub judged: u32,
    /// Corrections of the fixture, from the test of an earlier part.
    pub fixture: Fixture,
}

impl Device {
    /// Resolves points, instruments and ranges of the recipe on a rig.
    ///
    /// # Errors
    /// Fails with the first point or instrument that the rig lacks, an instrument without a range for the test included.
    pub fn new(recipe: Arc<Recipe>, ssr: &SsrRecipe, rig: &Rig) -> Result<Self, MissingPoint> {
        let points = Points::resolve(rig.wiring, ssr.part.output != Output::Dc)?;
        let plan = Plan::of(
            ssr,
            &recipe.limits,
            recipe.decision.rule,
            &points,
            rig.wiring,
        );
        let plan = plan.map_err(|lack| MissingPoint {
            section: "instrument",
            name: lack.device.name(),
        })?;
        Ok(Self {
            recipe,
            plan: Arc::new(plan),
            points: Arc::new(points),
            learned: Learned::default(),
            judged: 0,
            fixture: Fixture::default(),
        })
    }
}

impl DeviceUnderTest for Device {
    fn begin(&self, order: &TestOrder, now: RigTime) -> Procedure {
        Procedure::Ssr(Box::new(Test::begin(self.clone(), order, now)))
    }

    fn learn(&mut self, record: &TestRecord, pass: bool) {
        if let Own::Ssr(fixture) = record.own {
            self.fixture = Fixture {
                references: fixture.references.or(self.fixture.references),
                open: fixture.open.or(self.fixture.open),
            };
        }
        // A void part is no sample.
        if !matches!(record.why_stopped(), Some(Stop::Void(_) | Stop::Trouble(_))) {
            self.judged = self.judged.saturating_add(1);
        }
        if pass {
            self.learned.add(record);
        }
    }
}
