//! Runs a lot: one stream of events goes to several subscribers.
//!
//! | subscriber | does |
//! |---|---|
//! | `recorder` (with `journal`, `rows`) | writes the history, before the sorter may release a part |
//! | `screen` | shows the run on the page |
//! | the caller's | shows a progress bar, prints rows on stdout, plays a script, or keeps a calibration |
//!
//! The cycle sends events; `progress` takes each into account first, then every subscriber receives it with the
//! progress.

mod assemble;
mod context;
mod counts;
mod event;
mod journal;
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
use super::traces::Traces;
use crate::cycle::{CycleLinks, Event, Profile};
use bus::{LineLog, Pace};
use machine::station::turn::Ending;
use recorder::Recorder;
use screen::Screen;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use tokio::sync::mpsc;

/// A lot with its rig, history and controls, ready to run.
pub struct LotRunner<'a> {
    /// History file.
    pub db: &'a Path,
    /// Everything the run needs; its lot has passed admission.
    pub context: LotContext<'a>,
    /// Controls shared with page, signals and scripts.
    pub controls: &'a Controls,
}

impl LotRunner<'_> {
    /// Runs the lot until it ends; `outer` receives every event. Panics outside a runtime of [`super::block_on`].
    ///
    /// # Errors
    /// Fails when the history cannot be opened or closed, a line has no wiring, or the truth file cannot be written.
    pub async fn run(
        &self,
        orders: OrderQueue,
        outer: &mut dyn Subscriber,
    ) -> anyhow::Result<Exit> {
        let (context, controls) = (&self.context, self.controls);
        let pace = pace_of(context);
        let speed = context.source.speed();
        let limiter = speed.map(|speed| tokio::spawn(pace.limit_speed(speed)));
        let mut lines = links::open(context, &pace)?;
        let traces = Traces::new(self.db, context.plant, &lines.logs);
        controls.show_traffic(&traces);
        let (recorder, prior_state) = Recorder::open(self.db, context)?;
        let mut stream = Stream {
            lot: LotProgress::new(*context, lines.eeprom_count()),
            recorder,
            screen: Screen {
                view: controls.view.clone(),
                traces: traces.clone(),
            },
            traces,
            outer,
        };
        stream.tell(&LotEvent::Begun)?;
        let (events, received) = mpsc::unbounded_channel::<Event>();
        let recorded = Arc::new(AtomicU64::new(0));
        let history_lost = Arc::new(AtomicBool::new(false));
        let links = CycleLinks {
            events,
            recorded: Arc::clone(&recorded),
            stop: Arc::clone(&controls.stop),
            abort: Arc::clone(&controls.abort),
            orders: orders.orders,
            epoch_us: context.epoch_us,
            history_lost: Arc::clone(&history_lost),
            view: controls.view.clone(),
        };
        let ends = std::mem::take(&mut lines.ends);
        let attended = controls.attended;
        let cycle = assemble::cycle(context, prior_state, pace, ends, links, attended)?;
        let running = tokio::spawn(cycle.run());
        let kept = stream.keep(received, &recorded).await;
        if let Err(error) = &kept {
            tracing::error!("history: {error:#}");
            history_lost.store(true, Ordering::Release);
        }
        let ended = running.await;
        if let Some(limiter) = limiter {
            limiter.abort();
        }
        let exit = match (&ended, &kept) {
            (Ok((ending, _)), Ok(())) => stream.lot.exit(ending),
            (Ok(_), Err(error)) => Exit::Trouble(Cause::history_lost(&format!("{error:#}"))),
            (Err(_), _) => {
                let cause = Cause::assertion();
                tracing::error!("{}", cause.text);
                Exit::Trouble(cause)
            }
        };
        let (ending, profile) = ended.unwrap_or((Ending::Alarm, Profile::default()));
        let closed = stream.close(&ending, &exit, &profile, &lines.logs);
        lines.finish(context.source)?;
        // A lost history cannot close the run, and a failed assertion matters more than a failed close: both hide
        // `closed`.
        if !exit.cause().is_some_and(Cause::is_program_failure) {
            closed?;
        }
        Ok(exit)
    }
}

fn pace_of(context: &LotContext) -> Pace {
    if context.source.is_virtual() {
        Pace::virtual_time()
    } else {
        Pace::real()
    }
}

/// Carries the events of a run to the subscribers.
struct Stream<'a, 'b> {
    lot: LotProgress<'a>,
    recorder: Recorder,
    screen: Screen,
    traces: Traces,
    outer: &'b mut dyn Subscriber,
}

impl Stream<'_, '_> {
    fn tell(&mut self, event: &LotEvent) -> anyhow::Result<()> {
        self.screen.receive(event, &self.lot);
        self.outer.receive(event, &self.lot);
        self.recorder.receive(event, &self.lot)
    }

    /// Receives the events of the cycle until it ends; sets `recorded` to the ordinal of the last part on the disk.
    async fn keep(
        &mut self,
        mut events: mpsc::UnboundedReceiver<Event>,
        recorded: &AtomicU64,
    ) -> anyhow::Result<()> {
        let mut batch = Vec::new();
        while events.recv_many(&mut batch, 64).await > 0 {
            for event in batch.drain(..) {
                self.take_in(event)?;
            }
            if let Some(ordinal) = self.recorder.commit().await? {
                recorded.fetch_max(ordinal, Ordering::AcqRel);
            }
        }
        Ok(())
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

    /// Reports the parts that will never land and the summary, then ends the run in the history.
    fn close(
        mut self,
        ending: &Ending,
        exit: &Exit,
        profile: &Profile,
        logs: &[(String, LineLog)],
    ) -> anyhow::Result<()> {
        for left_behind in self.lot.take_unlanded() {
            self.tell(&left_behind)?;
        }
        let writing = self.recorder.writing;
        let summary = self
            .lot
            .summary(ending, exit.cause(), profile, writing, logs);
        self.tell(&LotEvent::Ended(Box::new(summary)))?;
        self.recorder.close(ending, exit, &self.lot)
    }
}
