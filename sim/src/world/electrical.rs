//! The world as instruments see it: the circuit of the board with the part in the nest.

use super::{World, in_nest};
use crate::scpi::circuit::{Circuit, Drive, Reading, Terminal};
use crate::terminal::Plant;

impl Circuit for World {
    fn advance(&mut self, t_us: u64) {
        Plant::advance(self, t_us);
    }

    fn drive(&mut self, terminal: Terminal, drive: Drive) {
        let now_us = self.now_us as f64;
        self.fixture.advance(now_us, in_nest(&mut self.mechanism));
        self.fixture.drive(terminal, drive);
    }

    fn at(&self, terminal: Terminal) -> Reading {
        self.fixture.at(terminal, self.specimen())
    }

    fn line_deg(&self) -> f64 {
        self.fixture.line_deg()
    }
}
