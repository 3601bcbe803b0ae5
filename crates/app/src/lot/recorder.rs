//! Writes the events of a run to the history.
//!
//! Between lots the history has no run until a part found inside needs a row: the lot [`FOUND_LOT`](super::FOUND_LOT) then gets
//! one. One transaction takes all pending rows; the recorder then publishes the ordinal of the last judged part, which
//! allows the sorter to open its gripper. The database works on a blocking thread, one short task per transaction.

use super::event::LotEvent;
use super::journal::Journal;
use super::prior_state::PriorState;
use super::progress::{LotProgress, PartUnderWay};
use super::{LotContext, Purpose, rows};
use crate::cycle::Event;
use crate::exit::Exit;
use anyhow::Context;
use history::{
    CalibrationRecord, Identity, InterruptedRecord, LandingRecord, LotRecord, Row, Store,
    snapshot_hash,
};
use machine::dut::{Calibration, Reason};
use machine::handling::inside::Inside;
use machine::handling::output::{Interrupted, Judged, Landed};
use machine::handling::wear::Uses;
use machine::station::turn::Ending;
use std::path::Path;
use std::time::{Duration, Instant};

/// Recorder of one run.
pub(super) struct Recorder {
    store: Option<Store>,
    journal: Journal,
    /// Rows of the next transaction.
    rows: Vec<Row>,
    /// Ordinal of the last judged part among them.
    judged: Option<u64>,
    contents: Option<(Inside, Uses)>,
    /// Wall time of all transactions.
    pub writing: Duration,
}

impl Recorder {
    /// Opens the history and begins the lot's run; returns what the run takes over, on a rig a valid calibration.
    pub fn open(db: &Path, context: &LotContext) -> anyhow::Result<(Self, PriorState)> {
        let mut store = Store::open(db, &Identity::of_this_program())?;
        store.cut_off(context.is_simulated(), context.epoch_us)?;
        let prior_state = PriorState::read(&store, context)?;
        let mut recorder = Self {
            store: Some(store),
            journal: Journal::new(context.is_simulated()),
            rows: Vec::new(),
            judged: None,
            contents: None,
            writing: Duration::ZERO,
        };
        if !context.purpose.is_between_lots() {
            recorder.begin(context, prior_state.calibration.as_ref())?;
        }
        Ok((recorder, prior_state))
    }

    fn store(&mut self) -> anyhow::Result<&mut Store> {
        self.store.as_mut().context("the history is closed")
    }

    fn begin(
        &mut self,
        context: &LotContext,
        calibration: Option<&Calibration>,
    ) -> anyhow::Result<()> {
        let (order, recipe) = (context.order, context.recipe);
        let begun = self.journal.begin(&order.lot, context.epoch_us);
        let store = self.store()?;
        store.begin_lot(&LotRecord {
            lot: order.lot.clone(),
            recipe: recipe.name.clone(),
            recipe_snapshot: recipe.source_text.clone(),
            recipe_hash: snapshot_hash(&recipe.source_text),
            calibration_hash: calibration.map(hash),
            opened_at_us: context.epoch_us,
            simulated: context.is_simulated(),
            seed: context.source.seed(),
            retest: order.retest.clone(),
        })?;
        Ok(store.record(begun.as_slice())?)
    }

    /// Turns an event into rows of the next transaction.
    ///
    /// # Errors
    /// Fails when a run or a calibration cannot be written.
    pub fn receive(&mut self, event: &LotEvent, lot: &LotProgress) -> anyhow::Result<()> {
        match event {
            LotEvent::Cycle(event) => self.of_the_cycle(event, lot)?,
            LotEvent::PartDone(part, Some(landed)) => self.landed(part, landed, lot),
            LotEvent::PartDone(_, None)
            | LotEvent::Begun
            | LotEvent::TracesKept(_)
            | LotEvent::Ended(_) => {}
        }
        Ok(())
    }

