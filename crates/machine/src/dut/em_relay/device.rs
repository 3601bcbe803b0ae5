//! Relay recipe on a rig, with the data that the parts of a lot share.
//!
//! Holds recipe, calibration and what it learns: the overshoot of the ramps from reference parts, the interval of the
//! next fine ramp from good parts of the lot, the probe contact at the coil from every part.

use super::calibration::{Calibration, Overshoots};
use super::feasible::nominal_v_per_s;
use super::measure::context::{UNTAUGHT_FINE_V, untaught};
use super::measure::{Context, Observed, Test};
use super::overshoot::OvershootModel;
use super::points::{AnalogIn, AnalogOut, Points};
use super::probe_contact::Trend;
use super::promise::{Promises, operation};
use super::recipe::RelayRecipe;
use super::reference::{self, ReferenceFault};
use super::reference_part::{self, Misfit, ReferenceRun};
use super::settings::ReferencePart;
use super::threshold::Direction;
use crate::dut::Recipe;
use crate::dut::device::{Made, Rig, TestOrder};
use crate::dut::promise::{Broken, Promise};
use crate::dut::record::{Own, TestRecord};
use crate::gauge::evidence::Residuals;
use crate::instrument::act::Act;
use crate::instrument::readings::Readings;
use crate::rig::point::MissingPoint;
use std::sync::Arc;
use units::{Ohm, RigTime};

/// A relay recipe on a rig.
#[derive(Debug, Clone)]
pub struct Device {
    context: Context,
    /// Volts at the terminal per volt of the coil, fine channel.
    voltage_gain: f64,
    certificates: Vec<ReferencePart>,
    reference_parts: ReferenceRun,
    /// Models of the coarse overshoot, operate and release, learned from reference parts and from every part that passes.
    coarse: (OvershootModel, OvershootModel),
    /// The same models, learned from parts of this lot alone.
    of_lot: (OvershootModel, OvershootModel),
    probe_contact: Trend,
    promises: Promises,
}

impl Device {
    /// Resolves the points of the recipe on a rig, and selects the reference parts of its nominal voltage.
    ///
    /// # Errors
    /// Names the first point that the rig lacks, or the section of its references.
    pub fn new(
        recipe: Arc<Recipe>,
        relay: Arc<RelayRecipe>,
        rig: &Rig,
        stored: Option<Calibration>,
    ) -> Result<Self, MissingPoint> {
        let points = Points::resolve(rig.wiring)?;
        let reference = rig.reference.copied().ok_or(MissingPoint {
            section: "reference",
            name: "coil_ohm",
        })?;
        let nominal_v = relay.part.nominal_v;
        let calibration = stored.unwrap_or_else(|| Calibration::unknown(nominal_v));
        let voltage = points.analog(AnalogIn::CoilVoltageFine);
        let voltage_gain = rig.wiring.analog_in(voltage).gain;
        let context = Context {
            recipe,
            relay,
            calibration: Arc::new(calibration),
            reference,
            accuracy: *rig.accuracy,
            nominal_v_per_s: [AnalogOut::SupplyCoarse, AnalogOut::SupplyFine]
                .map(|output| nominal_v_per_s(rig.wiring, points.source(output))),
            points,
            probe_contact: None,
            thorough: false,
            teaching: None,
        };
        let certificates = rig.reference_parts.of_nominal(nominal_v).cloned();
        Ok(Self::of(context, voltage_gain, certificates.collect()))
    }

    pub(super) fn of(
        mut context: Context,
        voltage_gain: f64,
        certificates: Vec<ReferencePart>,
    ) -> Self {
        let coarse = context
            .calibration
            .overshoots
            .map_or(untaught(), |overshoots| {
                (overshoots.operate.coarse, overshoots.release.coarse)
            });
        let broken = context.calibration.broken.clone();
        let promises = Promises::new(context.accuracy, broken);
        context.accuracy = promises.accuracy();
        Self {
            context,
            voltage_gain,
            certificates,
            reference_parts: ReferenceRun::default(),
            coarse,
            of_lot: untaught(),
            probe_contact: Trend::default(),
            promises,
        }
    }

    /// Returns the factors in force.
    pub fn calibration(&self) -> &Calibration {
        &self.context.calibration
    }

    /// Returns the serial numbers of the reference parts, in the order of the magazine.
    pub fn reference_serials(&self) -> impl Iterator<Item = &str> {
        self.certificates.iter().map(|part| part.serial.as_str())
    }

    /// Returns true when the overshoot of the fine ramps is known, so that the test may judge parts.
    pub fn is_calibrated(&self) -> bool {
        let overshoots = self.context.calibration.overshoots;
        overshoots.is_some_and(|overshoots| overshoots.operate.fine_v.u.is_finite())
    }

    /// Returns the acts that measure the references on the board.
    pub fn reference_acts(&self) -> Vec<Act> {
        reference::acts(&self.context)
    }

