//! Runs the chamber second by second: identification or search for the room, rest, passes.

use super::super::Finding;
use super::super::device::Device;
use super::super::recipe::Control;
use super::contacts::Events;
use super::repeat::{self, Shown};
use super::trial::Trial;
use super::windows::{planned, shown};
use crate::dut::batch::HeatTrouble;
use crate::dut::experiment::Experiment;
use chamber::control::increment::{Increment, Rules};
use chamber::control::pid::Pid;
use chamber::control::scheduled::{FuzzyPid, Symmetry};
use chamber::control::split_range::{Command, SplitRange};
use chamber::control::{Controller, Law, Observed};
use chamber::lag::Record;
use chamber::program::{Phase, Program, Waiting, Window};
use chamber::tune::identify::{Identification, Step};
use chamber::tune::room::{self, RoomSearch};
use chamber::tune::{Identified, Settings};
use chamber::watch::slope::SlidingSlope;
use chamber::watch::{Second, Watch};

/// Power of the heater in the identification, 1 = full heater.
const STEP: f64 = 0.15;
/// Rest before the passes, s: afterwards the chamber responds to present power alone.
const REST_S: u32 = 120;
/// Temperature for which the set point heads after the last pass, C; the batch ends before the chamber reaches it.
const UNLOAD_C: f64 = 40.0;
/// Time in a window after which the slope over a minute no longer includes the approach, s.
const SETTLES_S: u32 = 150;
/// Seconds for which the record goes on after the last pass, so that it covers the last event.
const AFTER_S: u32 = 3;

/// Readings of a second, C.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Control thermometer, at the controller; `None` without a valid reading.
    pub control_c: Option<f64>,
    /// Reference thermometer, beside the parts; `None` without a valid reading.
    pub reference_c: Option<f64>,
    /// Temperature of the room, C.
    pub ambient_c: f64,
    /// Numbers of live sockets that have yet to switch.
    pub waiting: Waiting,
}

/// Identified response of the chamber, and its surroundings.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    chamber: Identified,
    /// Temperature of the room, C.
    ambient_c: f64,
}

/// Present work of the chamber.
#[derive(Debug)]
pub enum Work {
    /// Identification of the chamber, with a step of the heater.
    Identification(Box<Identification>),
    /// Search for the temperature of the room around a chamber whose response the plant states.
    Room(Box<RoomSearch>),
    /// Rest with the fan only, for the remaining seconds.
    Rest(Known, u32),
    /// Passes through the windows.
    Passes(Box<Passes>),
    /// The experiment without parts, after its identification.
    Trial(Box<Trial>),
}

impl Work {
    /// Starts with an identification, unless the response of the chamber is known: from an earlier batch, whose heat it may
    /// still give off, so that it rests; or from the plant, which does not know the room. An experiment always identifies.
    pub fn new(device: &Device, is_experiment: bool, ambient_c: f64, operate_c: f64) -> Self {
        let lesson = device.lesson.as_deref().filter(|_| !is_experiment);
        let stated = device.stated.filter(|_| !is_experiment);
        match (lesson, stated) {
            (Some(lesson), _) => {
                let chamber = lesson.chamber;
                Self::Rest(Known { chamber, ambient_c }, REST_S)
            }
            (None, Some(stated)) => Self::Room(Box::new(RoomSearch::new(&stated.identified()))),
            (None, None) => {
                let run = Identification::new(STEP, ambient_c, operate_c);
                Self::Identification(Box::new(run))
            }
        }
    }

