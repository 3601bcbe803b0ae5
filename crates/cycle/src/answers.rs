//! Takes the answers of the lines: values go into the process image, trouble becomes an alarm of the next step.

use super::Cycle;
use super::traffic::Purpose;
use bus::{Answer, LineError};
use dcon::Command;
use machine::rig::wiring::LineId;
use machine::station::trouble::Alarm;
use units::{RigTime, Span};

/// Share of the allowance for a late reply from which on the lateness of this computer explains a missing one.
const EXPLAINS: f64 = 0.5;

impl Cycle {
    /// Stores an answer in the process image, and notes the trouble that it shows.
    pub(super) fn take(&mut self, line: LineId, purpose: Purpose, answer: Answer) {
        assert!(
            answer.answered_at >= answer.requested_at,
            "an answer precedes its request"
        );
        // Reading the reset status clears it, so the read cannot be repeated: when its reply is lost, the
        // module may have restarted while it measured the part, and the part is void.
        let is_status = matches!(
            answer.command,
            Command::Common(_, dcon::Common::ReadResetStatus)
        );
        let trouble = match &answer.outcome {
            Ok(reply) => self
                .image
                .accept(
                    line,
                    &answer.command,
                    reply,
                    &answer.raw,
                    answer.requested_at,
                )
                .err()
                .map(|unexpected| format!("line {}: {unexpected}", self.wiring.line(line).name)),
            Err(error) => Some(format!(
                "{error} ({} of {} tries)",
                answer.tries_used,
                self.traffic.tries(line)
            )),
        };
        let refused =
            matches!(&answer.outcome, Err(LineError::Reply { reason, .. }) if reason.is_answer());
        match (purpose, trouble) {
            (Purpose::Write { module, job }, None) => {
                self.outputs.confirmed(module);
                self.timeouts.written(module);
                self.finish_job(job, answer.answered_at, None);
            }
            // A module that refuses writes has a tripped host watchdog: its outputs are at their safe values.
            (Purpose::Write { module, .. }, Some(_)) if self.making_safe && refused => {
                self.outputs.confirmed(module);
            }
            (Purpose::Write { module, job }, Some(trouble)) => {
                if self.timeouts.may_rewrite(module) {
                    self.outputs.failed(module);
                    if job {
                        self.traffic.rewrite_for_job(module);
                    }
                } else {
                    self.finish_job(job, answer.answered_at, Some(trouble.clone()));
                    self.note_line_trouble(&answer, &trouble);
                }
            }
            (Purpose::Job, trouble) => {
                let trouble = match is_status {
                    true => trouble.or(self.lost_status.take()),
                    false => trouble,
                };
                if let Some(trouble) = trouble.as_ref().filter(|_| !refused && !is_status) {
                    self.note_line_trouble(&answer, trouble);
                }
                self.finish_job(true, answer.answered_at, trouble);
            }
            (Purpose::Scan, Some(trouble)) => {
                if is_status && self.is_measuring(line) {
                    self.lost_status = Some(trouble.clone());
                }
                if let Some(times) = self.timeouts.scan_failed(line, &answer.command) {
                    self.note_line_trouble(&answer, &format!("{trouble}, {times} times in a row"));
                }
            }
            (Purpose::Scan, None) => self.timeouts.scan_answered(line, &answer.command),
            (Purpose::Check, Some(trouble)) => {
                self.note_line_trouble(&answer, &trouble);
            }
            (Purpose::Check | Purpose::Heartbeat, _) => {}
        }
    }

    fn finish_job(&mut self, is_job: bool, at: RigTime, trouble: Option<String>) {
        if is_job && let Some(done) = self.traffic.job_part_done(at, trouble) {
            self.job_done = Some(done);
        }
    }

    /// Keeps the first bus trouble of the turn; the station learns it in its next step.
    pub(super) fn note_bus_trouble(&mut self, detail: &str) {
        self.bus_alarm.get_or_insert_with(|| Alarm::bus(detail));
    }

    /// Keeps trouble with an answer as [`Cycle::note_bus_trouble`] does, or as lateness of this computer when that
    /// explains a missing reply.
    fn note_line_trouble(&mut self, answer: &Answer, detail: &str) {
        let is_missing = matches!(answer.outcome, Err(LineError::TimeOut { .. }));
        match self.host_late().filter(|_| is_missing) {
            Some(late) => {
                let alarm = || Alarm::host_late(detail, late);
                self.bus_alarm.get_or_insert_with(alarm);
            }
            None => self.note_bus_trouble(detail),
        }
    }

    /// Returns the lateness of this computer in the last seconds when it takes half of what a reply may be late, or more.
    pub(super) fn host_late(&self) -> Option<Span> {
        let allowed_ms = self.wiring.bus.digital_allowance_ms;
        let recent = self.lateness.recent();
        (recent.as_seconds() * 1e3 >= EXPLAINS * allowed_ms).then_some(recent)
    }
}
