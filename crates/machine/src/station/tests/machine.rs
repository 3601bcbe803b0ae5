//! A station with a machine whose actuators always arrive and whose parts have known defects.

use super::{MockRig, context, device, device_of};
use crate::dut::em_relay::bins;
use crate::dut::em_relay::points::{self, AnalogIn};
use crate::dut::prompt::Prompt;
use crate::handling::inside::Inside;
use crate::handling::moves::Move;
use crate::handling::output::{NestDone, NestJob};
use crate::handling::serial::{Serials, Source};
use crate::handling::tests::mechanism_of;
use crate::handling::wear::Uses;
use crate::instrument::act::{Job, JobDone};
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::image::Image;
use crate::rig::point::{DigitalIn, DigitalInput, DigitalOut, Point};
use crate::station::gates::LotSettings;
use crate::station::orders::{Order, Refused};
use crate::station::trouble::Alarm;
use crate::station::turn::{Ending, HistoryState, Inputs, TurnOutput};
use crate::station::{Plan, Station};
use std::collections::{BTreeMap, VecDeque};
use units::{RigTime, Span};

/// Defect of a part of the magazine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Specimen {
    /// No pin at NO: void.
    MissingPin,
    /// NO is welded: fails at rest.
    StuckNo,
    /// Its coil is open: no current.
    OpenCoil,
}

impl Specimen {
    /// Returns the bin to which the part belongs.
    pub fn bin(self) -> Bin {
        match self {
            Self::MissingPin => Bin::RETEST,
            Self::StuckNo => bins::CONTACT,
            Self::OpenCoil => bins::COIL,
        }
    }
}

/// Inputs of the station in one turn, and the motions driven after it.
pub struct TurnRecord {
    pub now: RigTime,
    pub image: Image,
    pub job: Option<NestDone>,
    pub recorded: u64,
    pub bus: Option<Alarm>,
    pub stop: bool,
    pub driven: Vec<Move>,
    pub output: String,
}

/// A station with its machine.
pub struct Machine {
    pub station: Station,
    pub mock: MockRig,
    pub bus: Option<Alarm>,
    pub host_late: Option<Span>,
    pub fleet: Vec<Alarm>,
    pub stop: bool,
    pub abort: bool,
    /// Key of an actuator that never arrives.
    pub sticking: Option<&'static str>,
    magazine: VecDeque<Specimen>,
    under_way: Vec<(RigTime, Move)>,
    job: Option<NestJob>,
    reversed: bool,
    axis: AxisStation,
    beams: BTreeMap<DigitalInput, u16>,
    beam: Option<DigitalInput>,
    recorded: u64,
    orders: Vec<Order>,
    answers: Vec<Result<(), Refused>>,
    verify: bool,
    /// Outputs of the last turn.
    pub last_outputs: Vec<(DigitalOut, bool)>,
    /// Record of every turn.
    pub turns: Vec<TurnRecord>,
    /// Ordinals and bins in the order of landing.
    pub landed: Vec<(u64, Bin)>,
    /// Number of parts that left the nest.
    pub left: usize,
    /// End of the run.
    pub ending: Option<Ending>,
}

/// Returns inputs without orders or answers, every output confirmed.
pub fn quiet(image: &Image) -> Inputs<'_> {
    Inputs {
        image,
        job: None,
        recorded: 0,
        history: HistoryState::Written,
        bus: Vec::new(),
        readings: Vec::new(),
        reader: None,
        fleet: Vec::new(),
        host_late: None,
        stop: false,
        abort: false,
        orders: Vec::new(),
        settled: true,
        verified: false,
    }
}

/// Returns a calibrated station before its first turn.
pub fn station(count: Option<u64>, mock: &MockRig) -> Station {
    of_plan(plan(count), mock)
}

fn plan(count: Option<u64>) -> Plan {
    Plan {
        attended: false,
        between_lots: None,
        simulated: true,
        count,
        reference_serials: Vec::new(),
        calibrated: true,
        valid_us: 0,
        epoch_us: 0,
        lot: LotSettings::default(),
        worn: Uses::default(),
        left: Inside::default(),
        serials: Serials::default(),
        prompts: Vec::new(),
        experiment: None,
    }
}

fn of_plan(plan: Plan, mock: &MockRig) -> Station {
    let mechanism = mechanism_of(&mock.wiring);
    Station::new(plan, device(), mock.wiring.axis().clone(), mechanism)
}

impl Machine {
    pub fn new(count: Option<u64>, magazine: Vec<Specimen>) -> Self {
        let mut mock = MockRig::at_rest();
        mock.track(23.0);
        Self {
            station: station(count, &mock),
            mock,
            bus: None,
            host_late: None,
            fleet: Vec::new(),
            stop: false,
            abort: false,
            sticking: None,
            magazine: magazine.into(),
            under_way: Vec::new(),
            job: None,
            reversed: false,
            axis: AxisStation::Park,
            beams: BTreeMap::new(),
            beam: None,
            recorded: 0,
            orders: Vec::new(),
            answers: Vec::new(),
            verify: false,
            last_outputs: Vec::new(),
            turns: Vec::new(),
            landed: Vec::new(),
            left: 0,
            ending: None,
        }
    }