    /// Computes the factors from the readings of [`Self::reference_acts`].
    ///
    /// # Errors
    /// Names the channel or the reference whose reading is out of range.
    pub fn conclude_references(
        &mut self,
        readings: &Readings,
        made: Made,
    ) -> Result<(), ReferenceFault> {
        let noise_lsb = self.promises.promised().ai_noise_lsb;
        let noise = reference::noise(&self.context, readings, noise_lsb);
        self.observe(Promise::AiNoise, noise);
        let calibration = reference::conclude(
            &self.context,
            readings,
            made.at_us,
            made.valid_us,
            self.voltage_gain,
        )?;
        self.context.calibration = Arc::new(Calibration {
            simulated: made.simulated,
            broken: self.promises.broken().to_vec(),
            ..calibration
        });
        Ok(())
    }

    /// Discards the overshoot, so that the rig must measure references and reference parts again.
    pub fn forget_calibration(&mut self) {
        self.reference_parts = ReferenceRun::default();
        self.calibrate(|calibration| calibration.overshoots = None);
    }

    /// Begins the test of the part in the nest; the probes are up.
    pub fn begin(&self, order: &TestOrder, now: RigTime) -> Test {
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
        match order.number {
            1 => test,
            number => test.another(number),
        }
    }

    /// Learns from a reference part. After the `last` one, returns the complete calibration.
    ///
    /// # Errors
    /// Names the reason why the part is unusable, or the outlier.
    pub fn learn_reference(
        &mut self,
        serial: &str,
        record: &TestRecord,
        last: bool,
    ) -> Result<Option<Calibration>, Misfit> {
        let observed = observed(record);
        self.learn_ramps(observed, false);
        let missing = || Misfit::NoCertificate {
            serial: serial.to_owned(),
        };
        let part = self.certificate(serial).ok_or_else(missing)?.clone();
        let reference = self.context.reference_temperature();
        self.reference_parts
            .learn(&part, reference, record, observed)?;
        if last {
            return self.conclude_reference_parts().map(Some);
        }
        let fine_v = self.reference_parts.fine_v().unwrap_or(UNTAUGHT_FINE_V);
        self.teach(Overshoots {
            operate: reference_part::interim(self.coarse.0, fine_v.0),
            release: reference_part::interim(self.coarse.1, fine_v.1),
        });
        Ok(None)
    }

    /// Completes the calibration with the reference parts measured so far.
    ///
    /// # Errors
    /// Names the outlier, or reports too few parts.
    pub fn conclude_reference_parts(&mut self) -> Result<Calibration, Misfit> {
        let accuracy = &self.context.accuracy;
        let overshoots =
            self.reference_parts
                .overshoots(&self.certificates, accuracy, self.coarse)?;
        self.teach(overshoots);
        Ok(self.calibration().clone())
    }

    /// Learns from a part of the lot; the overshoot models take only parts that `pass`.
    pub fn learn(&mut self, record: &TestRecord, pass: bool) {
        let observed = observed(record);
        self.watch_operations(record, pass);
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

    /// Compares the results of a reference part with its certificate.
    ///
    /// # Errors
    /// Names the result that disagrees.
    pub fn check(&self, serial: &str, record: &TestRecord) -> Result<(), Misfit> {
        match self.certificate(serial) {
            Some(part) => reference_part::check(part, record),
            None => Err(Misfit::NoCertificate {
                serial: serial.to_owned(),
            }),
        }
    }

    /// Returns the resistance of the coil's two force contacts, mean over the last parts; `None` before the first part.
    pub fn probe_contact(&self) -> Option<Ohm> {
        self.probe_contact.mean()
    }

    /// Returns [`Self::probe_contact`] once it is the mean of enough parts for an alarm.
    pub fn settled_probe_contact(&self) -> Option<Ohm> {
        self.probe_contact.settled()
    }

    /// Returns the promises of the rig's file found broken since the last call.
    pub fn broken_promises(&mut self) -> Vec<Broken> {
        self.promises.announce()
    }

    fn observe(&mut self, promise: Promise, residuals: Vec<Residuals>) {
        self.promises.observe(promise, residuals);
        self.context.accuracy = self.promises.accuracy();
    }

    /// Observes the scatter of operations: repeated ramps, and for a part that passes the residuals of both models.
    fn watch_operations(&mut self, record: &TestRecord, pass: bool) {
        let scatter_v = self
            .promises
            .promised()
            .operation_v(self.context.relay.part.nominal_v);
        let mut residuals: Vec<Residuals> = operation::of_repeats(record, scatter_v).collect();
        let ramps = observed(record);
        let models = [
            (ramps.operate, &self.of_lot.0),
            (ramps.release, &self.of_lot.1),
        ];
        let models = models.into_iter().filter(|_| pass);
        residuals.extend(
            models.filter_map(|(ramp, law)| operation::of_overshoot(law, &ramp?, scatter_v)),
        );
        self.observe(Promise::OperationScatter, residuals);
    }

    fn certificate(&self, serial: &str) -> Option<&ReferencePart> {
        self.certificates.iter().find(|part| part.serial == serial)
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

    /// Takes over the overshoot of the reference parts and the probe contact that it contains.
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

/// Returns the observations of a relay test.
fn observed(record: &TestRecord) -> &Observed {
    match &record.own {
        Own::EmRelay(observed) => observed,
        Own::Nothing => panic!("the record of a relay test has no observations"),
    }
}
