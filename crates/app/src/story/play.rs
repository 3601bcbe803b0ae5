//! Plays a script during a lot: waits, applies faults, sends orders, and passes events to the narrator.

use super::narrator::Narrator;
use super::script::{Action, Awaited, Script};
use bus::Pace;
use cycle::Event;
use machine::handling::ledger::PartRole;
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
use texts::{Lang, Message};
use thiserror::Error;
use tokio::sync::{mpsc, oneshot};
use units::{RigTime, Span};

/// Longest time without an event; a longer silence ends the story.
pub const SILENCE_TIMEOUT: Span = Span::ms(180_000);
/// Result of a story.
#[derive(Debug)]
pub struct StoryReport {
    /// The account of the story, line by line.
    pub text: String,
    /// True when the whole script was played and the journal was written.
    pub complete: bool,
}

/// Player of one script.
#[derive(Debug)]
pub(super) struct Player {
    script: Script,
    journal: Option<File>,
}

/// Events so far, of those for which a step of the script may wait.
#[derive(Debug, Default)]
struct Observed {
    lot: bool,
    state: Option<State>,
    alarms: BTreeSet<String>,
    judged: BTreeSet<u64>,
    left: BTreeSet<u64>,
    landed: BTreeSet<u64>,
    /// Number of each part within the lot, by its ordinal in the run.
    numbers: BTreeMap<u64, u64>,
}

impl Player {
    /// Prepares a script; the player writes the rig's journal to `journal`, if given.
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
        let mut steps = self.script.steps.iter().peekable();
        let (mut last, mut due) = (pace.now(), None);
        let mut complete = true;
        loop {
            let now = pace.now();
            match steps.peek() {
                Some(step) if due.is_none() && observed.holds(&step.event) => {
                    due = Some(now + step.after)
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
                () = pace.sleep_until(due.unwrap_or(last + SILENCE_TIMEOUT)) => {
                    if let Some(step) = steps.next_if(|_| due.is_some()) {
                        (last, due) = (pace.now(), None);
                        perform(&step.action, &orders, &rig, pace, &mut narrator).await;
                    } else if std::mem::replace(&mut complete, false) {
                        narrator.silence(steps.peek().copied(), pace.now());
                        stop.store(true, Ordering::Release);
                        last = RigTime(u64::MAX / 2);
                    }
                }
            }
        }
        complete &= steps.peek().is_none();
        let text = narrator.end(&rig);
        if let Some((file, entries)) = journal
            && let Err(error) = write_journal(file, &entries)
        {
            tracing::error!("--journal: {error}");
            complete = false;
        }
        StoryReport { text, complete }
    }
}

/// Writes the journal, one JSON object per line.
fn write_journal(file: File, entries: &Receiver<Entry>) -> std::io::Result<()> {
    let mut file = BufWriter::new(file);
    for entry in entries.try_iter() {
        writeln!(file, "{}", json!(entry))?;
    }
    file.flush()
}

async fn perform(
    action: &Action,
    orders: &mpsc::Sender<OrderRequest>,
    rig: &SharedRig,
    pace: Pace,
    narrator: &mut Narrator,
) {
    match action {
        Action::Fault(fault) => {
            narrator.fault(fault, rig.inject(fault), pace.now());
        }
        Action::Order(words, order) => {
            let answer = ask(order, orders).await;
            narrator.order(words, answer, pace.now());
        }
    }
}

/// Reason why an order of the script fails.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub(super) enum Refusal {
    /// The run has ended.
    #[error("the run has ended")]
    Ended,
    /// The station refused the order for this reason.
    #[error("{0}")]
    Refused(String),
}

/// Sends an order and returns the station's answer.
async fn ask(
    order: &Order,
    orders: &mpsc::Sender<OrderRequest>,
) -> Result<Option<Message>, Refusal> {
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
    answer.map_err(|why| Refusal::Refused(why.say(Lang::En)))
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
                if let PartRole::Lot(number) = judged.part.role {
                    self.numbers.insert(judged.part.ordinal, number);
                    self.judged.insert(number);
                }
            }
            Event::Left(left) => self.left.extend(self.numbers.get(&left.ordinal)),
            Event::Landed(landed) => self.landed.extend(self.numbers.get(&landed.part.ordinal)),
            Event::Interrupted(_)
            | Event::ListedAlarms(..)
            | Event::Checked(..)
            | Event::Ordered(..)
            | Event::Inside(..)
            | Event::Calibrated(_)
            | Event::BatchEnded(_)
            | Event::Found(_)
            | Event::Prompted(_)
            | Event::PromiseBroken(_) => {}
        }
    }

    /// Returns true when the lot is complete or stopped.
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
