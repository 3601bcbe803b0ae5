//! Verifies modules and instruments before any motion; makes outputs, then instruments, safe at the end of a run.

use super::traffic::Purpose;
use super::{Cycle, Event, IDLE, commission};
use machine::station::catalogue::AlarmCode;
use units::Span;

/// Longest time for writing the safe outputs at the end of a run.
const SAFE_WITHIN: Span = Span::ms(2000);

impl Cycle {
    /// Compares every module with the wiring; restores the settings that an interrupted run has left changed in a
    /// module; prepares the instruments.
    pub(super) async fn verify(&mut self) {
        self.quiet().await;
        assert!(self.traffic.is_quiet(), "verified while a line is in use");
        let mut verification = commission::Verification {
            wiring: &self.wiring,
            pace: &self.pace,
            traffic: &mut self.traffic,
            timer: &mut self.timer,
            lateness: &mut self.lateness,
        };
        match verification.run().await {
            Ok(restored) => {
                restored.into_iter().for_each(|it| self.note_alarm(it));
                self.verified = self.prepare_instruments().await;
            }
            Err(alarm) => {
                self.note_alarm(alarm);
                self.traffic.start_scan();
            }
        }
        self.image.take_resets();
        self.lost_status = None;
        self.outputs.everything_safe();
    }

    /// Stops the scan, and waits until no transaction is queued or under way.
    async fn quiet(&mut self) {
        self.traffic.only_writes();
        while !self.traffic.is_quiet() {
            let now = self.pace.now();
            self.failures.reset_writes();
            self.scan(now);
            self.traffic.dispatch(now);
            self.wait(now, Some(now + IDLE)).await;
        }
    }

    /// Makes the outputs of the modules safe, then the instruments. Returns true when every instrument has confirmed.
    pub(super) async fn make_safe(&mut self) -> bool {
        self.write_safe_outputs().await;
        self.make_instruments_safe().await
    }

    /// Writes the safe outputs and waits until every module has confirmed, or the time is up.
    async fn write_safe_outputs(&mut self) {
        let end = self.pace.now() + SAFE_WITHIN;
        self.traffic.only_writes();
        self.making_safe = true;
        while self.pace.now() < end {
            let now = self.pace.now();
            self.failures.reset_writes();
            self.scan(now);
            for write in self.outputs.writes() {
                let purpose = Purpose::Write {
                    module: write.module,
                    job: false,
                };
                self.traffic.queue(write.line, write.command, purpose);
            }
            self.traffic.dispatch(now);
            if self.traffic.is_quiet() {
                return;
            }
            self.wait(now, Some(end)).await;
        }
        self.send(Event::Alarm(
            AlarmCode::OutputsNotConfirmed.into(),
            self.pace.now(),
        ));
    }
}
