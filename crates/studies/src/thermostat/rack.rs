//! Model of parts in their sockets: two lags in series, switching temperatures that scatter, polled contacts.

use super::world::{Kind, World};
use chamber::lag::{Switching, Transition};
use chamber::program::Waiting;
use machine::dut::thermostat::measure::{Events, Shown};
use machine::dut::thermostat::recipe::Control;
use rigsim::world::draw::{Draw, Subject};
use rigsim::world::oven::{Delay, Lag};

/// Operate temperature of a lot: mean C and standard deviation K.
const OPERATE: [f64; 2] = [85.0, 1.5];
/// Differential of a lot: mean and standard deviation, K.
const DIFFERENTIAL: [f64; 2] = [20.0, 2.0];
/// Spread of the lags within a lot, one standard deviation as a share.
const LAG_SPREAD: f64 = 0.15;
/// Error of a socket's temperature that the map of the sockets leaves, one standard deviation, K, at [`MAP_EXCESS_K`].
pub const MAP_RESIDUAL_K: f64 = 0.10;
/// Temperature above that of the room at which [`MAP_RESIDUAL_K`] holds, K.
pub const MAP_EXCESS_K: f64 = 75.0;
/// Delay of the air from the fan to the sockets, s.
const AIR_DELAY_S: f64 = 1.0;
/// Time between two polls of the contacts, s.
const POLL_S: f64 = 0.04;
/// Time step of the parts, s.
const STEP_S: f64 = 0.1;

/// A part with its true values.
#[derive(Debug, Clone)]
struct Part {
    /// Operate temperature without scatter, C.
    operate_c: f64,
    /// Reset temperature without scatter, C.
    reset_c: f64,
    offset: f64,
    lags: [Lag; 2],
    scatter_k: f64,
    next_c: f64,
    /// True while the contact is operated.
    operated: bool,
    /// Switchings of the contact, as the polls have seen them.
    seen: Switching,
}

/// A loaded rack.
#[derive(Debug, Clone)]
pub struct Rack {
    /// Parts by socket.
    parts: Vec<Part>,
    delay: Delay,
    ambient_c: f64,
    now_s: f64,
    due_s: f64,
    draw: Draw,
}

impl Rack {
    /// Fills the rack with a batch of a lot: a kind in a world, and the seed of rig and lot. The parts start at one
    /// temperature, the air at another, C.
    pub fn new(
        (kind, world, seed): (Kind, &World, u64),
        batch: &Batch,
        [parts_c, air_c]: [f64; 2],
        ambient_c: f64,
    ) -> Self {
        let number = batch.number;
        let mut draw = Draw::new(seed, Subject::LotPart, number);
        let mut map = Draw::new(seed, Subject::Rig, 2);
        let part = |place: usize| {
            let operate_c = draw.normal(OPERATE[0], OPERATE[1]);
            let lag = world.lag[place % 2] * draw.normal(1.0, LAG_SPREAD).max(0.3);
            Part {
                operate_c,
                reset_c: operate_c - draw.normal(DIFFERENTIAL[0], DIFFERENTIAL[1]),
                offset: map.normal(0.0, MAP_RESIDUAL_K) / MAP_EXCESS_K,
                lags: kind.lags_s.map(|it| Lag::new(it * lag, parts_c)),
                scatter_k: world.scatter_k,
                next_c: draw.normal(operate_c, world.scatter_k),
                operated: false,
                seen: Switching::default(),
            }
        };
        Self {
            parts: (0..batch.sockets).map(part).collect(),
            delay: Delay::new(AIR_DELAY_S, air_c),
            ambient_c,
            now_s: 0.0,
            due_s: STEP_S,
            draw: Draw::new(seed, Subject::LotOperations, number),
        }
    }

    /// Returns what the contacts have shown.
    pub fn shown(&self) -> Vec<Shown> {
        let one = |(socket, part): (u16, &Part)| Shown {
            socket,
            events: Events {
                switching: part.seen.clone(),
                stray: 0,
            },
        };
        (1..).zip(&self.parts).map(one).collect()
    }

    /// Counts the parts that have yet to switch.
    pub fn waiting(&self) -> Waiting {
        let operated = self.parts.iter().filter(|it| it.operated).count();
        Waiting {
            operate: self.parts.len() - operated,
            reset: operated,
        }
    }

    /// Returns the true operate and reset temperature of each part, C.
    pub fn truths(&self) -> impl Iterator<Item = [f64; 2]> {
        self.parts.iter().map(|it| [it.operate_c, it.reset_c])
    }

    /// Advances the parts by `dt_s`, less than a second, in which the air goes to `air_c`.
    pub fn step(&mut self, dt_s: f64, air_c: f64) {
        self.now_s += dt_s;
        if self.now_s + 1e-9 < self.due_s {
            return;
        }
        let step_s = self.now_s - (self.due_s - STEP_S);
        self.due_s = self.now_s + STEP_S;
        let socket_c = self.delay.step(step_s, air_c);
        for part in &mut self.parts {
            let here_c = socket_c + part.offset * (socket_c - self.ambient_c);
            part.step(self.now_s, step_s, here_c, &mut self.draw);
        }
    }
}

impl Part {
    fn step(&mut self, now_s: f64, step_s: f64, socket_c: f64, draw: &mut Draw) {
        let before_c = self.lags[1].celsius();
        let body_c = self.lags[0].step(step_s, socket_c);
        let after_c = self.lags[1].step(step_s, body_c);
        let passed = if self.operated {
            after_c <= self.next_c
        } else {
            after_c >= self.next_c
        };
        if !passed {
            return;
        }
        let share = ((self.next_c - before_c) / (after_c - before_c)).clamp(0.0, 1.0);
        let at_s = now_s - step_s + share * step_s;
        let polled_s = ((at_s / POLL_S).floor() + 0.5) * POLL_S;
        let list = if self.operated {
            &mut self.seen.reset
        } else {
            &mut self.seen.operate
        };
        list.push(Transition::at(polled_s));
        self.operated = !self.operated;
        let mean_c = if self.operated {
            self.reset_c
        } else {
            self.operate_c
        };
        self.next_c = draw.normal(mean_c, self.scatter_k);
    }
}

/// A batch of a lot, all sockets filled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Batch {
    /// Number of the batch in its lot, from 0.
    pub number: u64,
    /// Number of sockets.
    pub sockets: usize,
    /// Rate of the first pass of a batch that measures the lag, and of the other passes, K/min.
    pub rates: [f64; 2],
    /// Controller of the chamber.
    pub control: Control,
}
