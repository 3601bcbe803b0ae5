//! Escapement, pusher, clamp, probe lift, sorter and gripper, and the parts that they move.
//!
//! Air and outputs move cylinders; a cylinder without either goes to its rest, a bistable one
//! stays. Strokes take their own time. Parts move because something moves them: the escapement
//! lets one fall into an empty pocket, the pusher carries it to the nest, fingers that close on
//! it take it along once sort z rises, and it falls when they open. The emergency stop vents the
//! air and takes the servo's power.

use super::axis::Axis;
use super::cylinder::Cylinder;
use super::draw::Draw;
use super::fault::{Fault, Faults};
use super::magazine::{Magazine, Part};
use super::places::Places;
use super::signal::{Commands, In, Out};
use super::table::MechanismTable;
use crate::config::Bin;

/// A cylinder of the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stroke {
    Escapement,
    Pusher,
    JawLeft,
    JawRight,
    ProbeLift,
    SortZ,
    Gripper,
}

impl Stroke {
    const ALL: [Self; 7] = [
        Self::Escapement,
        Self::Pusher,
        Self::JawLeft,
        Self::JawRight,
        Self::ProbeLift,
        Self::SortZ,
        Self::Gripper,
    ];
}

/// Something that happens by itself later.
#[derive(Debug, Clone)]
enum Later {
    LiftOff,
    LetGo,
    Slip,
    Trip,
    Dark(In),
    Lit(In),
    Land(String, Box<Part>),
    Disturb(Fault),
    Calm(Fault),
}

/// A pin block up or a gripper down within this distance of the nest is in the pusher's way, mm.
const NEAR_NEST_MM: f64 = 40.0;

/// The mechanism with its parts.
#[derive(Debug, Clone)]
pub struct Mechanism {
    table: MechanismTable,
    cylinders: [Cylinder; 7],
    axis: Axis,
    bins: Vec<Bin>,
    magazine: Magazine,
    /// Where the parts are.
    pub places: Places,
    faults: Faults,
    draw: Draw,
    commands: Commands,
    disturbed: Vec<Fault>,
    dark: Vec<In>,
    later: Vec<(u64, Later)>,
    next_us: u64,
    crashes: Vec<String>,
}

impl Mechanism {
    /// Everything at rest, the axis braked at `park_mm`.
    pub fn new(table: &MechanismTable, axis: Axis, bins: Vec<Bin>, magazine: Magazine, faults: Faults, draw: Draw) -> Self {
        let means = [
            table.escapement_ms,
            table.pusher_ms,
            table.clamp_ms,
            table.clamp_ms,
            table.probe_lift_ms,
            table.sort_z_ms,
            table.gripper_ms,
        ];
        let timed = [Fault::Door, Fault::Estop, Fault::Air, Fault::StopButton];
        let at = |s: f64| (s.max(0.0) * 1e6) as u64;
        let later: Vec<(u64, Later)> = timed
            .into_iter()
            .flat_map(|f| faults.values(f).map(move |s| (at(s), Later::Disturb(f))))
            .collect();
        let mut mechanism = Self {
            table: table.clone(),
            cylinders: means.map(Cylinder::new),
            axis,
            bins,
            magazine,
            places: Places::default(),
            faults,
            draw,
            commands: Commands::default(),
            disturbed: Vec::new(),
            dark: Vec::new(),
            later,
            next_us: u64::MAX,
            crashes: Vec::new(),
        };
        mechanism.schedule();
        mechanism
    }

    /// Next instant at which something happens by itself.
    pub fn next_us(&self) -> u64 {
        self.next_us
    }

    /// Bodies that touched where they must not, in order of time.
    pub fn crashes(&self) -> &[String] {
        &self.crashes
    }

    /// The pin block is up: the probe-up chain is closed.
    pub fn probes_up(&self, now_us: u64) -> bool {
        self.at(Stroke::ProbeLift).at_far(now_us)
    }

    /// The pins of a clamped part stand on the probes.
    pub fn probes_touch(&self, now_us: u64) -> bool {
        let clamped = [Stroke::JawLeft, Stroke::JawRight].map(|j| self.at(j).at_far(now_us));
        self.probes_up(now_us) && self.places.nest.is_some() && clamped == [true, true]
    }

    /// All commands of the controller as they now stand.
    pub fn command(&mut self, commands: Commands, now_us: u64) {
        let before = std::mem::replace(&mut self.commands, commands);
        self.move_cylinders(now_us);
        self.axis.servo(commands.is_on(Out::AxisServoOn) && !self.is_disturbed(Fault::Estop), now_us);
        if commands.rises(before, Out::AxisReset) {
            self.axis.reset();
        }
        if commands.rises(before, Out::AxisDrive) {
            self.start_axis(now_us);
        }
        self.schedule();
    }

