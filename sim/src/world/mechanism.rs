//! Escapement, pusher, jaws, probe lift, sorter and gripper, and the parts that they move.
//!
//! Air and outputs move the cylinders; without air or without its output a cylinder returns to its rest end, and a
//! bistable one keeps its position. Every stroke draws its own time. A part moves only by contact: the escapement drops
//! it into an empty pocket, the pusher carries it to the nest, closed fingers lift it as sort z rises, and open fingers
//! drop it. The emergency stop vents the air and cuts the power of the servo.

mod parts;
mod posture;
mod sensors;

use super::axis::Axis;
use super::bodies::Bodies;
use super::cylinder::Cylinder;
use super::draw::Draw;
use super::fault::{Fault, WorldFaults};
use super::magazine::{Magazine, Part};
use super::places::Places;
use super::signal::{Commands, In, Out};
use super::table::MechanismTable;
use crate::config::{Bin, CodeReader};
use crate::truth::{BodyTruth, Place};
use posture::CrashWatch;
use std::collections::VecDeque;

/// Identifies a cylinder of the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CylinderId {
    Escapement,
    Pusher,
    JawLeft,
    JawRight,
    ProbeLift,
    SortZ,
    Gripper,
}

impl CylinderId {
    const ALL: [Self; 7] = [
        Self::Escapement,
        Self::Pusher,
        Self::JawLeft,
        Self::JawRight,
        Self::ProbeLift,
        Self::SortZ,
        Self::Gripper,
    ];

    /// Returns the name in `config/scene.toml`.
    const fn name(self) -> &'static str {
        match self {
            Self::Escapement => "escapement",
            Self::Pusher => "pusher",
            Self::JawLeft => "jaw_left",
            Self::JawRight => "jaw_right",
            Self::ProbeLift => "probe_lift",
            Self::SortZ => "sort_z",
            Self::Gripper => "gripper",
        }
    }
}

/// Event that the mechanism has scheduled.
#[derive(Debug, Clone)]
enum Scheduled {
    LiftOff,
    LetGo,
    Slip,
    TakenOut,
    Trip,
    Dark(In),
    Lit(In),
    Land(String, Box<Part>),
    ReadCode(String),
    Strike(Fault),
    End(Fault),
}

/// Number of motion starts that the mechanism keeps: a quarter of an hour of production.
const MOTION_STARTS_KEPT: usize = 8_192;

/// The mechanism with its parts.
#[derive(Debug, Clone)]
pub struct Mechanism {
    table: MechanismTable,
    cylinders: [Cylinder; 7],
    axis: Axis,
    bins: Vec<Bin>,
    lookout: CrashWatch,
    magazine: Magazine,
    code_reader: Option<CodeReader>,
    /// Texts that the code reader has sent.
    codes: Vec<String>,
    /// Parts by their place.
    pub places: Places,
    faults: WorldFaults,
    draw: Draw,
    commands: Commands,
    disturbed: Vec<Fault>,
    dark: Vec<In>,
    scheduled: Vec<(u64, Scheduled)>,
    next_us: u64,
    crashes: Vec<String>,
    driven: VecDeque<(u64, &'static str)>,
}

impl Mechanism {
    /// Creates the mechanism at rest, with the axis braked at `park_mm`.
    pub fn new(
        table: &MechanismTable,
        axis: Axis,
        (bins, bodies): (Vec<Bin>, Bodies),
        (magazine, code_reader): (Magazine, Option<CodeReader>),
        faults: WorldFaults,
        draw: Draw,
    ) -> Self {
        let means = [
            table.escapement_ms,
            table.pusher_ms,
            table.clamp_ms,
            table.clamp_ms,
            table.probe_lift_ms,
            table.sort_z_ms,
            table.gripper_ms,
        ];
        let at = |s: f64| (s.max(0.0) * 1e6) as u64;
        let scheduled: Vec<(u64, Scheduled)> = faults
            .timed()
            .map(|(fault, s)| (at(s), Scheduled::Strike(fault)))
            .collect();
        let mut mechanism = Self {
            table: table.clone(),
            cylinders: means.map(Cylinder::new),
            axis,
            bins,
            lookout: CrashWatch::new(bodies),
            magazine,
            code_reader,
            codes: Vec::new(),
            places: Places::default(),
            faults,
            draw,
            commands: Commands::default(),
            disturbed: Vec::new(),
            dark: Vec::new(),
            scheduled,
            next_us: u64::MAX,
            crashes: Vec::new(),
            driven: VecDeque::with_capacity(MOTION_STARTS_KEPT),
        };
        mechanism.schedule();
        mechanism
    }

    /// Returns the instant of the mechanism's next own event.
    pub fn next_us(&self) -> u64 {
        self.next_us
    }

    /// Returns a description of each crash, in order of time.
    pub fn crashes(&self) -> &[String] {
        &self.crashes
    }

    /// Replaces the parts in the magazine by those that `load` returns; `load` gets the remaining faults.
    pub fn refill<E>(
        &mut self,
        load: impl FnOnce(&WorldFaults) -> Result<Magazine, E>,
    ) -> Result<(), E> {
        self.magazine = load(&self.faults)?.continuing(&self.magazine);
        Ok(())
    }

