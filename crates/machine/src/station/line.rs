//! The line: feeder, mechanism, part ledger, and waiting motions.

use super::turn::{Inputs, TurnOutput};
use crate::guard::Situation;
use crate::handling::mechanism::DEBOUNCE;
use crate::handling::recovery::Recovery;
use crate::handling::serial::Serials;
use crate::handling::turn::Turn;
use crate::handling::{Feeder, Ledger, Mechanism, Move, Place};
use crate::rig::image::Image;
use crate::rig::point::DigitalInput;
use std::collections::VecDeque;
use units::RigTime;

/// Feeder, mechanism and ledger.
#[derive(Debug)]
pub(super) struct Line {
    pub feeder: Feeder,
    pub ledger: Ledger,
    pub mechanism: Mechanism,
    pub recovery: Recovery,
    pub serials: Serials,
    /// True while every actuator is homed; a jog and safe outputs end this.
    pub homed: bool,
    /// Beams that are dark (interrupted), each with the time since which it has been dark.
    pub dark: Vec<(DigitalInput, RigTime)>,
    /// Motions that wait for the order `step`, in maintenance.
    pub stepwise: VecDeque<Move>,
    /// Motions that wait until every end sensor is debounced.
    pub postponed: Vec<Move>,
}

impl Line {
    pub fn new(feeder: Feeder, ledger: Ledger, mechanism: Mechanism, serials: Serials) -> Self {
        Self {
            feeder,
            ledger,
            mechanism,
            recovery: Recovery::default(),
            serials,
            homed: false,
            dark: Vec::new(),
            stepwise: VecDeque::new(),
            postponed: Vec::new(),
        }
    }

    /// Returns feeder, recovery, and the context of a turn for both.
    pub fn at<'a>(
        &'a mut self,
        now: RigTime,
        inputs: &'a Inputs,
        output: &'a mut TurnOutput,
        reference_serials: &'a mut VecDeque<String>,
        resting: bool,
    ) -> (&'a mut Feeder, &'a mut Recovery, Turn<'a>) {
        assert!(
            output.notes.feeder.is_empty(),
            "trouble of the turn before is left"
        );
        let turn = Turn {
            now,
            image: inputs.image,
            mechanism: &self.mechanism,
            ledger: &mut self.ledger,
            rig: &mut output.rig,
            parts: &mut output.record.parts,
            trouble: &mut output.notes.feeder,
            reference_serials,
            serials: &mut self.serials,
            recorded: inputs.recorded,
            resting,
        };
        (&mut self.feeder, &mut self.recovery, turn)
    }

    /// Panics when an invariant of the line is broken.
    pub fn check(&self) {
        let ledger = &self.ledger;
        assert!(ledger.balances(), "a part is in two places or in none");
        let places = self.feeder.nests().len() as u64 + 3;
        assert!(ledger.inside() <= places, "more parts than places");
        let beams = self.feeder.beams().count();
        assert!(self.dark.len() <= beams, "a dark beam without a bin");
    }

    /// Forgets the positions of all actuators and drops all motions, under way or queued, because the outputs are made
    /// safe; homing must follow.
    pub fn cut_off(&mut self) {
        self.feeder.cut_off(&self.ledger);
        self.stepwise.clear();
        self.postponed.clear();
        self.mechanism.forget();
        self.homed = false;
    }

    /// Records a motion that the guard has cleared and the rig has driven.
    pub fn driven(&mut self, movement: Move, now: RigTime, image: &Image) {
        self.mechanism.driven(movement, now, image);
        self.feeder.driven(movement, &mut self.ledger, now);
    }

    /// Returns the situation for the guard.
    pub fn situation(&self, now: RigTime, image: &Image) -> Situation {
        let parts = self.feeder.part_places(&self.ledger);
        self.mechanism.situation(parts, now, image)
    }

    /// Holds motions back until every end sensor is debounced, because the guard assumes the whole stroke of an
    /// actuator whose sensor is undecided.
    pub fn postpone(&mut self, now: RigTime, output: &mut TurnOutput) {
        self.postponed.append(&mut output.rig.motions);
        if self.mechanism.is_undecided() {
            let soon = now + DEBOUNCE;
            let wake_at = &mut output.rig.wake_at;
            *wake_at = Some(wake_at.map_or(soon, |at| at.min(soon)));
        } else {
            output.rig.motions.append(&mut self.postponed);
        }
        let waiting = self.stepwise.iter().chain(&self.postponed).copied();
        self.mechanism.keep_waiting(&waiting.collect::<Vec<_>>());
    }

    /// Returns true when every part is in a waiting position.
    pub fn is_at_rest(&self) -> bool {
        self.feeder.is_at_rest(!self.dark.is_empty())
            && !self.ledger.holds(Place::Falling)
            && self.mechanism.moving().next().is_none()
    }

    /// Returns true when no part is inside and every row is safely on the disk. If `pocket` is false, a part of this
    /// run may still wait in the pocket.
    pub fn is_finished(&self, pocket: bool, recorded: u64, output: &TurnOutput) -> bool {
        let ledger = &self.ledger;
        let empty = ledger.each().all(|(place, _)| place == Place::Pocket);
        let waiting = ledger.holds(Place::Pocket) && (pocket || ledger.is_pocket_found());
        let mut judged = output.record.parts.judged.iter();
        let durable = judged.all(|judged| judged.part.ordinal <= recorded);
        empty && !waiting && durable && self.feeder.moves_no_part()
    }
}
