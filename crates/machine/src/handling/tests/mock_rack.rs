//! A rack with a person, a lock and a temperature, to test batches without modules.

use crate::dut::Device;
use crate::dut::batch::BatchTrouble;
use crate::dut::mock::MockDevice;
use crate::handling::ledger::Ledger;
use crate::handling::output::Commands;
use crate::handling::serial::Serials;
use crate::instrument::act::{Job, JobDone};
use crate::rig::image::Image;
use crate::rig::point::{DigitalIn, DigitalInput, DigitalOut, DigitalOutput, Point};
use crate::rig::settings::RigSettings;
use crate::rig::wiring::Wiring;
use std::collections::BTreeSet;
use std::sync::Arc;
use texts::Message;
use units::{RigTime, Span};

const RIG: &str = include_str!("../../../../../config/rigs/thermostat/rig.toml");

/// Temperature around the chamber.
const AMBIENT_C: f64 = 23.0;
/// Time constant of the rack.
const TAU_S: f64 = 200.0;
/// Temperature that the rack reaches with heat.
const HOT_C: f64 = 120.0;

/// A rack whose inputs follow its outputs.
pub struct RackRig {
    pub wiring: Arc<Wiring>,
    pub image: Image,
    pub now: RigTime,
    pub device: Device,
    pub ledger: Ledger,
    pub serials: Serials,
    /// Outcome of the job that the last turn requested.
    pub done: Option<JobDone>,
    pub rack_c: f64,
    pub door_open: bool,
    pub lock_works: bool,
    pub cools: bool,
    pub is_thermometer_broken: bool,
    /// Reading at which the thermometer in the rack is stuck.
    pub stuck_c: Option<f64>,
    /// Temperature of the surface of the heater; `None` for that of the rack.
    pub surface_c: Option<f64>,
    pub emergency_stop: bool,
    /// Number of coming output writes that fail.
    pub failing_sets: u32,
    /// Sockets whose contact is closed.
    pub contacts: BTreeSet<u16>,
    on: BTreeSet<DigitalOutput>,
    job: Option<Job>,
}

impl RackRig {
    /// Makes a cold, empty rack with a closed door.
    pub fn cold() -> Self {
        let settings: RigSettings = toml::from_str(RIG).unwrap();
        let wiring = Arc::new(Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap());
        let output = |name| wiring.digital_output(name).unwrap();
        let device = MockDevice {
            heater: output("main_contactor"),
            fan: output("fan"),
            lasts: Span::ms(600_000),
            longest: Span::ms(3_600_000),
            air: vec![wiring.thermometer("reference_temperature").unwrap()],
            surfaces: vec![wiring.thermometer("control_temperature").unwrap()],
            void: Vec::new(),
            troubles: Vec::new(),
        };
        Self {
            image: Image::new(Arc::clone(&wiring)),
            wiring,
            now: RigTime(1_000_000),
            device: Device::Mock(Box::new(device)),
            ledger: Ledger::default(),
            serials: Serials::default(),
            done: None,
            rack_c: AMBIENT_C,
            door_open: false,
            lock_works: true,
            cools: true,
            is_thermometer_broken: false,
            stuck_c: None,
            surface_c: None,
            emergency_stop: false,
            failing_sets: 0,
            contacts: BTreeSet::new(),
            on: BTreeSet::new(),
            job: None,
        }
    }

    fn mock(&mut self) -> &mut MockDevice {
        match &mut self.device {
            Device::Mock(mock) => mock,
            Device::EmRelay(_) | Device::Resistor(_) | Device::Ssr(_) | Device::Thermostat(_) => {
                panic!("no mock")
            }
        }
    }

    /// Makes the parts of these sockets impossible to judge.
    pub fn void(&mut self, sockets: &[u16]) {
        self.mock().void = sockets.to_vec();
    }

    /// Lets each test report a trouble at its end.
    pub fn meets(&mut self, trouble: BatchTrouble) {
        self.mock().troubles = vec![trouble];
    }

    /// Sets the longest time of a test.
    pub fn longest(&mut self, longest: Span) {
        self.mock().longest = longest;
    }

    pub fn heater(&self) -> DigitalOutput {
        self.wiring.digital_output("main_contactor").unwrap()
    }

    pub fn fan(&self) -> DigitalOutput {
        self.wiring.digital_output("fan").unwrap()
    }

