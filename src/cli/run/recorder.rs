//! Takes the events of a run to the history, the screen and stdout.
//!
//! Between lots there is no run in the history, until a part that was found inside needs a row: then the lot
//! [`FOUND`] gets one.
//! Everything that has come in goes into one transaction; then the ordinal of the last judged part is
//! published, which is what lets the sorter open its gripper. The database works on a blocking thread,
//! one short task per transaction.

use super::counts::Counts;
use super::diary::Diary;
use super::known::Known;
use super::table::Table;
use super::traces::Traces;
use super::{Controls, RunArgs, rows, screen, summary};
use anyhow::Context;
use app::cycle::{Event, Profile};
use bus::LineLog;
use config::Plant;
use history::{
    CalibrationRecord, Identity, InterruptedRecord, LandingRecord, LotRecord, Row, Store,
    snapshot_hash,
};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use machine::dut::Recipe;
use machine::dut::{Bin, Calibration, Reason, Verdict};
use machine::handling::inside::Inside;
use machine::handling::ledger::Kind;
use machine::handling::wants::{Interrupted, Judged, Landed};
use machine::handling::wear::Uses;
use machine::station::wants::Ending;
use machine::view::View;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tokio::sync::mpsc;
use units::RigTime;

/// Lot of parts that were found inside of the rig between lots.
pub const FOUND: &str = "found in the rig";

/// What a run was started with.
pub struct Setup<'a> {
    /// Configuration.
    pub plant: &'a Plant,
    /// Recipe of the lot.
    pub recipe: &'a Arc<Recipe>,
    /// Command line.
    pub args: &'a RunArgs,
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    pub epoch_us: i64,
}

/// A part that has not landed yet.
struct Underway {
    judged: Box<Judged>,
    cycle_s: Option<f64>,
    golden: u64,
}

/// The recorder of one run.
pub struct Recorder<'a> {
    setup: &'a Setup<'a>,
    controls: &'a Controls,
    store: Option<Store>,
    began: Instant,
    lot_began: Option<RigTime>,
    last_landed: Option<RigTime>,
    underway: BTreeMap<u64, Underway>,
    golden: u64,
    counts: Counts,
    table: Table,
    bar: ProgressBar,
    eeprom: EepromCount,
    traces: Traces,
    eeprom_at_start: Option<u64>,
    writing: Duration,
    diary: Diary,
    aside: Option<(Inside, Uses)>,
}

/// EEPROM writes of all modules so far; `None` on a rig, where nobody can count them.
pub type EepromCount = Box<dyn Fn() -> Option<u64> + Send>;

impl<'a> Recorder<'a> {
    /// Opens the history and the lot's run; on a rig, a calibration that is still valid comes back.
    pub fn open(
        db: &Path,
        setup: &'a Setup<'a>,
        controls: &'a Controls,
        eeprom: EepromCount,
        traces: Traces,
    ) -> anyhow::Result<(Self, Known)> {
        let mut store = Store::open(db, &Identity::of_this_program())?;
        store.cut_off(setup.args.rig.sim, setup.epoch_us)?;
        let known = Known::read(&store, setup, controls)?;
        let mut diary = Diary::new(setup.args.rig.sim);
        if controls.between_lots.is_some() {
            controls
                .view
                .send_modify(|view| screen::between(view, setup));
        } else {
            begin(&mut store, &mut diary, setup, known.calibration.as_ref())?;
            controls.view.send_modify(|view| screen::begun(view, setup));
        }
        let recorder = Self {
            setup,
            controls,
            store: Some(store),
            began: Instant::now(),
            lot_began: None,
            last_landed: None,
            underway: BTreeMap::new(),
            golden: 0,
            counts: Counts::default(),
            table: Table::default(),
            bar: bar(setup.args.count, controls.between_lots.is_some()),
            eeprom,
            traces,
            eeprom_at_start: None,
            writing: Duration::ZERO,
            diary,
            aside: None,
        };
        Ok((recorder, known))
    }

