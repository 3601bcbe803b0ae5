//! The control cycle: the one task that runs the rig, in turns; each turn goes through six phases:
//!
//! ```text
//! scan -> step -> clear -> apply -> record -> publish
//! ```
//! `scan` stores the answers of the lines, `step` lets the station decide, `clear` asks the guard whether each motion
//! is free of collisions, `apply` turns outputs into commands, `record` sends events to the history, `publish` builds
//! the view for the screens.
//!
//! One task owns the process image, the outputs, the guard and the station; each line is a task of its own with a queue
//! for one request ([`traffic`]). A turn begins when an answer arrives, or at the instant that the last step requested.
//! Only the station knows which kind of device is under test.
//!
//! The cycle counts how late this computer wakes it, so that a missed reply is not blamed on a cable:
//!
//! ```
//! use cycle::Lateness;
//! use units::{RigTime, Span};
//! let mut lateness = Lateness::default();
//! lateness.count(RigTime(10_000), RigTime(10_400));
//! assert_eq!(lateness.recent(), Span(400));
//! ```

mod answers;
mod arrival;
mod commission;
mod converter;
mod event;
mod failures;
mod instruments;
mod jobs;
mod jog_preview;
mod lateness;
mod open_job;
mod orders;
mod profile;
mod publish;
mod queries;
mod record;
mod scan_schedule;
mod snapshot;
mod standstill;
mod traffic;

pub use instruments::InstrumentEnds;
pub use lateness::Lateness;
pub use snapshot::{Snapshot, Snapshots, snapshots};
pub use traffic::LineEnds;

use bus::{Pace, Passage, Reading, Timer};
use converter::Converter;
pub use event::Event;
use failures::Failures;
use instruments::Instruments;
use machine::guard::Guard;
use machine::handling::NestId;
use machine::handling::inside::Inside;
use machine::handling::output::{NestDone, NestJob};
use machine::instrument::act::JobDone;
use machine::rig::drive::Outputs;
use machine::rig::image::Image;
use machine::rig::point::{DigitalIn, DigitalOutput};
use machine::rig::wiring::{LineId, Wiring};
use machine::station::Station;
use machine::station::packml;
use machine::station::trouble::Alarm;
use machine::station::turn::{Ending, HistoryState, Inputs, TurnOutput};
use machine::view::{self, OrderRequest};
pub use orders::PANEL;
pub use profile::Profile;
pub use publish::line as alarm_line;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use texts::Message;
use tokio::runtime::Handle;
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;
use traffic::{Purpose, Traffic};
use units::{RigTime, Span};

/// Longest pause between two turns when the station asks for no earlier instant.
const IDLE: Span = Span::ms(50);

/// Channels and flags between the cycle and the rest of the program.
#[derive(Debug)]
pub struct CycleLinks {
    /// Carries events to the history; unbounded, but the parts inside the machine limit how many can wait.
    pub events: mpsc::UnboundedSender<Event>,
    /// Ordinal of the last part whose record is safely on the disk; the history sets it.
    pub recorded: Arc<AtomicU64>,
    /// True once the operator stops the lot; the parts inside the machine are finished first.
    pub stop: Arc<AtomicBool>,
    /// True once the operator stops the lot at once.
    pub abort: Arc<AtomicBool>,
    /// Orders of screens, each with the channel for its answer.
    pub orders: mpsc::Receiver<OrderRequest>,
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    pub epoch_us: i64,
    /// State of the history; the recorder sets it.
    pub history: watch::Receiver<HistoryState>,
    /// Alarms about the databases of the fleet while they last.
    pub fleet: watch::Receiver<Vec<Alarm>>,
    /// Carries the readings of the code reader; `None` in a lot without one.
    pub readings: Option<mpsc::Receiver<Reading>>,
    /// Carries snapshots to the screens; `None` on a rig without a screen.
    pub snapshots: Option<Snapshots>,
    /// How late this computer passes bytes on; never late in virtual time.
    pub passage: Passage,
}

/// How a run of the cycle ended.
#[derive(Debug)]
pub struct Ended {
    /// Way in which the run ended.
    pub ending: Ending,
    /// Wall time of the phases of the turns.
    pub profile: Profile,
    /// How late this computer woke the cycle.
    pub lateness: Lateness,
}

impl Ended {
    /// Returns the end of a cycle whose assertion failed.
    pub fn by_assertion() -> Self {
        Self {
            ending: Ending::Alarm,
            profile: Profile::default(),
            lateness: Lateness::default(),
        }
    }
}

