//! Finds the temperature of the room around a chamber whose response is known: rest, then a cooling if the rest shows
//! that the chamber is warm.

use super::Identified;
use super::cool::{Cooling, is_cold};
use crate::control::split_range::Command;
use crate::statistics::slope;

/// Length of the rest, s; its slope comes from the last part.
const REST_S: usize = 180;
const SLOPE_S: usize = 120;
/// Greatest excess over the room that the slope of a rest may show for a chamber that counts as cold, K. Walls that
/// take up the heat of the fan show some 2 K, and 0.3 K more for each kelvin by which the whole chamber is warm.
const COLD_K: f64 = 3.0;
/// Vent open, no heat.
const VENTED: Command = Command {
    heater: 0.0,
    vent: 1.0,
};

/// Outcome of one second of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// The outputs until the next second.
    Go(Command),
    /// The temperature of the room is found; outputs are off.
    Done {
        /// Temperature of the room, C.
        room_c: f64,
        /// True when the vent was open, so that the chamber needs another rest.
        vented: bool,
    },
}

/// State of the search, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct RoomSearch {
    chamber: Identified,
    rest_c: Vec<f64>,
    cooling: Option<Cooling>,
}

impl RoomSearch {
    /// Starts with the response of the chamber.
    pub fn new(chamber: &Identified) -> Self {
        Self {
            chamber: *chamber,
            rest_c: Vec::with_capacity(REST_S + 1),
            cooling: None,
        }
    }

    /// Returns the response of the chamber.
    pub fn chamber(&self) -> Identified {
        self.chamber
    }

    /// Takes the reading of this second, C. A cold chamber has begun at the temperature of the room; for a warm chamber
    /// this temperature follows from the end of the cooling.
    pub fn step(&mut self, measured_c: f64) -> Step {
        if let Some(cooling) = &mut self.cooling {
            let cooled = cooling.step(measured_c);
            return cooled.map_or(Step::Go(VENTED), |it| Step::Done {
                room_c: it.ambient_c(&self.chamber).unwrap_or(measured_c),
                vented: true,
            });
        }
        self.rest_c.push(measured_c);
        if self.rest_c.len() <= REST_S {
            return Step::Go(Command::OFF);
        }
        if self.began_cold() {
            return Step::Done {
                room_c: self.rest_c[0],
                vented: false,
            };
        }
        self.cooling = Some(Cooling::default());
        Step::Go(VENTED)
    }

    /// Returns true when rise and slope of the rest are those of a cold chamber, and its losses do not yet show.
    fn began_cold(&self) -> bool {
        let drift = slope(&self.rest_c[REST_S - SLOPE_S..]);
        let lost = self.chamber.fan - drift / self.chamber.slope_k_per_s;
        is_cold(&self.rest_c, drift) && lost <= COLD_K * self.chamber.loss_per_k
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_plant::{AMBIENT_C, Plant, identified};

    /// Returns what the search finds on a chamber that begins at one temperature, and whether it opened the vent.
    fn found(start_c: f64) -> (f64, bool) {
        let mut plant = Plant::at(start_c);
        let mut search = RoomSearch::new(&identified());
        loop {
            match search.step(plant.seen().measured_c) {
                Step::Go(command) => plant.step(command),
                Step::Done { room_c, vented } => return (room_c, vented),
            };
        }
    }

    #[test]
    fn a_cold_chamber_begins_at_the_room() {
        let (room_c, vented) = found(AMBIENT_C);
        assert!(
            (room_c - AMBIENT_C).abs() < 0.1 && !vented,
            "{room_c} {vented}"
        );
    }

    #[test]
    fn a_warm_chamber_shows_the_room_after_cooling() {
        for start_c in [33.0, 40.0, 60.0, 80.0] {
            let (room_c, vented) = found(start_c);
            assert!(
                (room_c - AMBIENT_C).abs() < 0.5 && vented,
                "{start_c}: {room_c} {vented}"
            );
        }
    }
}
