//! A fixture with a part on it, for tests: the bench answers the jobs of a test as instruments and modules do.
#![allow(clippy::unwrap_used)]

use crate::dut::device::{DeviceUnderTest, Rig, TestOrder};
use crate::dut::em_relay::settings::ReferenceSet;
use crate::dut::procedure::Progress;
use crate::dut::recipe::DeviceRecipe;
use crate::dut::ssr::Device as SsrDevice;
use crate::dut::ssr::learned::Learned;
use crate::dut::ssr::points::{Device, DigitalIn, DigitalOut, Points};
use crate::dut::{Procedure, Recipe};
use crate::instrument::act::{Job, JobDone, RunnerState};
use crate::instrument::query::{Delivered, Query};
use crate::rig::image::Image;
use crate::rig::instruments::Profiles;
use crate::rig::point::Point;
use crate::rig::settings::RigSettings;
use crate::rig::wiring::Wiring;
use dcon::{Bits, Reply};
use std::collections::BTreeSet;
use std::sync::Arc;
use texts::Message;
use units::{RigTime, Span};

mod circuit;

/// Offset of the meter at the output, A: the open fixture shows it.
const OFFSET_A: f64 = 5e-9;

/// Text of the rig.
pub const RIG: &str = include_str!("../../../../../../config/rigs/ssr/rig.toml");
/// Text of the recipe.
pub const RECIPE: &str =
    include_str!("../../../../../../config/rigs/ssr/recipes/ssr-dc-60v-3a.toml");
const PROFILES: [(&str, &str); 5] = [
    (
        "ac-source-61500",
        include_str!("../../../../../../config/instruments/ac-source-61500.toml"),
    ),
    (
        "smu-2450",
        include_str!("../../../../../../config/instruments/smu-2450.toml"),
    ),
    (
        "digitizer-rigol",
        include_str!("../../../../../../config/instruments/digitizer-rigol.toml"),
    ),
    (
        "digitizer-keysight",
        include_str!("../../../../../../config/instruments/digitizer-keysight.toml"),
    ),
    (
        "pulse-source",
        include_str!("../../../../../../config/instruments/pulse-source.toml"),
    ),
];

/// Profiles; `change` gets name and text of each.
pub fn profiles(change: impl Fn(&str, &str) -> String) -> Profiles {
    let parsed = |(name, text): (&str, &str)| {
        let profile: scpi::Profile = toml::from_str(&change(name, text)).unwrap();
        (name.to_owned(), Arc::new(profile))
    };
    PROFILES.into_iter().map(parsed).collect()
}

/// The wiring of a rig.
pub fn wiring(rig: &str, profiles: &Profiles) -> Arc<Wiring> {
    let settings: RigSettings = toml::from_str(rig).unwrap();
    Arc::new(Wiring::resolve_with(&settings, crate::dut::FIXTURES, profiles).unwrap())
}

/// The recipe with changes of its text.
pub fn recipe(changes: &[(&str, &str)]) -> Arc<Recipe> {
    let text = changes.iter().fold(RECIPE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the recipe");
        text.replace(from, to)
    });
    Arc::new(toml::from_str(&text).unwrap())
}

/// Gives an image what the modules of the fixture answer to a read: the inputs that are on, and the voltage at the
/// socket, V.
pub fn scan(
    image: &mut Image,
    (wiring, points): (&Wiring, &Points),
    read: &[Point],
    (seen, residual_v): (&[DigitalIn], f64),
    now: RigTime,
) {
    let terminals = DigitalIn::ALL.iter();
    let terminals = terminals.map(|it| (it, wiring.digital_in(points.input(*it))));
    let word = terminals.fold(0, |word, (point, terminal)| {
        let is_set = seen.contains(point) != terminal.active_low;
        word | if is_set { terminal.bit() } else { 0 }
    });
    let [first, second] = u16::to_be_bytes(word);
    let module = wiring
        .digital_in(points.input(DigitalIn::ProbeChain))
        .module;
    let (line, command) = (wiring.module(module).line, wiring.poll(module));
    let bits = Reply::Bits(Bits { first, second });
    image.accept(line, &command, &bits, "", now).unwrap();
    for point in read.iter().filter(|it| matches!(it, Point::Analog(_))) {
        let command = wiring.reads(&[*point])[0].1;
        let steps = (residual_v * 0.01 / 10.0 * 32768.0).round() as i16;
        let text = format!(">{steps:04X}");
        let reply = command.decode(format!("{text}\r").as_bytes(), false);
        let reply = reply.unwrap();
        image.accept(line, &command, &reply, &text, now).unwrap();
    }
}

