//! Takes the answers of the lines: stores their values in the process image, and turns trouble into alarms that the
//! station receives in its next step.

use super::Cycle;
use super::traffic::Purpose;
use bus::{Answer, Failure, LineError};
use dcon::Command;
use machine::rig::wiring::LineId;
use machine::station::trouble::Alarm;
use texts::Message;
use units::{RigTime, Span};

/// Trouble that an answer shows.
pub(super) struct AnswerTrouble {
    /// Message of family `transaction`.
    transaction: Message,
    /// Number of tries made.
    used: u8,
    /// Largest number of tries that the line makes.
    tries: u8,
    /// Lateness of this computer, when it explains why a reply is missing.
    late: Option<Span>,
}

impl AnswerTrouble {
    /// Returns the trouble of a failed transaction; `late` is the lateness of this computer, given only if it is long
    /// enough to explain a missing reply.
    pub(super) fn of(error: &LineError, used: u8, tries: u8, late: Option<Span>) -> Self {
        Self {
            transaction: error.message(),
            used,
            tries,
            late: late.filter(|_| comes_of_lateness(&error.failure)),
        }
    }

    fn detail(&self, code: &'static str) -> Message {
        Message::new("detail", code)
            .with_inner("transaction", &self.transaction)
            .with("used", self.used)
            .with("tries", self.tries)
    }

    fn alarm_with(&self, detail: &Message) -> Alarm {
        match self.late {
            Some(late) => Alarm::host_late(detail, late),
            None => Alarm::bus(detail),
        }
    }

    pub(super) fn alarm(&self) -> Alarm {
        self.alarm_with(&self.detail("tried"))
    }

    /// Returns the alarm for this trouble after `times` consecutive failures.
    fn repeated(&self, times: u8) -> Alarm {
        assert!(times > 0, "a failure that was not counted");
        self.alarm_with(&self.detail("tried_in_a_row").with("times", times))
    }

    /// Returns the reason why the job that needs the answer fails, and thus why a part is void or a reference part
    /// repeated.
    fn reason(&self) -> Message {
        match self.late {
            Some(late) => self
                .detail("tried_while_late")
                .with("late_ms", format!("{:.0}", late.as_seconds() * 1e3)),
            None => self.detail("tried"),
        }
    }
}

impl Cycle {
    /// Stores an answer in the process image, and notes the trouble that it shows.
    pub(super) fn take(&mut self, line: LineId, purpose: Purpose, answer: Answer) {
        assert!(
            answer.answered_at >= answer.requested_at,
            "an answer precedes its request"
        );
        // Reading the reset status clears it, so nothing can repeat the read: when its reply is lost, the module may
        // have restarted unnoticed while it measured the part, and the part is void.
        let is_status = matches!(
            answer.command,
            Command::Common(_, dcon::Common::ReadResetStatus)
        );
        let trouble = self.trouble_of(line, &answer);
        let failure = answer.outcome.as_ref().err().map(|error| &error.failure);
        let refused = failure.is_some_and(Failure::is_answer);
        match (purpose, trouble) {
            (Purpose::Write { module, job }, None) => {
                self.outputs.confirmed(module);
                self.failures.written(module);
                self.finish_job(job, answer.answered_at, None);
            }
            // A module that refuses writes has a tripped host watchdog: its outputs are at their safe values.
            (Purpose::Write { module, .. }, Some(_)) if self.making_safe && refused => {
                self.outputs.confirmed(module);
            }
            (Purpose::Write { module, job }, Some(trouble)) => {
                if self.failures.may_rewrite(module) {
                    self.outputs.failed(module);
                    if job {
                        self.traffic.rewrite_for_job(module);
                    }
                } else {
                    self.finish_job(job, answer.answered_at, Some(trouble.reason()));
                    self.note_alarm(trouble.alarm());
                }
            }
            (Purpose::Job, trouble) => {
                if let Some(trouble) = trouble.as_ref().filter(|_| !refused && !is_status) {
                    self.note_alarm(trouble.alarm());
                }
                let earlier = self.lost_status.take_if(|_| is_status);
                let reason = trouble.map(|it| it.reason()).or(earlier);
                self.finish_job(true, answer.answered_at, reason);
            }
            (Purpose::Scan, Some(trouble)) => {
                if is_status && self.is_measuring(line) {
                    self.lost_status = Some(trouble.reason());
                }
                if let Some(times) = self.failures.scan_failed(line, &answer.command) {
                    self.note_alarm(trouble.repeated(times));
                }
            }
            (Purpose::Scan, None) => self.failures.scan_answered(line, &answer.command),
            (Purpose::Check, Some(trouble)) => self.note_alarm(trouble.alarm()),
            (Purpose::Check | Purpose::Heartbeat, _) => {}
        }
    }

