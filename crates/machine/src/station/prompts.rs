//! Prompts of the lot under way: while a prompt is open nothing moves until its answer, a stop or an abort.
//!
//! A prompt opens in the turn in which its moment comes, stays open while the machine calls [`Prompts::asks`] in each
//! turn, and closes with its answer, or when the machine leaves the moment (after an abort it opens again).

use super::orders::Refused;
use crate::dut::prompt::{Prompt, PromptMoment};

/// Prompts of a run, in the order of the recipe.
#[derive(Debug, Default)]
pub(super) struct Prompts {
    all: Vec<Prompt>,
    /// Indices in `all` of the answered prompts.
    answered: Vec<usize>,
    /// Index in `all` of the open prompt.
    open: Option<usize>,
    /// Index in `all` of the prompt that was open in the turn before.
    shown: Option<usize>,
}

impl Prompts {
    pub fn new(all: Vec<Prompt>) -> Self {
        Self {
            all,
            ..Self::default()
        }
    }

    /// Returns the open prompt, if there is one.
    pub fn open(&self) -> Option<&Prompt> {
        self.open.map(|place| &self.all[place])
    }

    /// Begins a turn with no open prompt; [`Prompts::asks`] opens the one of the present moment.
    pub fn turn(&mut self) {
        self.shown = self.open.take();
    }

    /// Returns the open prompt if it has opened in this turn.
    pub fn opened(&self) -> Option<&Prompt> {
        self.open().filter(|_| self.open != self.shown)
    }

    fn next(&self, when: PromptMoment) -> Option<usize> {
        let mut places = 0..self.all.len();
        places.find(|it| self.all[*it].when == when && !self.answered.contains(it))
    }

    /// Returns true when a prompt of this moment has no answer.
    pub fn is_due(&self, when: PromptMoment) -> bool {
        self.next(when).is_some()
    }

    /// Opens the next prompt of this moment; returns false when all are answered.
    pub fn asks(&mut self, when: PromptMoment) -> bool {
        self.open = self.next(when);
        self.open.is_some()
    }

    /// Answers the open prompt; returns true when the answer stops the lot.
    ///
    /// # Errors
    /// Fails when the prompt is not open or has no such choice.
    pub fn answer(&mut self, name: &str, choice: &str) -> Result<bool, Refused> {
        let open = self.open.filter(|it| self.all[*it].name == name);
        let place = open.ok_or(Refused::NoPrompt)?;
        let Some(choice) = self.all[place].choice(choice) else {
            return Err(Refused::NoSuchChoice);
        };
        let stops = choice.stops;
        self.open = None;
        self.answered.push(place);
        Ok(stops)
    }

    /// Marks the prompts before and after a calibration as unanswered, because there will be another calibration.
    pub fn calibrate_again(&mut self) {
        let again = [
            PromptMoment::BeforeCalibration,
            PromptMoment::AfterCalibration,
        ];
        let all = &self.all;
        self.answered.retain(|it| !again.contains(&all[*it].when));
    }
}