    pub fn is_on(&self, output: impl Into<DigitalOutput>) -> bool {
        self.on.contains(&output.into())
    }

    pub fn is_unlocked(&self) -> bool {
        self.is_on(DigitalOut::DoorLockRelease)
    }

    pub fn is_locked(&self) -> bool {
        !self.door_open && !self.is_unlocked() && self.lock_works
    }

    /// Opens the door, unless it is locked.
    pub fn open(&mut self) -> Result<(), ()> {
        if self.is_locked() {
            return Err(());
        }
        self.door_open = true;
        Ok(())
    }

    /// Switches every output off and drops the job.
    pub fn everything_off(&mut self) {
        self.on.clear();
        (self.job, self.done) = (None, None);
    }

    /// Lets time pass, finishes the job and scans the inputs.
    pub fn pass(&mut self, span: Span) {
        self.now = self.now + span;
        let goal = match self.is_on(self.heater()) {
            true => HOT_C,
            false if self.cools => AMBIENT_C,
            false => self.rack_c,
        };
        self.rack_c += (goal - self.rack_c) * span.as_seconds() / TAU_S;
        self.scan();
        if let Some(job) = self.job.take() {
            self.finish(job);
        }
    }

    fn finish(&mut self, job: Job) {
        let mut trouble = None;
        match job {
            Job::Set(_) if self.failing_sets > 0 => {
                self.failing_sets -= 1;
                trouble = Some(Message::new("detail", "input"));
            }
            Job::Set(outputs) => outputs.into_iter().for_each(|(it, on)| self.switch(it, on)),
            Job::Read(points) => points.iter().for_each(|it| self.read(*it)),
            Job::Level(_) | Job::Restarts | Job::Query(_) | Job::Convert(..) | Job::Mask(_) => {
                panic!("no such job here")
            }
        }
        self.done = Some(JobDone::new(self.now, trouble));
    }

    fn switch(&mut self, output: DigitalOutput, on: bool) {
        match on {
            true => self.on.insert(output),
            false => self.on.remove(&output),
        };
    }

    fn read(&mut self, point: Point) {
        let rack = self.wiring.rack().unwrap().thermometer;
        let is_of = |it| point == Point::Temperature(it);
        let stuck_c = self.stuck_c.filter(|_| is_of(rack));
        let surfaces = self.device.hot_surfaces();
        let surface_c = self.surface_c.filter(|_| surfaces.into_iter().any(is_of));
        let shown_c = stuck_c.or(surface_c).unwrap_or(self.rack_c);
        let reply = match self.is_thermometer_broken {
            true => ">7FFF".to_owned(),
            false => format!(">{:04X}", (shown_c / 200.0 * 32767.0) as u16),
        };
        for (line, command) in self.wiring.reads(&[point]) {
            let decoded = command
                .decode(format!("{reply}\r").as_bytes(), false)
                .unwrap();
            self.image
                .accept(line, &command, &decoded, &reply, self.now)
                .unwrap();
        }
    }

    /// Carries out the commands of a turn.
    pub fn apply(&mut self, commands: Commands) {
        if commands.safe {
            self.everything_off();
        }
        for (output, on) in commands.outputs {
            self.switch(output.into(), on);
        }
        assert!(commands.motions.is_empty(), "nothing moves at a rack");
        if let Some(job) = commands.job {
            assert!(self.job.is_none(), "two jobs at once");
            self.job = Some(job.job);
        }
    }

    fn is_signal_on(&self, point: DigitalInput) -> bool {
        let machine = [
            (DigitalIn::EmergencyStopOk, !self.emergency_stop),
            (DigitalIn::DoorClosed, !self.door_open),
            (DigitalIn::DoorLocked, self.is_locked()),
        ];
        if let Some((_, state)) = machine.iter().find(|(it, _)| point == (*it).into()) {
            return *state;
        }
        let mut sockets = self.wiring.rack().unwrap().sockets().iter();
        let socket = sockets.find(|it| it.contact == point);
        socket.is_some_and(|it| self.contacts.contains(&it.number))
    }

    fn scan(&mut self) {
        let points = self.wiring.digital_inputs().map(|(_, point)| point);
        let on: BTreeSet<DigitalInput> = points.filter(|it| self.is_signal_on(*it)).collect();
        super::scan(&self.wiring, &mut self.image, self.now, |point| {
            on.contains(&point)
        });
    }
}