    /// Returns every body that has left the magazine, in order of leaving.
    pub fn bodies(&self) -> Vec<BodyTruth> {
        let falling = self.scheduled.iter().filter_map(|(_, what)| match what {
            Scheduled::Land(_, part) => Some(part.bodies()),
            _ => None,
        });
        let mut all: Vec<BodyTruth> = self.places.bodies().chain(falling.flatten()).collect();
        all.sort_by_key(|body| body.path.first().map(|(at, _)| *at));
        all
    }

    /// Returns the start (microseconds) and actuator of the last [`MOTION_STARTS_KEPT`] motions that an output caused.
    pub fn motion_starts(&self) -> impl Iterator<Item = (u64, &'static str)> + '_ {
        self.driven.iter().copied()
    }

    /// Removes and returns the texts that the code reader has sent so far.
    pub fn take_codes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.codes)
    }

    fn note_driven(&mut self, now_us: u64, what: &'static str) {
        if self.driven.len() == MOTION_STARTS_KEPT {
            self.driven.pop_front();
        }
        self.driven.push_back((now_us, what));
    }

    /// Cancels the faults that have not struck yet; parameters of the whole rig stay.
    pub fn cancel_faults(&mut self) {
        self.faults.clear();
        self.scheduled
            .retain(|(_, what)| !matches!(what, Scheduled::Strike(_)));
        self.schedule();
    }

    /// Checks whether the pin block is up, so that the probe-up chain is closed.
    pub fn probes_up(&self, now_us: u64) -> bool {
        self.at(CylinderId::ProbeLift).at_far(now_us)
    }

    /// Checks whether the pin block is up and not about to go down.
    pub fn probes_stay(&self, now_us: u64) -> bool {
        self.probes_up(now_us) && self.at(CylinderId::ProbeLift).is_commanded_far()
    }

    /// Checks whether the probes touch the pins of a clamped part.
    pub fn probes_touch(&self, now_us: u64) -> bool {
        let clamped =
            [CylinderId::JawLeft, CylinderId::JawRight].map(|j| self.at(j).at_far(now_us));
        self.probes_up(now_us) && self.places.nest.is_some() && clamped == [true, true]
    }

    /// Applies all commands of the controller.
    pub fn command(&mut self, commands: Commands, now_us: u64) {
        self.watch(now_us);
        let before = std::mem::replace(&mut self.commands, commands);
        self.move_cylinders(now_us);
        self.axis.servo(
            commands.is_on(Out::AxisServoOn) && !self.is_disturbed(Fault::Estop),
            now_us,
        );
        if commands.rises(before, Out::AxisReset) {
            self.axis.reset();
        }
        if commands.rises(before, Out::AxisDrive) {
            self.start_axis(now_us);
        }
        self.schedule();
    }

    /// Carries out all events that are due at `now_us`.
    pub fn process(&mut self, now_us: u64) {
        self.watch(now_us);
        for stroke in CylinderId::ALL {
            if self.at(stroke).due_us().is_some_and(|due| due <= now_us) {
                self.cylinders[stroke as usize].arrive();
                self.stroke_ended(stroke, now_us);
            }
        }
        if self.axis.due_us().is_some_and(|due| due <= now_us) {
            self.axis.arrive();
        }
        while let Some(place) = self.scheduled.iter().position(|(due, _)| *due <= now_us) {
            let (_, what) = self.scheduled.remove(place);
            self.run_event(what, now_us);
        }
        self.schedule();
    }

    /// Lets a timed fault strike now.
    pub fn inject(&mut self, fault: Fault, now_us: u64) {
        self.scheduled.push((now_us, Scheduled::Strike(fault)));
        self.schedule();
    }

    /// Adds a fault that strikes at a part (number from 1).
    pub fn add_part_fault(&mut self, fault: Fault, part: f64) {
        self.faults.add(fault, part);
    }

    fn at(&self, stroke: CylinderId) -> &Cylinder {
        &self.cylinders[stroke as usize]
    }

    /// Checks whether a timed fault lasts at present.
    pub fn is_disturbed(&self, fault: Fault) -> bool {
        self.disturbed.contains(&fault)
    }

    fn has_air(&self) -> bool {
        !self.is_disturbed(Fault::Air) && !self.is_disturbed(Fault::Estop)
    }

    /// Checks whether every valve is off or the air is gone: then only springs move cylinders.
    fn only_springs_move(&self) -> bool {
        let valves = [
            Out::EscapementRelease,
            Out::PusherExtend,
            Out::ClampClose,
            Out::ClampOpen,
            Out::ProbeLift,
            Out::SortZLower,
            Out::GripperClose,
            Out::GripperRelease,
        ];
        !self.has_air() || !valves.iter().any(|valve| self.commands.is_on(*valve))
    }

    fn schedule(&mut self) {
        let strokes = self.cylinders.iter().filter_map(Cylinder::due_us);
        let others = self
            .scheduled
            .iter()
            .map(|(due, _)| *due)
            .chain(self.axis.due_us());
        self.next_us = strokes.chain(others).min().unwrap_or(u64::MAX);
    }

