//! The end of a test: its curve goes to the history with the numbers of the parts.

use super::{Batch, BatchTurn};
use crate::handling::ledger::PartRole;
use crate::handling::output::EndedBatch;
use crate::handling::place::Place;
use crate::rig::rack::Socket;

impl Batch {
    /// Hands the curve of a test that has ended to the history, while its parts are still in their sockets.
    pub(super) fn hand_over(&mut self, turn: &mut BatchTurn) {
        let Some((curve, ended)) = self.ended.take() else {
            return;
        };
        let part = |socket: &Socket| match turn.ledger.part(Place::Socket(socket.number))?.role {
            PartRole::Lot(seq) => Some((socket.number, seq)),
            PartRole::Reference(_) => None,
        };
        turn.parts.batch = Some(Box::new(EndedBatch {
            number: self.number,
            curve,
            ended,
            parts: self.rack.sockets().iter().filter_map(part).collect(),
        }));
    }
}
