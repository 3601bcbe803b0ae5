//! Relay recipe on a rig, with the data that the parts of a lot share.
//!
//! The device learns the overshoot of the ramps from reference parts, the interval of the next fine ramp from good
//! parts of the lot, the probe contact at the coil from every part.

use super::calibration::{Calibration, Overshoots, Temperature};
use super::feasible::nominal_v_per_s;
use super::measure::{Context, Observed, Test};
use super::overshoot::OvershootModel;
use super::points::{AnalogOut, Points};
use super::probe_contact::Trend;
use super::promise::Promises;
use super::recipe::RelayRecipe;
use super::reference;
use super::reference_part::{self, Misfit, ReferenceRun};
use super::settings::ReferencePart;
use super::threshold::Direction;
use crate::dut::device::{CalibrationFault, DeviceUnderTest, Made, Rig, TestOrder};
use crate::dut::promise::{Broken, Promise};
use crate::dut::record::{Own, TestRecord};
use crate::dut::{self, Procedure, Recipe};
use crate::gauge::budget::COVERAGE_FACTOR;
use crate::instrument::act::Act;
use crate::instrument::readings::Readings;
use crate::rig::point::MissingPoint;
use std::sync::Arc;
use units::{Ohm, RigTime};

/// A relay recipe on a rig.
#[derive(Debug, Clone)]
pub struct Device {
    context: Context,
    certificates: Vec<ReferencePart>,
    reference_parts: ReferenceRun,
    /// Models of the coarse overshoot, operate and release, learned from reference parts and from every good part of
    /// the lot.
    coarse: (OvershootModel, OvershootModel),
    /// Models of the coarse overshoot, operate and release, learned from parts of this lot alone.
    of_lot: (OvershootModel, OvershootModel),
    probe_contact: Trend,
    promises: Promises,
}

impl Device {
    /// Resolves the points of the recipe on a rig, and selects the reference parts of the recipe's nominal voltage.
    ///
    /// # Errors
    /// Fails with the first point that the rig lacks, or with the section of references that `rig.toml` lacks.
    pub fn new(
        recipe: Arc<Recipe>,
        relay: &RelayRecipe,
        rig: &Rig,
        stored: Option<Calibration>,
    ) -> Result<Self, MissingPoint> {
        let points = Points::resolve(rig.wiring)?;
        let reference = rig.reference.copied().ok_or(MissingPoint {
            section: "reference",
            name: "coil_ohm",
        })?;
        let nominal_v = relay.part.nominal_v;
        let range = rig.wiring.supply_range.clone();
        assert!(range.is_some(), "a relay on a supply without a range");
        let factor = range.as_ref().map_or(1.0, |range| range.factor);
        let calibration = stored.unwrap_or_else(|| Calibration::unknown(nominal_v, factor));
        let context = Context {
            recipe,
            relay: Arc::new(relay.clone()),
            calibration: Arc::new(calibration),
            reference,
            accuracy: *rig.accuracy,
            nominal_v_per_s: [AnalogOut::SupplyCoarse, AnalogOut::SupplyFine]
                .map(|output| nominal_v_per_s(rig.wiring, points.source(output))),
            points,
            range,
            probe_contact: None,
            thorough: false,
            teaching: None,
        };
        let certificates = rig.reference_parts.of_nominal(nominal_v).cloned();
        Ok(Self::of(context, certificates.collect()))
    }

    pub(super) fn of(mut context: Context, certificates: Vec<ReferencePart>) -> Self {
        let coarse = context
            .calibration
            .overshoots
            .map_or(context.assumed_models(), |overshoots| {
                (overshoots.operate.coarse, overshoots.release.coarse)
            });
        let promises = Promises::new(&context);
        promises.apply(&mut context);
        Self {
            of_lot: context.assumed_models(),
            context,
            certificates,
            reference_parts: ReferenceRun::default(),
            coarse,
            probe_contact: Trend::default(),
            promises,
        }
    }