    /// Lets happen what is due at [`Mechanism::next_us`].
    pub fn process(&mut self, now_us: u64) {
        for stroke in Stroke::ALL {
            if self.at(stroke).due_us().is_some_and(|due| due <= now_us) {
                self.cylinders[stroke as usize].arrive();
                self.stroke_ended(stroke, now_us);
            }
        }
        if self.axis.due_us().is_some_and(|due| due <= now_us) {
            self.axis.arrive();
        }
        while let Some(place) = self.later.iter().position(|(due, _)| *due <= now_us) {
            let (_, what) = self.later.remove(place);
            self.happen(what, now_us);
        }
        self.schedule();
    }

    /// A signal of the mechanism; `None` where it is none of its own.
    pub fn signal(&self, signal: In, now_us: u64) -> Option<bool> {
        let rest = |s: Stroke| Some(self.at(s).at_rest(now_us));
        let far = |s: Stroke| Some(self.at(s).at_far(now_us));
        match signal {
            In::EmergencyStopOk => Some(!self.is_disturbed(Fault::Estop)),
            In::DoorClosed => Some(!self.is_disturbed(Fault::Door)),
            In::AirOk => Some(self.has_air()),
            In::EscapementHold => rest(Stroke::Escapement),
            In::PocketPresent => Some(self.places.pocket.is_some()),
            In::TrackLevel => Some(self.magazine.waiting() >= self.table.track_level_parts),
            In::PusherRetracted => rest(Stroke::Pusher),
            In::PusherExtended => far(Stroke::Pusher),
            In::NestPresent => Some(self.places.nest.is_some()),
            In::JawLeftOpen => rest(Stroke::JawLeft),
            In::JawLeftClosed => far(Stroke::JawLeft),
            In::JawRightOpen => rest(Stroke::JawRight),
            In::JawRightClosed => far(Stroke::JawRight),
            In::ProbeDown => rest(Stroke::ProbeLift),
            In::ProbeUp => far(Stroke::ProbeLift),
            In::AxisInPosition => Some(self.axis.is_in_position()),
            In::AxisBusy => Some(self.axis.is_moving()),
            In::AxisAlarm => Some(self.axis.is_alarmed()),
            In::SortZUp => rest(Stroke::SortZ),
            In::SortZDown => far(Stroke::SortZ),
            In::GripperOpen => rest(Stroke::Gripper),
            In::GripperPart => Some(self.places.gripped || self.places.carried.is_some()),
            In::ButtonStart | In::ButtonReset => Some(false),
            In::ButtonStop => Some(self.is_disturbed(Fault::StopButton)),
            In::BeamPass
            | In::BeamCoil
            | In::BeamVoltage
            | In::BeamTime
            | In::BeamContact
            | In::BeamRetest => Some(self.dark.contains(&signal)),
            _ => None,
        }
    }

    fn at(&self, stroke: Stroke) -> &Cylinder {
        &self.cylinders[stroke as usize]
    }

    fn is_disturbed(&self, fault: Fault) -> bool {
        self.disturbed.contains(&fault)
    }

    fn has_air(&self) -> bool {
        !self.is_disturbed(Fault::Air) && !self.is_disturbed(Fault::Estop)
    }

    fn schedule(&mut self) {
        let strokes = self.cylinders.iter().filter_map(Cylinder::due_us);
        let others = self.later.iter().map(|(due, _)| *due).chain(self.axis.due_us());
        self.next_us = strokes.chain(others).min().unwrap_or(u64::MAX);
    }

    fn move_cylinders(&mut self, now_us: u64) {
        let (air, on) = (self.has_air(), self.commands);
        let single = [
            (Stroke::Escapement, Out::EscapementRelease),
            (Stroke::Pusher, Out::PusherExtend),
            (Stroke::ProbeLift, Out::ProbeLift),
            (Stroke::SortZ, Out::SortZLower),
        ];
        for (stroke, out) in single {
            self.send(stroke, air && on.is_on(out), now_us);
        }
        let bistable = [
            (Stroke::JawLeft, Out::ClampClose, Out::ClampOpen),
            (Stroke::JawRight, Out::ClampClose, Out::ClampOpen),
            (Stroke::Gripper, Out::GripperClose, Out::GripperRelease),
        ];
        for (stroke, far, back) in bistable {
            match (air, on.is_on(far), on.is_on(back)) {
                (true, true, false) => self.send(stroke, true, now_us),
                (true, false, true) => self.send(stroke, false, now_us),
                (_, _, _) => {}
            }
        }
    }

