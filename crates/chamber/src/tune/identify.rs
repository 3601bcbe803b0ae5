//! Identification run: rest, heat, coast, vent; stepped once a second.
//!
//! | stage | outputs | gives |
//! |---|---|---|
//! | rest | fan only | drift before the step |
//! | heat | heater at the step | gain, time constant, delay, slope |
//! | coast | fan only | losses and fan, together with the drift of the rest |
//! | vent | vent open | power that the vent removes |
//!
//! The run takes 15 minutes and heats by some 20 K. When the rest shows that the chamber is warm, the run first cools
//! it with the vent open, then rests again.

mod doubt;

use super::cool::{self, Cooled, Cooling};
use super::fit;
use super::response::Response;
use super::{FirstOrder, Identified};
use crate::control::split_range::Command;
use crate::statistics::{mean, slope};

/// Lengths of rest, heat, coast and vent, s.
const LENGTHS_S: [usize; 4] = [180, 300, 300, 90];
/// Stretch at the end of rest and coast that gives the drift, s.
const DRIFT_S: usize = 120;
/// Length of the response that the first-order model fits, s.
const FIRST_ORDER_S: usize = 120;
/// Least delay of the first-order model, as a share of the delay of the whole response. With a quick sensor the model
/// alone would show hardly any delay, and a loop that is tuned on it oscillates.
const LEAST_DELAY: f64 = 0.65;
/// Least delay of the first-order model, s: sampling and the filter of the derivative.
const LEAST_DELAY_S: f64 = 4.2;
/// Greatest rate at which losses take back a rise, 1/s: with a greater one the fit could not tell both parts of the
/// response from each other.
const MOST_RETURN_PER_S: f64 = 1.0 / 300.0;
/// Least rise of the heat stage, K.
const LEAST_RISE_K: f64 = 3.0;
/// Least rise of a later minute of the heat stage, beyond the drift, K: less shows a heater that has broken.
const LEAST_MINUTE_K: f64 = 0.3;
/// Length of each minute compared with [`LEAST_MINUTE_K`], s.
const MINUTE_S: usize = 60;
/// Coolings after which a chamber that still drifts is identified as it is.
const MOST_COOLINGS: usize = 2;
/// Iterations that find the temperature around a cooled chamber.
const AMBIENT_ROUNDS: usize = 8;
/// Vent open, no heat.
const VENTED: Command = Command {
    heater: 0.0,
    vent: 1.0,
};

/// Why a run gives no figures.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// The chamber did not follow the heater.
    #[error(
        "found a rise of {found_k:.1} K at {power} of the heater, expected {LEAST_RISE_K} K or more"
    )]
    NoRise {
        /// Rise, K.
        found_k: f64,
        /// Step of the heater.
        power: f64,
    },
    /// The chamber stopped following the heater.
    #[error(
        "found a rise of {found_k:.1} K in a minute of heat, expected {LEAST_MINUTE_K} K or more"
    )]
    Stalls {
        /// Rise beyond the drift, K.
        found_k: f64,
    },
    /// The chamber became too hot for the experiment.
    #[error("found {found_c:.1} C, expected at most {limit_c:.1} C")]
    TooHot {
        /// Temperature, C.
        found_c: f64,
        /// Limit, C.
        limit_c: f64,
    },
    /// The response has a part without rise, by which the feed-forward would divide.
    #[error(
        "found a gain of {gain_k:.1} K and a slope of {slope_k_per_s:.4} K/s, expected both above 0"
    )]
    NotAbove {
        /// Rise that settles, K per full heater.
        gain_k: f64,
        /// Rise that goes on, K/s per full heater.
        slope_k_per_s: f64,
    },
    /// A reading is not a number.
    #[error("found no reading of the control sensor in second {second}")]
    NoReading {
        /// Second of the run.
        second: usize,
    },
}

/// Outcome of one second of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// Outputs until the next second.
    Go(Command),
    /// The run is over; outputs are off.
    Done(Identified),
}

/// State of an identification run.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    power: f64,
    ambient_c: f64,
    limit_c: f64,
    readings_c: Vec<f64>,
    /// Cooling of a warm chamber under way.
    cooling: Option<Cooling>,
    /// End of the last cooling; `None` for a chamber that was cold.
    cooled: Option<Cooled>,
    coolings: usize,
}

impl Identification {
    /// Starts a run whose heater step is `power`, 0 to 1; the chamber must not exceed `limit_c`.
    pub fn new(power: f64, ambient_c: f64, limit_c: f64) -> Self {
        let readings_c = Vec::with_capacity(LENGTHS_S.iter().sum());
        Self {
            power,
            ambient_c,
            limit_c,
            readings_c,
            cooling: None,
            cooled: None,
            coolings: 0,
        }
    }

