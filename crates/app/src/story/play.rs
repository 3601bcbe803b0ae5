//! Plays a script beside a running lot: waits, strikes, orders, and has the narrator describe what happens.

use super::narrator::Narrator;
use super::script::{Awaited, Deed, Script};
use crate::cycle::Event;
use bus::Pace;
use machine::handling::ledger::Kind;
use machine::station::packml::State;
use machine::view::{By, Order, OrderRequest};
use rigsim::SharedRig;
use rigsim::journal::Entry;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use thiserror::Error;
use tokio::sync::{mpsc, oneshot};
use units::{RigTime, Span};

/// Nothing has happened for so long: nothing will any more.
pub const PATIENCE: Span = Span::ms(180_000);
/// What happened, line by line.
#[derive(Debug)]
pub struct StoryReport {
    /// The story.
    pub text: String,
    /// Everything in the script came, and the journal was kept.
    pub whole: bool,
}

/// A script to be played.
#[derive(Debug)]
pub(super) struct Play {
    script: Script,
    journal: Option<File>,
}

/// What a line of the script may wait for.
#[derive(Debug, Default)]
struct Observed {
    lot: bool,
    state: Option<State>,
    alarms: BTreeSet<String>,
    judged: BTreeSet<u64>,
    left: BTreeSet<u64>,
    landed: BTreeSet<u64>,
    /// Number in the lot by ordinal.
    numbers: BTreeMap<u64, u64>,
}

impl Play {
    /// Ready to begin; what the outputs did goes to `journal`.
    pub fn new(script: Script, journal: Option<File>) -> Self {
        Self { script, journal }
    }

    /// Plays until the run has ended.
    pub async fn run(
        self,
        mut events: mpsc::UnboundedReceiver<Event>,
        orders: mpsc::Sender<OrderRequest>,
        rig: SharedRig,
        pace: Pace,
        stop: Arc<AtomicBool>,
    ) -> StoryReport {
        let journal = self.journal.map(|file| (file, rig.journal()));
        let mut narrator = Narrator::new(&self.script);
        let mut observed = Observed::default();
        let mut lines = self.script.lines.iter().peekable();
        let (mut last, mut due) = (pace.now(), None);
        let mut whole = true;
        loop {
            let now = pace.now();
            match lines.peek() {
                Some(line) if due.is_none() && observed.holds(&line.event) => {
                    due = Some(now + line.after)
                }
                Some(_) => {}
                None if observed.is_over() => stop.store(true, Ordering::Release),
                None => {}
            }
            tokio::select! {
                biased;
                event = events.recv() => match event {
                    Some(_) if stop.load(Ordering::Acquire) => {}
                    Some(event) => {
                        last = now;
                        observed.note(&event);
                        narrator.event(&event, pace.now());
                    }
                    None => break,
                },
                () = pace.sleep_until(due.unwrap_or(last + PATIENCE)) => {
                    if let Some(line) = lines.next_if(|_| due.is_some()) {
                        (last, due) = (pace.now(), None);
                        play(&line.deed, &orders, &rig, pace, &mut narrator).await;
                    } else if std::mem::replace(&mut whole, false) {
                        narrator.silence(lines.peek().copied(), pace.now());
                        stop.store(true, Ordering::Release);
                        last = RigTime(u64::MAX / 2);
                    }
                }
            }
        }
        whole &= lines.peek().is_none();
        let text = narrator.end(&rig.crashes());
        if let Some((file, entries)) = journal
            && let Err(error) = kept(file, &entries)
        {
            tracing::error!("--journal: {error}");
            whole = false;
        }
        StoryReport { text, whole }
    }
}

/// What the journal holds, one object per line.
fn kept(file: File, entries: &Receiver<Entry>) -> std::io::Result<()> {
    let mut file = BufWriter::new(file);
    for entry in entries.try_iter() {
        writeln!(file, "{}", json!(entry))?;
    }
    file.flush()
}

async fn play(
    deed: &Deed,
    orders: &mpsc::Sender<OrderRequest>,
    rig: &SharedRig,
    pace: Pace,
    narrator: &mut Narrator,
) {
    match deed {
        Deed::Fault(fault) => {
            narrator.fault(fault, rig.strike(fault), pace.now());
        }
        Deed::Order(words, order) => {
            let answer = ask(order, orders).await;
            narrator.order(words, answer, pace.now());
        }
    }
}

/// Why an order of the script is not taken.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub(super) enum Refusal {
    /// The line is gone.
    #[error("the run has ended")]
    Ended,
    /// The station's reason.
    #[error("{0}")]
    Said(String),
}

/// The station's answer.
async fn ask(order: &Order, orders: &mpsc::Sender<OrderRequest>) -> Result<(), Refusal> {
    let (answer, answered) = oneshot::channel();
    let order = order.clone();
    let by = By {
        who: "script".to_owned(),
        role: "engineer".to_owned(),
        origin: "story".to_owned(),
    };
    let way_back = move |it| drop(answer.send(it));
    orders
        .send(OrderRequest::new(order, by, way_back))
        .await
        .map_err(|_| Refusal::Ended)?;
    let answer = answered.await.map_err(|_| Refusal::Ended)?;
    answer.map_err(|why| Refusal::Said(why.say(texts::Lang::En)))
}

impl Observed {
    fn note(&mut self, event: &Event) {
        match event {
            Event::State(state) => self.state = Some(*state),
            Event::LotBegan(_) => self.lot = true,
            Event::Alarm(alarm, _) => {
                self.alarms.insert(alarm.code.name());
            }
            Event::Judged(judged) => {
                if let Kind::Lot(number) = judged.part.kind {
                    self.numbers.insert(judged.part.ordinal, number);
                    self.judged.insert(number);
                }
            }
            Event::Left(left) => self.left.extend(self.numbers.get(&left.ordinal)),
            Event::Landed(landed) => self.landed.extend(self.numbers.get(&landed.part.ordinal)),
            Event::Interrupted(_)
            | Event::Standing(..)
            | Event::Checked(..)
            | Event::Ordered(..)
            | Event::Inside(..)
            | Event::Calibrated(_) => {}
        }
    }

    /// The lot is done, or was ended before.
    fn is_over(&self) -> bool {
        matches!(self.state, Some(State::Complete | State::Stopped))
    }

    fn holds(&self, event: &Awaited) -> bool {
        match event {
            Awaited::Lot => self.lot,
            Awaited::State(state) => self.state == Some(*state),
            Awaited::Alarm(code) => self.alarms.contains(code),
            Awaited::Judged(part) => self.judged.contains(part),
            Awaited::Left(part) => self.left.contains(part),
            Awaited::Landed(part) => self.landed.contains(part),
        }
    }
}
