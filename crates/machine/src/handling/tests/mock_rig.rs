//! A rig with given sensor states, to test step machines without modules.

use super::wiring;
use crate::dut::em_relay::points::{self, AnalogIn, Counter, Points};
use crate::guard::{Actuator, PartSize};
use crate::handling::ledger::Ledger;
use crate::handling::mechanism::Mechanism;
use crate::handling::moves::{Move, Strokes};
use crate::handling::output::{Commands, PartEvents};
use crate::handling::serial::Serials;
use crate::handling::trouble::Trouble;
use crate::handling::turn::Turn;
use crate::rig::image::Image;
use crate::rig::point::{AnalogInput, DigitalIn, DigitalInput, GatedCounter, Point};
use crate::rig::stroke::ActuatorKey;
use crate::rig::wiring::{ModuleId, Wiring};
use crate::station::trouble::Alarm;
use dcon::Command;
use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use units::{RigTime, Span};

/// Longest time of a stroke of any actuator in these tests.
pub const TIMEOUT: Span = Span::ms(900);

/// Sensors that are on with every actuator at rest, no part, and safety intact.
const AT_REST: [DigitalIn; 11] = [
    DigitalIn::EmergencyStopOk,
    DigitalIn::DoorClosed,
    DigitalIn::AirOk,
    DigitalIn::EscapementHold,
    DigitalIn::PusherRetracted,
    DigitalIn::JawLeftOpen,
    DigitalIn::JawRightOpen,
    DigitalIn::ProbeDown,
    DigitalIn::AxisInPosition,
    DigitalIn::SortZUp,
    DigitalIn::GripperOpen,
];

/// Commands and events of a turn.
#[derive(Debug, Default)]
pub struct Output {
    pub rig: Commands,
    pub parts: PartEvents,
    pub trouble: Vec<Trouble>,
}

impl Output {
    /// Returns the codes of the resulting alarms.
    pub fn alarms(&self) -> Vec<String> {
        let alarms = self.trouble.iter().cloned().map(Alarm::from);
        alarms.map(|alarm| alarm.code.name()).collect()
    }
}

/// A rig with given sensor states, and the inputs of its next turn.
pub struct MockRig {
    pub wiring: Arc<Wiring>,
    pub image: Image,
    pub now: RigTime,
    pub mechanism: Mechanism,
    pub ledger: Ledger,
    pub output: Output,
    pub reference_serials: VecDeque<String>,
    pub serials: Serials,
    pub recorded: u64,
    pub points: Points,
    on: BTreeSet<DigitalInput>,
}

impl MockRig {
    /// Makes a rig at rest whose sensors are unread.
    pub fn unread() -> Self {
        let wiring = wiring();
        let points = Points::resolve(&wiring).unwrap();
        let at_rest = AT_REST.into_iter().map(DigitalInput::from);
        let nc_closed = points.input(points::DigitalIn::NcClosed);
        Self {
            on: at_rest.chain([nc_closed]).collect(),
            points,
            image: Image::new(Arc::clone(&wiring)),
            now: RigTime(1_000_000),
            mechanism: mechanism(&wiring),
            wiring,
            ledger: Ledger::default(),
            output: Output::default(),
            reference_serials: VecDeque::new(),
            serials: Serials::default(),
            recorded: 0,
        }
    }

    /// Makes a rig at rest with all sensors read.
    pub fn at_rest() -> Self {
        let mut mock = Self::unread();
        mock.scan();
        mock
    }

    /// Changes a sensor without reading it.
    pub fn set(&mut self, point: impl Into<DigitalInput>, state: bool) {
        if state {
            self.on.insert(point.into());
        } else {
            self.on.remove(&point.into());
        }
    }

    /// Changes an input of the interface board.
    pub fn set_board(&mut self, point: points::DigitalIn, state: bool) {
        self.set(self.points.input(point), state);
    }

    /// Returns the state of a sensor, read or not.
    pub fn is_on(&self, point: impl Into<DigitalInput>) -> bool {
        self.on.contains(&point.into())
    }

    /// Reads every digital module.
    pub fn scan(&mut self) {
        super::scan(&self.wiring, &mut self.image, self.now, |point| {
            self.on.contains(&point)
        });
    }

    /// Lets time pass and reads everything.
    pub fn after(&mut self, ms: u64) {
        self.now = self.now + Span::ms(ms);
        self.scan();
    }

    /// Feeds the raw reply of a module to a command into the image.
    pub fn answer(&mut self, command: Command, module: ModuleId, reply: &str) {
        let decoded = command
            .decode(format!("{reply}\r").as_bytes(), false)
            .unwrap();
        let line = self.wiring.module(module).line;
        self.image
            .accept(line, &command, &decoded, reply, self.now)
            .unwrap();
    }

