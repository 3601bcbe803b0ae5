//! Runs the heated part of a batch: each second reads both thermometers, steps the chamber, sets heater and vent.

use super::super::Finding;
use super::super::device::{Device, WHOLE_V};
use super::Ended;
use super::contacts::Contact;
use super::creep::{EACH_SECOND, Pulse};
use super::drop;
use super::passes::{Seen, Work};
use super::repeat::Shown;
use crate::dut::batch::HeatTrouble;
use crate::dut::batch_shown::{AirCurve, AirSecond, BatchShown};
use crate::dut::experiment::Experiment;
use crate::instrument::act::{Act, JobDone, Read, Runner, RunnerState};
use crate::rig::image::Image;
use crate::rig::point::{Point, Thermometer};
use crate::rig::rack::Socket;
use crate::rig::sample::{Quality, Sample};
use chamber::control::split_range::Command;
use chamber::lag::Record;
use chamber::program::{TRAVEL_K_PER_MIN, Waiting};
use chamber::watch::heater::Heater;
use chamber::watch::sensors::Sensors;
use chamber::watch::slope::SlidingSlope;
use chamber::watch::unpowered::Unpowered;
use units::{RigTime, Span, Volt};

const SECOND: Span = Span::ms(1_000);
/// Time after which the safety chain must be closed, s: the airflow switch needs it.
const CHAIN_S: usize = 15;
/// Time after which every input of the chain must have been read, s.
const READ_S: usize = 3;
/// Greatest age of an input of the safety chain, or of a reading of the surface of the heater, that counts.
const FRESH: Span = Span::ms(2_000);
/// Range of room temperatures in which a chamber may stand, C.
const ROOM_C: [f64; 2] = [5.0, 38.0];

#[derive(Debug)]
enum Doing {
    Wait,
    Read(Runner),
    Set(Runner),
    /// Reads rack and surface of the heater, which the control does not need.
    Others(Runner),
    /// Pulses through the contacts of these places.
    Pulse(Runner, Vec<usize>),
}

/// What a runner has done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Did {
    Read,
    Set,
    Others,
    Pulse,
}

/// Result of [`Seconds::step`].
pub enum Advance {
    /// The test waits for the runner in this state.
    Waiting(RunnerState),
    /// All passes are over.
    Over,
    /// The batch ends early.
    Ended(Ended),
}

/// The heated part of a batch.
#[derive(Debug)]
pub struct Seconds {
    /// Time zero of the record.
    pub origin: RigTime,
    /// Readings of the reference thermometer.
    pub record: Record,
    /// Last reading of the reference thermometer.
    pub last: Option<Sample>,
    /// Temperature of the room, C.
    pub ambient_c: f64,
    /// What the chamber does; `None` before the first reading.
    pub work: Option<Work>,
    experiment: Option<Experiment>,
    sensors: Sensors,
    unpowered: Unpowered,
    heater: Heater,
    /// Command of the last second.
    command: Command,
    /// Resistances in the last rise, by the place of the contact in the batch.
    pub pulses: Vec<(usize, Pulse)>,
    /// Place of the contact that gets the next pulse.
    next: usize,
    /// The air, as pages show it and as the history keeps it.
    curve: AirCurve,
    pub kept: AirCurve,
    /// Slope of the reference thermometer over a minute.
    slope: SlidingSlope,
    rate_k_per_min: Option<f64>,
    tick: RigTime,
    doing: Doing,
}

impl Seconds {
    /// Begins: closes the contactor while the heater is at zero.
    pub fn begin(device: &Device, experiment: Option<Experiment>, now: RigTime) -> Self {
        let points = &device.points;
        let mut acts = vec![levels(device, Command::OFF)];
        acts.push(Act::Set(vec![(points.contactor, true)]));
        Self {
            origin: now,
            record: Record::new(0.0, 0.0),
            last: None,
            ambient_c: ROOM_C[1],
            work: None,
            experiment,
            sensors: Sensors::default(),
            unpowered: Unpowered::default(),
            heater: Heater::default(),
            command: Command::OFF,
            pulses: Vec::new(),
            next: 0,
            curve: AirCurve::default(),
            kept: AirCurve::kept(),
            slope: SlidingSlope::default(),
            rate_k_per_min: None,
            tick: now,
            doing: Doing::Set(Runner::new(acts, now)),
        }
    }