/// The control cycle of one rig: its image, outputs, guard, station and lines.
pub struct Cycle {
    wiring: Arc<Wiring>,
    pace: Pace,
    station: Station,
    /// Guard of a rig with a feeder; `None` at a rack, where nothing moves.
    guard: Option<Guard>,
    image: Image,
    outputs: Outputs,
    traffic: Traffic,
    instruments: Instruments,
    converter: Converter,
    failures: Failures,
    links: CycleLinks,
    job_done: Option<JobDone>,
    /// Nest of the current measuring job, or of the last one.
    job_nest: NestId,
    /// Alarms of lines and modules, which the station receives in its next step.
    bus_alarms: Vec<Alarm>,
    profile: Profile,
    turned_at: RigTime,
    /// True in an abort and at the end of a run, when every write makes a module safe.
    making_safe: bool,
    pending_orders: Vec<OrderRequest>,
    /// Order of the jog under way, which the cycle answers when the motion ends.
    jogging: Option<OrderRequest>,
    orders_closed: bool,
    /// Readings of the code reader since the last turn; `None` for a reading without a code.
    readings: Vec<Option<String>>,
    /// Alarm about the code reader while its port is lost.
    reader: Option<Alarm>,
    verified: bool,
    publish_at: RigTime,
    /// State of the whole rig (PackML) in the last event sent.
    published_state: packml::State,
    /// Reason why the scan failed to read a reset status on a measuring line. The lost read may have cleared the sign
    /// of a restart, so the next job that reads a reset status fails for this reason.
    lost_status: Option<Message>,
    /// Contents of the machine in the last event sent.
    inside: Inside,
    /// Longest age that the emergency-stop input has reached so far.
    worst_age: Span,
    /// Motion that the guard refused last; cleared when another motion begins.
    refused: Option<view::MotionView>,
    /// Buttons that the last view shows as refused.
    refusals: publish::Refusals,
    lateness: Lateness,
    timer: Timer,
}

impl Cycle {
    /// Takes over the lines and the instruments; writes nothing before [`Cycle::run`]. Conversions get the priority of
    /// the calling thread.
    pub fn new(
        wiring: Arc<Wiring>,
        pace: Pace,
        station: Station,
        guard: Option<Guard>,
        (lines, instruments): (Vec<LineEnds>, Vec<InstrumentEnds>),
        links: CycleLinks,
    ) -> Self {
        assert_eq!(lines.len(), wiring.lines.len(), "a line without its task");
        let interlocks = wiring.guarded();
        let lateness = Lateness::with(links.passage.clone());
        Self {
            image: Image::new(Arc::clone(&wiring)),
            outputs: Outputs::new(Arc::clone(&wiring)),
            traffic: Traffic::new(&wiring, lines),
            instruments: Instruments::new(&wiring, instruments),
            converter: Converter::new(pace),
            failures: Failures::new(&wiring),
            wiring,
            timer: Timer::new(pace),
            pace,
            inside: station.ledger().parts_to_find(),
            station,
            guard: guard.map(|it| it.with_interlocks(interlocks)),
            links,
            job_done: None,
            job_nest: NestId::FIRST,
            bus_alarms: Vec::new(),
            profile: Profile::default(),
            turned_at: RigTime(0),
            making_safe: false,
            pending_orders: Vec::new(),
            jogging: None,
            orders_closed: false,
            readings: Vec::new(),
            reader: None,
            verified: false,
            publish_at: RigTime(0),
            published_state: packml::State::Stopped,
            worst_age: Span(0),
            refused: None,
            refusals: publish::Refusals::default(),
            lost_status: None,
            lateness,
        }
    }

    /// Spawns [`Self::run`] on the runtime of `handle`, from this crate: see [`bus::spawn`].
    pub fn spawn(self, handle: &Handle) -> JoinHandle<Ended> {
        handle.spawn(self.run())
    }