    fn move_cylinders(&mut self, now_us: u64) {
        let (air, on) = (self.has_air(), self.commands);
        let single = [
            (CylinderId::Escapement, Out::EscapementRelease),
            (CylinderId::Pusher, Out::PusherExtend),
            (CylinderId::ProbeLift, Out::ProbeLift),
            (CylinderId::SortZ, Out::SortZLower),
        ];
        for (stroke, out) in single {
            let driven = air && on.is_on(out);
            if self.send(stroke, driven, now_us) && driven {
                self.note_driven(now_us, stroke.name());
            }
        }
        let bistable = [
            (CylinderId::JawLeft, Out::ClampClose, Out::ClampOpen),
            (CylinderId::JawRight, Out::ClampClose, Out::ClampOpen),
            (CylinderId::Gripper, Out::GripperClose, Out::GripperRelease),
        ];
        for (stroke, far, back) in bistable {
            let began = match (air, on.is_on(far), on.is_on(back)) {
                (true, true, false) => self.send(stroke, true, now_us),
                (true, false, true) => self.send(stroke, false, now_us),
                (_, _, _) => false,
            };
            if began {
                self.note_driven(now_us, stroke.name());
            }
        }
    }

    /// Starts a stroke; returns false if that end was already commanded.
    fn send(&mut self, stroke: CylinderId, far: bool, now_us: u64) -> bool {
        if far == self.at(stroke).is_commanded_far() {
            return false;
        }
        let scatter = self.draw.normal(1.0, self.table.scatter_pct / 100.0);
        let stalls = far && self.stalls(stroke);
        self.cylinders[stroke as usize].send(far, now_us, scatter, stalls);
        self.stroke_began(stroke, far, now_us);
        true
    }

    fn stalls(&mut self, stroke: CylinderId) -> bool {
        let number = |part: &Option<Box<Part>>| part.as_ref().and_then(|p| p.number);
        let (pocket, nest) = (number(&self.places.pocket), number(&self.places.nest));
        match stroke {
            CylinderId::Pusher => self.faults.strikes(Fault::JamPusher, pocket),
            CylinderId::JawRight => self.faults.strikes(Fault::StuckClamp, nest),
            CylinderId::ProbeLift => self.faults.strikes(Fault::StuckLift, nest),
            CylinderId::Gripper => self.faults.strikes(Fault::StuckGripper, nest),
            CylinderId::Escapement | CylinderId::JawLeft | CylinderId::SortZ => false,
        }
    }

    fn start_axis(&mut self, now_us: u64) {
        let bits = [Out::AxisPoint0, Out::AxisPoint1, Out::AxisPoint2];
        let point = (0..3)
            .filter(|&i| self.commands.is_on(bits[i]))
            .map(|i| 1 << i)
            .sum();
        if !self.axis.go(point, now_us) {
            return;
        }
        self.note_driven(now_us, "sort_axis");
        let number = self.places.carried.as_ref().and_then(|p| p.number);
        let whole = self.axis.due_us().map_or(0, |due| due - now_us);
        if self.faults.strikes(Fault::Fall, number) {
            self.scheduled.push((now_us + whole / 3, Scheduled::Slip));
        }
        if self.faults.strikes(Fault::AxisAlarm, number) {
            self.scheduled.push((now_us + whole / 2, Scheduled::Trip));
        }
    }

    fn run_event(&mut self, what: Scheduled, now_us: u64) {
        match what {
            Scheduled::LiftOff => self.lift_off(now_us),
            Scheduled::LetGo => self.release_part(now_us),
            Scheduled::Slip | Scheduled::TakenOut => self.drop_carried(now_us),
            Scheduled::Trip => self.axis.trip(now_us),
            Scheduled::Dark(beam) => self.dark.push(beam),
            Scheduled::ReadCode(text) => self.codes.push(text),
            Scheduled::Lit(beam) => self.dark.retain(|&b| b != beam),
            Scheduled::Land(bin, mut part) => {
                part.arrive(now_us, Place::Bin(bin));
                self.places.finish(&part);
            }
            Scheduled::Strike(fault) => {
                self.disturbed.push(fault);
                let hold = (self.table.fault_hold_ms * 1000.0) as u64;
                self.scheduled.push((now_us + hold, Scheduled::End(fault)));
                self.disturbance_changed(now_us);
            }
            Scheduled::End(fault) => {
                // When the same fault strikes again, it lasts until the later of both ends.
                let first = self.disturbed.iter().position(|&other| other == fault);
                first.map(|place| self.disturbed.remove(place));
                self.disturbance_changed(now_us);
            }
        }
    }

    fn disturbance_changed(&mut self, now_us: u64) {
        self.move_cylinders(now_us);
        let power = self.commands.is_on(Out::AxisServoOn) && !self.is_disturbed(Fault::Estop);
        self.axis.servo(power, now_us);
    }

    fn crash(&mut self, now_us: u64, what: &str) {
        self.crashes
            .push(format!("{:.3} s: {what}", now_us as f64 * 1e-6));
    }
}