    /// Returns the same machine, attended.
    pub fn attended(count: Option<u64>, magazine: Vec<Specimen>) -> Self {
        let mut machine = Self::new(count, magazine);
        let plan = Plan {
            attended: true,
            ..plan(count)
        };
        machine.station = of_plan(plan, &machine.mock);
        machine
    }

    /// Returns an attended machine of a lot with these prompts.
    pub fn with_prompts(magazine: Vec<Specimen>, prompts: Vec<Prompt>) -> Self {
        let count = Some(magazine.len() as u64);
        let mut machine = Self::new(count, magazine);
        let plan = Plan {
            attended: true,
            prompts,
            ..plan(count)
        };
        machine.station = of_plan(plan, &machine.mock);
        machine
    }

    /// Returns an attended machine of a lot of one part that a person scans.
    pub fn scanned() -> Self {
        let mut machine = Self::new(Some(1), vec![Specimen::MissingPin]);
        let plan = Plan {
            attended: true,
            serials: Serials::new(Source::Wedge, Default::default()),
            ..plan(Some(1))
        };
        machine.station = of_plan(plan, &machine.mock);
        machine
    }

    /// Returns an attended machine between lots.
    pub fn between_lots() -> Self {
        let mut machine = Self::new(Some(0), Vec::new());
        let plan = Plan {
            attended: true,
            between_lots: Some(crate::station::packml::State::Stopped),
            ..plan(Some(0))
        };
        machine.station = of_plan(plan, &machine.mock);
        machine
    }

    /// Returns a machine with these gates and the reference parts of the default plant.
    pub fn of_lot(
        count: Option<u64>,
        magazine: Vec<Specimen>,
        lot: LotSettings,
        attended: bool,
    ) -> Self {
        let mut machine = Self::new(count, magazine);
        let plan = Plan {
            attended,
            lot,
            reference_serials: device().reference_serials(),
            ..plan(count)
        };
        machine.station = of_plan(plan, &machine.mock);
        machine
    }

    /// Makes the calibration expire now.
    pub fn calibration_runs_out(&mut self) {
        let mut context = context();
        std::sync::Arc::make_mut(&mut context.calibration).due_at_us =
            i64::try_from(self.mock.now.0).unwrap();
        self.station.device = device_of(context);
    }

    /// Sets the use counts of the wearing parts before the run.
    pub fn wore(&mut self, worn: Uses) {
        self.station.plan.worn = worn;
    }

    /// Gives an order and returns its answer in the next turn.
    pub fn order(&mut self, order: Order) -> Result<(), Refused> {
        self.orders.push(order);
        self.turn();
        self.answers.pop().unwrap()
    }

    /// Adds one part to the magazine.
    pub fn fill(&mut self, specimen: Specimen) {
        self.magazine.push_back(specimen);
    }

    /// Returns the number of motions driven so far.
    pub fn driven(&self) -> usize {
        self.turns.iter().map(|turn| turn.driven.len()).sum()
    }

    /// Advances 4 ms: reads every point, performs the station's turn and its commands.
    pub fn turn(&mut self) -> TurnOutput {
        self.mock.now = self.mock.now + Span::ms(4);
        let now = self.mock.now;
        let (there, still): (Vec<_>, Vec<_>) =
            self.under_way.iter().partition(|(at, _)| *at <= now);
        self.under_way = still;
        there.into_iter().for_each(|(_, m)| self.arrive(m));
        self.mock.scan();
        if let Some(beam) = self.beam {
            let count = self.beams.get(&beam).copied().unwrap_or(0);
            self.mock.beam(beam, count);
        }
        self.turn_without_scan()
    }

    /// Performs a turn on the previous samples.
    pub fn turn_without_scan(&mut self) -> TurnOutput {
        let job = self.job.take().map(|NestJob { nest, job }| NestDone {
            nest,
            done: self.answer(&job),
        });
        let image = self.mock.image.clone();
        let (now, recorded, stop) = (self.mock.now, self.recorded, self.stop);
        let bus = self.bus.take();
        let level = !self.magazine.is_empty();
        self.mock.set(DigitalIn::TrackLevel, level);
        let inputs = Inputs {
            orders: std::mem::take(&mut self.orders),
            verified: std::mem::take(&mut self.verify),
            image: &image,
            job: job.clone(),
            recorded,
            bus: bus.iter().cloned().collect(),
            host_late: self.host_late,
            fleet: self.fleet.clone(),
            stop,
            abort: self.abort,
            ..quiet(&image)
        };
        let mut output = self.station.step(now, inputs);
        self.answers.append(&mut output.answers);
        self.verify = output.rig.verify;
        self.ending = output.record.ending.or(self.ending);
        self.last_outputs.clone_from(&output.rig.outputs);
        if output.rig.safe {
            self.make_safe();
        }
        for movement in &output.rig.motions {
            self.drive(*movement);
        }
        self.obey(&output);
        self.turns.push(TurnRecord {
            now,
            image,
            job,
            recorded,
            bus,
            stop,
            driven: output.rig.motions.clone(),
            output: format!("{output:?}"),
        });
        output
    }

