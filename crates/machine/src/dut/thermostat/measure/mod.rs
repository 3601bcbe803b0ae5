//! The test of a batch: contact resistances, identification of the chamber, passes through the windows, heat off.
//!
//! ```text
//! contacts -> identification, or room for a stated response (first batch of a run) -> passes -> off
//! ```
//! Signals: the contacts in the image, which the scan reads all the time, and the two thermometers of the chamber, read
//! once a second. The program gives the set point to the controller, which commands heater and vent.
//!
//! Troubles: whatever `chamber::watch` sees, an open chain of limiter, airflow and mains, a failed transaction. The
//! heater goes off, no part of the batch is judged, and the station raises an alarm. Contacts that are open before
//! heating and an unexpected lag are reported, and the batch goes on.

mod contacts;
mod creep;
mod drop;
mod passes;
mod repeat;
mod results;
mod seconds;
mod trial;
mod windows;

use super::device::Device;
use super::{Finding, duration};
use crate::dut::batch::{
    BatchCurve, BatchOrder, BatchOutcome, BatchProgress, BatchTest, BatchTrouble, HeatTrouble,
};
use crate::dut::batch_shown::{BatchShown, SocketSwitched};
use crate::dut::experiment::Experiment;
use crate::instrument::act::{Act, JobDone, Read, Runner, RunnerState};
use crate::rig::image::Image;
use crate::rig::rack::Socket;
use chamber::lag::{Switching, Transition};
use contacts::Contact;
pub use contacts::Events;
use drop::{Found, Unreadable};
pub use passes::{Seen, Work};
pub use repeat::Shown;
pub use results::{Recorded, SCATTER_K, batch as judged};
use seconds::{Advance, Seconds};
use texts::Message;
use units::{RigTime, Span};

named! {
    /// Stage of the test of a batch.
    Stage {
        /// Contact resistances.
        Contacts = "Contacts",
        /// Identification of the chamber.
        Identification = "Identification",
        /// Passes through the windows.
        Passes = "Passes",
        /// Heat off.
        Off = "HeatOff",
    }
}

/// Time in which the scan reads every contact at least once.
const SEEN: Span = Span::ms(1_000);

/// Why a batch ends before its last pass.
#[derive(Debug, Clone)]
pub(super) enum Ended {
    /// The chamber is in trouble.
    Found(Finding),
    /// A transaction has failed.
    Trouble(Message),
}

#[derive(Debug)]
enum State {
    /// The fan runs until the scan has read every contact.
    Cold(Runner),
    /// Measures the resistances of the closed contacts of these sockets.
    Drops(Runner, Vec<Socket>),
    Seconds(Box<Seconds>),
    Off(Runner, Option<Ended>),
}

/// The test of a batch.
#[derive(Debug)]
pub struct Test {
    device: Device,
    order: BatchOrder,
    sockets: Vec<Socket>,
    contacts: Vec<Contact>,
    drops: Result<Vec<(u16, Found)>, Unreadable>,
    /// Experiment without parts; `None` for the test of parts.
    experiment: Option<Experiment>,
    /// Record and chamber of the heated part of the test, once it is over.
    ran: Option<Box<Seconds>>,
    state: State,
}

/// What the test does after a stage.
enum Next {
    State(Box<State>),
    Waiting(RunnerState),
    Judged,
}

impl Test {
    /// Begins the test of a batch; the door must be locked.
    pub fn begin(device: Device, order: &BatchOrder, now: RigTime) -> Self {
        let all = device.points.sockets.iter();
        let sockets: Vec<Socket> = all
            .filter(|it| order.sockets.contains(&it.number))
            .copied()
            .collect();
        assert_eq!(
            sockets.len(),
            order.sockets.len(),
            "a socket that the rack lacks"
        );
        let acts = vec![Act::Set(vec![(device.points.fan, true)]), Act::Wait(SEEN)];
        Self {
            contacts: sockets.iter().map(|it| Contact::new(it.contact)).collect(),
            state: State::Cold(Runner::new(acts, now)),
            order: order.clone(),
            drops: Ok(Vec::new()),
            experiment: None,
            ran: None,
            sockets,
            device,
        }
    }