    fn send(&mut self, stroke: Stroke, far: bool, now_us: u64) {
        if far == self.at(stroke).is_sent_far() {
            return;
        }
        let scatter = self.draw.normal(1.0, self.table.scatter_pct / 100.0);
        let stalls = far && self.stalls(stroke);
        self.cylinders[stroke as usize].send(far, now_us, scatter, stalls);
        self.stroke_began(stroke, far, now_us);
    }

    fn stalls(&mut self, stroke: Stroke) -> bool {
        let number = |part: &Option<Box<Part>>| part.as_ref().and_then(|p| p.number);
        let (pocket, nest) = (number(&self.places.pocket), number(&self.places.nest));
        match stroke {
            Stroke::Pusher => self.faults.strikes(Fault::JamPusher, pocket),
            Stroke::JawRight => self.faults.strikes(Fault::StuckClamp, nest),
            Stroke::ProbeLift => self.faults.strikes(Fault::StuckLift, nest),
            Stroke::Gripper => self.faults.strikes(Fault::StuckGripper, nest),
            Stroke::Escapement | Stroke::JawLeft | Stroke::SortZ => false,
        }
    }

    /// What a stroke does to the parts as it begins.
    fn stroke_began(&mut self, stroke: Stroke, far: bool, now_us: u64) {
        let share = |percent: u64, of: &Cylinder| now_us + of.stroke_us() * percent / 100;
        match (stroke, far) {
            (Stroke::Pusher, true) => {
                self.check_pusher(now_us);
                self.places.pushed = self.places.pocket.take();
            }
            (Stroke::Pusher, false) if self.places.pushed.is_some() => {
                self.places.pocket = self.places.pushed.take();
            }
            (Stroke::SortZ, true) => self.check_lowering(now_us),
            (Stroke::SortZ, false) if self.places.gripped => {
                let at = share(25, self.at(Stroke::SortZ));
                self.later.push((at, Later::LiftOff));
            }
            (Stroke::Gripper, false) => {
                let at = share(30, self.at(Stroke::Gripper));
                self.later.push((at, Later::LetGo));
            }
            (_, _) => {}
        }
    }

    /// What a stroke does to the parts as it ends.
    fn stroke_ended(&mut self, stroke: Stroke, now_us: u64) {
        if !self.at(stroke).at_far(now_us) {
            return;
        }
        match stroke {
            Stroke::Escapement => self.drop_into_pocket(now_us),
            Stroke::Pusher => self.push_into_nest(now_us),
            Stroke::Gripper => self.grip(now_us),
            Stroke::JawLeft | Stroke::JawRight | Stroke::ProbeLift | Stroke::SortZ => {}
        }
    }

    fn drop_into_pocket(&mut self, now_us: u64) {
        let free = self.places.pocket.is_none() && self.at(Stroke::Pusher).at_rest(now_us);
        if !free || self.faults.strikes(Fault::NoPart, self.magazine.next_number()) {
            return;
        }
        self.places.pocket = self.magazine.take(now_us, &mut self.faults).map(Box::new);
    }

    fn push_into_nest(&mut self, now_us: u64) {
        let Some(part) = self.places.pushed.take() else {
            return;
        };
        if self.places.nest.is_some() {
            self.crash(now_us, "a part was pushed into an occupied nest");
            self.places.finish(&part);
        } else {
            self.places.enter_nest(part, now_us);
        }
    }

    fn grip(&mut self, now_us: u64) {
        let over = !self.axis.is_moving() && self.axis.x_mm(now_us).abs() < self.table.axis_window_mm;
        let empty = self.places.carried.is_none();
        if over && empty && self.at(Stroke::SortZ).at_far(now_us) && self.places.nest.is_some() {
            self.places.gripped = true;
        }
    }

    fn start_axis(&mut self, now_us: u64) {
        let bits = [Out::AxisPoint0, Out::AxisPoint1, Out::AxisPoint2];
        let point = (0..3).filter(|&i| self.commands.is_on(bits[i])).map(|i| 1 << i).sum();
        if !self.axis.go(point, now_us) {
            return;
        }
        if !self.at(Stroke::SortZ).at_rest(now_us) {
            self.crash(now_us, "the sort axis moved while sort z was not up");
        }
        let number = self.places.carried.as_ref().and_then(|p| p.number);
        let whole = self.axis.due_us().map_or(0, |due| due - now_us);
        if self.faults.strikes(Fault::Fall, number) {
            self.later.push((now_us + whole / 3, Later::Slip));
        }
        if self.faults.strikes(Fault::AxisAlarm, number) {
            self.later.push((now_us + whole / 2, Later::Trip));
        }
    }

