//! An experiment with the chamber after its identification: a tuning adds an oscillation. No part is tested.

use super::super::Finding;
use super::super::device::Device;
use super::super::response;
use super::passes::Seen;
use crate::dut::batch::HeatTrouble;
use crate::dut::experiment::{Experiment, Found};
use chamber::control::Observed;
use chamber::control::split_range::{Command, SplitRange};
use chamber::ramp::SetPoint;
use chamber::tune::Identified;
use chamber::tune::relay::{Oscillation, RelayTune, Step};
use chamber::watch::{Second, Watch};

/// Rest between identification and oscillation, s.
const REST_S: u32 = 120;
/// Least power with which an oscillation begins around its temperature, 1 = full heater.
const LEAST_HOLDING: f64 = 0.02;

/// The experiment after its identification.
#[derive(Debug)]
pub struct Trial {
    found: Identified,
    doubt: Identified,
    ambient_c: f64,
    tuning: Option<Tuning>,
    oscillation: Option<Oscillation>,
}

/// An oscillation around a temperature between the windows.
#[derive(Debug)]
struct Tuning {
    rest_s: u32,
    target_c: f64,
    relay: RelayTune,
    split: SplitRange,
    watch: Watch,
}

impl Trial {
    /// Goes on after an identification: a tuning oscillates, any other experiment is over.
    pub fn new(
        device: &Device,
        what: Experiment,
        [found, doubt]: [Identified; 2],
        ambient_c: f64,
    ) -> Self {
        Self {
            found,
            doubt,
            ambient_c,
            tuning: (what == Experiment::Tune).then(|| Tuning::new(device, &found, ambient_c)),
            oscillation: None,
        }
    }

    /// Performs one second of the experiment and returns the command for heater and vent; `None` when the experiment is
    /// over. `control_c` is the reading of the control thermometer, C.
    ///
    /// # Errors
    /// Fails with the trouble of the chamber; the caller switches the heater off.
    pub fn step(&mut self, seen: &Seen, control_c: f64) -> Result<Option<Command>, Finding> {
        let Some(tuning) = &mut self.tuning else {
            return Ok(None);
        };
        match tuning.step(seen, control_c)? {
            Step::Go(power) => Ok(Some(tuning.command(power, seen, control_c))),
            Step::Done(found) => {
                self.oscillation = Some(found);
                Ok(None)
            }
        }
    }

    /// Returns the temperature of the room, C.
    pub fn ambient_c(&self) -> f64 {
        self.ambient_c
    }

    /// Returns the identified response of the chamber.
    pub fn chamber(&self) -> Identified {
        self.found
    }

    /// Returns what the experiment has found.
    pub fn found(&self) -> Found {
        let settings = self.oscillation.as_ref().map(response::settings);
        let mut all = response::figures(&self.found, &self.doubt);
        all.extend(settings.unwrap_or_default());
        all
    }
}

impl Tuning {
    fn new(device: &Device, found: &Identified, ambient_c: f64) -> Self {
        let windows = device.thermostat.windows(&device.recipe.limits);
        let [operate, reset] =
            windows.unwrap_or_else(|| panic!("a recipe without windows is not feasible"));
        let target_c = f64::midpoint(reset.high_c, operate.low_c);
        let holding = found.loss_per_k * (target_c - ambient_c) - found.fan;
        Self {
            rest_s: REST_S,
            target_c,
            relay: RelayTune::new(target_c, holding.max(LEAST_HOLDING)),
            split: SplitRange::of(found),
            watch: Watch::new(found),
        }
    }

    fn step(&mut self, seen: &Seen, control_c: f64) -> Result<Step, Finding> {
        if self.rest_s > 0 {
            self.rest_s -= 1;
            return Ok(Step::Go(0.0));
        }
        let step = self.relay.step(control_c);
        let step = step.map_err(|_| Finding::Heat(HeatTrouble::NotIdentified))?;
        let Step::Go(power) = step else {
            return Ok(step);
        };
        let second = Second {
            control_c: seen.control_c,
            reference_c: seen.reference_c,
            ambient_c: seen.ambient_c,
            set: SetPoint::hold(self.target_c),
            command: self.command(power, seen, control_c),
            gain: 1.0,
        };
        match self.watch.step(&second).first() {
            Some(trouble) => Err((*trouble).into()),
            None => Ok(step),
        }
    }

    fn command(&self, power: f64, seen: &Seen, measured_c: f64) -> Command {
        let observed = Observed {
            measured_c,
            ambient_c: seen.ambient_c,
        };
        self.split.command(power, &observed)
    }
}