    /// Keeps events until the cycle has ended; an onlooker hears each of them.
    pub async fn keep(
        &mut self,
        mut events: mpsc::UnboundedReceiver<Event>,
        recorded: &AtomicU64,
        onlooker: Option<mpsc::UnboundedSender<Event>>,
    ) -> anyhow::Result<()> {
        let mut batch = Vec::new();
        while events.recv_many(&mut batch, 64).await > 0 {
            let mut rows = Vec::new();
            let mut durable = None;
            for event in batch.drain(..) {
                if let Some(onlooker) = &onlooker {
                    // One who has gone misses nothing.
                    let _ = onlooker.send(event.clone());
                }
                durable = self.take(event, &mut rows)?.or(durable);
            }
            if !rows.is_empty() {
                rows.extend(self.aside());
            }
            self.write(rows).await?;
            if let Some(ordinal) = durable {
                recorded.fetch_max(ordinal, Ordering::AcqRel);
            }
        }
        Ok(())
    }

    /// What is inside: written with the next rows, when a part is let go, when the next one stands behind a lifted one, and
    /// at the end.
    fn aside(&mut self) -> Vec<Row> {
        let Some((inside, uses)) = self.aside.take() else {
            return Vec::new();
        };
        let mut rows = self.diary.uses(uses);
        rows.push(self.diary.inside(inside));
        rows
    }

    async fn write(&mut self, rows: Vec<Row>) -> anyhow::Result<()> {
        if rows.is_empty() {
            return Ok(());
        }
        let from = Instant::now();
        let mut store = self.store.take().context("the history is closed")?;
        let (store, written) = tokio::task::spawn_blocking(move || {
            let written = store.record(&rows);
            (store, written)
        })
        .await
        .context("the history writer ended")?;
        self.store = Some(store);
        self.writing += from.elapsed();
        Ok(written?)
    }

    /// Turns one event into rows; the ordinal of a judged part once its rows are in the batch.
    fn take(&mut self, event: Event, rows: &mut Vec<Row>) -> anyhow::Result<Option<u64>> {
        match event {
            Event::Judged(judged) => {
                if self.diary.is_of_no_lot() {
                    let store = self.store.as_mut().context("the history is closed")?;
                    begin(store, &mut self.diary, self.setup, None)?;
                }
                return Ok(Some(self.judged(judged, rows)));
            }
            Event::Left(left) => {
                if let Some(part) = self.underway.get_mut(&left.ordinal) {
                    part.cycle_s = left.cycle.map(|cycle| cycle.0);
                }
            }
            Event::Landed(landed) => self.landed(&landed, rows),
            Event::Alarm(alarm, at) => {
                self.counts.alarms += 1;
                self.bar
                    .suspend(|| tracing::error!(code = alarm.code, "{}", alarm.text_en));
                for path in self.traces.dump(self.wall_us(at)) {
                    self.bar
                        .suspend(|| tracing::error!("last traffic: {}", path.display()));
                }
                let lines = self.traces.health();
                self.controls.view.send_modify(|view| view.lines = lines);
                rows.extend(self.diary.alarm(&alarm, self.wall_us(at)));
            }
            Event::Interrupted(interrupted) => self.interrupted(&interrupted, rows),
            Event::State(_) => {}
            Event::Standing(standing, at) => {
                rows.extend(self.diary.standing(&standing, self.wall_us(at)));
            }
            Event::Checked(checked, at) => {
                rows.extend(self.diary.checked(&checked, self.wall_us(at)));
            }
            Event::Ordered(answered, at) => {
                rows.extend(self.diary.ordered(&answered, self.wall_us(at)));
            }
            Event::Inside(inside, uses) => {
                self.aside = Some((inside, uses));
                if inside.needs_record() {
                    rows.extend(self.aside());
                }
            }
            Event::Calibrated(calibration) => {
                rows.extend(self.diary.calibrated(calibration.made_at_us()));
                self.calibrated(&calibration)?;
            }
            Event::LotBegan(at) => {
                self.lot_began = Some(at);
                self.eeprom_at_start = (self.eeprom)();
            }
        }
        Ok(None)
    }