    /// Takes the reading of this second, C, and returns the outputs until the next one.
    ///
    /// # Errors
    /// Fails when a reading is missing, when the chamber is too hot, or when it does not follow; the caller switches
    /// off.
    pub fn step(&mut self, measured_c: f64) -> Result<Step, IdentifyError> {
        let second = self.readings_c.len();
        if !measured_c.is_finite() {
            return Err(IdentifyError::NoReading { second });
        }
        if measured_c > self.limit_c {
            let (found_c, limit_c) = (measured_c, self.limit_c);
            return Err(IdentifyError::TooHot { found_c, limit_c });
        }
        if let Some(command) = self.cool(measured_c) {
            return Ok(Step::Go(command));
        }
        self.readings_c.push(measured_c);
        let [rest, heat, coast, vent] = LENGTHS_S;
        if second == rest && self.is_warm() {
            self.readings_c.clear();
            self.cooling = Some(Cooling::default());
            self.coolings += 1;
            return Ok(Step::Go(VENTED));
        }
        let heating = (rest..rest + heat).contains(&second);
        if heating && second >= rest + MINUTE_S {
            self.check_minute(measured_c)?;
        }
        let venting = second >= rest + heat + coast;
        if second == rest + heat + coast + vent {
            return self.settled_figures().map(Step::Done);
        }
        Ok(Step::Go(Command {
            heater: if heating { self.power } else { 0.0 },
            vent: if venting { 1.0 } else { 0.0 },
        }))
    }

    /// Checks that the last minute of heat has warmed the chamber.
    fn check_minute(&self, measured_c: f64) -> Result<(), IdentifyError> {
        let rest = LENGTHS_S[0];
        let drift = slope(&self.readings_c[rest - DRIFT_S..rest]);
        let before_c = self.readings_c[self.readings_c.len() - 1 - MINUTE_S];
        let found_k = measured_c - before_c - drift * MINUTE_S as f64;
        match found_k < LEAST_MINUTE_K {
            true => Err(IdentifyError::Stalls { found_k }),
            false => Ok(()),
        }
    }

    /// Performs a second of a cooling; `None` without one, and once it is over.
    fn cool(&mut self, measured_c: f64) -> Option<Command> {
        let Some(cooled) = self.cooling.as_mut()?.step(measured_c) else {
            return Some(VENTED);
        };
        (self.cooling, self.cooled) = (None, Some(cooled));
        None
    }

    fn is_warm(&self) -> bool {
        let drift = slope(&self.readings_c[LENGTHS_S[0] - DRIFT_S..]);
        self.coolings < MOST_COOLINGS && !cool::is_cold(&self.readings_c, drift)
    }

    /// Returns the temperature around the chamber, C: the one given at the start, or, after a cooling, the one that
    /// fits the figures.
    pub fn ambient_c(&self) -> f64 {
        self.ambient_c
    }

    /// Finds the temperature around a cooled chamber: the one that balances fan, losses and vent at the end of the
    /// cooling.
    fn find_ambient(&mut self, found: &Identified) {
        if let Some(ambient_c) = self.cooled.and_then(|it| it.ambient_c(found)) {
            self.ambient_c = ambient_c;
        }
    }

    /// Returns the response to the step, K per unit of power, the drift before it, K/s, and the temperature then, C.
    fn response(&self) -> (Vec<f64>, f64, f64) {
        let [rest, heat, ..] = LENGTHS_S;
        let drift = slope(&self.readings_c[rest - DRIFT_S..=rest]);
        let start_c = mean(&self.readings_c[rest - 4..=rest]) + 2.0 * drift;
        let return_per_s = self.return_per_s(drift, start_c);
        let rise = |(second, found): (usize, &f64)| {
            let drifted_k = drift * fit::risen(second as f64, return_per_s);
            (found - start_c - drifted_k) / self.power
        };
        let heated = self.readings_c[rest..=rest + heat].iter().enumerate();
        (heated.map(rise).collect(), drift, start_c)
    }

    /// Returns the figures. The figures of fan and vent depend on the temperature around the chamber, and this
    /// temperature on them, so the function finds both by iteration.
    fn settled_figures(&mut self) -> Result<Identified, IdentifyError> {
        let mut found = self.figures()?;
        for _ in 0..AMBIENT_ROUNDS {
            self.find_ambient(&found);
            found = self.figures()?;
        }
        Ok(found)
    }