    /// Verifies the modules, then takes one turn after another until the station has ended and the outputs are safe.
    pub async fn run(mut self) -> Ended {
        self.verify().await;
        if !self.verified && !self.station.is_attended() {
            for alarm in std::mem::take(&mut self.bus_alarms) {
                self.send(Event::Alarm(alarm, self.pace.now()));
            }
            return self.ended(Ending::Alarm);
        }
        self.verified = false;
        loop {
            let now = self.pace.now();
            let mut stopwatch = self.profile.turn();
            self.scan(now);
            stopwatch.lap(&mut self.profile.scan_s);
            let mut output = self.step(now);
            stopwatch.lap(&mut self.profile.step_s);
            self.clear(now, &mut output);
            stopwatch.lap(&mut self.profile.clear_s);
            self.apply(now, &mut output);
            stopwatch.lap(&mut self.profile.apply_s);
            self.answer(&mut output, now);
            self.pressed(&mut output, now);
            self.record(now, &mut output);
            stopwatch.skip();
            self.publish(now, output.record.ending.is_some());
            stopwatch.lap(&mut self.profile.publish_s);
            if output.rig.verify {
                self.verify().await;
            }
            if let Some(ending) = output.record.ending.take() {
                assert!(output.rig.safe, "the run ends with outputs on");
                let is_safe = self.make_safe().await;
                return self.ended(if is_safe { ending } else { Ending::Alarm });
            }
            if self.job_done.is_none() && output.rig.wake_at.is_none_or(|at| at > now) {
                self.wait(now, output.rig.wake_at).await;
            }
        }
    }

    fn ended(mut self, ending: Ending) -> Ended {
        self.answer_the_rest(self.pace.now());
        Ended {
            ending,
            profile: self.profile,
            lateness: self.lateness,
        }
    }

    /// Takes the answers of lines, instruments and converter, raises an alarm for each module that has restarted, and
    /// collects the readings of the code reader.
    fn scan(&mut self, now: RigTime) {
        assert!(now >= self.turned_at, "rig time ran backwards");
        self.turned_at = now;
        while let Some((line, purpose, answer)) = self.traffic.next_answer() {
            self.take(line, purpose, answer);
        }
        while let Some((instrument, purpose, answer)) = self.instruments.next_answer() {
            self.take_program(instrument, purpose, answer);
        }
        while let Some(finished) = self.converter.next_result() {
            self.take_finished(finished, now);
        }
        for module in self.image.take_resets() {
            let module = self.wiring.module(module);
            let detail = Message::new("detail", "restarted")
                .with("line", &self.wiring.line(module.line).name)
                .with("address", module.address)
                .with("module", &module.name);
            self.note_alarm(Alarm::bus(&detail));
        }
        while let Some(Ok(reading)) = self.links.readings.as_mut().map(mpsc::Receiver::try_recv) {
            self.take_reading(reading);
        }
        self.traffic.note_time(now);
    }

    fn take_reading(&mut self, reading: Reading) {
        match reading {
            Reading::Line(text) => self.readings.push(text),
            Reading::Open => self.reader = None,
            Reading::Lost(reason) => self.reader = Some(Alarm::serial_reader_lost(reason)),
        }
    }

    fn step(&mut self, now: RigTime) -> TurnOutput {
        if let Some(requested_at) = self.image.input_at(DigitalIn::EmergencyStopOk) {
            self.worst_age = self.worst_age.max(now.since(requested_at));
        }
        let orders = self.orders(now);
        self.making_safe = packml::is_aborted(self.station.outer());
        if self.making_safe {
            self.failures.reset_writes();
        }
        let inputs = Inputs {
            abort: self.links.abort.load(Ordering::Acquire),
            orders,
            settled: self.outputs.all_settled(),
            verified: std::mem::take(&mut self.verified),
            image: &self.image,
            job: self.job_done.take().map(|done| NestDone {
                nest: self.job_nest,
                done,
            }),
            recorded: self.links.recorded.load(Ordering::Acquire),
            history: self.links.history.borrow().clone(),
            bus: std::mem::take(&mut self.bus_alarms),
            host_late: self.lateness.explaining(&self.wiring),
            readings: std::mem::take(&mut self.readings),
            reader: self.reader.clone(),
            fleet: self.links.fleet.borrow().clone(),
            stop: self.links.stop.load(Ordering::Acquire),
        };
        self.station.step(now, inputs)
    }