    /// Feeds the count of a chute's beam into the image.
    pub fn beam(&mut self, point: DigitalInput, count: u16) {
        let command = self.wiring.read_events(point);
        let module = self.wiring.digital_in(point).module;
        let address = self.wiring.module(module).address;
        self.answer(command, module, &format!("!{address}{count:05}"));
    }

    /// Feeds volts at one terminal of a converter into the image.
    pub fn volts(&mut self, point: AnalogIn, volts: f64) {
        self.volts_at(self.points.analog(point), volts);
    }

    /// Feeds volts for a point that a job names.
    pub fn volts_at(&mut self, point: AnalogInput, volts: f64) {
        let steps = (volts / 10.0 * 32768.0).round() as i16;
        let module = self.wiring.analog_in(point).module;
        self.reads(Point::Analog(point), module, &format!(">{steps:04X}"));
    }

    /// Feeds the count of a gate counter into the image.
    pub fn gate(&mut self, counter: Counter, count: u32) {
        self.count(self.points.counter(counter), count);
    }

    /// Feeds the count of a point that a job names.
    pub fn count(&mut self, counter: GatedCounter, count: u32) {
        let module = self.wiring.counter(counter).module;
        self.reads(Point::Count(counter), module, &format!(">{count:08X}"));
    }

    /// Feeds the temperature of the track into the image.
    pub fn track(&mut self, celsius: f64) {
        let track = self.points.track;
        let module = self.wiring.temperature(track).module;
        self.reads(
            Point::Temperature(track),
            module,
            &format!(">{celsius:+07.2}"),
        );
    }

    fn reads(&mut self, point: Point, module: ModuleId, reply: &str) {
        let command = self.wiring.reads(&[point])[0].1;
        self.answer(command, module, reply);
    }

    /// Makes the sensors show the end of a motion.
    pub fn show_end(&mut self, movement: Move) {
        for (point, state) in opposite(movement).iter().chain(movement.arrival()) {
            self.set(*point, *state);
        }
    }

    /// Drives a motion and shows its arrival 100 ms later.
    pub fn carried_out(&mut self, movement: Move) {
        self.mechanism.driven(movement, self.now, &self.image);
        self.show_end(movement);
        self.after(100);
        let found = self.mechanism.update(self.now, &self.image);
        assert!(found.trouble.is_empty(), "{found:?}");
    }

    /// Makes a turn without commands.
    pub fn turn(&mut self) -> Turn<'_> {
        self.output = Output::default();
        Turn {
            now: self.now,
            image: &self.image,
            mechanism: &self.mechanism,
            ledger: &mut self.ledger,
            rig: &mut self.output.rig,
            parts: &mut self.output.parts,
            trouble: &mut self.output.trouble,
            reference_serials: &mut self.reference_serials,
            serials: &mut self.serials,
            recorded: self.recorded,
            resting: false,
        }
    }

    /// Returns the codes of the last turn's alarms.
    pub fn alarms(&self) -> Vec<String> {
        self.output.alarms()
    }
}

/// Returns the sensors of the other end, which a motion leaves.
fn opposite(movement: Move) -> &'static [(DigitalIn, bool)] {
    match movement {
        Move::ClampClose => &[
            (DigitalIn::JawLeftOpen, false),
            (DigitalIn::JawRightOpen, false),
        ],
        Move::ClampOpen => &[
            (DigitalIn::JawLeftClosed, false),
            (DigitalIn::JawRightClosed, false),
        ],
        Move::GripperOpen => &[(DigitalIn::GripperPart, false)],
        Move::EscapementRelease
        | Move::EscapementHold
        | Move::PusherExtend
        | Move::PusherRetract
        | Move::ProbesUp
        | Move::ProbesDown
        | Move::AxisTo(_)
        | Move::SortDown
        | Move::SortUp
        | Move::GripperClose => &[],
    }
}

/// Lengths of the strokes in the order of the actuators; the axis has a point table instead.
pub const LENGTH_MM: [f64; 8] = [12.0, 60.0, 8.0, 8.0, 12.0, 0.0, 40.0, 6.0];

/// Distance from an end at which a sensor of the pusher goes off, mm.
pub const SENSOR_OFF_MM: f64 = 3.0;

/// Makes a mechanism without motions.
pub fn mechanism(wiring: &Wiring) -> Mechanism {
    assert_eq!(Actuator::ALL.len(), LENGTH_MM.len());
    let strokes = Strokes {
        length_mm: LENGTH_MM,
        sensor_off_mm: [0.0, SENSOR_OFF_MM, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        probes_beside_pusher: true,
        axis_mm: wiring
            .axis()
            .stations()
            .map(|at| (at, wiring.axis().point(at).x_mm))
            .collect(),
    };
    let part = PartSize {
        body_mm: [22.5, 16.5, 16.5],
        pin_length_mm: 3.5,
    };
    Mechanism::new(strokes, [TIMEOUT; ActuatorKey::COUNT], part)
}
