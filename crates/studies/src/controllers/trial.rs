//! Trials of one controller: ramps from 40 to 100 C, the open door, the slow ramp of a referee.

use super::contender::Contender;
use super::plant::Plant;
use chamber::control::Controller;
use chamber::ramp::Ramp;
use chamber::tune::Identified;
use chamber::watch::slope::SlidingSlope;

/// Ends of the ramp, C.
const ENDS_C: [f64; 2] = [40.0, 100.0];
/// Time at the lower end before a ramp, s.
const BEFORE_S: usize = 1500;
/// Time at the upper end after a ramp, s.
const AFTER_S: usize = 900;
/// Last part of the time at the upper end, which counts as hold, s.
const HOLD_S: usize = 300;
/// Error within which the chamber has settled, K.
const SETTLED_K: f64 = 0.2;
/// Error within which the chamber has recovered from the door, K.
const RECOVERED_K: f64 = 0.5;
/// Time for which the door is open, s.
const DOOR_S: usize = 20;
/// Rate of a referee ramp, K/min.
const REFEREE_K_PER_MIN: f64 = 0.5;

/// One second of a trial.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// Set point that the controller follows, C.
    pub wanted_c: f64,
    /// Temperature at the sensor without noise, C.
    pub exact_c: f64,
}

/// Figures of a ramp.
#[derive(Debug, Clone)]
pub struct Tracked {
    /// Largest error along the ramp and after it, K.
    pub worst_k: f64,
    /// Greatest excess over the end of the ramp, K.
    pub overshoot_k: f64,
    /// Time from the end of the ramp to the last error above 0.2 K, s.
    pub settled_s: f64,
    /// Standard deviation at the end of the hold, K.
    pub hold_sd_k: f64,
    /// All seconds from the start of the ramp.
    pub moments: Vec<Moment>,
}

/// A controller running a chamber.
pub struct Trial {
    plant: Plant,
    controller: Controller,
    ramp: Ramp,
    /// Set points of the last seconds, which the feedback follows with a delay.
    past_c: Vec<f64>,
}

impl Trial {
    /// Brings a cold chamber to the lower end of the ramp; `chamber` holds its identified figures.
    pub fn new(contender: Contender, plant: Plant, chamber: &Identified) -> Self {
        let delay_s = if contender.forward {
            chamber.delay_s.round() as usize
        } else {
            0
        };
        let mut trial = Self {
            ramp: Ramp::at(ENDS_C[0]),
            controller: contender.controller(chamber),
            plant,
            past_c: vec![ENDS_C[0]; delay_s + 1],
        };
        trial.run(BEFORE_S);
        trial
    }

    fn second(&mut self) -> Moment {
        let seen = self.plant.seen();
        let set = self.ramp.step(seen.measured_c);
        let command = self.controller.step(&set, &seen);
        self.plant.step(command);
        self.past_c.rotate_left(1);
        let last = self.past_c.len() - 1;
        self.past_c[last] = set.value_c;
        Moment {
            wanted_c: self.past_c[0],
            exact_c: self.plant.exact_c(),
        }
    }

    fn run(&mut self, seconds: usize) -> Vec<Moment> {
        (0..seconds).map(|_| self.second()).collect()
    }

    /// Brings the chamber back to the lower end of the ramp, and waits until it has settled.
    pub fn back(&mut self) {
        self.ramp.head_for(ENDS_C[0], 5.0);
        self.run(3600 + BEFORE_S);
    }

    /// Ramps to the upper end at a rate, K/min, and holds it.
    pub fn track(&mut self, rate: f64) -> Tracked {
        let end_c = ENDS_C[1];
        self.ramp.head_for(end_c, rate);
        let mut moments = Vec::new();
        while !self.ramp.is_at_end() && moments.len() < 20_000 {
            moments.push(self.second());
        }
        let ramped = moments.len();
        moments.extend(self.run(AFTER_S));
        let error = |it: &Moment| (it.wanted_c - it.exact_c).abs();
        let unsettled = moments[ramped..]
            .iter()
            .rposition(|it| error(it) > SETTLED_K);
        let hold: Vec<f64> = moments[moments.len() - HOLD_S..]
            .iter()
            .map(|it| it.exact_c)
            .collect();
        Tracked {
            worst_k: moments.iter().map(error).fold(0.0, f64::max),
            overshoot_k: moments
                .iter()
                .map(|it| it.exact_c - end_c)
                .fold(0.0, f64::max),
            settled_s: unsettled.map_or(0.0, |it| it as f64 + 1.0),
            hold_sd_k: quality::Spread::of(&hold).sd().unwrap_or(f64::NAN),
            moments,
        }
    }

    /// Opens the door for 20 s; returns the time from closing until the error stays within 0.5 K, s, and the excess, K.
    pub fn door(&mut self) -> [f64; 2] {
        self.plant.door_open = true;
        self.run(DOOR_S);
        self.plant.door_open = false;
        let after = self.run(AFTER_S);
        let end_c = ENDS_C[1];
        let away = after
            .iter()
            .rposition(|it| (it.exact_c - end_c).abs() > RECOVERED_K);
        let over = after
            .iter()
            .map(|it| it.exact_c - end_c)
            .fold(0.0, f64::max);
        [away.map_or(0.0, |it| it as f64 + 1.0), over]
    }

    /// Ramps by 15 K at the rate of a referee test; returns the greatest slope of the reference sensor over a minute,
    /// K/min, once the ramp has started.
    pub fn referee(&mut self) -> f64 {
        self.ramp.head_for(ENDS_C[0] + 15.0, REFEREE_K_PER_MIN);
        let mut slope = SlidingSlope::default();
        let steps = (0..1700).map(|_| {
            self.second();
            slope.step(self.plant.reference_c())
        });
        steps.flatten().fold(0.0, f64::max)
    }
}