    fn happen(&mut self, what: Later, now_us: u64) {
        match what {
            Later::LiftOff => self.lift_off(now_us),
            Later::LetGo => self.let_go(now_us),
            Later::Slip => self.lose(),
            Later::Trip => self.axis.trip(now_us),
            Later::Dark(beam) => self.dark.push(beam),
            Later::Lit(beam) => self.dark.retain(|&b| b != beam),
            Later::Land(bin, mut part) => {
                part.landed_in = Some(bin);
                self.places.finish(&part);
            }
            Later::Disturb(fault) => {
                self.disturbed.push(fault);
                let hold = (self.table.fault_hold_ms * 1000.0) as u64;
                self.later.push((now_us + hold, Later::Calm(fault)));
                self.disturbance_changed(now_us);
            }
            Later::Calm(fault) => {
                self.disturbed.retain(|&f| f != fault);
                self.disturbance_changed(now_us);
            }
        }
    }

    fn disturbance_changed(&mut self, now_us: u64) {
        self.move_cylinders(now_us);
        let power = self.commands.is_on(Out::AxisServoOn) && !self.is_disturbed(Fault::Estop);
        self.axis.servo(power, now_us);
    }

    fn lift_off(&mut self, now_us: u64) {
        if !self.places.gripped {
            return;
        }
        if ![Stroke::JawLeft, Stroke::JawRight].iter().all(|&j| self.at(j).at_rest(now_us)) {
            self.crash(now_us, "a part was torn out of jaws that were not open");
        }
        self.places.gripped = false;
        self.places.carried = self.places.nest.take();
    }

    /// The fingers have opened far enough to let a part go.
    fn let_go(&mut self, now_us: u64) {
        self.places.gripped = false;
        let x = self.axis.x_mm(now_us);
        let near = |at: f64| (x - at).abs() <= self.table.axis_window_mm;
        let bin = self.bins.iter().find(|b| near(b.x_mm) && !self.axis.is_moving());
        let (name, beam) = match bin {
            Some(bin) => (bin.name.clone(), In::from_name(&bin.beam)),
            None if near(0.0) && self.at(Stroke::SortZ).at_far(now_us) => {
                return self.put_back(now_us);
            }
            None => return self.lose(),
        };
        if let Some(part) = self.places.carried.take() {
            self.fall(part, name, beam, now_us);
        }
    }

    fn fall(&mut self, part: Box<Part>, bin: String, beam: Option<In>, now_us: u64) {
        let us = |ms: f64| (ms * 1000.0) as u64;
        let seen = !self.faults.strikes(Fault::BeamBlind, part.number);
        let bodies = if part.double { 2 } else { 1 };
        let mut dark = now_us + us(self.draw.between(self.table.fall_ms));
        self.later.push((dark, Later::Land(bin, part)));
        for _ in 0..bodies {
            let lit = dark + us(self.draw.between(self.table.beam_dark_ms));
            if let Some(beam) = beam.filter(|_| seen) {
                self.later.push((dark, Later::Dark(beam)));
                self.later.push((lit, Later::Lit(beam)));
            }
            dark = lit + us(25.0);
        }
    }

    /// A carried part that is set down in the nest.
    fn put_back(&mut self, now_us: u64) {
        if let Some(part) = self.places.carried.take() {
            match self.places.nest.is_some() {
                true => {
                    self.crash(now_us, "a part was set down on another one");
                    self.places.finish(&part);
                }
                false => self.places.enter_nest(part, now_us),
            }
        }
    }

    /// A carried part falls on the floor.
    fn lose(&mut self) {
        if let Some(part) = self.places.carried.take() {
            self.places.finish(&part);
        }
    }

    fn check_pusher(&mut self, now_us: u64) {
        if !self.at(Stroke::ProbeLift).at_rest(now_us) {
            self.crash(now_us, "the pusher extended against raised probes");
        }
        let near = self.axis.x_mm(now_us).abs() < NEAR_NEST_MM;
        if near && !self.at(Stroke::SortZ).at_rest(now_us) {
            self.crash(now_us, "the pusher extended against a lowered gripper");
        }
    }

    fn check_lowering(&mut self, now_us: u64) {
        let near = self.axis.x_mm(now_us).abs() < NEAR_NEST_MM;
        if near && !self.at(Stroke::Pusher).at_rest(now_us) {
            self.crash(now_us, "sort z came down on an extended pusher");
        }
    }

    fn crash(&mut self, now_us: u64, what: &str) {
        self.crashes.push(format!("{:.3} s: {what}", now_us as f64 * 1e-6));
    }
}
