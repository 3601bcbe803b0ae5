//! A fixture with an AC part on it, for tests: mains, line, loop and references answer with waveforms.
#![allow(clippy::unwrap_used)]

use super::bench::{profiles, scan, wiring};
use crate::dut::device::{DeviceUnderTest, Rig, TestOrder};
use crate::dut::em_relay::settings::ReferenceSet;
use crate::dut::procedure::Progress;
use crate::dut::recipe::DeviceRecipe;
use crate::dut::ssr::Device as SsrDevice;
use crate::dut::ssr::points::{Device, DigitalIn, DigitalOut, Points};
use crate::dut::{Procedure, Recipe};
use crate::instrument::act::{Job, JobDone, RunnerState};
use crate::instrument::query::{Delivered, Query, Waveform};
use crate::rig::image::Image;
use crate::rig::point::Point;
use crate::rig::wiring::Wiring;
use std::collections::BTreeSet;
use std::sync::Arc;
use texts::Message;
use units::{RigTime, Span};

mod part;
mod waves;

pub use part::{Part, good};

/// Text of the recipe of a zero-cross part.
pub const ZERO_CROSS: &str =
    include_str!("../../../../../../config/rigs/ssr/recipes/ssr-ac-240v-5a-zc.toml");
/// Text of the recipe of a part that turns on at any instant.
pub const RANDOM: &str =
    include_str!("../../../../../../config/rigs/ssr/recipes/ssr-ac-240v-5a-random.toml");
/// A recipe with changes of its text.
pub fn recipe(text: &str, changes: &[(&str, &str)]) -> Arc<Recipe> {
    let text = changes.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the recipe");
        text.replace(from, to)
    });
    Arc::new(toml::from_str(&text).unwrap())
}

/// The fixture with a part.
pub struct LineBench {
    pub part: Part,
    pub now: RigTime,
    pub rounds: usize,
    pub log: Vec<String>,
    pub device: SsrDevice,
    wiring: Arc<Wiring>,
    image: Image,
    points: Points,
    on: BTreeSet<DigitalOut>,
    level_v: f64,
    smu_v: f64,
    /// Steps of the control voltage: instant and volts.
    control: Vec<(f64, f64)>,
    scales: [f64; 4],
    record: (f64, f64, f64),
    begins_s: Option<f64>,
    falls: bool,
    train: (f64, f64, f64, f64),
    memory: Vec<Vec<f32>>,
    /// Number of records on the line so far.
    pub line_records: usize,
    /// Instant from which on the present record shows a dead line, s.
    dead_s: f64,
    /// True once the output conducts for good.
    has_stuck: bool,
    seed: u64,
}

impl LineBench {
    /// Puts a part on the fixture of a rig and prepares a recipe.
    pub fn with(part: Part, recipe: &Arc<Recipe>) -> Self {
        let wiring = wiring(super::bench::RIG, &profiles(|_, text| text.to_owned()));
        let DeviceRecipe::Ssr(ssr) = recipe.device.clone() else {
            panic!("a solid-state relay");
        };
        let rig = Rig {
            wiring: &wiring,
            reference: None,
            accuracy: &crate::dut::em_relay::tests::context().accuracy,
            reference_parts: &ReferenceSet::default(),
            certificate: None,
        };
        Self {
            device: SsrDevice::new(Arc::clone(recipe), &ssr, &rig).unwrap(),
            points: Points::resolve(&wiring, true).unwrap(),
            image: Image::new(Arc::clone(&wiring)),
            wiring,
            part,
            now: RigTime(1_000_000),
            rounds: 0,
            log: Vec::new(),
            on: BTreeSet::new(),
            level_v: 230.0,
            smu_v: 0.0,
            control: Vec::new(),
            scales: [1.0; 4],
            record: (0.0, 1.0, 0.0),
            begins_s: None,
            falls: false,
            train: (0.0, 1.0, 0.0, 0.0),
            memory: Vec::new(),
            line_records: 0,
            dead_s: f64::INFINITY,
            has_stuck: false,
            seed: 1,
        }
    }

    /// Tests the part to its end, and lets the device learn from it.
    pub fn tested(&mut self, thorough: bool) -> Procedure {
        let order = TestOrder {
            thorough,
            teaching: None,
            number: 1,
        };
        let mut test = self.device.begin(&order, self.now);
        let mut done = None;
        loop {
            match test.step(self.now, done.take().as_ref(), &self.image) {
                Progress::Judged => break,
                Progress::Running(RunnerState::Wait(until)) => self.now = until,
                Progress::Running(RunnerState::Job(job)) => done = Some(self.does(&job)),
                Progress::Running(other) => panic!("a test that waits for nothing: {other:?}"),
            }
        }
        let pass = test.verdict().name() == "pass";
        self.device.learn(&test.record(), pass);
        test
    }