    /// A judged part that goes to retest: counts and row follow.
    fn interrupted(&mut self, interrupted: &Interrupted, rows: &mut Vec<Row>) {
        let Some(part) = self.underway.get_mut(&interrupted.ordinal) else {
            return;
        };
        let (seq, kind) = rows::number(&part.judged.part.kind, part.golden);
        let reason = Reason::interrupted(&interrupted.why);
        let mut reasons = part.judged.verdict.reasons().to_vec();
        reasons.push(reason.clone());
        let before = std::mem::replace(&mut part.judged.verdict, Verdict::Void(reasons));
        part.judged.part.bin = Some(Bin::RETEST);
        if kind == "lot" {
            if let Some(count) = self.counts.verdicts.get_mut(before.name()) {
                *count -= 1;
            }
            *self.counts.verdicts.entry("void").or_insert(0) += 1;
        }
        rows.push(Row::Interrupted(InterruptedRecord {
            lot: self.setup.args.lot.clone(),
            kind: kind.into(),
            seq,
            reason,
        }));
    }

    /// Progress bar and view.
    fn show(&self, judged: &Judged) {
        let rate = self
            .lot_began
            .and_then(|began| self.counts.per_hour(judged.at.since(began).as_seconds()));
        self.bar.set_position(self.counts.parts());
        self.bar.set_message(self.counts.in_short(rate));
        let lines = self.traces.health();
        self.controls.view.send_modify(|view| {
            screen::judged(view, self.setup, &self.counts, judged, rate, lines)
        });
    }

    fn wall_us(&self, at: RigTime) -> i64 {
        self.setup.epoch_us + i64::try_from(at.0).unwrap_or(i64::MAX)
    }

    fn judged(&mut self, judged: Box<Judged>, rows: &mut Vec<Row>) -> u64 {
        let ordinal = judged.part.ordinal;
        if matches!(judged.part.kind, Kind::Golden(_)) {
            self.golden += 1;
        } else {
            *self
                .counts
                .verdicts
                .entry(judged.verdict.name())
                .or_insert(0) += 1;
            self.table.add(self.setup.recipe.kind(), &judged);
            if self.controls.between_lots.is_none() {
                self.show(&judged);
            }
        }
        rows.push(Row::Part(rows::part(self.setup, &judged, self.golden)));
        let before = self.underway.insert(
            ordinal,
            Underway {
                judged,
                cycle_s: None,
                golden: self.golden,
            },
        );
        assert!(before.is_none(), "part {ordinal} was judged twice");
        ordinal
    }

    fn landed(&mut self, landed: &Landed, rows: &mut Vec<Row>) {
        let Some(part) = self.underway.remove(&landed.part.ordinal) else {
            return;
        };
        let (seq, kind) = rows::number(&landed.part.kind, part.golden);
        rows.push(Row::Landed(LandingRecord {
            lot: self.setup.args.lot.clone(),
            kind: kind.into(),
            seq,
            bin: landed.bin.name().into(),
            at_us: self.wall_us(landed.at),
            cycle_s: part.cycle_s,
        }));
        if kind == "golden" {
            return;
        }
        self.last_landed = Some(landed.at);
        let bin = landed.bin.to_string();
        *self.counts.bins.entry(bin).or_insert(0) += 1;
        if self.controls.between_lots.is_none() {
            let show = |view: &mut View| screen::landed(view, &self.counts);
            self.controls.view.send_modify(show);
        }
        self.print(&rows::json(
            self.setup,
            &part.judged,
            part.cycle_s,
            landed.bin.name(),
        ));
    }

