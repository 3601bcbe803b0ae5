//! Queries of the measuring job on SCPI instruments; the instruments at the start and at the end of a run.

use super::converter::Finished;
use super::instruments::{Deliverer, OpenQuery, Part, Purpose};
use super::{Cycle, Event};
use bus::instrument::{ProgramAnswer, message};
use machine::instrument::query::{Delivered, Instrument, Query};
use machine::station::trouble::Alarm;
use scpi::{Failure, Reply};
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
    /// Queues the programs of a job, those of one instrument in one run. A program that a profile lacks makes the job
    /// fail before any program starts.
    pub(super) fn start_queries(&mut self, queries: &[Query]) {
        let programs: Result<Vec<_>, Message> = queries.iter().map(|it| self.program(it)).collect();
        match programs {
            Err(refused) => self.traffic.fail_job(refused),
            Ok(programs) => {
                let mut all: Vec<(Instrument, OpenQuery)> = Vec::new();
                for (at, (query, program)) in queries.iter().zip(programs).enumerate() {
                    self.traffic.query_begun();
                    let open = OpenQuery::new(at, query.program, program);
                    match all.iter_mut().find(|it| it.0 == query.instrument) {
                        Some((_, earlier)) => earlier.append(open),
                        None => all.push((query.instrument, open)),
                    }
                }
                for (instrument, open) in all {
                    self.instruments.queue(instrument, open);
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

    /// Takes the result of a program that an instrument has ended.
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
            Purpose::Query => self.take_queries(instrument, answer),
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

    /// Gives each query of a program its replies. After a failure no query has values.
    fn take_queries(&mut self, instrument: Instrument, answer: ProgramAnswer) {
        let parts = self.instruments.take_parts(instrument);
        assert!(!parts.is_empty(), "a program of the job without a query");
        let ended_at = answer.answered_at;
        let deliverer = |part: &Part| Deliverer {
            instrument,
            at: part.at,
            program: part.name,
            ended_at,
        };
        match answer.outcome {
            Ok(mut replies) => {
                let wanted: usize = parts.iter().map(|it| it.values).sum();
                assert_eq!(replies.len(), wanted, "a value for each query");
                for part in &parts {
                    self.instruments.succeeded(instrument, part.name);
                    let rest = replies.split_off(part.values);
                    self.decode(deliverer(part), std::mem::replace(&mut replies, rest));
                }
            }
            Err(failure) => {
                let trouble = self.failed(instrument, parts[0].name, &failure);
                for part in &parts {
                    self.deliver(deliverer(part), Err(trouble.clone()));
                }
            }
        }
    }

    /// Makes values of the replies to a query; the converter does it for replies with a block, which may be long.
    fn decode(&mut self, query: Deliverer, replies: Vec<Reply>) {
        let dialect = self.wiring.instrument(query.instrument).profile.dialect;
        let has_block = replies.iter().any(|it| matches!(it, Reply::Block(_)));
        let decode = move || Finished::Decoded(query, Delivered::of(dialect, &replies));
        match has_block {
            true => self.converter.begin(decode),
            false => self.take_finished(decode(), query.ended_at),
        }
    }

    /// Takes the result of a calculation.
    pub(super) fn take_finished(&mut self, finished: Finished, now: RigTime) {
        match finished {
            Finished::Converted(converted) => {
                let done = self.traffic.conversion_done(now, converted);
                self.job_done = done.or(self.job_done.take());
            }
            Finished::Decoded(query, result) => {
                let result = result
                    .map_err(|error| self.refused_query(query.instrument, query.program, &error));
                self.deliver(query, result);
            }
        }
    }

    /// Closes a query; after a failure also those that wait behind it.
    fn deliver(&mut self, query: Deliverer, result: Result<Delivered, Message>) {
        let rest = match &result {
            Ok(_) => Vec::new(),
            Err(_) => self.instruments.drop_queue(query.instrument),
        };
        let trouble = result.as_ref().err().cloned();
        assert!(
            query.ended_at <= self.pace.now(),
            "a query ends in the future"
        );
        self.query_done(query.at, query.ended_at, result);
        for (at, trouble) in rest.into_iter().zip(trouble.into_iter().cycle()) {
            self.query_done(at, query.ended_at, Err(trouble));
        }
    }

    fn query_done(&mut self, at: usize, now: RigTime, result: Result<Delivered, Message>) {
        if let Some(done) = self.traffic.query_done(at, now, result) {
            self.job_done = Some(done);
        }
    }

    /// Returns the reason why the part is void. Raises an alarm too when the instrument is lost, or when one of its
    /// programs has failed as often in a row as a module may.
    fn failed(
        &mut self,
        instrument: Instrument,
        program: &'static str,
        failure: &Failure,
    ) -> Message {
        let name = self.wiring.instrument(instrument).name.clone();
        let trouble = Message::new("detail", "query_failed")
            .with("instrument", &name)
            .with("program", program)
            .with_inner("failure", &message(failure));
        if !may_be_the_part(failure) {
            let times = self.instruments.failed(instrument, program);
            if is_lost(failure) || times >= self.wiring.bus.tries {
                self.note_alarm(Alarm::instrument(&name, &trouble));
            }
        }
        trouble
    }

    fn prepared(&mut self, instrument: Instrument, answer: ProgramAnswer) {
        let failure = match answer.outcome {
            Ok(_) => return self.instruments.prepared(instrument, true, false),
            // The instrument was switched on since its last program; now it has its set-up.
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
            // The watchdog of the service and the screens see that the program lives.
            self.publish(now, false);
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
    /// Returns true when all have.
    pub(super) async fn make_instruments_safe(&mut self) -> bool {
        let began = self.pace.now();
        let end = began + SAFE_WITHIN;
        self.instruments.make_safe(began);
        while !self.instruments.is_quiet() && self.pace.now() < end {
            self.attend_instruments(self.pace.now(), true).await;
        }
        let left: Vec<Instrument> = self.instruments.may_be_on().collect();
        for instrument in &left {
            let name = &self.wiring.instrument(*instrument).name;
            let alarm = Alarm::instrument_not_safe(name);
            self.send(Event::Alarm(alarm, self.pace.now()));
        }
        left.is_empty()
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

/// Returns true for a failure that a bad part can cause on an instrument without fault.
const fn may_be_the_part(failure: &Failure) -> bool {
    matches!(
        failure,
        Failure::OverRange { .. } | Failure::NotANumber { .. }
    )
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