    /// Advances as far as the outcome of the job allows.
    pub fn step(
        &mut self,
        device: &Device,
        contacts: &[Contact],
        now: RigTime,
        mut done: Option<&JobDone>,
        image: &Image,
    ) -> Advance {
        loop {
            let (did, state) = match &mut self.doing {
                Doing::Wait if now < self.tick => {
                    return Advance::Waiting(RunnerState::Wait(self.tick));
                }
                Doing::Wait => {
                    let points = [device.points.control, device.points.reference];
                    let read = Read::points(points.map(Point::Temperature));
                    self.doing = Doing::Read(Runner::new(vec![Act::Read(read)], now));
                    continue;
                }
                Doing::Read(runner) => (Did::Read, runner.step(now, done.take(), image)),
                Doing::Set(runner) => (Did::Set, runner.step(now, done.take(), image)),
                Doing::Others(runner) => (Did::Others, runner.step(now, done.take(), image)),
                Doing::Pulse(runner, _) => (Did::Pulse, runner.step(now, done.take(), image)),
            };
            match (state, did) {
                (RunnerState::Done, Did::Read) => match self.second(device, contacts, now, image) {
                    Ok(Some(command)) => {
                        let acts = vec![levels(device, command)];
                        self.doing = Doing::Set(Runner::new(acts, now));
                    }
                    Ok(None) => return Advance::Over,
                    Err(found) => return Advance::Ended(Ended::Found(found)),
                },
                (RunnerState::Done, Did::Set) => {
                    let others = [device.points.surface, device.points.rack].into_iter();
                    let read = |it| Act::Read(Read::points([Point::Temperature(it)]));
                    let acts = others.flatten().map(read).collect();
                    self.doing = Doing::Others(Runner::new(acts, now));
                }
                // Without these readings checks of rack and heater are missing; the batch goes on.
                (RunnerState::Done | RunnerState::Trouble(_), Did::Others) => {
                    self.doing = self.pulse(device, contacts, now);
                }
                (RunnerState::Done, Did::Pulse) => {
                    self.keep_pulses(device, now);
                    self.doing = Doing::Wait;
                }
                (RunnerState::Trouble(why), _) => return Advance::Ended(Ended::Trouble(why)),
                (waiting @ (RunnerState::Job(_) | RunnerState::Busy | RunnerState::Wait(_)), _) => {
                    return Advance::Waiting(waiting);
                }
            }
        }
    }

    /// Returns the pulses of this second: through closed contacts, in the rise of the last pass.
    fn pulse(&mut self, device: &Device, contacts: &[Contact], now: RigTime) -> Doing {
        let rises = matches!(&self.work, Some(Work::Passes(passes)) if passes.is_last_rise());
        if !rises || contacts.is_empty() {
            return Doing::Wait;
        }
        let around = (0..contacts.len()).map(|it| (self.next + it) % contacts.len());
        let closed = around.filter(|it| contacts[*it].is_live_and_closed());
        let places: Vec<usize> = closed.take(EACH_SECOND).collect();
        let Some(last) = places.last() else {
            return Doing::Wait;
        };
        self.next = last + 1;
        let sockets: Vec<Socket> = places
            .iter()
            .filter_map(|it| device.points.of_contact(contacts[*it].input()))
            .collect();
        let acts = drop::acts(&device.points, &sockets, &device.accuracy);
        Doing::Pulse(Runner::new(acts, now), places)
    }

    /// Keeps the resistances of the pulses that have just ended; drops unreadable ones.
    fn keep_pulses(&mut self, device: &Device, now: RigTime) {
        let Doing::Pulse(runner, places) = &self.doing else {
            return;
        };
        let found = drop::resistances(&device.points, &runner.readings, &device.accuracy);
        let at_s = now.since(self.origin).as_seconds();
        let pulses = found.unwrap_or_default();
        let pulses = places.iter().copied().zip(pulses.iter());
        self.pulses
            .extend(pulses.map(|(place, found)| (place, Pulse::of(at_s, found))));
    }