    /// Performs one second and returns the command for heater and vent; `None` when all passes or the experiment are
    /// over.
    ///
    /// # Errors
    /// Fails with the trouble of the chamber; the caller switches the heater off.
    pub fn step(
        &mut self,
        device: &Device,
        experiment: Option<Experiment>,
        seen: &Seen,
        (record, parts): (&Record, &dyn Fn() -> Vec<Shown>),
    ) -> Result<Option<Command>, Finding> {
        let control_c = seen
            .control_c
            .ok_or(Finding::Heat(HeatTrouble::ThermometerBroken))?;
        match self {
            Self::Identification(run) => match run.step(control_c) {
                Ok(Step::Go(command)) => Ok(Some(command)),
                Ok(Step::Done(found)) => {
                    let both = [found, run.doubt(&found)];
                    let ambient_c = run.ambient_c();
                    let trial = |what| Trial::new(device, what, both, ambient_c);
                    *self = match experiment {
                        Some(what) => Self::Trial(Box::new(trial(what))),
                        None => Self::Rest(
                            Known {
                                chamber: found,
                                ambient_c,
                            },
                            REST_S,
                        ),
                    };
                    Ok(Some(Command::OFF))
                }
                Err(_) => Err(Finding::Heat(HeatTrouble::NotIdentified)),
            },
            Self::Room(search) => match search.step(control_c) {
                room::Step::Go(command) => Ok(Some(command)),
                room::Step::Done { room_c, vented } => {
                    let known = Known {
                        chamber: search.chamber(),
                        ambient_c: room_c,
                    };
                    *self = Self::Rest(known, if vented { REST_S } else { 0 });
                    Ok(Some(Command::OFF))
                }
            },
            Self::Rest(known, 0) => {
                let passes = Passes::new(device, known, control_c);
                *self = Self::Passes(Box::new(passes));
                Ok(Some(Command::OFF))
            }
            Self::Rest(_, left) => {
                *left -= 1;
                Ok(Some(Command::OFF))
            }
            Self::Passes(passes) => passes.step(device, seen, control_c, record, parts),
            Self::Trial(trial) => trial.step(seen, control_c),
        }
    }

    /// Returns the set point of this second, C; `None` outside of the passes.
    pub fn set_c(&self) -> Option<f64> {
        match self {
            Self::Identification(_) | Self::Room(_) | Self::Rest(..) | Self::Trial(_) => None,
            Self::Passes(passes) => Some(passes.program.set_point().value_c),
        }
    }

    /// Returns the temperature of the room, C, once response and room are known; `None` before.
    pub fn ambient_c(&self) -> Option<f64> {
        match self {
            Self::Identification(_) | Self::Room(_) => None,
            Self::Rest(known, _) => Some(known.ambient_c),
            Self::Passes(passes) => Some(passes.ambient_c),
            Self::Trial(trial) => Some(trial.ambient_c()),
        }
    }

    /// Returns when the present pass began, s of the record; `None` before and in the first one.
    pub fn later_pass_s(&self) -> Option<f64> {
        match self {
            Self::Identification(_) | Self::Room(_) | Self::Rest(..) | Self::Trial(_) => None,
            Self::Passes(passes) => passes.later_pass_s,
        }
    }

    /// Returns the identified response of the chamber; `None` until it is known.
    pub fn chamber(&self) -> Option<Identified> {
        match self {
            Self::Identification(_) => None,
            Self::Room(search) => Some(search.chamber()),
            Self::Rest(known, _) => Some(known.chamber),
            Self::Passes(passes) => Some(passes.chamber),
            Self::Trial(trial) => Some(trial.chamber()),
        }
    }
}

/// Passes through the windows.
#[derive(Debug)]
pub struct Passes {
    chamber: Identified,
    ambient_c: f64,
    program: Program,
    controller: Controller,
    watch: Watch,
    slope: SlidingSlope,
    /// Number of passes.
    passes: usize,
    /// When the present pass began, s of the record; `None` in the first one.
    later_pass_s: Option<f64>,
    /// Seconds in the present phase.
    stayed_s: u32,
    lag_s: f64,
    expected: [Window; 2],
    /// Number of slow repeats so far.
    repeated: u32,
}

impl Passes {
    fn new(device: &Device, known: &Known, control_c: f64) -> Self {
        let Known {
            chamber: found,
            ambient_c,
        } = known;
        let thermostat = &device.thermostat;
        let expected = thermostat
            .windows(&device.recipe.limits)
            .unwrap_or_else(|| panic!("a recipe without windows is not feasible"));
        let lesson = device.lesson.as_deref();
        let all = planned(&thermostat.strategy(), lesson, expected);
        let lag_s = lesson
            .and_then(|it| it.lag)
            .map_or(thermostat.part.lag_s, |it| it.seconds);
        Self {
            chamber: *found,
            ambient_c: *ambient_c,
            passes: all.len(),
            program: Program::new(control_c, all, lag_s, UNLOAD_C),
            controller: controller(device, found),
            watch: Watch::new(found),
            slope: SlidingSlope::default(),
            later_pass_s: None,
            stayed_s: 0,
            lag_s,
            expected,
            repeated: 0,
        }
    }

