//! Memory of the guard's earlier answers.
//!
//! Sensors report only ends and the station repeats its cycle, so a lot asks the same few hundred questions again and
//! again. The key of an answer holds every bit on which the answer depends (the scene is fixed), so a remembered answer
//! equals a computed one.

use super::actuator::{Actuator, Position};
use super::motion::Motion;
use super::refusal::Refusal;
use super::situation::Situation;
use std::collections::HashMap;

/// Greatest number of answers kept, at about 400 bytes each; the memory clears itself when it is full.
const LIMIT: usize = 4096;

/// The bits of a motion and a situation: the key of an answer.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Question {
    /// By actuator: kind of position (0 unknown, 1 `At`, 2 `Between`), its two numbers, and the target if it moves.
    actuators: [(u8, u64, u64, Option<u64>); 8],
    parts: super::situation::PartPlaces,
    size: [u64; 4],
    granted: u16,
}

impl Question {
    pub fn of(motion: &Motion, situation: &Situation) -> Question {
        let one = |actuator: Actuator| {
            let (kind, low, high) = match situation.position(actuator) {
                None => (0, 0.0, 0.0),
                Some(Position::At(mm)) => (1, mm, mm),
                Some(Position::Between { from_mm, to_mm }) => (2, from_mm, to_mm),
            };
            (
                kind,
                low.to_bits(),
                high.to_bits(),
                motion.target_mm(actuator).map(f64::to_bits),
            )
        };
        let [x, y, z] = situation.part_size.body_mm;
        Question {
            actuators: Actuator::ALL.map(one),
            parts: situation.parts,
            granted: situation.granted,
            size: [x, y, z, situation.part_size.pin_length_mm].map(f64::to_bits),
        }
    }
}

#[derive(Debug, Clone, Default)]
pub(super) struct Memory {
    answers: HashMap<Question, Result<(), Refusal>>,
}

impl Memory {
    pub fn answer(&self, question: &Question) -> Option<Result<(), Refusal>> {
        self.answers.get(question).cloned()
    }

    pub fn keep(&mut self, question: Question, answer: Result<(), Refusal>) {
        if self.answers.len() >= LIMIT {
            self.answers.clear();
        }
        self.answers.insert(question, answer);
    }
}