    fn finish_job(&mut self, is_job: bool, at: RigTime, trouble: Option<Message>) {
        if is_job && let Some(done) = self.traffic.job_part_done(at, trouble) {
            self.job_done = Some(done);
        }
    }

    /// Takes a reply into the image; returns the trouble when the transaction failed or the reply does not fit the rig.
    fn trouble_of(&mut self, line: LineId, answer: &Answer) -> Option<AnswerTrouble> {
        let (used, tries) = (answer.tries_used, self.traffic.tries(line));
        match &answer.outcome {
            Ok(reply) => {
                let (at, command) = (answer.requested_at, &answer.command);
                let accepted = self.image.accept(line, command, reply, &answer.raw, at);
                let transaction = Message::new("transaction", "foreign_reply")
                    .with("said", accepted.err()?)
                    .with("line", &self.wiring.line(line).name);
                Some(AnswerTrouble {
                    transaction,
                    used,
                    tries,
                    late: None,
                })
            }
            Err(error) => {
                let late = self.lateness.explaining(&self.wiring);
                Some(AnswerTrouble::of(error, used, tries, late))
            }
        }
    }

    /// Keeps an alarm of a line or module for the next step of the station; drops it if the same alarm waits already.
    pub(super) fn note_alarm(&mut self, alarm: Alarm) {
        if !self.bus_alarms.iter().any(|it| it.is_same(&alarm)) {
            self.bus_alarms.push(alarm);
        }
    }
}

/// Returns true for a failure that lateness of this computer can cause: a reply that it misses, or one that it reads
/// only after the next request.
fn comes_of_lateness(failure: &Failure) -> bool {
    match failure {
        Failure::TimeOut(_) | Failure::OutOfStep | Failure::SecondReply => true,
        Failure::Reply(_)
        | Failure::Echo
        | Failure::Contradicted
        | Failure::NeverSilent
        | Failure::PortLost(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use machine::station::catalogue::AlarmCode;
    use texts::Lang;

    #[test]
    fn lateness_explains_late_replies_and_no_echo() {
        assert!(comes_of_lateness(&Failure::SecondReply));
        assert!(!comes_of_lateness(&Failure::Echo));
    }

    #[test]
    fn lateness_explains_a_missing_reply() {
        let error = LineError {
            line: "measure".to_owned(),
            command: dcon::Common::ReadResetStatus.to(dcon::Address(1)),
            failure: Failure::TimeOut(Span::ms(31)),
        };
        let trouble = |late| AnswerTrouble::of(&error, 3, 3, late);
        let (late, in_time) = (trouble(Some(Span::ms(45))), trouble(None));
        let codes = [late.alarm().code, in_time.alarm().code];
        assert_eq!(codes, [AlarmCode::HostLate, AlarmCode::BusTrouble]);
        let said = |it: &AnswerTrouble, lang| it.reason().say(lang);
        assert!(said(&late, Lang::En).ends_with("; this computer was 45 ms late"));
        assert!(said(&late, Lang::Zh).ends_with("本机迟了 45 毫秒"));
        assert!(said(&in_time, Lang::En).ends_with("no whole reply within 31 ms (3 of 3 tries)"));
        let taken = LineError {
            failure: Failure::PortLost(bus::PortError::Taken {
                path: "/dev/ttyUSB0".to_owned(),
            }),
            ..error.clone()
        };
        let taken = AnswerTrouble::of(&taken, 1, 3, Some(Span::ms(45))).alarm();
        assert!(
            taken
                .text(Lang::En)
                .ends_with("(1 of 3 tries). End the other program.")
        );
        assert!(taken.text(Lang::Zh).contains("端口被另一程序占用"));
        let repeated = in_time.repeated(3);
        assert!(repeated.text(Lang::Zh).contains("连续 3 次"));
    }
}