    fn figures(&self) -> Result<Identified, IdentifyError> {
        let [rest, heat, ..] = LENGTHS_S;
        let (response, drift, start_c) = self.response();
        let found_k = response.last().copied().unwrap_or(0.0) * self.power;
        if found_k < LEAST_RISE_K {
            return Err(IdentifyError::NoRise {
                found_k,
                power: self.power,
            });
        }
        let found = self.with_losses(&response, drift, start_c);
        let settles_only = IdentifyError::NotAbove {
            gain_k: found.gain_k,
            slope_k_per_s: found.slope_k_per_s,
        };
        let above = |it: f64| it.is_finite() && it > 0.0;
        if !above(found.gain_k) || !above(found.slope_k_per_s) {
            return Err(settles_only);
        }
        let end = rest + heat + LENGTHS_S[2];
        let cooling = slope(&self.readings_c[end - DRIFT_S..=end]);
        Ok(Identified {
            vent_per_k: self.vent(&found, cooling),
            ..found
        })
    }

    /// Returns the rate at which losses take back a rise, 1/s: the fall of the coast beyond the drift of the rest, per
    /// kelvin by which the chamber is hotter then; [`MOST_RETURN_PER_S`] at most.
    fn return_per_s(&self, drift: f64, start_c: f64) -> f64 {
        let end: usize = LENGTHS_S[..3].iter().sum();
        let coast = &self.readings_c[end - DRIFT_S..=end];
        let return_per_s = (drift - slope(coast)) / (mean(coast) - start_c);
        return_per_s.clamp(0.0, MOST_RETURN_PER_S)
    }

    /// Fits the response, and finds losses and fan from the drifts before and after the heat.
    fn with_losses(&self, response: &[f64], drift: f64, start_c: f64) -> Identified {
        let return_per_s = self.return_per_s(drift, start_c);
        let parts = fit::two_part(response, return_per_s);
        let early = fit::first_order(&response[..=FIRST_ORDER_S]);
        let loss_per_k = return_per_s / parts.slope_k_per_s;
        let fan = drift / parts.slope_k_per_s + loss_per_k * (start_c - self.ambient_c);
        Identified {
            gain_k: parts.gain_k,
            time_constant_s: parts.time_constant_s,
            delay_s: parts.delay_s,
            slope_k_per_s: parts.slope_k_per_s,
            loss_per_k,
            fan: fan.max(0.0),
            vent_per_k: 0.0,
            first_order: FirstOrder {
                delay_s: early
                    .delay_s
                    .max(LEAST_DELAY * parts.delay_s)
                    .max(LEAST_DELAY_S),
                ..early
            },
        }
    }

    /// Returns the power that the open vent removes per kelvin above ambient, by least squares over the vent stage.
    fn vent(&self, chamber: &Identified, cooling: f64) -> f64 {
        let from = LENGTHS_S[..3].iter().sum::<usize>();
        let mut model = Response::of(chamber);
        let (mut modelled, mut over, mut under) = (0.0, 0.0, 0.0);
        for (second, found_c) in self.readings_c[from..].iter().enumerate() {
            let fell = self.readings_c[from] + cooling * second as f64 - found_c;
            over += fell * modelled;
            under += modelled * modelled;
            modelled += model.step(found_c - self.ambient_c);
        }
        (over / under).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the readings, C, of a chamber that settles within a minute at a step of the heater and then moves by a
    /// slope, K/s.
    fn readings_c(slope_k_per_s: f64) -> Vec<f64> {
        let [rest, heat, coast, vent] = LENGTHS_S;
        let (mut heated_s, mut settled_k) = (0.0, 0.0);
        let reading = |second| {
            let found_c = 25.0 + settled_k + slope_k_per_s * heated_s;
            let heats = (rest..rest + heat).contains(&second);
            heated_s += f64::from(u8::from(heats));
            settled_k += (if heats { 8.0 } else { 0.0 } - settled_k) / 20.0;
            found_c
        };
        (0..=rest + heat + coast + vent).map(reading).collect()
    }

    /// Runs over these readings; returns the last outcome.
    fn run_over(readings_c: &[f64]) -> Result<Step, IdentifyError> {
        let mut run = Identification::new(0.15, 25.0, 90.0);
        let mut answers = readings_c.iter().map(|it| run.step(*it));
        let ended = answers.find(|it| !matches!(it, Ok(Step::Go(_))));
        ended.expect("a run that ends")
    }

    #[test]
    fn a_response_that_sinks_under_power_ends_the_run() {
        let rising = run_over(&readings_c(0.01));
        assert!(matches!(rising, Ok(Step::Done(_))), "{rising:?}");
        let sinking = run_over(&readings_c(-0.01));
        assert!(
            matches!(sinking, Err(IdentifyError::Stalls { .. })),
            "{sinking:?}"
        );
    }

    #[test]
    fn figures_without_a_rise_are_refused() {
        let mut run = Identification::new(0.15, 25.0, 90.0);
        run.readings_c = readings_c(-0.01);
        let found = run.figures();
        let is_refused = |slope_k_per_s| slope_k_per_s < 0.0;
        assert!(
            matches!(found, Err(IdentifyError::NotAbove { slope_k_per_s, .. }) if is_refused(slope_k_per_s)),
            "{found:?}"
        );
    }
}