    /// Goes safe: bistable cylinders stay, the others go to rest.
    fn make_safe(&mut self) {
        self.under_way.clear();
        self.job = None;
        for movement in [
            Move::SortUp,
            Move::ProbesDown,
            Move::PusherRetract,
            Move::EscapementHold,
        ] {
            self.mock.show_end(movement);
        }
        self.mock.set(DigitalIn::AxisInPosition, false);
    }

    fn obey(&mut self, output: &TurnOutput) {
        if output.rig.job.is_some() {
            assert!(self.job.is_none(), "two jobs at once");
            self.job.clone_from(&output.rig.job);
        }
        self.beam = output.rig.beam;
        for judged in &output.record.parts.judged {
            self.recorded = judged.part.ordinal;
        }
        let landed = output.record.parts.landed.iter();
        self.landed
            .extend(landed.map(|landed| (landed.part.ordinal, landed.bin)));
        self.left += output.record.parts.left.len();
    }

    fn drive(&mut self, movement: Move) {
        self.station
            .driven(movement, self.mock.now, &self.mock.image);
        if let Move::AxisTo(_) = movement {
            self.mock.set(DigitalIn::AxisInPosition, false);
        }
        if self.sticking != Some(movement.actuator_key()) {
            let at = self.mock.now + Span::ms(60);
            self.under_way.push((at, movement));
        }
    }

    fn arrive(&mut self, movement: Move) {
        let held = self.station.ledger().fall().is_some();
        self.mock.show_end(movement);
        match movement {
            Move::EscapementRelease if !self.magazine.is_empty() => {
                self.mock.set(DigitalIn::PocketPresent, true);
            }
            Move::PusherExtend => {
                self.mock.set(DigitalIn::PocketPresent, false);
                self.mock.set(DigitalIn::NestPresent, true);
                self.insert();
            }
            Move::SortUp if self.mock.is_on(DigitalIn::GripperPart) => {
                self.mock.set(DigitalIn::NestPresent, false);
            }
            Move::AxisTo(station) => self.axis = station,
            Move::GripperOpen if held => {
                let AxisStation::Bin(bin) = self.axis else {
                    panic!("a part was let go over {:?}", self.axis);
                };
                let beam = self.mock.wiring.axis().beam(bin);
                *self.beams.entry(beam).or_default() += 1;
            }
            _ => {}
        }
    }

    fn insert(&mut self) {
        let specimen = self.magazine.pop_front().unwrap();
        let kelvin = [
            points::DigitalIn::KelvinCoilA,
            points::DigitalIn::KelvinCoilB,
            points::DigitalIn::KelvinCom,
            points::DigitalIn::KelvinNo,
            points::DigitalIn::KelvinNc,
        ];
        self.mock.set_board(points::DigitalIn::ProbeChain, true);
        for point in kelvin {
            self.mock.set_board(point, true);
        }
        let missing = specimen == Specimen::MissingPin;
        self.mock.set_board(points::DigitalIn::KelvinNo, !missing);
        let stuck = specimen == Specimen::StuckNo;
        self.mock.set_board(points::DigitalIn::NoClosed, stuck);
    }

    fn answer(&mut self, job: &Job) -> JobDone {
        match job {
            Job::Set(outputs) => {
                let reverse = self.mock.points.output(points::DigitalOut::SourceReverse);
                for (_, state) in outputs.iter().filter(|(point, _)| *point == reverse) {
                    self.reversed = *state;
                }
            }
            Job::Read(points) => points.iter().for_each(|point| self.read(*point)),
            Job::Level(_) | Job::Restarts | Job::Mask(_) | Job::Query(_) | Job::Convert(..) => {}
        }
        JobDone::new(self.mock.now, None)
    }

    /// Reads a point: the coil is open, the contacts are good, no gate counts.
    fn read(&mut self, point: Point) {
        let known = |input| self.mock.points.analog(input);
        match point {
            Point::Analog(input) if input == known(AnalogIn::CoilVoltageFine) => {
                self.mock.volts_at(input, 8.0);
            }
            Point::Analog(input) if input == known(AnalogIn::ContactDrop) => {
                let volts = if self.reversed { -1.1 } else { 1.1 };
                self.mock.volts_at(input, volts);
            }
            Point::Analog(input) => self.mock.volts_at(input, 0.0),
            Point::Count(counter) => self.mock.count(counter, 0),
            Point::Temperature(_) => self.mock.track(23.0),
            Point::Input(_) => {}
        }
    }

    /// Takes turns until the run is over.
    pub fn run(&mut self) -> TurnOutput {
        for _ in 0..10_000 {
            let output = self.turn();
            assert!(self.station.ledger().balances());
            if output.record.ending.is_some() {
                return output;
            }
        }
        panic!("the run does not end: {:?}", self.station.activity());
    }
}
