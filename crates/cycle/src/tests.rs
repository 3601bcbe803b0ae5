//! Tests of the cycle with instruments in memory and lines whose modules accept every write.
#![allow(clippy::unwrap_used)]

mod meter;
mod queries;
mod standstill;

use super::*;
use bus::instrument::{Link, serve};
use bus::{Answer, Passage, Request};
use config::{Folder, Plant, load_recipe};
use dcon::{Command, Reply};
use machine::guard::{Actuator, PartSize};
use machine::handling::mechanism::Mechanism;
use machine::handling::moves::Strokes;
use machine::instrument::act::Job;
use machine::instrument::query::{Instrument, Query};
use machine::rig::instruments::InstrumentWiring;
use machine::station::Plan;
use meter::Meter;
use scpi::{Failure, Profile};
use std::sync::Mutex;
use tokio::task::JoinHandle;

/// Messages to instruments and writes to modules, in their order.
#[derive(Debug, Clone, Default)]
struct Log(Arc<Mutex<Vec<(RigTime, String)>>>);

impl Log {
    fn add(&self, at: RigTime, text: String) {
        self.0.lock().unwrap().push((at, text));
    }

    fn all(&self) -> Vec<(RigTime, String)> {
        self.0.lock().unwrap().clone()
    }

    /// Returns the time of the first entry with this text at or after `from`.
    fn first(&self, text: &str, from: RigTime) -> Option<RigTime> {
        let all = self.all();
        let found = all.iter().find(|(at, it)| *at >= from && it.contains(text));
        found.map(|it| it.0)
    }

    /// Returns the entries after `from`, without their times.
    fn since(&self, from: RigTime) -> Vec<String> {
        let all = self.all().into_iter().filter(|it| it.0 > from);
        all.map(|it| it.1).collect()
    }

    fn count(&self, text: &str) -> usize {
        self.all().iter().filter(|it| it.1.contains(text)).count()
    }
}

/// A cycle with its instruments and lines.
struct Bench {
    cycle: Cycle,
    pace: Pace,
    log: Log,
    /// Tasks of the instruments.
    tasks: Vec<JoinHandle<Result<(), Failure>>>,
    events: mpsc::UnboundedReceiver<Event>,
}

/// Runs `test` in virtual time with the instruments `meter` and `source`.
fn in_virtual_time(meters: [Meter; 2], test: impl AsyncFnOnce(Bench)) {
    let run = async { test(Bench::new(meters)).await };
    virtual_time::block_on(run).unwrap();
}

/// Answers every request: modules accept every command.
async fn accept(
    name: String,
    pace: Pace,
    log: Log,
    mut requests: mpsc::Receiver<Request>,
    answers: mpsc::Sender<Answer>,
) {
    while let Some(Request {
        ticket, command, ..
    }) = requests.recv().await
    {
        let requested_at = pace.now();
        pace.sleep_until(requested_at + Span::ms(2)).await;
        let is_heartbeat = command == Command::HostOk;
        if !is_heartbeat {
            log.add(pace.now(), format!("line {name} accepted"));
        }
        let answer = Answer {
            ticket,
            command,
            outcome: Ok(if is_heartbeat {
                Reply::Sent
            } else {
                Reply::Accepted
            }),
            raw: String::new(),
            requested_at,
            answered_at: pace.now(),
            tries_used: 1,
        };
        if answers.send(answer).await.is_err() {
            return;
        }
    }
}

