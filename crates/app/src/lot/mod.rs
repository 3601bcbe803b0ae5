//! Runs a lot: one stream of events goes to several subscribers.
//!
//! | subscriber | does |
//! |---|---|
//! | `recorder` (with `journal`, `rows`) | writes the history, before the sorter may release a part |
//! | `screen` | shows the run on the page |
//! | the caller's | shows a progress bar, prints rows on stdout, plays a script, or keeps a calibration |
//!
//! The cycle sends events; `progress` takes each event into account first, then every subscriber receives the event
//! together with the progress.

mod assemble;
mod context;
mod counts;
mod event;
mod journal;
mod outage;
mod prior_state;
mod progress;
mod recorder;
mod rows;
mod screen;
mod summary;
#[cfg(all(test, feature = "sim"))]
mod tests;

pub use assemble::mimic;
pub use context::{FOUND_LOT, LotContext, Purpose};
pub use counts::Counts;
pub use event::{LotEvent, Subscriber};
pub use progress::{LotProgress, PartUnderWay};
pub use rows::json as part_json;
pub use summary::{Summary, WallProfile};

use super::controls::Controls;
use super::exit::{Cause, Exit};
use super::links;
use super::order_queue::OrderQueue;
use super::real_time::{Owned, RigThread};
use super::source::RigSource;
use super::traces::Traces;
use bus::{LineLog, Pace};
use cycle::{CycleLinks, Ended, Event};
use history::HistoryError;
use machine::station::turn::{Ending, HistoryState};
pub(crate) use outage::HistoryRetry;
use outage::{Outage, history_lost};
use recorder::Recorder;
use screen::Screen;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tokio::sync::{mpsc, watch};

/// A lot with its rig, history and controls, ready to run.
pub struct LotRunner<'a> {
    /// History file.
    pub db: &'a Path,
    /// Everything the run needs; admission has accepted the lot.
    pub context: LotContext<'a>,
    /// Controls shared with page, signals and scripts.
    pub controls: &'a Controls,
}

impl LotRunner<'_> {
    /// Runs the lot until it ends; `outer` receives every event. Panics outside a runtime of [`super::block_on`].
    ///
    /// # Errors
    /// Fails when the history cannot be opened, a line has no wiring, or the truth file cannot be written.
    pub async fn run(
        &self,
        orders: OrderQueue,
        outer: &mut dyn Subscriber,
    ) -> anyhow::Result<Exit> {
        let (context, controls) = (&self.context, self.controls);
        let pace = pace_of(context.source);
        let speed = context.source.speed();
        let limiter = speed.map(|speed| tokio::spawn(pace.limit_speed(speed)));
        let thread = RigThread::start(pace)?;
        controls
            .view
            .send_modify(|view| view.host = thread.rights.clone());
        let mut lines = links::open(context, &pace, thread.keeper()).await?;
        let traces = Traces::new(self.db, context.plant, &lines);
        controls.show_traffic(&traces);
        let (recorder, prior_state) = Recorder::open(self.db, context)?;
        let (history, history_seen) = watch::channel(HistoryState::Written);
        let mut stream = Stream {
            lot: LotProgress::new(*context, lines.eeprom_count()),
            recorder,
            screen: Screen {
                view: controls.view.clone(),
                traces: traces.clone(),
            },
            traces,
            outer,
            history,
            retry: HistoryRetry {
                db: self.db,
                controls,
                pace,
                give_up_s: context.plant.history.give_up_s,
            },
        };
        stream.tell(&LotEvent::Begun)?;
        let (events, received) = mpsc::unbounded_channel::<Event>();
        let recorded = Arc::new(AtomicU64::new(0));
        let (snapshots, showing) = cycle::snapshots(controls.view.clone(), speed);
        let showing = tokio::spawn(showing);
        let links = CycleLinks {
            events,
            recorded: Arc::clone(&recorded),
            stop: Arc::clone(&controls.stop),
            abort: Arc::clone(&controls.abort),
            orders: orders.orders,
            epoch_us: context.epoch_us,
            history: history_seen,
            fleet: controls.fleet.subscribe(),
            readings: lines.readings.take(),
            snapshots,
            passage: thread.passage.clone(),
        };
        let ends = std::mem::take(&mut lines.ends);
        let ends = (ends, std::mem::take(&mut lines.instruments));
        let attended = controls.attended;
        let cycle = assemble::cycle(context, prior_state, pace, ends, links, attended)?;
        let running = Owned::new(cycle.spawn(&thread.keeper().handle));
        let kept = stream.keep(received, &recorded).await;
        if let Err(error) = &kept {
            stream.give_up(error);
        }
        let ended = running.end().await;
        lines.end_instruments().await;
        // Ends because the cycle has dropped its sender; so the page gets the last snapshot before the end of the run.
        showing.await?;
        if let Some(limiter) = limiter {
            limiter.abort();
        }
        let exit = match (&ended, &kept) {
            (Ok(ended), Ok(())) => stream.lot.exit(&ended.ending),
            (Ok(_), Err(error)) => lost(error),
            (Err(_), _) => {
                let cause = Cause::assertion();
                tracing::error!("{}", cause.text);
                Exit::Trouble(cause)
            }
        };
        let mut ended = ended.unwrap_or_else(|_| Ended::by_assertion());
        if exit.cause().is_some() {
            // A run whose last rows are lost is not complete, even if its cycle ended well.
            ended.ending = Ending::Alarm;
        }
        let closed = stream.close(&ended, &exit, &lines.logs).await;
        lines.finish(context.source)?;
        // A failed assertion outranks a failed close.
        Ok(match closed {
            Err(error) if !exit.cause().is_some_and(Cause::is_program_failure) => lost(&error),
            Ok(()) | Err(_) => exit,
        })
    }
}

