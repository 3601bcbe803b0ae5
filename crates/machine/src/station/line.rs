//! The line: a feeder, or the batch of a rack, with the part ledger. The station uses the line without knowing which of
//! the two it has, except for motions, beams and reference parts in the nest, which only a feeder has.

use super::turn::{Inputs, TurnOutput};
use crate::dut::Device;
use crate::dut::experiment::Experiment;
use crate::guard::Situation;
use crate::handling::batch::BatchTurn;
use crate::handling::mechanism::DEBOUNCE;
use crate::handling::recovery::Recovery;
use crate::handling::serial::Serials;
use crate::handling::turn::Turn;
use crate::handling::{Batch, Feeder, Ledger, Mechanism, Move, Place};
use crate::rig::image::Image;
use crate::rig::point::DigitalInput;
use std::collections::VecDeque;
use units::RigTime;

/// Feeder or batch of a rack, which brings parts to their test, with the ledger of the parts.
#[derive(Debug)]
pub(super) struct Line {
    pub handling: Handling,
    pub ledger: Ledger,
    pub serials: Serials,
    /// True while every actuator is homed, or while the rack is cool and holds no interrupted part. A jog and safe
    /// outputs end this.
    pub homed: bool,
}

/// The feeder, or the batch of a rack.
#[derive(Debug)]
pub(super) enum Handling {
    Feeder(Box<FeederLine>),
    Batch(Box<Batch>),
}

/// Feeder and mechanism.
#[derive(Debug)]
pub(super) struct FeederLine {
    pub feeder: Feeder,
    pub mechanism: Mechanism,
    pub recovery: Recovery,
    /// Beams that are dark (interrupted), each with the time since which it has been dark.
    pub dark: Vec<(DigitalInput, RigTime)>,
    /// Motions that wait for the order `step`, in maintenance.
    pub stepwise: VecDeque<Move>,
    /// Motions that wait until every end sensor is debounced and every input that they need is read.
    pub postponed: Vec<Move>,
}

impl FeederLine {
    /// Makes a line whose actuators may be anywhere.
    pub fn new(feeder: Feeder, mechanism: Mechanism) -> Self {
        Self {
            feeder,
            mechanism,
            recovery: Recovery::default(),
            dark: Vec::new(),
            stepwise: VecDeque::new(),
            postponed: Vec::new(),
        }
    }

    fn cut_off(&mut self, ledger: &Ledger) {
        self.feeder.cut_off(ledger);
        self.stepwise.clear();
        self.postponed.clear();
        self.mechanism.forget();
    }

    fn postpone(&mut self, now: RigTime, image: &Image, output: &mut TurnOutput) {
        self.postponed.append(&mut output.rig.motions);
        let unread = |it: &Move| self.mechanism.needs_unread_input(*it, now, image);
        if self.mechanism.is_undecided() || self.postponed.iter().any(unread) {
            let soon = now + DEBOUNCE;
            let wake_at = &mut output.rig.wake_at;
            *wake_at = Some(wake_at.map_or(soon, |at| at.min(soon)));
        } else {
            output.rig.motions.append(&mut self.postponed);
        }
        let waiting = self.stepwise.iter().chain(&self.postponed).copied();
        self.mechanism.keep_waiting(&waiting.collect::<Vec<_>>());
    }

    fn check(&self, ledger: &Ledger) {
        let places = self.feeder.nests().len() as u64 + 3;
        assert!(ledger.inside() <= places, "more parts than places");
        let beams = self.feeder.beams().count();
        assert!(self.dark.len() <= beams, "a dark beam without a bin");
    }
}

/// Facts about lot and run that the turn of a batch needs.
#[derive(Debug, Clone, Copy)]
pub(super) struct BatchTerms<'a> {
    pub device: &'a Device,
    /// Number of parts that the lot still lacks; `None` for an endless lot.
    pub lacking: Option<u64>,
    pub attended: bool,
    /// True when another batch may begin.
    pub begins: bool,
    pub experiment: Option<Experiment>,
}

impl Line {
    pub fn new(handling: Handling, ledger: Ledger, serials: Serials) -> Self {
        Self {
            handling,
            ledger,
            serials,
            homed: false,
        }
    }

    /// Returns the feeder with its mechanism; `None` on a rig with a rack.
    pub fn feeder(&self) -> Option<&FeederLine> {
        match &self.handling {
            Handling::Feeder(own) => Some(own),
            Handling::Batch(_) => None,
        }
    }

    /// Returns [`Self::feeder`] for changes.
    pub fn feeder_mut(&mut self) -> Option<&mut FeederLine> {
        match &mut self.handling {
            Handling::Feeder(own) => Some(own),
            Handling::Batch(_) => None,
        }
    }

    /// Returns the batch; `None` on a rig with a feeder.
    pub fn batch(&self) -> Option<&Batch> {
        match &self.handling {
            Handling::Feeder(_) => None,
            Handling::Batch(batch) => Some(batch),
        }
    }

    /// Returns [`Self::batch`] for changes.
    pub fn batch_mut(&mut self) -> Option<&mut Batch> {
        match &mut self.handling {
            Handling::Feeder(_) => None,
            Handling::Batch(batch) => Some(batch),
        }
    }