    /// Passes the wanted motions through the guard one by one; drives each, or refuses it.
    fn clear(&mut self, now: RigTime, output: &mut TurnOutput) {
        let moves = !output.rig.motions.is_empty() || output.rig.jog.is_some();
        assert!(
            !(output.rig.safe && moves),
            "a motion while outputs go safe"
        );
        for movement in std::mem::take(&mut output.rig.motions) {
            match self.judge(movement, now) {
                Ok(cleared) => {
                    if let Err(cannot) = self.outputs.apply(cleared) {
                        self.station.refused(
                            movement,
                            &Message::detail("not_driven", cannot),
                            now,
                            output,
                        );
                        return;
                    }
                    self.station.driven(movement, now, &self.image);
                    self.refused = None;
                }
                Err(refused) => {
                    let (situation, refusal) = *refused;
                    self.refused = Some(self.refused_motion(movement, &situation, &refusal));
                    self.station
                        .refused(movement, &refusal.message(), now, output);
                    return;
                }
            }
        }
        if let Some(jog) = output.rig.jog {
            assert!(jog.answer < output.answers.len(), "a jog without its order");
            if let Err(refused) = self.jog(jog.movement, now) {
                output.answers[jog.answer] = Err(refused);
                output.rig.jog = None;
            }
        }
    }

    /// Turns outputs into commands, and hands the measuring job to the lines.
    fn apply(&mut self, now: RigTime, output: &mut TurnOutput) {
        if output.rig.safe {
            self.outputs.everything_safe();
            for module in self.traffic.drop_all() {
                self.outputs.confirmed(module);
            }
            self.instruments.make_safe(now);
            self.converter.forget();
        }
        for (point, on) in output.rig.outputs.drain(..) {
            self.set_output(point, on);
        }
        self.traffic.check_restarts(output.rig.restart_check);
        self.traffic.await_inputs(&output.rig.awaited, &self.wiring);
        self.traffic
            .watch_beam(output.rig.beam.map(|beam| self.wiring.read_events(beam)));
        let is_job = output.rig.job.is_some();
        if let Some(NestJob { nest, job }) = output.rig.job.take() {
            assert!(!output.rig.safe, "a job begins while outputs go safe");
            assert!(self.job_done.is_none(), "the last answer is still pending");
            self.job_nest = nest;
            self.start(job);
        }
        for write in self.outputs.writes() {
            let again = self.traffic.is_rewrite_for_job(write.module);
            let job = again || (is_job && self.is_measuring(write.line));
            self.traffic.queue(
                write.line,
                write.command,
                Purpose::Write {
                    module: write.module,
                    job,
                },
            );
        }
        if is_job && let Some(done) = self.traffic.job_if_empty(now) {
            self.job_done = Some(done);
        }
        self.traffic.dispatch(now);
        self.instruments.dispatch(now, self.outputs.all_settled());
    }

    fn set_output(&mut self, point: impl Into<DigitalOutput>, on: bool) {
        if let Err(needs) = self.outputs.set(point, on) {
            self.note_alarm(Alarm::bus(&Message::detail("not_driven", needs)));
        }
    }

    fn is_measuring(&self, line: LineId) -> bool {
        self.traffic.measuring_lines().contains(&line)
    }

    /// Returns the first instant at which the last poll of the emergency-stop contact is too old; `None` if it is too
    /// old already.
    fn contact_unknown(&self, now: RigTime) -> Option<RigTime> {
        let until = self.image.emergency_stop_known_until()?;
        (until >= now).then_some(until + Span(1))
    }

    /// Waits for an answer, an order or a code reading, at most until `wake_at`, the next scan or heartbeat, or the
    /// instant at which the last poll of the emergency-stop contact is too old.
    async fn wait(&mut self, now: RigTime, wake_at: Option<RigTime>) {
        assert!(wake_at.is_none_or(|at| at > now), "a deadline in the past");
        let until = wake_at
            .unwrap_or(now + IDLE)
            .min(self.traffic.next_due(now).unwrap_or(now + IDLE))
            .min(self.instruments.next_due(now).unwrap_or(now + IDLE))
            .min(self.contact_unknown(now).unwrap_or(now + IDLE));
        tokio::select! {
            biased;
            () = self.traffic.answer() => {}
            () = self.instruments.answer() => {}
            () = self.converter.result() => {}
            asked = self.links.orders.recv(), if !self.orders_closed => {
                self.orders_closed = asked.is_none();
                self.pending_orders.extend(asked);
            }
            Some(reading) = next_reading(&mut self.links.readings) => self.take_reading(reading),
            () = self.timer.until(until) => {}
        }
        self.lateness.count(until, self.pace.now());
    }
}

/// Returns the next reading of the code reader; never resolves in a lot without one.
async fn next_reading(readings: &mut Option<mpsc::Receiver<Reading>>) -> Option<Reading> {
    match readings {
        Some(readings) => readings.recv().await,
        None => std::future::pending().await,
    }
}

#[cfg(test)]
mod tests;
