//! A run of a lot: one stream of events, and who hears it.
//!
//! | subscriber | does |
//! |---|---|
//! | `recorder` (with `journal`, `rows`) | history: durable before the sorter lets a part go |
//! | `screen` | view of the page |
//! | the caller's | progress bar, rows on stdout, a script, a calibration that is looked for |
//!
//! The cycle tells what happens; `progress` takes it in, and every subscriber hears it together with the progress.

mod assemble;
mod context;
mod counts;
mod event;
mod journal;
mod progress;
mod recorder;
mod rows;
mod screen;
mod summary;
mod taken_over;

pub use assemble::mimic;
pub use context::{FOUND, LotContext, Purpose};
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

/// Runs one lot on a rig.
pub struct LotRunner<'a> {
    /// History file.
    pub db: &'a Path,
    /// What the run was started with; the lot has passed the gates.
    pub context: LotContext<'a>,
    /// Controls shared with page, signals and scripts.
    pub controls: &'a Controls,
}

impl LotRunner<'_> {
    /// Runs the lot until it ends; `outer` hears every event. Inside of a runtime of [`super::block_on`].
    ///
    /// # Errors
    /// A history that cannot be opened or closed, a line that is not wired, a truth file that cannot be written.
    pub async fn run(
        &self,
        orders: OrderQueue,
        outer: &mut dyn Subscriber,
    ) -> anyhow::Result<Exit> {
        let (context, controls) = (&self.context, self.controls);
        let pace = pace_of(context);
        let speed = context.source.speed();
        let held_back = speed.map(|speed| tokio::spawn(pace.hold_back(speed)));
        let mut lines = links::open(context, &pace)?;
        let traces = Traces::new(self.db, context.plant, &lines.logs);
        controls.show_traffic(&traces);
        let (recorder, taken_over) = Recorder::open(self.db, context)?;
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
        let cycle = assemble::cycle(context, taken_over, pace, ends, links, attended)?;
        let running = tokio::spawn(cycle.run());
        let kept = stream.keep(received, &recorded).await;
        if let Err(error) = &kept {
            tracing::error!("history: {error:#}");
            history_lost.store(true, Ordering::Release);
        }
        let ended = running.await;
        if let Some(held_back) = held_back {
            held_back.abort();
        }
        let Ok((ending, profile)) = ended else {
            let cause = Cause::assertion();
            tracing::error!("{}", cause.text);
            return Ok(Exit::Trouble(cause));
        };
        let exit = match &kept {
            Ok(()) => stream.lot.exit(&ending),
            Err(error) => Exit::Trouble(Cause::history_lost(&format!("{error:#}"))),
        };
        let closed = stream.close(&ending, &exit, &profile, &lines.logs);
        lines.finish(context.source)?;
        if kept.is_ok() {
            closed?;
        }
        Ok(exit)
    }
}

/// The clock of a run.
fn pace_of(context: &LotContext) -> Pace {
    if context.source.is_virtual() {
        Pace::virtual_time()
    } else {
        Pace::real()
    }
}

/// The events of a run on their way to the subscribers.
struct Stream<'a, 'b> {
    lot: LotProgress<'a>,
    recorder: Recorder,
    screen: Screen,
    traces: Traces,
    outer: &'b mut dyn Subscriber,
}

impl Stream<'_, '_> {
    /// Every subscriber hears the event.
    fn tell(&mut self, event: &LotEvent) -> anyhow::Result<()> {
        self.screen.hear(event, &self.lot);
        self.outer.hear(event, &self.lot);
        self.recorder.hear(event, &self.lot)
    }

    /// Takes in what the cycle tells until it ends; `recorded` follows what is durable.
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
        let follows = self.lot.take_in(&event);
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

    /// Parts that never landed, the summary, and the end of the run in the history.
    fn close(
        mut self,
        ending: &Ending,
        exit: &Exit,
        profile: &Profile,
        logs: &[(String, LineLog)],
    ) -> anyhow::Result<()> {
        for left_behind in self.lot.take_left_behind() {
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