    /// Returns the number of the present pass, from 1, and the count of passes; `None` after the last one.
    pub fn progress(&self) -> Option<(usize, usize)> {
        let present = self.program.pass() + 1;
        (present <= self.passes).then_some((present, self.passes))
    }

    /// Returns true during the rise of the last pass.
    pub fn is_last_rise(&self) -> bool {
        self.program.phase() == Phase::Rise && self.program.pass() + 1 == self.passes
    }

    fn step(
        &mut self,
        device: &Device,
        seen: &Seen,
        control_c: f64,
        record: &Record,
        parts: &dyn Fn() -> Vec<Shown>,
    ) -> Result<Option<Command>, Finding> {
        let before = (self.program.phase(), self.program.pass());
        let set = self.program.step(control_c, seen.waiting);
        let (phase, pass) = (self.program.phase(), self.program.pass());
        self.stayed_s = if phase == before.0 {
            self.stayed_s + 1
        } else {
            0
        };
        if pass > before.1 {
            self.later_pass_s = Some(record.seconds() as f64);
            let events: Vec<Events> = parts().into_iter().map(|it| it.events).collect();
            let [operate, reset] = self.shown(record, &events);
            self.program.narrow(operate, reset, self.lag_s);
        }
        if phase == Phase::Cool {
            let over = self.stayed_s >= AFTER_S;
            let goes_on = !over || self.repeats(device, record, parts);
            return Ok(goes_on.then_some(Command::OFF));
        }
        let observed = Observed {
            measured_c: control_c,
            ambient_c: self.ambient_c,
        };
        let command = self.controller.step(&set, &observed);
        let second = Second {
            control_c: seen.control_c,
            reference_c: seen.reference_c,
            ambient_c: self.ambient_c,
            set,
            command,
            gain: self.controller.learnt_gain(),
        };
        if let Some(trouble) = self.watch.step(&second).first() {
            return Err((*trouble).into());
        }
        self.check_slope(device, phase, control_c)?;
        Ok(Some(command))
    }

    /// Begins a slow repeat if a part needs one and the recipe has one left; returns true when it begins.
    fn repeats(
        &mut self,
        device: &Device,
        record: &Record,
        parts: &dyn Fn() -> Vec<Shown>,
    ) -> bool {
        let left = self.repeated < device.recipe.decision.slow_repeats;
        let pass = left.then(|| repeat::pass(device, record, &parts(), self.ambient_c));
        let Some(pass) = pass.flatten() else {
            return false;
        };
        self.program.repeat(pass, self.lag_s);
        (self.repeated, self.passes) = (self.repeated + 1, self.passes + 1);
        true
    }

    /// Checks the slope over the last minute within the windows against the limit of the recipe; fails with
    /// [`HeatTrouble::RampTooFast`].
    fn check_slope(
        &mut self,
        device: &Device,
        phase: Phase,
        control_c: f64,
    ) -> Result<(), Finding> {
        let slope = self.slope.step(control_c);
        let within = match phase {
            Phase::Rise | Phase::Fall => self.stayed_s > SETTLES_S,
            Phase::Approach | Phase::Descent | Phase::Cool => false,
        };
        let most = device.thermostat.test.most_k_per_min;
        let exceeds = within
            && slope
                .zip(most)
                .is_some_and(|(slope, most)| slope.abs() > most);
        match exceeds {
            true => Err(Finding::Heat(HeatTrouble::RampTooFast)),
            false => Ok(()),
        }
    }

    fn shown(&self, record: &Record, events: &[Events]) -> [Window; 2] {
        let [operate, reset] = self.expected;
        shown(record, events, self.lag_s, [operate, reset])
    }
}

fn controller(device: &Device, chamber: &Identified) -> Controller {
    let stated = device.stated.and_then(|it| it.settings());
    let tuned = stated.unwrap_or_else(|| Settings::simc(&chamber.first_order, 1.0));
    let law = match device.thermostat.test.control {
        Control::Pid => Law::Pid(Pid::new(tuned)),
        Control::Fuzzy => Law::Fuzzy(Increment::new(Rules::FURNACE)),
        Control::FuzzyPid => Law::FuzzyPid(FuzzyPid::new(tuned, Symmetry::Even)),
    };
    Controller::new(law, SplitRange::of(chamber)).with_feed_forward(chamber)
}