    /// Compares the scatter of repeated ramps, of any part, with the promised scatter of operations.
    fn watch(&mut self, record: &TestRecord) {
        let scale = self.context.scale();
        self.promises.watch_repeats(record, scale);
        self.promises.apply(&mut self.context);
    }

    /// Compares the scatter of closures with the promised one, which only a good part of the lot can test.
    fn watch_good(&mut self, record: &TestRecord) {
        self.promises.watch_closures(observed(record));
        self.promises.apply(&mut self.context);
    }

    /// Tests the promised temperature of parts on the reference parts, and returns the one that both give together.
    fn temperature(&mut self) -> Temperature {
        let (run, accuracy) = (&self.reference_parts, &self.context.accuracy);
        let residuals = run.temperatures(&self.certificates, accuracy);
        self.promises.observe(Promise::PartMinusTrack, residuals);
        let u_pct = accuracy.part_minus_track_u_pct;
        run.temperature(self.promises.part_minus_track_k(u_pct))
    }

    fn certificate(&self, serial: &str) -> Option<&ReferencePart> {
        self.certificates.iter().find(|part| part.serial == serial)
    }

    fn certified(&self, serial: &str) -> Result<&ReferencePart, Misfit> {
        self.certificate(serial)
            .ok_or_else(|| Misfit::NoCertificate {
                serial: serial.to_owned(),
            })
    }

    fn learn_ramps(&mut self, observed: &Observed, of_lot: bool) {
        let both = [
            (observed.operate, &mut self.coarse.0, &mut self.of_lot.0),
            (observed.release, &mut self.coarse.1, &mut self.of_lot.1),
        ];
        for (ramp, law, law_of_lot) in both {
            let Some((coarse, fine)) = ramp.and_then(|it| Some((it.coarse, it.fine?))) else {
                continue;
            };
            law.learn(&coarse, fine);
            if of_lot {
                law_of_lot.learn(&coarse, fine);
            }
        }
    }

    /// Takes over the overshoot found on the reference parts, and the probe contact resistance that it contains.
    fn teach(&mut self, overshoots: Overshoots) {
        let probe_contact_ohm = self.reference_parts.probe_contact_ohm();
        self.calibrate(|calibration| calibration.probe_contact_ohm = probe_contact_ohm);
        self.calibrate_overshoots(overshoots);
    }

    fn calibrate_overshoots(&mut self, overshoots: Overshoots) {
        self.calibrate(|calibration| calibration.overshoots = Some(overshoots));
    }

    fn calibrate(&mut self, change: impl FnOnce(&mut Calibration)) {
        change(Arc::make_mut(&mut self.context.calibration));
    }
}

impl DeviceUnderTest for Device {
    fn begin(&self, order: &TestOrder, now: RigTime) -> Procedure {
        let context = Context {
            thorough: order.thorough,
            probe_contact: self.probe_contact.mean(),
            teaching: order
                .teaching
                .and_then(|serial| self.certificate(serial))
                .cloned(),
            ..self.context.clone()
        };
        let test = Test::begin(context, now);
        Procedure::EmRelay(Box::new(match order.number {
            1 => test,
            number => test.another(number),
        }))
    }

    fn due_at_us(&self) -> Option<i64> {
        Some(self.context.calibration.due_at_us)
    }

    fn reference_serials(&self) -> Vec<String> {
        let serials = self.certificates.iter().map(|part| part.serial.clone());
        serials.collect()
    }

    /// Returns true when the overshoot of the fine ramps is known.
    fn is_calibrated(&self) -> bool {
        let overshoots = self.context.calibration.overshoots;
        overshoots.is_some_and(|overshoots| overshoots.operate.fine_v.u.is_finite())
    }

    fn reference_acts(&self) -> Vec<Act> {
        reference::acts(&self.context)
    }

