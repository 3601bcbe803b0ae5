//! Heat without command in a chamber whose response to power is not known yet: before and during its identification.
//!
//! Air without power warms only at what is hotter: walls and rack that have kept the heat of an earlier batch, or a
//! heater that a shorted power unit still feeds. The rise shows which it is:
//!
//! | source | rise of the air |
//! |---|---|
//! | walls and rack, after the vent has closed or the door was open | to their own temperature within a minute, then under 3 K/min |
//! | fan alone | under 1 K/min |
//! | power unit shorted, a half wave or all | 6 to 13 K/min for as long as it lasts, most of it in the first minute |
//!
//! The slope therefore counts once the heater has been off, and the vent has not closed, for a minute; within that
//! minute the check allows the rise that walls can make.

use super::lasting::Recent;
use crate::control::split_range::Command;

/// Time after which walls and air have evened out, s.
const EVENS_S: u32 = 40;
/// Rise from walls that are hotter than the air, K: with the fan on and the vent open they are 10 K above it; after the
/// door was open, 20 K.
const WALL_K: f64 = 25.0;
/// Length of the stretch that gives the slope, s.
const SLOPE_S: usize = 20;
/// Slope that only a heater makes once walls and air have evened out, K/s.
const HEATED_K_PER_S: f64 = 4.0 / 60.0;
/// Change within `SLOPE_S` that only a heater far above the power of an identification makes, K: the step of an
/// identification makes half of this.
const RACE_K: f64 = 8.0;
/// A vent that closes by more than this lets the walls warm the air.
const CLOSES: f64 = 0.05;

/// State of the check, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Unpowered {
    recent: Recent,
    /// Temperature when the heater was last on or the vent last closed, C; `None` before the first second.
    from_c: Option<f64>,
    /// Seconds since the heater was last on or the vent last closed.
    quiet_s: u32,
    vent: f64,
}

impl Default for Unpowered {
    fn default() -> Self {
        Self {
            recent: Recent::of(SLOPE_S),
            from_c: None,
            quiet_s: 0,
            vent: 0.0,
        }
    }
}

impl Unpowered {
    /// Takes the reading of a second, C, and the command of that second; returns true when the chamber heats without
    /// command.
    pub fn step(&mut self, reading_c: f64, command: Command) -> bool {
        let closes = command.vent + CLOSES < self.vent;
        let is_quiet = command.heater == 0.0 && !closes;
        self.vent = match closes {
            true => command.vent,
            false => self.vent.max(command.vent),
        };
        self.recent.push(reading_c);
        self.quiet_s = if is_quiet { self.quiet_s + 1 } else { 0 };
        let from_c = match self.from_c {
            Some(from_c) if is_quiet => from_c,
            Some(_) | None => reading_c,
        };
        self.from_c = Some(from_c);
        if command.heater > 0.0 {
            return self.recent.range().is_some_and(|it| it > RACE_K);
        }
        let steep = self.recent.slope().is_some_and(|it| it > HEATED_K_PER_S);
        let evened = self.quiet_s > EVENS_S + SLOPE_S as u32;
        reading_c > from_c + WALL_K || evened && steep
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_plant::Plant;

    const AT: fn(f64) -> Command = |heater| Command { heater, vent: 0.0 };

    /// Returns the second in which the check finds heat, within five minutes; `driven` reaches the heater.
    fn found(plant: &mut Plant, command: Command, driven: Command) -> Option<usize> {
        let mut watch = Unpowered::default();
        (0..300).find(|_| {
            plant.step(driven);
            watch.step(plant.seen().measured_c, command)
        })
    }

    /// Returns a chamber that was hot for an hour, then cooled by its vent to `cooled_c`, then stood open for some
    /// seconds.
    fn warm(hot_c: f64, cooled_c: f64, open_s: usize) -> Plant {
        let mut plant = Plant::at(hot_c);
        let vented = Command {
            vent: 1.0,
            ..AT(0.0)
        };
        while plant.step(vented).measured_c > cooled_c {}
        plant.door_open = true;
        for _ in 0..open_s {
            plant.step(Command::OFF);
        }
        plant.door_open = false;
        plant
    }

    #[test]
    fn walls_that_kept_their_heat_are_no_trouble() {
        for (hot_c, cooled_c, open_s) in [
            (95.0, 46.0, 0),
            (95.0, 40.0, 20),
            (95.0, 46.0, 240),
            (140.0, 46.0, 240),
        ] {
            let mut plant = warm(hot_c, cooled_c, open_s);
            let before_c = plant.seen().measured_c;
            assert_eq!(
                found(&mut plant, AT(0.0), AT(0.0)),
                None,
                "{hot_c} {cooled_c} {open_s}"
            );
            assert!(plant.seen().measured_c > before_c + 5.0);
        }
    }

    #[test]
    fn a_vent_that_closes_may_warm_the_air() {
        let mut plant = warm(95.0, 46.0, 0);
        let mut watch = Unpowered::default();
        let mut step = |command| {
            plant.step(command);
            watch.step(plant.seen().measured_c, command)
        };
        assert!(!(0..90).any(|_| step(Command {
            vent: 1.0,
            ..AT(0.0)
        })));
        assert!(!(0..300).any(|_| step(AT(0.0))));
    }

    #[test]
    fn a_shorted_power_unit_shows_within_a_minute() {
        for share in [1.0, 0.85, 0.5] {
            for mut plant in [Plant::at(25.0), warm(95.0, 46.0, 240)] {
                let second = found(&mut plant, AT(0.0), AT(share));
                assert!(second.is_some_and(|it| it <= 61), "{share}: {second:?}");
            }
        }
    }

    #[test]
    fn a_unit_that_shorts_later_shows_sooner() {
        let (mut plant, mut watch) = (warm(95.0, 46.0, 240), Unpowered::default());
        let mut step = |driven: f64| {
            plant.step(AT(driven));
            watch.step(plant.seen().measured_c, AT(0.0))
        };
        assert!(!(0..120).any(|_| step(0.0)));
        let second = (0..60).position(|_| step(0.5));
        assert!(second.is_some_and(|it| it <= 25), "{second:?}");
    }

    #[test]
    fn a_race_under_the_step_of_an_identification_shows() {
        assert_eq!(found(&mut Plant::at(25.0), AT(0.15), AT(0.15)), None);
        let second = found(&mut Plant::at(25.0), AT(0.15), AT(1.0));
        assert!(second.is_some_and(|it| it <= 30), "{second:?}");
    }
}