    /// Returns the feeder with the context of a turn for it; `None` on a rig with a rack.
    pub fn at<'a>(
        &'a mut self,
        now: RigTime,
        inputs: &'a Inputs,
        output: &'a mut TurnOutput,
        reference_serials: &'a mut VecDeque<String>,
        resting: bool,
    ) -> Option<(&'a mut Feeder, &'a mut Recovery, Turn<'a>)> {
        assert!(
            output.notes.feeder.is_empty(),
            "trouble of the turn before is left"
        );
        let Handling::Feeder(own) = &mut self.handling else {
            return None;
        };
        let turn = Turn {
            now,
            image: inputs.image,
            mechanism: &own.mechanism,
            ledger: &mut self.ledger,
            rig: &mut output.rig,
            parts: &mut output.record.parts,
            trouble: &mut output.notes.feeder,
            reference_serials,
            serials: &mut self.serials,
            recorded: inputs.recorded,
            resting,
        };
        Some((&mut own.feeder, &mut own.recovery, turn))
    }

    /// Returns the batch with the context of a turn for it; `None` on a rig with a feeder.
    pub fn batch_at<'a>(
        &'a mut self,
        now: RigTime,
        inputs: &'a Inputs,
        output: &'a mut TurnOutput,
        terms: BatchTerms<'a>,
    ) -> Option<(&'a mut Batch, BatchTurn<'a>)> {
        let Handling::Batch(batch) = &mut self.handling else {
            return None;
        };
        let turn = BatchTurn {
            now,
            image: inputs.image,
            ledger: &mut self.ledger,
            rig: &mut output.rig,
            parts: &mut output.record.parts,
            trouble: &mut output.notes.feeder,
            serials: &mut self.serials,
            device: terms.device,
            recorded: inputs.recorded,
            lacking: terms.lacking,
            attended: terms.attended,
            begins: terms.begins,
            experiment: terms.experiment,
        };
        Some((batch, turn))
    }

    /// Panics when an invariant of the line is broken.
    pub fn check(&self) {
        let ledger = &self.ledger;
        assert!(ledger.balances(), "a part is in two places or in none");
        match &self.handling {
            Handling::Feeder(own) => own.check(ledger),
            Handling::Batch(batch) => {
                let sockets = batch.rack().sockets().len() as u64;
                assert!(ledger.inside() <= sockets, "more parts than sockets");
            }
        }
    }

    /// Forgets positions, motions and the test when the outputs are made safe; homing must follow.
    pub fn cut_off(&mut self, now: RigTime) {
        match &mut self.handling {
            Handling::Feeder(own) => own.cut_off(&self.ledger),
            Handling::Batch(batch) => batch.cut_off(now),
        }
        self.homed = false;
    }

    /// Records a motion that the guard has cleared and the rig has driven.
    pub fn driven(&mut self, movement: Move, now: RigTime, image: &Image) {
        let ledger = &mut self.ledger;
        let Handling::Feeder(own) = &mut self.handling else {
            panic!("{movement:?} at a rack");
        };
        own.mechanism.driven(movement, now, image);
        own.feeder.driven(movement, ledger, now);
    }

    /// Returns the situation for the guard; `None` on a rig with a rack, where nothing moves.
    pub fn situation(&self, now: RigTime, image: &Image) -> Option<Situation> {
        let own = self.feeder()?;
        let parts = own.feeder.part_places(&self.ledger);
        Some(own.mechanism.situation(parts, now, image))
    }

    /// Holds motions back until every end sensor is debounced and every needed input is read. Until then the guard
    /// would assume the whole stroke for an undecided sensor, and would count an unread input as off.
    pub fn postpone(&mut self, now: RigTime, image: &Image, output: &mut TurnOutput) {
        if let Some(own) = self.feeder_mut() {
            own.postpone(now, image, output);
        }
    }

    /// Returns true while a motion is in progress.
    pub fn is_moving(&self) -> bool {
        let moving = |own: &FeederLine| own.mechanism.moving().next().is_some();
        self.feeder().is_some_and(moving)
    }

    /// Returns true when every part is in a waiting position.
    pub fn is_at_rest(&self) -> bool {
        match &self.handling {
            Handling::Feeder(own) => {
                own.feeder.is_at_rest(!own.dark.is_empty())
                    && !self.ledger.holds(Place::Falling)
                    && !self.is_moving()
            }
            Handling::Batch(batch) => batch.is_at_rest(),
        }
    }

    /// Returns true when no part is inside and every row is safely on the disk. If `pocket` is false, a part of this
    /// run may still wait in the pocket.
    pub fn is_finished(&self, pocket: bool, recorded: u64, output: &TurnOutput) -> bool {
        let ledger = &self.ledger;
        let empty = ledger.each().all(|(place, _)| place == Place::Pocket);
        let waiting = ledger.holds(Place::Pocket) && (pocket || ledger.is_pocket_found());
        let mut judged = output.record.parts.judged.iter();
        let durable = judged.all(|judged| judged.part.ordinal <= recorded);
        let still = match &self.handling {
            Handling::Feeder(own) => own.feeder.moves_no_part(),
            Handling::Batch(batch) => batch.is_empty(),
        };
        empty && !waiting && durable && still
    }

    /// Returns the stage of the test under way, if there is one.
    pub fn stage(&self) -> Option<&'static str> {
        match &self.handling {
            Handling::Feeder(own) => Some(own.feeder.test()?.stage()),
            Handling::Batch(batch) => Some(batch.test()?.stage()),
        }
    }
}