    fn conclude_references(
        &mut self,
        readings: &Readings,
        made: Made,
    ) -> Result<(), CalibrationFault> {
        let noise_lsb = self.promises.promised(Promise::AiNoise);
        let noise = reference::noise(&self.context, readings, noise_lsb);
        self.promises.observe(Promise::AiNoise, noise);
        self.promises.apply(&mut self.context);
        let calibration = reference::conclude(&self.context, readings, made.at_us, made.valid_us)?;
        self.context.calibration = Arc::new(Calibration {
            simulated: made.simulated,
            broken: self.promises.broken(),
            ..calibration
        });
        Ok(())
    }

    fn forget_calibration(&mut self) {
        self.reference_parts = ReferenceRun::default();
        self.promises.restart();
        self.calibrate(|calibration| {
            calibration.overshoots = None;
            calibration.temperature = None;
        });
        self.promises.apply(&mut self.context);
    }

    fn learn_reference(
        &mut self,
        serial: &str,
        record: &TestRecord,
        last: bool,
    ) -> Result<Option<dut::Calibration>, CalibrationFault> {
        let observed = observed(record);
        self.watch(record);
        self.learn_ramps(observed, false);
        let part = self.certified(serial)?.clone();
        let reference = self.context.reference_temperature();
        self.reference_parts
            .learn(&part, reference, record, observed)?;
        if last {
            return self.conclude_reference_parts().map(Some);
        }
        let assumed = self.context.assumed_fine_v();
        let fine_v = self.reference_parts.fine_v().unwrap_or(assumed.into());
        self.teach(Overshoots {
            operate: reference_part::interim(self.coarse.0, fine_v.0),
            release: reference_part::interim(self.coarse.1, fine_v.1),
        });
        Ok(None)
    }

    fn conclude_reference_parts(&mut self) -> Result<dut::Calibration, CalibrationFault> {
        let accuracy = &self.context.accuracy;
        let overshoots =
            self.reference_parts
                .overshoots(&self.certificates, accuracy, self.coarse)?;
        self.teach(overshoots);
        let temperature = self.temperature();
        let broken = self.promises.broken();
        self.calibrate(|calibration| {
            calibration.temperature = Some(temperature);
            calibration.broken = broken;
        });
        let calibration = Calibration::clone(&self.context.calibration);
        Ok(dut::Calibration::EmRelay(Box::new(calibration)))
    }

    /// Teaches the overshoot models with parts that `pass`, and the trend of the probe contact with every part.
    fn learn(&mut self, record: &TestRecord, pass: bool) {
        let observed = observed(record);
        self.watch(record);
        if pass {
            self.watch_good(record);
        }
        if let Some(ohm) = observed.probe_contact {
            self.probe_contact.add(ohm);
        }
        if pass {
            self.learn_ramps(observed, true);
        }
        let overshoot = |direction| self.context.overshoot(direction);
        self.calibrate_overshoots(Overshoots {
            operate: overshoot(Direction::Rising).taught(self.coarse.0, self.of_lot.0),
            release: overshoot(Direction::Falling).taught(self.coarse.1, self.of_lot.1),
        });
    }

    fn check(&mut self, serial: &str, record: &TestRecord) -> Result<(), CalibrationFault> {
        self.watch(record);
        Ok(reference_part::check(self.certified(serial)?, record)?)
    }

    fn probe_contact(&self) -> Option<Ohm> {
        self.probe_contact.mean()
    }

    fn broken_promises(&mut self) -> Vec<Broken> {
        self.promises.announce()
    }

    /// Returns the mean contact resistance of the probes less its expanded uncertainty (k = 2), which comes from the
    /// gain of the level output: on a coil of thousands of ohms, one ohm of contact resistance is smaller than the
    /// error of that output.
    fn settled_probe_contact(&self) -> Option<Ohm> {
        let Ohm(mean) = self.probe_contact.settled()?;
        let level = self.context.calibration.level.gain;
        let doubt = COVERAGE_FACTOR * self.context.relay.part.nominal_coil_ohm * level.u;
        Some(Ohm((mean - doubt).max(0.0)))
    }
}

/// Returns the observations of a relay test.
fn observed(record: &TestRecord) -> &Observed {
    let Own::EmRelay(observed) = &record.own else {
        panic!("the record of a relay test has no observations");
    };
    observed
}
