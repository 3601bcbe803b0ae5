//! Implements the record of the world: facts that no module reports, and faults that begin at run time.

use super::World;
use super::fault::{Fault, FaultKind};
use super::magazine::Magazine;
use crate::config::read_world;
use crate::error::SimError;
use crate::truth::{BodyTruth, ContactMove, Overdrive, WorldRecord};
use crate::world::WorldOptions;

impl WorldRecord for World {
    fn truth(&self) -> Vec<serde_json::Value> {
        let truths = self.mechanism.places.truth();
        truths
            .into_iter()
            .filter_map(|t| serde_json::to_value(t).ok())
            .collect()
    }

    fn bodies(&self) -> Vec<BodyTruth> {
        self.mechanism.bodies()
    }

    fn take_codes(&mut self) -> Vec<String> {
        self.mechanism.take_codes()
    }

    fn cancel_faults(&mut self) {
        self.mechanism.cancel_faults();
    }

    fn forget_finished(&mut self) {
        self.mechanism.places.forget_finished();
    }

    fn motion_starts(&self) -> Vec<(u64, &'static str)> {
        self.mechanism.motion_starts().collect()
    }

    fn crashes(&self) -> Vec<String> {
        self.mechanism.crashes().to_vec()
    }

    fn overdrives(&self) -> &[Overdrive] {
        self.fixture.overdrives()
    }

    fn contact_moves(&self) -> &[ContactMove] {
        self.fixture.contact_moves()
    }

    fn inject(&mut self, name: &str, value: Option<f64>) -> Result<(), SimError> {
        let Some(fault) = Fault::from_name(name) else {
            return Err(SimError::UnknownFault { name: name.into() });
        };
        let wrong = |expected: &str| SimError::FaultValue {
            name: name.into(),
            found: value.map_or_else(|| "nothing".into(), |value| value.to_string()),
            expected: expected.into(),
        };
        match (fault.kind(), value) {
            (FaultKind::Timed, None) => self.mechanism.inject(fault, self.now_us),
            (FaultKind::Timed, Some(_)) => {
                return Err(wrong("no value, since the fault strikes now"));
            }
            (FaultKind::OfPart, Some(part)) => self.mechanism.add_part_fault(fault, part),
            (FaultKind::OfPart, None) => return Err(wrong("the number of a part")),
            (FaultKind::OfStart, _) => {
                return Err(wrong(
                    "a fault that a running rig accepts; this one applies only to the start",
                ));
            }
        }
        Ok(())
    }

    fn refill(&mut self, options: &WorldOptions) -> Result<(), SimError> {
        let table = read_world(&options.files, options.world_file.as_deref())?;
        let (track, ambient) = (self.environment.track_c, self.environment.ambient_c);
        self.mechanism
            .refill(|faults| Magazine::load(options, &table, faults, track, ambient))?;
        self.mechanism_changed();
        Ok(())
    }
}