    fn is_on(&self, point: DigitalOut) -> bool {
        self.on.contains(&point)
    }

    fn now_s(&self) -> f64 {
        self.now.0 as f64 / 1e6
    }

    fn does(&mut self, job: &Job) -> JobDone {
        self.now = self.now + Span::ms(2);
        match job {
            Job::Set(outputs) => {
                self.stores();
                let before = self.on.clone();
                let all = DigitalOut::ALL
                    .iter()
                    .zip(self.points.outputs(DigitalOut::ALL));
                for (point, (handle, _)) in all {
                    let state = outputs.iter().find(|it| it.0 == handle).unwrap().1;
                    match state && !self.part.broken.contains(point) {
                        true => self.on.insert(*point),
                        false => self.on.remove(point),
                    };
                }
                self.check(&before);
                let on: Vec<&str> = self.on.iter().map(|it| it.name()).collect();
                self.log.push(format!("set {}", on.join(" ")));
                JobDone::new(self.now, None)
            }
            Job::Read(points) => {
                self.scan(points);
                JobDone::new(self.now, None)
            }
            Job::Query(queries) => self.runs(queries),
            other => panic!("no test of this kind does {other:?}"),
        }
    }

    /// Checks that never both contactors are closed, never 230 V feeds the loop, and no reference switches under power.
    fn check(&self, before: &BTreeSet<DigitalOut>) {
        use DigitalOut::{
            LineContactor, LoopContactor, Reference0, Reference1, ShortCheck, SmuToOutput,
        };
        let (line, ring) = (self.is_on(LineContactor), self.is_on(LoopContactor));
        assert!(!(line && ring), "both contactors");
        let changed = line && before.contains(&LoopContactor);
        assert!(
            !(changed || ring && before.contains(&LineContactor)),
            "one to the other"
        );
        assert!(
            !ring || self.level_v < 40.0,
            "{} V at the loop",
            self.level_v
        );
        let powered = [LineContactor, LoopContactor, SmuToOutput];
        let is_powered = |on: &BTreeSet<_>| powered.iter().any(|it| on.contains(it));
        let moved = [Reference0, Reference1]
            .iter()
            .any(|it| before.contains(it) != self.on.contains(it));
        assert!(
            !moved || (!is_powered(before) && !is_powered(&self.on)),
            "references under power"
        );
        assert!(
            !(line || ring) || !self.is_on(SmuToOutput),
            "the source and meter at the mains"
        );
        assert!(
            !(line || ring) || !self.is_on(ShortCheck),
            "the short check at the mains"
        );
    }

    fn scan(&mut self, read: &[Point]) {
        let inputs = DigitalIn::ALL.iter().copied();
        let seen: Vec<DigitalIn> = inputs.filter(|it| self.sees(*it)).collect();
        let of = (&*self.wiring, &self.points);
        scan(&mut self.image, of, read, (&seen, 0.5), self.now);
    }

    fn sees(&self, point: DigitalIn) -> bool {
        let closed = |it| self.is_on(it);
        let (line, ring) = (
            closed(DigitalOut::LineContactor),
            closed(DigitalOut::LoopContactor),
        );
        !self.part.stuck.contains(&point)
            && match point {
                DigitalIn::ShortSeen => {
                    let conducts = self.part.shorted.abs() > 1.5;
                    let conducts = conducts && !closed(DigitalOut::Reference0);
                    closed(DigitalOut::ShortCheck) && (conducts || self.part.is_socket_shorted)
                }
                DigitalIn::KelvinInPlus
                | DigitalIn::KelvinInMinus
                | DigitalIn::KelvinOut1
                | DigitalIn::KelvinOut2 => closed(DigitalOut::KelvinTest),
                DigitalIn::OutputSafe => !line && !ring,
                DigitalIn::LineOpen => !line,
                DigitalIn::LoopOpen => !ring,
                DigitalIn::ProbeChain => true,
            }
    }

    fn runs(&mut self, queries: &[Query]) -> JobDone {
        self.rounds += 1;
        let names: Vec<&str> = queries.iter().map(|it| it.program).collect();
        self.log.push(format!("query {}", names.join(" ")));
        let mut delivered = Vec::new();
        for query in queries {
            let own = Device::ALL.iter().copied();
            let mut own = own.filter(|it| self.points.instrument(*it) == query.instrument);
            let device = own.next().unwrap();
            let profile = &self.wiring.instrument(query.instrument).profile;
            profile.program(query.program, &query.arguments).unwrap();
            if self.part.failing == Some((device, query.program)) {
                let why = Message::detail("unread", query.program);
                return JobDone::new(self.now, Some(why));
            }
            delivered.push(self.delivers(device, query));
        }
        JobDone {
            delivered,
            ..JobDone::new(self.now, None)
        }
    }