/// Returns the exit of a program that cannot write its history any more.
pub(crate) fn lost(error: &anyhow::Error) -> Exit {
    tracing::error!("history: {error:#}");
    Exit::Trouble(Cause::history_lost(&format!("{error:#}")))
}

/// Returns the pace of rig time: virtual, or the pace of the wall clock.
pub(crate) fn pace_of(source: &RigSource) -> Pace {
    match source.is_virtual() {
        true => Pace::virtual_time(),
        false => Pace::real(),
    }
}

/// Carries the events of a run to the subscribers.
struct Stream<'a, 'b> {
    lot: LotProgress<'a>,
    recorder: Recorder,
    screen: Screen,
    traces: Traces,
    outer: &'b mut dyn Subscriber,
    /// Tells the cycle whether the history is written, in an outage, or given up.
    history: watch::Sender<HistoryState>,
    retry: HistoryRetry<'a>,
}

impl Stream<'_, '_> {
    fn tell(&mut self, event: &LotEvent) -> anyhow::Result<()> {
        self.screen.receive(event, &self.lot);
        self.outer.receive(event, &self.lot);
        self.recorder.receive(event, &self.lot)
    }

    /// Writes the events of the cycle to the history until the cycle ends; sets `recorded` to the ordinal of the last
    /// part on the disk. [`Stream::close`] writes the rows that an outage leaves pending.
    ///
    /// # Errors
    /// Fails when an event cannot be made into rows.
    async fn keep(
        &mut self,
        mut events: mpsc::UnboundedReceiver<Event>,
        recorded: &AtomicU64,
    ) -> anyhow::Result<()> {
        let pace = self.retry.pace;
        let mut batch = Vec::new();
        let mut outage: Option<Outage> = None;
        loop {
            let retry_at = outage.as_ref().map(Outage::retry_at);
            let more = tokio::select! {
                biased;
                more = events.recv_many(&mut batch, 64) => more > 0,
                () = pace.sleep_until(retry_at.unwrap_or_default()), if retry_at.is_some() => true,
            };
            for event in batch.drain(..) {
                self.take_in(event)?;
            }
            if !more {
                return Ok(());
            }
            if retry_at.is_some_and(|at| pace.now() < at) {
                continue;
            }
            match self.recorder.commit().await {
                Ok(ordinal) => self.written(&mut outage, ordinal.unwrap_or_default(), recorded),
                Err(error) => self.unwritten(&mut outage, &error),
            }
        }
    }

    /// Publishes `ordinal`, the number of the last part on the disk, and ends an outage.
    fn written(&self, outage: &mut Option<Outage>, ordinal: u64, recorded: &AtomicU64) {
        recorded.fetch_max(ordinal, Ordering::AcqRel);
        if outage.take().is_some() {
            tracing::warn!("history: written again, nothing is lost");
            self.history.send_replace(HistoryState::Written);
        }
    }

    /// Tells the cycle that rows are pending; ends the run when the outage is too long, or when `error` does not come
    /// from the history.
    fn unwritten(&mut self, outage: &mut Option<Outage>, error: &anyhow::Error) {
        let (now, give_up_s) = (self.retry.pace.now(), self.retry.give_up_s);
        if outage.is_none() {
            tracing::error!("history: {error:#}; trying again for {give_up_s} s");
        }
        let outage = Outage::note(outage, now);
        if outage.is_too_long(now, give_up_s) || !error.is::<HistoryError>() {
            return self.give_up(error);
        }
        self.history
            .send_replace(match self.retry.controls.attended {
                true => HistoryState::Lost(history_lost(self.retry.db, error)),
                false => HistoryState::Waiting,
            });
    }

    /// Ends the run because rows cannot be written.
    fn give_up(&mut self, error: &anyhow::Error) {
        self.retry.give_up_s = 0.0;
        let alarm = history_lost(self.retry.db, error);
        self.history.send_replace(HistoryState::GivenUp(alarm));
    }

    fn take_in(&mut self, event: Event) -> anyhow::Result<()> {
        let follows = self.lot.apply(&event);
        let raised = match &event {
            Event::Alarm(_, at) => Some(self.lot.context.wall_us(*at)),
            _other => None,
        };
        self.tell(&LotEvent::Cycle(event))?;
        if let Some(follows) = follows {
            self.tell(&follows)?;
        }
        if let Some(at_us) = raised {
            let kept = self.traces.dump(at_us);
            self.tell(&LotEvent::TracesKept(kept))?;
        }
        Ok(())
    }

    /// Passes the parts that never landed and then the summary to all subscribers; writes the end of the run into the
    /// history.
    ///
    /// # Errors
    /// Fails when the history cannot be written for too long; the run then stays open in the history.
    async fn close(
        &mut self,
        ended: &Ended,
        exit: &Exit,
        logs: &[(String, LineLog)],
    ) -> anyhow::Result<()> {
        for left_behind in self.lot.take_unlanded() {
            self.tell(&left_behind)?;
        }
        let writing = self.recorder.writing;
        let summary = self.lot.summary(ended, exit.cause(), writing, logs);
        self.tell(&LotEvent::Ended(Box::new(summary)))?;
        self.recorder.end(&ended.ending, exit, &self.lot);
        let (recorder, lot) = (&mut self.recorder, &self.lot);
        self.retry.until_written(async || recorder.close(lot)).await
    }
}
