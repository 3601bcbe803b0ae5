//! Queries of the measuring job on SCPI instruments; the instruments at the start and at the end of a run.

use super::instruments::{OpenQuery, Purpose};
use super::{Cycle, Event};
use bus::instrument::{ProgramAnswer, message};
use machine::instrument::query::{Delivered, Instrument, Query};
use machine::station::trouble::Alarm;
use scpi::Failure;
use std::sync::atomic::Ordering;
use texts::Message;
use units::{RigTime, Span};

/// Longest time for opening, identifying and setting up all instruments before a run.
const PREPARE_WITHIN: Span = Span::ms(30_000);
/// Longest time for the safe programs of all instruments at the end of a run.
const SAFE_WITHIN: Span = Span::ms(5_000);
/// Longest pause between two looks at the links while the cycle waits for instruments.
const LOOK: Span = Span::ms(50);

impl Cycle {
    /// Queues the programs of a job; one that a profile does not have makes the job fail before any program starts.
    pub(super) fn start_queries(&mut self, queries: &[Query]) {
        let programs: Result<Vec<_>, Message> = queries.iter().map(|it| self.program(it)).collect();
        match programs {
            Err(refused) => self.traffic.fail_job(refused),
            Ok(programs) => {
                for (at, (query, program)) in queries.iter().zip(programs).enumerate() {
                    self.traffic.query_begun();
                    let name = query.program;
                    let open = OpenQuery { at, name, program };
                    self.instruments.queue(query.instrument, open);
                }
            }
        }
    }

    fn program(&self, query: &Query) -> Result<scpi::Program, Message> {
        let profile = &self.wiring.instrument(query.instrument).profile;
        let program = profile.program(query.program, &query.arguments);
        program.map_err(|error| self.refused_query(query.instrument, query.program, &error))
    }

    fn refused_query(
        &self,
        instrument: Instrument,
        program: &str,
        why: &dyn std::error::Error,
    ) -> Message {
        Message::detail("query_refused", why)
            .with("instrument", &self.wiring.instrument(instrument).name)
            .with("program", program)
    }

    /// Takes the end of a program of an instrument.
    pub(super) fn take_program(
        &mut self,
        instrument: Instrument,
        purpose: Purpose,
        answer: ProgramAnswer,
    ) {
        assert!(
            answer.answered_at <= self.pace.now(),
            "a program ends in the future"
        );
        match purpose {
            Purpose::Prepare => self.prepared(instrument, answer),
            Purpose::Query(at, program) => {
                let ended_at = answer.answered_at;
                match self.delivered(instrument, program, answer) {
                    Ok(delivered) => self.query_done(at, ended_at, Ok(delivered)),
                    Err(trouble) => {
                        let rest = self.instruments.drop_queue(instrument);
                        for at in std::iter::once(at).chain(rest) {
                            self.query_done(at, ended_at, Err(trouble.clone()));
                        }
                    }
                }
            }
            Purpose::Safe => {
                let is_safe = answer.outcome.is_ok();
                let now = answer.answered_at;
                if self.instruments.made_safe(instrument, is_safe, now) {
                    let name = &self.wiring.instrument(instrument).name;
                    self.note_alarm(Alarm::instrument_not_safe(name));
                }
            }
            Purpose::Dropped => {}
        }
    }

    fn query_done(&mut self, at: usize, now: RigTime, result: Result<Delivered, Message>) {
        if let Some(done) = self.traffic.query_done(at, now, result) {
            self.job_done = Some(done);
        }
    }

    /// Returns what a program has delivered, or the reason why a part is void. An instrument that is lost, or that fails
    /// as often in a row as a module may, raises an alarm too.
    fn delivered(
        &mut self,
        instrument: Instrument,
        program: &'static str,
        answer: ProgramAnswer,
    ) -> Result<Delivered, Message> {
        let wired = self.wiring.instrument(instrument);
        let failure = match answer.outcome {
            Ok(replies) => {
                self.instruments.succeeded(instrument);
                return Delivered::of(wired.profile.dialect, &replies)
                    .map_err(|error| self.refused_query(instrument, program, &error));
            }
            Err(failure) => failure,
        };
        let trouble = Message::new("detail", "query_failed")
            .with("instrument", &wired.name)
            .with("program", program)
            .with_inner("failure", &message(&failure));
        if failure.is_doubt() {
            let times = self.instruments.failed(instrument);
            if is_lost(&failure) || times >= self.wiring.bus.tries {
                let name = &self.wiring.instrument(instrument).name;
                self.note_alarm(Alarm::instrument(name, &trouble));
            }
        }
        Err(trouble)
    }

