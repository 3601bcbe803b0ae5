//! Time during which the history cannot be written: when to try again, and when to give up.

use crate::controls::Controls;
use bus::Pace;
use cycle::alarm_line;
use history::HistoryError;
use machine::station::annunciator::Annunciator;
use machine::station::trouble::Alarm;
use std::path::Path;
use std::time::Instant;
use units::{RigTime, Span};

/// Time between two attempts to write the history.
const RETRY: Span = Span::ms(1000);

/// An outage of the history.
#[derive(Debug)]
pub(super) struct Outage {
    began: RigTime,
    /// Start by the wall clock, because virtual time stands still while an attempt waits for a lock.
    began_wall: Instant,
    retry_at: RigTime,
}

impl Outage {
    /// Notes a failed attempt at `now`; the first one begins the outage.
    pub fn note(outage: &mut Option<Self>, now: RigTime) -> &Self {
        let outage = outage.get_or_insert_with(|| Self {
            began: now,
            began_wall: Instant::now(),
            retry_at: now,
        });
        assert!(now >= outage.began, "a try before the outage");
        outage.retry_at = now + RETRY;
        outage
    }

    /// Returns the time of the next attempt.
    pub fn retry_at(&self) -> RigTime {
        self.retry_at
    }

    /// Returns true once the outage has lasted for `give_up_s`, by the clock of the rig or of the wall.
    pub fn is_too_long(&self, now: RigTime, give_up_s: f64) -> bool {
        let rig_s = now.since(self.began).as_seconds();
        rig_s >= give_up_s || self.began_wall.elapsed().as_secs_f64() >= give_up_s
    }
}

/// Repeats failed writes of the history while no cycle runs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HistoryRetry<'a> {
    /// History file.
    pub db: &'a Path,
    /// Stop flags and view that the program shares with screens.
    pub controls: &'a Controls,
    /// Clock of the rig.
    pub pace: Pace,
    /// Longest outage before the run gives up, s.
    pub give_up_s: f64,
}

impl HistoryRetry<'_> {
    /// Repeats `write` until the history can be written, and shows the alarm on the page meanwhile.
    ///
    /// # Errors
    /// Fails at once with an error that does not come from the history. Fails with the error of the history after a
    /// stop, and when the outage is too long.
    pub async fn until_written<T>(
        &self,
        mut write: impl AsyncFnMut() -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        let mut outage: Option<Outage> = None;
        loop {
            let error = match write().await {
                Ok(done) => {
                    if outage.is_some() {
                        self.controls.view.send_modify(|view| view.alarms.clear());
                    }
                    return Ok(done);
                }
                Err(error) => error,
            };
            let now = self.pace.now();
            let outage = Outage::note(&mut outage, now);
            let over = outage.is_too_long(now, self.give_up_s) || self.controls.is_stopping();
            if over || !error.is::<HistoryError>() {
                return Err(error);
            }
            tracing::warn!("history: {error:#}; trying again");
            self.show(&history_lost(self.db, &error));
            self.pace.sleep_until(outage.retry_at()).await;
        }
    }

    fn show(&self, alarm: &Alarm) {
        let mut list = Annunciator::default();
        list.raise(alarm, RigTime(0));
        let now_us = jiff::Timestamp::now().as_microsecond();
        let lines = list.listed().iter().map(|it| alarm_line(it, now_us));
        let lines = lines.collect();
        self.controls.view.send_modify(|view| view.alarms = lines);
    }
}

/// Returns the alarm of a history that cannot be written.
pub(super) fn history_lost(db: &Path, error: &anyhow::Error) -> Alarm {
    let refusal = error
        .downcast_ref::<HistoryError>()
        .map_or("history_failed", HistoryError::refusal);
    Alarm::history_lost(&db.display().to_string(), refusal, &format!("{error:#}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outage_is_tried_every_second_until_too_long() {
        let mut outage = None;
        let first = Outage::note(&mut outage, RigTime(5_000_000));
        assert_eq!(first.retry_at(), RigTime(6_000_000));
        assert!(!first.is_too_long(RigTime(6_000_000), 2.0));
        assert!(first.is_too_long(RigTime(5_000_000), 0.0));
        let second = Outage::note(&mut outage, RigTime(6_000_000));
        assert_eq!(second.retry_at(), RigTime(7_000_000));
        assert!(second.is_too_long(RigTime(7_000_000), 2.0));
    }
}