    fn delivers(&mut self, device: Device, query: &Query) -> Delivered {
        let given = |name: &str| query.arguments.iter().find(|it| it.0 == name).unwrap().1;
        let now_s = self.now_s();
        let numbers = match (device, query.program) {
            (Device::SmuIn, "source" | "level") => {
                self.control_to(given("level_v"));
                Vec::new()
            }
            (Device::SmuIn, "source_and_read") => {
                let ampere = if given("level_v") > 0.0 {
                    self.part.input_a
                } else {
                    -1e-6
                };
                vec![ampere.min(given("limit_a")); 2]
            }
            (Device::SmuIn, "ramp") => {
                let (from_v, to_v) = (given("from_v"), given("to_v"));
                let count = given("points") as usize;
                let step_v = given("step_v").copysign(to_v - from_v);
                for level in 0..count {
                    self.control_to(from_v + step_v * level as f64);
                    self.now = self.now + Span::seconds(given("dwell_s") + 2e-4);
                }
                vec![0.0; 2 * count]
            }
            (Device::SmuIn, "off") => {
                self.control_to(0.0);
                Vec::new()
            }
            (Device::SmuOut, "source") => {
                self.smu_v = given("level_v");
                Vec::new()
            }
            (Device::SmuOut, "read") => vec![0.0],
            (Device::SmuOut, "off") => {
                self.smu_v = 0.0;
                Vec::new()
            }
            (Device::AcSource, "set" | "level") => {
                let ring = self.is_on(DigitalOut::LoopContactor);
                assert!(!ring || given("level_v") < 40.0, "the loop gets the line");
                self.level_v = given("level_v") * self.part.source;
                Vec::new()
            }
            (Device::AcSource, "voltage") => vec![self.level_v],
            (Device::PulseSource, "train") => {
                let train = (given("pulses"), given("period_s"), given("width_s"));
                self.train = (train.0, train.1, train.2, given("level_v"));
                Vec::new()
            }
            (Device::PulseSource, "off") => {
                self.train.0 = 0.0;
                Vec::new()
            }
            (Device::PulseSource, "start") => {
                assert!(self.is_on(DigitalOut::DriveSelect));
                for pulse in 0..self.train.0 as usize {
                    let at_s = now_s + pulse as f64 * self.train.1;
                    self.control.push((at_s, 5.0));
                    self.control.push((at_s + self.train.2, 0.0));
                }
                self.trigger(now_s);
                Vec::new()
            }
            (Device::Digitizer, "capture_all" | "capture_all_falling") => {
                self.falls = query.program == "capture_all_falling";
                let scale = |name| given(name) * 4.0;
                self.scales = [
                    scale("control_v_per_div"),
                    scale("divided_v_per_div"),
                    scale("output_v_per_div"),
                    scale("shunt_v_per_div"),
                ];
                let record_s = 10.0 * given("s_per_div");
                self.record = (record_s, given("points"), given("level_v"));
                (self.begins_s, self.memory) = (None, Vec::new());
                assert!((given("offset_s") - 0.48 * record_s).abs() < 1e-9);
                Vec::new()
            }
            (Device::Digitizer, "force_trigger") => {
                self.trigger(now_s);
                Vec::new()
            }
            (Device::Digitizer, "complete") => {
                let begins_s = self.begins_s.expect("a trigger");
                assert!(now_s >= begins_s + self.record.0, "read before its end");
                self.stores();
                Vec::new()
            }
            (Device::Digitizer, "waveform") => {
                let volts = self.memory[given("channel") as usize - 1].clone();
                let step_s = self.record.0 / self.record.1;
                return Delivered {
                    numbers: Vec::new(),
                    waveform: Some(Arc::new(Waveform {
                        start_s: -0.02 * self.record.0,
                        step_s,
                        volts,
                    })),
                };
            }
            (device, program) => panic!("{device} runs {program}"),
        };
        Delivered {
            numbers,
            waveform: None,
        }
    }

    /// Stores the record of the digitizer at its end, with the connections that the fixture has then.
    fn stores(&mut self) {
        let ends_s = self.begins_s.map(|it| it + self.record.0);
        if self.memory.is_empty() && ends_s.is_some_and(|it| self.now_s() >= it) {
            self.renders();
        }
    }

    fn control_to(&mut self, volts: f64) {
        let now_s = self.now_s();
        let before = self.control.last().map_or(0.0, |it| it.1);
        self.control.push((now_s, volts));
        let crosses = match self.falls {
            true => before >= self.record.2 && volts < self.record.2,
            false => before < self.record.2 && volts >= self.record.2,
        };
        if crosses {
            self.trigger(now_s);
        }
    }

    fn trigger(&mut self, at_s: f64) {
        self.begins_s.get_or_insert(at_s - 0.02 * self.record.0);
        self.log.push("trigger".to_owned());
    }
}