    fn prepared(&mut self, instrument: Instrument, answer: ProgramAnswer) {
        let failure = match answer.outcome {
            Ok(_) => return self.instruments.prepared(instrument, true, false),
            // It was switched on since its last program; now it has its set-up.
            Err(Failure::PowerCycled) => {
                return self.instruments.prepared(instrument, false, true);
            }
            Err(failure) => failure,
        };
        self.instruments.prepared(instrument, false, false);
        let name = &self.wiring.instrument(instrument).name;
        let detail = Message::new("detail", "instrument_not_ready")
            .with("instrument", name)
            .with_inner("failure", &message(&failure));
        self.note_alarm(Alarm::instrument(name, &detail));
    }

    /// Opens, identifies and sets up every instrument; notes an alarm for each that fails or is late. Returns true when
    /// all are ready, and after an order to abort, because the station then ends the run before anything moves.
    pub(super) async fn prepare_instruments(&mut self) -> bool {
        self.instruments.prepare_all();
        let end = self.pace.now() + PREPARE_WITHIN;
        while !self.instruments.is_quiet() {
            let now = self.pace.now();
            if self.links.abort.load(Ordering::Acquire) {
                self.instruments.end_preparation();
                return true;
            }
            if now >= end {
                self.note_late_instruments();
                break;
            }
            self.attend_instruments(now, false).await;
        }
        self.instruments.end_preparation().is_empty()
    }

    fn note_late_instruments(&mut self) {
        for instrument in self.instruments.end_preparation() {
            let name = &self.wiring.instrument(instrument).name;
            let detail = Message::new("detail", "instrument_silent")
                .with("instrument", name)
                .with("limit_ms", PREPARE_WITHIN.0 / 1000);
            self.note_alarm(Alarm::instrument(name, &detail));
        }
    }

    /// Makes the instruments safe at the end of a run; sends an alarm for each that has not confirmed it in time.
    pub(super) async fn make_instruments_safe(&mut self) {
        let began = self.pace.now();
        let end = began + SAFE_WITHIN;
        self.instruments.make_safe(began);
        while !self.instruments.is_quiet() && self.pace.now() < end {
            self.attend_instruments(self.pace.now(), true).await;
        }
        let left: Vec<Instrument> = self.instruments.may_be_on().collect();
        for instrument in left {
            let name = &self.wiring.instrument(instrument).name;
            let alarm = Alarm::instrument_not_safe(name);
            self.send(Event::Alarm(alarm, self.pace.now()));
        }
    }

    /// Keeps lines and instruments going until the next answer, at most for [`LOOK`].
    async fn attend_instruments(&mut self, now: RigTime, settled: bool) {
        self.scan(now);
        self.traffic.dispatch(now);
        self.instruments.dispatch(now, settled);
        if !self.instruments.is_quiet() {
            self.wait(now, Some(now + LOOK)).await;
        }
    }
}

/// Returns true for a failure that only a person can end.
fn is_lost(failure: &Failure) -> bool {
    match failure {
        Failure::Down { .. }
        | Failure::Identity { .. }
        | Failure::AdapterAddress { .. }
        | Failure::Local { .. } => true,
        Failure::Timeout { .. }
        | Failure::Disconnected { .. }
        | Failure::Malformed { .. }
        | Failure::Instrument { .. }
        | Failure::QueueOverflow
        | Failure::OverRange { .. }
        | Failure::NotANumber { .. }
        | Failure::PowerCycled
        | Failure::OutOfStep { .. }
        | Failure::ReadBack { .. }
        | Failure::NeverSilent
        | Failure::Overdue { .. } => false,
    }
}