    /// Takes the readings of a second; returns its command, or `None` when all passes are over. On a slow line the pulses
    /// through the contacts may take longer than a second: the readings then count for each second that has passed.
    fn second(
        &mut self,
        device: &Device,
        contacts: &[Contact],
        now: RigTime,
        image: &Image,
    ) -> Result<Option<Command>, Finding> {
        let points = &device.points;
        let reference = usable(image, points.reference);
        let control_c = usable(image, points.control).map(|it| it.value);
        let reading = reference
            .clone()
            .ok_or(Finding::Heat(HeatTrouble::ThermometerBroken))?;
        if self.work.is_none() {
            self.start(device, reading.value);
        }
        self.tick = self.tick + SECOND;
        let mut passed = 1;
        while self.tick + SECOND < now {
            self.tick = self.tick + SECOND;
            self.record.push(f64::NAN);
            self.slope.step(reading.value);
            passed += 1;
        }
        self.record.push(reading.value);
        self.draw(reading.value);
        let reference_c = Some(reading.value);
        self.last = Some(reading);
        self.check_chain(device, now, image)?;
        let later_pass_s = self.work.as_ref().and_then(Work::later_pass_s);
        let seen = Seen {
            control_c,
            reference_c,
            ambient_c: self.ambient_c,
            waiting: waiting(contacts, (now, self.origin), later_pass_s),
        };
        let origin = self.origin;
        let shown = |it| part(device, it, origin);
        let parts = || contacts.iter().filter_map(shown).collect();
        self.check_sensors(&seen)?;
        let surface = points.surface.and_then(|it| usable(image, it));
        let surface = surface.filter(|it| now.since(it.origin.at) <= FRESH);
        self.check_heater(surface.as_ref(), control_c, passed)?;
        let Some(work) = &mut self.work else {
            return Ok(Some(Command::OFF));
        };
        let recorded = (&self.record, &parts as &dyn Fn() -> Vec<Shown>);
        let mut next = Some(self.command);
        for _ in 0..passed {
            next = work.step(device, self.experiment, &seen, recorded)?;
            if next.is_none() {
                break;
            }
        }
        self.ambient_c = work.ambient_c().unwrap_or(self.ambient_c);
        self.command = next.unwrap_or(Command::OFF);
        Ok(next)
    }

    /// Adds a second to both curves.
    fn draw(&mut self, reference_c: f64) {
        self.rate_k_per_min = self.slope.step(reference_c);
        let now = AirSecond {
            t_s: u32::try_from(self.record.seconds()).unwrap_or(u32::MAX) - 1,
            set_c: self.work.as_ref().and_then(Work::set_c),
            reference_c,
            rate_k_per_min: self.rate_k_per_min,
        };
        self.curve.push(&now);
        self.kept.push(&now);
    }

    /// Returns the passes, temperatures, outputs and curve that pages show.
    pub fn shown(&self) -> BatchShown {
        let passes = match &self.work {
            Some(Work::Passes(passes)) => passes.progress(),
            None
            | Some(Work::Identification(_) | Work::Room(_) | Work::Rest(..) | Work::Trial(_)) => {
                None
            }
        };
        let (pass, passes) = passes.unzip();
        let percent = |share: f64| (share * 1000.0).round() / 10.0;
        BatchShown {
            pass,
            passes,
            set_c: self.work.as_ref().and_then(Work::set_c),
            reference_c: self.last.as_ref().map(|it| it.value),
            rate_k_per_min: self.rate_k_per_min,
            heater_pct: percent(self.command.heater),
            vent_pct: percent(self.command.vent),
            curve: self.curve.clone(),
            switched: Vec::new(),
        }
    }

    /// Checks thermometers and power before the passes and in experiments; during passes [`Work`] checks more.
    fn check_sensors(&mut self, seen: &Seen) -> Result<(), Finding> {
        if matches!(self.work, Some(Work::Passes(_))) {
            return Ok(());
        }
        let readings = [seen.control_c, seen.reference_c];
        let power = self.command.heater;
        let found = self.sensors.step(readings, TRAVEL_K_PER_MIN, power);
        if let Some(trouble) = found.first() {
            return Err((*trouble).into());
        }
        let heats = seen
            .control_c
            .is_some_and(|it| self.unpowered.step(it, self.command));
        match heats {
            true => Err(Finding::Heat(HeatTrouble::HeatWithoutCommand)),
            false => Ok(()),
        }
    }