    /// Begins an experiment without parts; the door must be locked.
    pub fn experiment(device: Device, what: Experiment, now: RigTime) -> Self {
        let nothing = BatchOrder {
            sockets: Vec::new(),
            number: 0,
        };
        Self {
            experiment: Some(what),
            ..Self::begin(device, &nothing, now)
        }
    }

    fn advance(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> Next {
        match &mut self.state {
            State::Cold(runner) => match runner.step(now, done, image) {
                RunnerState::Done => Next::State(Box::new(self.drops(now))),
                RunnerState::Trouble(why) => self.off(now, Some(Ended::Trouble(why))),
                waiting => Next::Waiting(waiting),
            },
            State::Drops(runner, sockets) => match runner.step(now, done, image) {
                RunnerState::Done => {
                    let found = drop::resistances(
                        &self.device.points,
                        &runner.readings,
                        &self.device.accuracy,
                    );
                    let numbers = sockets.iter().map(|it| it.number);
                    self.drops = found.map(|found| numbers.zip(found).collect());
                    let seconds = Seconds::begin(&self.device, self.experiment, now);
                    Next::State(Box::new(State::Seconds(Box::new(seconds))))
                }
                RunnerState::Trouble(why) => self.off(now, Some(Ended::Trouble(why))),
                waiting => Next::Waiting(waiting),
            },
            State::Seconds(seconds) => {
                match seconds.step(&self.device, &self.contacts, now, done, image) {
                    Advance::Waiting(state) => Next::Waiting(state),
                    Advance::Over => self.off(now, None),
                    Advance::Ended(why) => self.off(now, Some(why)),
                }
            }
            State::Off(runner, _) => match runner.step(now, done, image) {
                RunnerState::Done => Next::Judged,
                RunnerState::Trouble(why) => {
                    let (runner, why) = (Runner::new(Vec::new(), now), Some(Ended::Trouble(why)));
                    Next::State(Box::new(State::Off(runner, why)))
                }
                waiting => Next::Waiting(waiting),
            },
        }
    }

    /// Begins the resistances: from now on no contact counts as cold that was not read before.
    fn drops(&mut self, now: RigTime) -> State {
        self.contacts.iter_mut().for_each(Contact::warm);
        let closed = |(socket, contact): (&Socket, &Contact)| {
            (contact.cold() == Some(true)).then_some(*socket)
        };
        let closed: Vec<Socket> = self
            .sockets
            .iter()
            .zip(&self.contacts)
            .filter_map(closed)
            .collect();
        let acts = drop::acts(&self.device.points, &closed, &self.device.accuracy);
        State::Drops(Runner::new(acts, now), closed)
    }

    fn off(&self, now: RigTime, why: Option<Ended>) -> Next {
        let mut acts = self.device.heat_off(0.0);
        acts.push(Act::Read(Read::Restarts));
        Next::State(Box::new(State::Off(Runner::new(acts, now), why)))
    }

    /// Judges the parts, or voids them all when the batch has ended early.
    fn outcome(&self) -> BatchOutcome {
        let why = match &self.state {
            State::Off(_, why) => why.clone(),
            State::Cold(_) | State::Drops(..) | State::Seconds(_) => {
                panic!("a test judges at its end")
            }
        };
        if self.experiment.is_some() {
            return self.experiment_outcome(why);
        }
        let mut troubles = self.open_sockets();
        if let Some(Ended::Found(found)) = &why {
            troubles.extend(found.trouble());
        }
        let why = match (why, &self.drops) {
            (None, Err(Unreadable)) => Some(Ended::Found(Finding::DropNotReadable)),
            (why, _) => why,
        };
        let complete = self.ran.as_deref().filter(|it| it.last.is_some());
        let results = match (why, complete, &self.drops) {
            (None, Some(ran), Ok(drops)) => {
                let contacts = self.contacts.iter();
                let recorded = Recorded {
                    record: &ran.record,
                    events: contacts.clone().map(|it| it.events(ran.origin)).collect(),
                    cold_open: contacts.map(|it| it.cold() == Some(false)).collect(),
                    drops,
                    pulses: &ran.pulses,
                    ambient_c: ran.ambient_c,
                    last: ran.last.as_ref(),
                };
                troubles.extend(results::unexpected_lag(&self.device, &recorded));
                results::batch(&self.device, &self.order, &recorded, ran.work.as_ref())
            }
            (why, _, _) => results::void(&self.device, &self.order, why),
        };
        BatchOutcome {
            results,
            troubles,
            found: None,
        }
    }

    /// Returns what the experiment has found, or the trouble that ended it.
    fn experiment_outcome(&self, why: Option<Ended>) -> BatchOutcome {
        let work = self.ran.as_ref().and_then(|it| it.work.as_ref());
        let found = match (&why, work) {
            (None, Some(Work::Trial(trial))) => Some(trial.found()),
            (_, _) => None,
        };
        let troubles = match why {
            Some(Ended::Found(finding)) => finding.trouble().into_iter().collect(),
            Some(Ended::Trouble(_)) | None if found.is_none() => {
                vec![BatchTrouble::Heat(HeatTrouble::NotIdentified)]
            }
            Some(Ended::Trouble(_)) | None => Vec::new(),
        };
        BatchOutcome {
            results: Vec::new(),
            troubles,
            found,
        }
    }

    /// Returns the heated part of the test, under way or over.
    fn seconds(&self) -> Option<&Seconds> {
        match &self.state {
            State::Seconds(seconds) => Some(seconds),
            State::Cold(_) | State::Drops(..) | State::Off(..) => self.ran.as_deref(),
        }
    }

    fn switched(&self) -> Vec<SocketSwitched> {
        let Some(seconds) = self.seconds() else {
            return Vec::new();
        };
        let sockets = self.sockets.iter().zip(&self.contacts);
        let one = |(socket, contact): (&Socket, &Contact)| {
            let Switching { operate, reset } = contact.events(seconds.origin).switching;
            let times = |all: Vec<Transition>| all.into_iter().map(|it| it.first_s);
            SocketSwitched::new(socket.number, times(operate), times(reset))
        };
        sockets.map(one).collect()
    }

    /// Returns the trouble of contacts that were open before heating.
    fn open_sockets(&self) -> Vec<BatchTrouble> {
        let all = self.sockets.iter().zip(&self.contacts);
        let open = all.filter(|(_, contact)| contact.cold() == Some(false));
        let numbers: Vec<String> = open.map(|(socket, _)| socket.number.to_string()).collect();
        let said = (!numbers.is_empty()).then(|| BatchTrouble::SocketsOpen(numbers.join(", ")));
        said.into_iter().collect()
    }
}

impl BatchTest for Test {
    fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> BatchProgress {
        for contact in &mut self.contacts {
            contact.poll(image, now);
        }
        let mut done = done;
        loop {
            match self.advance(now, done.take(), image) {
                Next::Waiting(state) => return BatchProgress::Running(state),
                Next::Judged => return BatchProgress::Judged(self.outcome()),
                Next::State(next) => {
                    if let State::Seconds(ran) = std::mem::replace(&mut self.state, *next) {
                        self.ran = Some(ran);
                    }
                }
            }
        }
    }

    fn stage(&self) -> &'static str {
        let stage = match &self.state {
            State::Cold(_) | State::Drops(..) => Stage::Contacts,
            State::Seconds(seconds) => match &seconds.work {
                None
                | Some(Work::Identification(_) | Work::Room(_) | Work::Rest(..) | Work::Trial(_)) => {
                    Stage::Identification
                }
                Some(Work::Passes(_)) => Stage::Passes,
            },
            State::Off(..) => Stage::Off,
        };
        stage.name()
    }

    fn longest(&self) -> Span {
        let recipe = &self.device.recipe;
        let repeats = recipe.decision.slow_repeats;
        duration::longest(&self.device.thermostat, &recipe.limits, repeats)
    }

    fn shown(&self) -> BatchShown {
        let seconds = self.seconds();
        BatchShown {
            switched: self.switched(),
            ..seconds.map(Seconds::shown).unwrap_or_default()
        }
    }

    fn curve(&self) -> Option<BatchCurve> {
        let seconds = self.seconds().filter(|_| self.experiment.is_none())?;
        seconds.last.as_ref()?;
        Some(BatchCurve {
            origin: seconds.origin,
            air: seconds.kept.clone(),
            switched: self.switched(),
        })
    }
}
