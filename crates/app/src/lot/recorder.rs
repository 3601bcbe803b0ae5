//! Writes the events of a run to the history.
//!
//! Between lots the history has no run until a part found inside needs a row; then the run of lot
//! [`FOUND_LOT`](super::FOUND_LOT) begins. One transaction writes all pending rows; [`Recorder::commit`] then returns
//! the ordinal (number within the run) of the last judged part, whose publication allows the sorter to open its
//! gripper. After a failed transaction its rows stay pending, in order. While the cycle runs in real time, the database
//! works on a blocking thread, one short task per transaction; in virtual time, which stops meanwhile, it works at once. At
//! unlimited speed it does not wait for the disk: a power loss may take the last simulated parts.

use super::event::LotEvent;
use super::journal::Journal;
use super::prior_state::PriorState;
use super::progress::{LotProgress, PartUnderWay};
use super::{LotContext, Purpose, rows};
use crate::exit::Exit;
use anyhow::Context;
use cycle::Event;
use history::{
    CalibratedRecord, CalibrationRecord, InterruptedRecord, LandingRecord, LotRecord, Row, Store,
    snapshot_hash,
};
use machine::dut::{Calibration, Reason};
use machine::handling::inside::Inside;
use machine::handling::output::{Interrupted, Judged, Landed};
use machine::handling::wear::Uses;
use machine::station::turn::Ending;
use std::path::Path;
use std::time::{Duration, Instant};

/// Writes the rows of one run to the history, in transactions.
pub(super) struct Recorder {
    store: Option<Store>,
    journal: Journal,
    /// Rows that wait for the next transaction.
    rows: Vec<Row>,
    /// Ordinal of the last judged part among the rows that wait.
    judged: Option<u64>,
    contents: Option<(Inside, Uses)>,
    /// Contents of the machine in the last row of them, written or waiting.
    recorded: Inside,
    is_virtual: bool,
    /// Wall time of all transactions so far.
    pub writing: Duration,
}

impl Recorder {
    /// Opens the history and, except between lots, begins the run of the lot; returns the state that the run takes
    /// over.
    pub fn open(db: &Path, context: &LotContext) -> anyhow::Result<(Self, PriorState)> {
        let mut store = Store::open(db)?;
        if context.source.is_unlimited() {
            store.trust_the_power()?;
        }
        store.claim(context.is_simulated())?;
        store.cut_off(context.is_simulated(), context.epoch_us)?;
        let prior_state = PriorState::read(&store, context)?;
        let mut recorder = Self {
            store: Some(store),
            journal: Journal::new(context.is_simulated()),
            rows: Vec::new(),
            judged: None,
            contents: None,
            recorded: Inside::default(),
            is_virtual: context.source.is_virtual(),
            writing: Duration::ZERO,
        };
        if !context.purpose.is_between_lots() {
            let calibration = prior_state.calibration.as_ref();
            recorder.begin(context, calibration);
            recorder.certified(context, calibration)?;
            recorder.write()?;
        }
        Ok((recorder, prior_state))
    }

    /// Queues the rows that begin a run.
    fn begin(&mut self, context: &LotContext, calibration: Option<&Calibration>) {
        let (order, recipe) = (context.order, context.recipe);
        self.rows.push(Row::Run(LotRecord {
            lot: order.lot.clone(),
            recipe: recipe.name.clone(),
            recipe_snapshot: recipe.source_text.clone(),
            recipe_hash: recipe.hash.clone(),
            calibration_hash: calibration.map(hash),
            opened_at_us: context.epoch_us,
            simulated: context.is_simulated(),
            seed: context.source.seed(),
            retest: order.retest.clone(),
        }));
        let begun = self.journal.begin(&order.lot, context.epoch_us);
        self.rows.extend(begun);
    }

    /// Turns an event into rows that wait for the next transaction.
    ///
    /// # Errors
    /// Fails when a calibration cannot be written as JSON.
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
                    self.begin(&lot.context, None);
                }
                self.judged(judged, lot);
            }
            Event::BatchEnded(ended) => {
                self.rows.push(Row::Batch(rows::batch(&lot.context, ended)))
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
                if inside.needs_record(self.recorded) {
                    self.queue_contents();
                }
            }
            Event::Calibrated(calibration) => self.calibrated(calibration, &lot.context)?,
            // `PartDone` brings the row of a landed part, an alarm the row of a broken promise.
            Event::State(_)
            | Event::Left(_)
            | Event::Landed(_)
            | Event::LotBegan(_)
            | Event::Prompted(_)
            | Event::Found(_)
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
        self.rows.push(Row::Calibrated(CalibratedRecord {
            lot: context.order.lot.clone(),
            calibration: record,
        }));
        Ok(())
    }

    /// Queues a calibration that this run has just taken over from the certificates of the plant.
    fn certified(
        &mut self,
        context: &LotContext,
        calibration: Option<&Calibration>,
    ) -> anyhow::Result<()> {
        let made_now = calibration.filter(|it| it.facts().made_at_us == context.epoch_us);
        made_now.map_or(Ok(()), |it| self.calibrated(it, context))
    }

    /// Queues the contents of the machine and the use counts, before each transaction and at the end of the run.
    fn queue_contents(&mut self) {
        if let Some((inside, uses)) = self.contents.take() {
            self.rows.extend(self.journal.uses(uses));
            self.rows.push(self.journal.inside(inside));
            self.recorded = inside;
        }
    }

    /// Writes the pending rows; returns the ordinal of the last judged part now on the disk, or `None` when no judged
    /// part was pending.
    ///
    /// # Errors
    /// Fails when the transaction fails and so writes nothing; the rows stay pending, in order.
    pub async fn commit(&mut self) -> anyhow::Result<Option<u64>> {
        if !self.rows.is_empty() {
            self.queue_contents();
            let from = Instant::now();
            let rows = std::mem::take(&mut self.rows);
            let mut store = self.store.take().context("the history is closed")?;
            let write = move || {
                let written = store.record(&rows);
                (store, rows, written)
            };
            let (store, rows, written) = match self.is_virtual {
                true => write(),
                false => tokio::task::spawn_blocking(write)
                    .await
                    .context("the history writer ended")?,
            };
            self.store = Some(store);
            self.writing += from.elapsed();
            if let Err(error) = written {
                self.rows = rows;
                return Err(error.into());
            }
        }
        Ok(self.judged.take())
    }

    /// Queues the rows about the end of the run.
    pub fn end(&mut self, ending: &Ending, exit: &Exit, lot: &LotProgress) {
        self.queue_contents();
        let end_us = lot.context.wall_us(lot.end());
        self.rows.extend(self.journal.ended(ending, exit, end_us));
    }

    /// Writes the pending rows and closes the run.
    ///
    /// # Errors
    /// Fails when the history cannot be written; rows that are not written yet stay pending.
    pub fn close(&mut self, lot: &LotProgress) -> anyhow::Result<()> {
        self.write()?;
        let end_us = lot.context.wall_us(lot.end());
        match &mut self.store {
            Some(store) if !self.journal.has_no_lot() => {
                Ok(store.close_lot(&lot.context.order.lot, end_us)?)
            }
            Some(_) | None => Ok(()),
        }
    }

    /// Writes the pending rows while no cycle runs.
    fn write(&mut self) -> anyhow::Result<()> {
        let store = self.store.as_mut().context("the history is closed")?;
        store.record(&self.rows)?;
        self.rows.clear();
        Ok(())
    }
}

fn hash(calibration: &Calibration) -> String {
    let body = serde_json::to_string(calibration);
    body.map(snapshot_hash).unwrap_or_default()
}