    /// Checks for the seconds that have passed that a heater with power is warmer than the air.
    fn check_heater(
        &mut self,
        surface: Option<&Sample>,
        control_c: Option<f64>,
        passed: usize,
    ) -> Result<(), Finding> {
        let surface_c = surface.map(|it| it.value);
        let power = self.command.heater;
        let mut step = |air_c| self.heater.step(air_c, surface_c, power);
        let is_open = control_c.is_some_and(|it| (0..passed).any(|_| step(it)));
        match is_open {
            true => Err(Finding::Heat(HeatTrouble::EnergyBalance)),
            false => Ok(()),
        }
    }

    fn start(&mut self, device: &Device, reference_c: f64) {
        let known = device.lesson.as_ref().map(|it| it.ambient_c);
        self.ambient_c = known.unwrap_or(reference_c.clamp(ROOM_C[0], ROOM_C[1]));
        self.origin = self.tick;
        self.record = Record::new(0.0, self.ambient_c);
        let windows = device.thermostat.windows(&device.recipe.limits);
        let operate_c = windows.map_or(reference_c, |[operate, _]| operate.low_c);
        let is_experiment = self.experiment.is_some();
        self.work = Some(Work::new(device, is_experiment, self.ambient_c, operate_c));
    }

    fn check_chain(&self, device: &Device, now: RigTime, image: &Image) -> Result<(), Finding> {
        let read = device.points.chain.map(|it| image.input(it, now, FRESH));
        broken_link(read, self.record.seconds()).map_or(Ok(()), Err)
    }
}

/// Returns what limiter, airflow and mains, read in this order, say after some seconds with the fan on; `None` for an input
/// that was not read for two seconds.
fn broken_link([limiter, airflow, mains]: [Option<bool>; 3], seconds: usize) -> Option<Finding> {
    let is_open = |it: Option<bool>| it == Some(false);
    let unread = [limiter, airflow, mains].contains(&None) && seconds > READ_S;
    let still = is_open(airflow) && seconds > CHAIN_S;
    match (is_open(limiter), is_open(mains), still, unread) {
        (true, _, _, _) => Some(Finding::Heat(HeatTrouble::LimiterTripped)),
        (false, true, _, _) => Some(Finding::Heat(HeatTrouble::MainsLost)),
        (false, false, true, _) => Some(Finding::Heat(HeatTrouble::AirflowLost)),
        (false, false, false, true) => Some(Finding::Heat(HeatTrouble::ChainNotRead)),
        (false, false, false, false) => None,
    }
}

/// Returns what the contact of a part has shown so far.
fn part(device: &Device, contact: &Contact, origin: RigTime) -> Option<Shown> {
    let socket = device.points.of_contact(contact.input())?;
    Some(Shown {
        socket: socket.number,
        events: contact.events(origin),
    })
}

fn levels(device: &Device, command: Command) -> Act {
    let points = &device.points;
    Act::Level(vec![
        (points.heater, Volt(command.heater * WHOLE_V)),
        (points.vent, Volt(command.vent * WHOLE_V)),
    ])
}

fn usable(image: &Image, point: Thermometer) -> Option<Sample> {
    let sample = image.temperature(point)?;
    (sample.quality == Quality::Good && sample.value.is_finite()).then(|| sample.clone())
}

/// Counts the sockets that have yet to switch. A contact that was open when cold does not count, nor one that a whole pass
/// has left in its state.
fn waiting(
    contacts: &[Contact],
    (now, origin): (RigTime, RigTime),
    later_pass_s: Option<f64>,
) -> Waiting {
    let live = contacts
        .iter()
        .filter(|it| it.cold() == Some(true) && !it.events(origin).is_stuck(later_pass_s));
    let (operated, all) = live.fold((0, 0), |(operated, all), it| {
        (operated + usize::from(it.is_open(now)), all + 1)
    });
    Waiting {
        operate: all - operated,
        reset: operated,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unread_link_of_the_chain_is_trouble() {
        let on = Some(true);
        assert_eq!(broken_link([on; 3], 100), None);
        for place in 0..3 {
            let mut read = [on; 3];
            read[place] = None;
            assert_eq!(
                broken_link(read, 100),
                Some(Finding::Heat(HeatTrouble::ChainNotRead))
            );
            assert_eq!(broken_link(read, 1), None);
        }
    }

    #[test]
    fn an_open_link_says_more_than_an_unread_one() {
        let read = [None, Some(true), Some(false)];
        assert_eq!(
            broken_link(read, 100),
            Some(Finding::Heat(HeatTrouble::MainsLost))
        );
    }
}