    fn calibrated(&mut self, calibration: &Calibration) -> anyhow::Result<()> {
        if let Some(found) = &self.controls.calibrates {
            found.get_or_init(|| calibration.clone());
            return Ok(());
        }
        let body = serde_json::to_string(calibration)?;
        let store = self.store.as_mut().context("the history is closed")?;
        let hash = snapshot_hash(&body);
        store.save_calibration(&CalibrationRecord {
            made_at_us: calibration.made_at_us(),
            due_at_us: calibration.due_at_us(),
            hash: hash.clone(),
            body,
            verified: true,
        })?;
        Ok(store.calibrated(&self.setup.args.lot, &hash)?)
    }

    fn print(&self, object: &Value) {
        if !self.setup.args.json || self.controls.quiet {
            return;
        }
        let line = format!("{object}\n");
        // A reader that has gone away does not stop the line.
        self.bar
            .suspend(|| std::io::stdout().write_all(line.as_bytes()).ok());
    }

    /// Parts that never landed, the summary, and the end of the lot's run.
    pub fn close(
        mut self,
        ending: &Ending,
        profile: &Profile,
        logs: &[(String, LineLog)],
    ) -> anyhow::Result<()> {
        for part in std::mem::take(&mut self.underway).into_values() {
            if matches!(part.judged.part.kind, Kind::Lot(_)) {
                self.print(&rows::json(self.setup, &part.judged, part.cycle_s, ""));
            }
        }
        let end = self.last_landed.or(self.lot_began).unwrap_or_default();
        let elapsed_s = self
            .lot_began
            .map_or(0.0, |began| end.since(began).as_seconds());
        let mut summary = summary::of(&self.counts, ending, elapsed_s, self.began.elapsed());
        if let (Some(before), Some(after)) = (self.eeprom_at_start, (self.eeprom)()) {
            summary["eeprom_writes"] = json!(after - before);
        }
        summary["wall_profile"] =
            summary::wall_profile(profile, self.writing, self.began.elapsed());
        summary["bytes"] = summary::bytes(logs);
        self.print(&summary);
        self.bar.finish_and_clear();
        if !self.setup.args.json && !self.controls.quiet {
            let text = self.table.text(&self.counts, &summary);
            std::io::stdout().write_all(text.as_bytes()).ok();
        }
        let end_us = self.wall_us(end);
        let mut rows = self.aside();
        if let Some(store) = &mut self.store {
            rows.extend(self.diary.ended(ending, end_us));
            store.record(&rows)?;
            if !self.diary.is_of_no_lot() {
                store.close_lot(&self.setup.args.lot, end_us)?;
            }
        }
        Ok(())
    }
}

/// The run begins in the history.
fn begin(
    store: &mut Store,
    diary: &mut Diary,
    setup: &Setup,
    calibration: Option<&Calibration>,
) -> anyhow::Result<()> {
    store.begin_lot(&LotRecord {
        lot: setup.args.lot.clone(),
        recipe: setup.recipe.name.clone(),
        recipe_snapshot: setup.recipe.source_text.clone(),
        recipe_hash: rows::recipe_hash(setup),
        calibration_hash: calibration.map(hash),
        opened_at_us: setup.epoch_us,
        simulated: setup.args.rig.sim,
        seed: setup.args.rig.sim.then_some(setup.args.rig.seed),
        retest: setup.args.retest.clone(),
    })?;
    let begun: Vec<Row> = diary
        .begin(&setup.args.lot, setup.epoch_us)
        .into_iter()
        .collect();
    Ok(store.record(&begun)?)
}

fn hash(calibration: &Calibration) -> String {
    serde_json::to_string(calibration)
        .map(|body| snapshot_hash(&body))
        .unwrap_or_default()
}

fn bar(count: Option<u64>, hidden: bool) -> ProgressBar {
    let target = if std::io::stderr().is_terminal() && !hidden {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let bar = ProgressBar::with_draw_target(count, target);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    bar
}