/// True values of a part, and the state of the fixture.
#[derive(Debug, Clone)]
pub struct Part {
    pub input_a: f64,
    pub reverse_a: f64,
    pub turn_on_v: f64,
    pub turn_off_v: f64,
    pub leakage_a: f64,
    pub hot_leakage_a: f64,
    pub ohm: f64,
    pub rise_v: f64,
    pub on_s: f64,
    pub off_s: f64,
    pub is_shorted: bool,
    /// True for a short in the socket.
    pub is_socket_shorted: bool,
    pub has_diode: bool,
    pub is_turned: bool,
    /// Conducts for ever once this voltage has been at its input.
    pub sticks_at_v: f64,
    /// The same while the load is at its output.
    pub sticks_loaded_v: f64,
    /// Inputs that the fixture never reports.
    pub dead: Vec<DigitalIn>,
    /// Times to answer a step to or from a voltage near the threshold, when they differ from those of the pulse, s.
    pub weak_s: Option<f64>,
    /// Voltage at the socket after the test.
    pub residual_v: f64,
    /// Program that fails.
    pub failing: Option<(Device, &'static str)>,
    /// Program that delivers these numbers in place of its own.
    pub spoiled: Option<(&'static str, Vec<f64>)>,
}

/// A part inside every limit.
pub fn good() -> Part {
    Part {
        input_a: 3.8e-3,
        reverse_a: 1e-6,
        turn_on_v: 2.41,
        turn_off_v: 2.23,
        leakage_a: 0.2e-6,
        hot_leakage_a: 0.4e-6,
        ohm: 0.060,
        rise_v: 60e-6,
        on_s: 300e-6,
        off_s: 200e-6,
        is_shorted: false,
        is_socket_shorted: false,
        has_diode: false,
        is_turned: false,
        sticks_at_v: f64::INFINITY,
        sticks_loaded_v: f64::INFINITY,
        dead: Vec::new(),
        weak_s: None,
        residual_v: 0.5,
        failing: None,
        spoiled: None,
    }
}

/// The fixture with a part.
pub struct Bench {
    pub part: Part,
    pub now: RigTime,
    pub rounds: usize,
    /// Jobs in their order, as words.
    pub log: Vec<String>,
    /// Number of jobs after which the lead of the source at the output breaks, and (the next field) of those so far.
    pub lead_opens_after: usize,
    /// Number of jobs after which the lead is whole again.
    pub lead_heals_after: usize,
    /// What earlier parts of the lot have taught.
    pub learned: Learned,
    jobs: usize,
    wiring: Arc<Wiring>,
    image: Image,
    points: Points,
    on: BTreeSet<DigitalOut>,
    is_lit: bool,
    is_stuck: bool,
    is_heated: bool,
    /// Voltage of the source at the output, V.
    source_v: f64,
    has_failed: bool,
    record_s: (f64, f64),
    pulse_s: f64,
    /// Level at which the digitizer waits for an edge, and whether for a falling one.
    waits: Option<(f64, bool)>,
    /// Whether the output was on before the recorded edge, and whether it is on long after the edge.
    answer: (bool, bool),
    control_v: f64,
    /// Control voltage before a recorded ramp and at each of its levels, and whether the output is on then.
    ramp: Vec<(f64, bool)>,
}

impl Bench {
    /// Puts a part on the fixture.
    pub fn with(part: Part) -> Self {
        let wiring = wiring(RIG, &profiles(|_, text| text.to_owned()));
        Self {
            points: Points::resolve(&wiring, false).unwrap(),
            image: Image::new(Arc::clone(&wiring)),
            wiring,
            part,
            now: RigTime(1_000_000),
            rounds: 0,
            log: Vec::new(),
            lead_opens_after: usize::MAX,
            lead_heals_after: usize::MAX,
            jobs: 0,
            on: BTreeSet::new(),
            is_lit: false,
            is_stuck: false,
            is_heated: false,
            source_v: 0.0,
            has_failed: false,
            record_s: (0.0, 0.0),
            pulse_s: 0.0,
            waits: None,
            answer: (false, false),
            control_v: 0.0,
            ramp: Vec::new(),
            learned: Learned::default(),
        }
    }

    /// Tests the part by a recipe.
    pub fn tested(&mut self, recipe: Arc<Recipe>, thorough: bool) -> Procedure {
        let DeviceRecipe::Ssr(ssr) = recipe.device.clone() else {
            panic!("a solid-state relay");
        };
        let rig = Rig {
            wiring: &self.wiring,
            reference: None,
            accuracy: &crate::dut::em_relay::tests::context().accuracy,
            reference_parts: &ReferenceSet::default(),
            certificate: None,
        };
        let mut device = SsrDevice::new(recipe, &ssr, &rig).unwrap();
        device.learned = self.learned;
        let order = TestOrder {
            thorough,
            teaching: None,
            number: 1,
        };
        let mut test = device.begin(&order, self.now);
        let mut done = None;
        loop {
            match test.step(self.now, done.take().as_ref(), &self.image) {
                Progress::Judged => return test,
                Progress::Running(RunnerState::Wait(until)) => self.now = until,
                Progress::Running(RunnerState::Job(job)) => done = Some(self.does(&job)),
                Progress::Running(other) => panic!("a test that waits for nothing: {other:?}"),
            }
        }
    }

    fn does(&mut self, job: &Job) -> JobDone {
        self.now = self.now + Span::ms(2);
        self.jobs += 1;
        match job {
            Job::Set(outputs) => {
                let all = DigitalOut::ALL
                    .iter()
                    .zip(self.points.outputs(DigitalOut::ALL));
                let before = self.on.clone();
                for (point, (handle, _)) in all {
                    let state = outputs.iter().find(|it| it.0 == handle);
                    match state.map(|it| it.1) {
                        Some(true) => self.on.insert(*point),
                        Some(false) => self.on.remove(point),
                        None => panic!("{point} is left as it was"),
                    };
                }
                self.check_cold(&before);
                // The part cools down before it is tested again.
                self.is_heated &= !self.on.contains(&DigitalOut::KelvinTest);
                let on: Vec<&str> = self.on.iter().map(|it| it.name()).collect();
                self.log.push(format!("set {}", on.join(" ")));
                JobDone::new(self.now, None)
            }
            Job::Read(points) => {
                self.scan(points);
                JobDone::new(self.now, None)
            }
            Job::Query(queries) => self.runs(queries),
            Job::Convert(conversion, waveforms) => JobDone {
                converted: Some(conversion.run(waveforms)),
                ..JobDone::new(self.now, None)
            },
            other => panic!("no test of this kind does {other:?}"),
        }
    }

    /// No relay of the output switches while its source is on, unless a job has failed before.
    fn check_cold(&self, before: &BTreeSet<DigitalOut>) {
        use DigitalOut::{OutputPolarity, SmuLoad, SmuToOutput};
        let moved = [OutputPolarity, SmuLoad, SmuToOutput];
        let moved = moved
            .iter()
            .any(|it| before.contains(it) != self.on.contains(it));
        let is_cold = self.source_v == 0.0 || self.has_failed;
        assert!(!moved || is_cold, "switched at {} V", self.source_v);
    }

    fn scan(&mut self, read: &[Point]) {
        let inputs = DigitalIn::ALL.iter().copied();
        let seen: Vec<DigitalIn> = inputs.filter(|it| self.sees(*it)).collect();
        let of = (&*self.wiring, &self.points);
        let shown = (&seen[..], self.socket_v());
        scan(&mut self.image, of, read, shown, self.now);
    }

    fn sees(&self, point: DigitalIn) -> bool {
        let is_on = |output| self.on.contains(&output);
        let reversed = is_on(DigitalOut::OutputPolarity);
        !self.part.dead.contains(&point)
            && match point {
                DigitalIn::ShortSeen => {
                    let conducts = self.part.is_shorted || self.is_stuck;
                    let conducts = conducts || (reversed && self.part.has_diode);
                    let conducts = conducts && !is_on(DigitalOut::Reference0);
                    is_on(DigitalOut::ShortCheck) && (conducts || self.part.is_socket_shorted)
                }
                DigitalIn::KelvinInPlus
                | DigitalIn::KelvinInMinus
                | DigitalIn::KelvinOut1
                | DigitalIn::KelvinOut2 => is_on(DigitalOut::KelvinTest),
                DigitalIn::OutputSafe => self.part.residual_v < 30.0,
                DigitalIn::LineOpen | DigitalIn::LoopOpen | DigitalIn::ProbeChain => true,
            }
    }

    fn runs(&mut self, queries: &[Query]) -> JobDone {
        self.rounds += 1;
        let names: Vec<&str> = queries.iter().map(|it| it.program).collect();
        self.log.push(format!("query {}", names.join(" ")));
        let device = |query: &Query| {
            let all = Device::ALL.iter().copied();
            let mut own = all.filter(|it| self.points.instrument(*it) == query.instrument);
            own.next().unwrap()
        };
        let devices: Vec<Device> = queries.iter().map(device).collect();
        for (query, device) in queries.iter().zip(&devices) {
            let profile = &self.wiring.instrument(query.instrument).profile;
            profile.program(query.program, &query.arguments).unwrap();
            if self.part.failing == Some((*device, query.program)) {
                self.has_failed = true;
                let why = Message::detail("unread", query.program);
                return JobDone::new(self.now, Some(why));
            }
        }
        let all = queries.iter().zip(devices);
        let delivered = all.map(|(query, device)| self.delivers(device, query));
        JobDone {
            delivered: delivered.collect(),
            ..JobDone::new(self.now, None)
        }
    }

    fn delivers(&mut self, device: Device, query: &Query) -> Delivered {
        let given = |name: &str| {
            let mut own = query.arguments.iter().filter(|it| it.0 == name);
            own.next().unwrap().1
        };
        let mut numbers = match (device, query.program) {
            (Device::SmuIn, "source" | "level") => {
                self.control(given("level_v"));
                Vec::new()
            }
            (Device::SmuIn, "source_and_read") => {
                self.control(given("level_v"));
                let ampere = self.input_a(given("level_v")).min(given("limit_a"));
                vec![ampere.max(-given("limit_a")); 2]
            }
            (Device::SmuIn, "step") => {
                self.control(given("before_v"));
                self.control(given("level_v"));
                vec![self.input_a(given("before_v"))]
            }
            (Device::SmuIn, "ramp") => {
                let sign = (given("to_v") - given("from_v")).signum();
                self.ramp = vec![(self.control_v, self.is_lit)];
                for number in 0..given("points") as u32 {
                    self.control(given("from_v") + sign * given("step_v") * f64::from(number));
                    self.ramp.push((self.control_v, self.is_lit));
                }
                assert!((self.control_v - given("to_v")).abs() < 1e-6);
                self.ramp.iter().map(|it| it.0).collect()
            }
            (Device::SmuIn | Device::SmuOut, "off") => {
                match device == Device::SmuIn {
                    true => self.control(0.0),
                    false => self.source_v = 0.0,
                }
                Vec::new()
            }
            (Device::SmuOut, "source") => {
                self.source_v = given("level_v");
                Vec::new()
            }
            (Device::SmuOut, "settle_and_read") => {
                self.source_v = given("level_v");
                let most_a = given("limit_a");
                let is_part = !self.on.contains(&DigitalOut::Reference0);
                let part_a = if is_part { self.output_a() } else { 0.0 };
                vec![(part_a + OFFSET_A).clamp(-most_a, most_a); 2]
            }
            (Device::SmuOut, "read") => vec![self.output_a()],
            (Device::SmuOut, "drop_at_current") => {
                assert!(self.is_lit, "a drop of a blocked output");
                self.source_v = 1.0;
                vec![self.drop_v(given("level_a")).min(given("limit_v"))]
            }
            (Device::SmuOut, "drops_over_time") => {
                assert!(self.is_lit, "drops of a blocked output");
                (self.is_heated, self.source_v) = (true, 1.0);
                let count = given("count") as usize;
                let settled = |at: usize| 1.0 - (-(at as f64) * 0.02 / 0.03).exp();
                let cold_v = self.drop_v(given("level_a"));
                let drop = |at| (cold_v + self.part.rise_v * settled(at)).min(given("limit_v"));
                let drops: Vec<f64> = (0..count).map(drop).collect();
                [vec![drops[count - 1]], drops].concat()
            }
            (Device::PulseSource, "train") => {
                self.pulse_s = given("width_s");
                Vec::new()
            }
            (Device::Digitizer, "capture" | "capture_falling") => {
                self.record_s = (10.0 * given("s_per_div"), given("points"));
                self.ramp = Vec::new();
                self.waits = Some((given("level_v"), query.program == "capture_falling"));
                Vec::new()
            }
            (Device::PulseSource, "start") => {
                assert!(self.on.contains(&DigitalOut::DriveSelect));
                self.waits = None;
                Vec::new()
            }
            (Device::Digitizer, "complete") => {
                assert!(self.waits.is_none(), "the digitizer still waits");
                Vec::new()
            }
            (Device::PulseSource, "off") => Vec::new(),
            (Device::Digitizer, "waveform") => {
                return Delivered {
                    numbers: Vec::new(),
                    waveform: Some(Arc::new(self.waveform(given("channel")))),
                };
            }
            (device, program) => panic!("{device} runs {program}"),
        };
        if let Some((program, instead)) = &self.part.spoiled
            && *program == query.program
        {
            numbers = instead.clone();
        }
        Delivered {
            numbers,
            waveform: None,
        }
    }
}