    fn of_the_cycle(&mut self, event: &Event, lot: &LotProgress) -> anyhow::Result<()> {
        let wall_us = |at| lot.context.wall_us(at);
        match event {
            Event::Judged(judged) => {
                if self.journal.has_no_lot() {
                    self.begin(&lot.context, None)?;
                }
                self.judged(judged, lot);
            }
            Event::Alarm(alarm, at) => self.rows.extend(self.journal.alarm(alarm, wall_us(*at))),
            Event::Interrupted(interrupted) => self.interrupted(interrupted, lot),
            Event::ListedAlarms(standing, at) => {
                let rows = self.journal.standing(standing, wall_us(*at));
                self.rows.extend(rows);
            }
            Event::Checked(checked, at) => {
                self.rows
                    .extend(self.journal.checked(checked, wall_us(*at)));
            }
            Event::Ordered(answered, at) => {
                self.rows
                    .extend(self.journal.ordered(answered, wall_us(*at)));
            }
            Event::Inside(inside, uses) => {
                self.contents = Some((*inside, *uses));
                if inside.needs_record() {
                    self.queue_contents();
                }
            }
            Event::Calibrated(calibration) => self.calibrated(calibration, &lot.context)?,
            // `PartDone` covers a landed part, the alarm a broken promise.
            Event::State(_)
            | Event::Left(_)
            | Event::Landed(_)
            | Event::LotBegan(_)
            | Event::PromiseBroken(_) => {}
        }
        Ok(())
    }

    fn judged(&mut self, judged: &Judged, lot: &LotProgress) {
        let row = rows::part(&lot.context, judged, lot.reference_count);
        self.rows.push(Row::Part(row));
        self.judged = Some(judged.part.ordinal);
    }

    /// Adds the row of a judged part that goes to retest.
    fn interrupted(&mut self, interrupted: &Interrupted, lot: &LotProgress) {
        let Some(part) = lot.part(interrupted.ordinal) else {
            return;
        };
        let (seq, kind) = part.number();
        self.rows.push(Row::Interrupted(InterruptedRecord {
            lot: lot.context.order.lot.clone(),
            kind: kind.into(),
            seq,
            reason: Reason::interrupted(&interrupted.why),
        }));
    }

    fn landed(&mut self, part: &PartUnderWay, landed: &Landed, lot: &LotProgress) {
        let (seq, kind) = part.number();
        self.rows.push(Row::Landed(LandingRecord {
            lot: lot.context.order.lot.clone(),
            kind: kind.into(),
            seq,
            bin: landed.bin.name().into(),
            at_us: lot.context.wall_us(landed.at),
            cycle_s: part.cycle_s,
        }));
    }

    fn calibrated(
        &mut self,
        calibration: &Calibration,
        context: &LotContext,
    ) -> anyhow::Result<()> {
        let facts = calibration.facts();
        let check = self.journal.calibrated(facts.made_at_us);
        self.rows.extend(check);
        if context.purpose == Purpose::Calibration {
            return Ok(());
        }
        let record = CalibrationRecord {
            made_at_us: facts.made_at_us,
            due_at_us: facts.due_at_us,
            hash: hash(calibration),
            body: serde_json::to_string(calibration)?,
            verified: true,
        };
        let store = self.store()?;
        store.save_calibration(&record)?;
        Ok(store.calibrated(&context.order.lot, &record.hash)?)
    }

    /// Queues the machine's contents, for the next transaction and the end of the run.
    fn queue_contents(&mut self) {
        if let Some((inside, uses)) = self.contents.take() {
            self.rows.extend(self.journal.uses(uses));
            self.rows.push(self.journal.inside(inside));
        }
    }

    /// Writes the pending rows; returns the ordinal up to which parts are durable when it has grown.
    ///
    /// # Errors
    /// Fails when the transaction fails, which then writes nothing.
    pub async fn commit(&mut self) -> anyhow::Result<Option<u64>> {
        if !self.rows.is_empty() {
            self.queue_contents();
            let from = Instant::now();
            let rows = std::mem::take(&mut self.rows);
            let mut store = self.store.take().context("the history is closed")?;
            let (store, written) = tokio::task::spawn_blocking(move || {
                let written = store.record(&rows);
                (store, written)
            })
            .await
            .context("the history writer ended")?;
            self.store = Some(store);
            self.writing += from.elapsed();
            written?;
        }
        Ok(self.judged.take())
    }

    /// Writes how the run ended, and closes it.
    ///
    /// # Errors
    /// Fails when the history cannot be written; the run then stays open in it.
    pub fn close(mut self, ending: &Ending, exit: &Exit, lot: &LotProgress) -> anyhow::Result<()> {
        self.queue_contents();
        let end_us = lot.context.wall_us(lot.end());
        self.rows.extend(self.journal.ended(ending, exit, end_us));
        let Some(store) = &mut self.store else {
            return Ok(());
        };
        store.record(&self.rows)?;
        if !self.journal.has_no_lot() {
            store.close_lot(&lot.context.order.lot, end_us)?;
        }
        Ok(())
    }
}

fn hash(calibration: &Calibration) -> String {
    serde_json::to_string(calibration)
        .map(|body| snapshot_hash(&body))
        .unwrap_or_default()
}