impl Bench {
    fn new(meters: [Meter; 2]) -> Self {
        let (pace, log) = (Pace::virtual_time(), Log::default());
        let folder = Folder::built_in();
        let plant = Plant::load(&folder).unwrap();
        let recipe = Arc::new(load_recipe(&folder, "resistor-390").unwrap());
        let mut wiring = recipe.wired(&plant.wiring, &plant.accuracy).unwrap();
        let profile: Arc<Profile> = Arc::new(toml::from_str(meter::PROFILE).unwrap());
        wiring.instruments = meters.iter().map(|it| wired(it, &profile)).collect();
        let wiring = Arc::new(wiring);
        let lines = wiring.line_ids().map(|line| {
            let (requests, requested) = mpsc::channel(1);
            let (answer, answers) = mpsc::channel(1);
            let name = wiring.line(line).name.clone();
            tokio::spawn(accept(name, pace, log.clone(), requested, answer));
            LineEnds {
                line,
                requests,
                answers,
            }
        });
        let mut tasks = Vec::new();
        let instruments = wiring
            .instrument_ids()
            .zip(&meters)
            .map(|(instrument, meter)| {
                let wired = wiring.instrument(instrument);
                let settings = wired.profile.link_settings(&wired.link);
                let link = Link::new(meter.opener(pace, &log), settings, pace, 7);
                let (requests, requested) = mpsc::channel(1);
                let (answer, answers) = mpsc::channel(1);
                let safe = wired.profile.safe();
                tasks.push(tokio::spawn(serve(link, pace, requested, answer, safe)));
                InstrumentEnds {
                    instrument,
                    requests,
                    answers,
                }
            });
        let ends = (lines.collect(), instruments.collect());
        let (events, received) = mpsc::unbounded_channel();
        let links = CycleLinks {
            events,
            recorded: Arc::default(),
            stop: Arc::default(),
            abort: Arc::default(),
            orders: mpsc::channel(1).1,
            epoch_us: 0,
            history: watch::channel(HistoryState::Written).1,
            fleet: watch::channel(Vec::new()).1,
            readings: None,
            snapshots: None,
            passage: Passage::default(),
        };
        let guard = Guard::build(plant.scene.as_ref().unwrap()).unwrap();
        let station = station(&plant, &wiring, &guard, recipe);
        Self {
            cycle: Cycle::new(wiring, pace, station, Some(guard), ends, links),
            pace,
            log,
            tasks,
            events: received,
        }
    }

    fn query(&self, name: &str, program: &'static str) -> Query {
        Query {
            instrument: self.instrument(name),
            program,
            arguments: Vec::new(),
            shows: Vec::new(),
        }
    }

    fn instrument(&self, name: &str) -> Instrument {
        self.cycle.wiring.instrument_named(name).unwrap()
    }

    /// Takes one turn without the station: scan, then the next programs and transactions.
    async fn turn(&mut self) {
        let now = self.pace.now();
        self.cycle.scan(now);
        self.cycle.traffic.dispatch(now);
        let settled = self.cycle.outputs.all_settled();
        self.cycle.instruments.dispatch(now, settled);
        if self.cycle.job_done.is_none() {
            self.cycle.wait(now, None).await;
        }
    }

    /// Carries out a measuring job.
    async fn job(&mut self, queries: Vec<Query>) -> JobDone {
        self.cycle.start(Job::Query(queries));
        if let Some(done) = self.cycle.traffic.job_if_empty(self.pace.now()) {
            return done;
        }
        loop {
            if let Some(done) = self.cycle.job_done.take() {
                return done;
            }
            self.turn().await;
        }
    }

    /// Takes a turn in which the station makes everything safe.
    fn go_safe(&mut self) {
        let mut output = TurnOutput::default();
        output.rig.safe = true;
        self.cycle.apply(self.pace.now(), &mut output);
    }
}

fn wired(meter: &Meter, profile: &Arc<Profile>) -> InstrumentWiring {
    InstrumentWiring {
        name: meter.name.to_owned(),
        profile: Arc::clone(profile),
        // After doubt a serial link keeps its stream, on which a late reply can still come.
        link: "serial:/dev/ttyS9:9600".parse().unwrap(),
    }
}

fn station(
    plant: &Plant,
    wiring: &Arc<Wiring>,
    guard: &Guard,
    recipe: Arc<machine::dut::Recipe>,
) -> Station {
    let part = recipe.device.part();
    let size = PartSize {
        body_mm: part.body_mm,
        pin_length_mm: part.pin_length_mm,
    };
    let strokes = Strokes {
        length_mm: Actuator::ALL.map(|actuator| guard.stroke_mm(actuator).1),
        sensor_off_mm: Actuator::ALL.map(|actuator| guard.sensor_off_mm(actuator)),
        probes_beside_pusher: false,
        axis_mm: Vec::new(),
    };
    let rig = machine::dut::device::Rig {
        wiring,
        ..plant.rig()
    };
    let device = recipe.device.on_rig(Arc::clone(&recipe), &rig, None);
    let plan = Plan {
        count: Some(1),
        reference_serials: Vec::new(),
        calibrated: true,
        valid_us: 0,
        epoch_us: 0,
        simulated: true,
        attended: false,
        between_lots: None,
        lot: plant.lot.clone(),
        worn: Default::default(),
        left: Inside::default(),
        serials: Default::default(),
        prompts: Vec::new(),
        experiment: None,
    };
    let mechanism = Mechanism::new(strokes, wiring.feeder().unwrap().strokes, size);
    Station::new(plan, device.unwrap(), wiring.axis().clone(), mechanism)
}
