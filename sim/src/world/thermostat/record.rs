//! Truth and faults of the chamber: true values by socket, faults that begin at run time, parts of another lot.

use super::fault::Fault;
use super::lot::Lot;
use super::{OvenWorld, Supply};
use crate::error::SimError;
use crate::truth::{ChamberMove, WorldRecord};
use crate::world::WorldOptions;

impl WorldRecord for OvenWorld {
    fn truth(&self) -> Vec<serde_json::Value> {
        let truths = self.rack.truths().into_iter();
        truths
            .filter_map(|it| serde_json::to_value(it).ok())
            .collect()
    }

    fn chamber_moves(&self) -> &[ChamberMove] {
        &self.moves
    }

    fn cancel_faults(&mut self) {
        self.faults.clear();
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
        self.catch_up();
        match (fault.is_of_socket(), value) {
            (false, None) => self.faults.add(self.done_us, fault),
            (false, Some(_)) => return Err(wrong("no value, since the fault strikes now")),
            (true, Some(number)) if self.break_wire(number) => {}
            (true, _) => return Err(wrong("the number of a socket")),
        }
        Ok(())
    }

    /// Gives the person the parts of another lot; those in the rack stay there.
    fn refill(&mut self, options: &WorldOptions) -> Result<(), SimError> {
        self.lot = Lot::read(&options.files, &options.recipe, &self.table, options.seed)?;
        self.supply = Supply {
            left: options.parts,
            ..self.supply
        };
        Ok(())
    }
}
