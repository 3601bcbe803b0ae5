//! A temperature relay in its socket: two lags, a snap disc, a contact.
//!
//! ```text
//! socket -> T1 -> T2;  operates when T2 rises to its operate temperature, resets when T2 falls to its reset temperature,
//! each time at a temperature of its own (scatter), at the instant at which T2 passes it
//! ```
//!
//! T2 counts as linear between two steps, at most 0.1 s apart; this moves an event by less than a millisecond.

use super::contact::Contact;
use super::defect::Defect;
use super::truth::ThermostatTruth;
use crate::world::draw::Draw;
use crate::world::oven::Lag;

/// Shortest time between two changes of a creeping or chattering contact, microseconds.
const DWELL_US: u64 = 10_000;

/// Way in which a part ignores its temperature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stuck {
    /// The contact is always closed.
    Closed,
    /// The contact is always open.
    Open,
    /// After its first operation the part stays operated.
    Operated,
}

/// A contact that flips near the operate temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chatter {
    /// Half width of the band around the operate temperature, kelvin.
    pub band_k: f64,
    /// Changes per second inside the band.
    pub per_s: f64,
}

/// A closed contact that opens from time to time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intermittent {
    /// Share of the time in which the contact is open.
    pub share: f64,
    /// Shortest and longest opening, milliseconds.
    pub open_ms: [f64; 2],
}

/// True values of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Mean operate temperature of the new part, degrees Celsius.
    pub operate_c: f64,
    /// Mean reset temperature of the new part, degrees Celsius.
    pub reset_c: f64,
    /// Standard deviation of a switching temperature from one event to the next, kelvin.
    pub scatter_k: f64,
    /// Ageing, kelvin: both temperatures change by this times log10(1 + cycles / 1000).
    pub drift_k: f64,
    /// Time constants of body and disc, seconds.
    pub lag_s: [f64; 2],
    /// True when the contact opens as the temperature rises.
    pub breaks: bool,
    /// Median contact resistance, milliohm.
    pub contact_mohm: f64,
    /// Standard deviation of the logarithm of the resistance from closure to closure.
    pub closure_ln_sd: f64,
    /// Shortest and longest bounce of a closure, milliseconds.
    pub bounce_ms: [f64; 2],
    /// Width of a slow break, kelvin; 0 for a snap.
    pub creep_k: f64,
    /// Chatter near the operate temperature; `None` for a clean contact.
    pub chatter: Option<Chatter>,
    /// Openings of the closed contact.
    pub intermittent: Option<Intermittent>,
    /// Way in which the part ignores its temperature; `None` for a working part.
    pub stuck: Option<Stuck>,
}

impl Values {
    /// Returns operate minus reset temperature, kelvin.
    pub fn differential_k(&self) -> f64 {
        self.operate_c - self.reset_c
    }
}

/// A part with its state.
#[derive(Debug, Clone)]
pub struct Thermostat {
    values: Values,
    defect: Option<Defect>,
    body: Lag,
    disc: Lag,
    operated: bool,
    /// Temperature at which the next event comes, degrees Celsius.
    next_c: f64,
    cycles: u64,
    /// Temperatures of the operations so far.
    operations_c: Vec<f64>,
    contact: Contact,
    /// Instant of the next flip or opening, microseconds.
    flip_us: Option<u64>,
    extra_edges: u64,
    closure_mohm: f64,
    /// Resistances of the closures that carried the test current, milliohm.
    measured_mohm: Vec<f64>,
    draw: Draw,
}

impl Thermostat {
    /// Puts a part that has long been at `celsius` into its socket.
    pub fn new(values: Values, defect: Option<Defect>, celsius: f64, draw: Draw) -> Self {
        let [body, disc] = values.lag_s.map(|tau_s| Lag::new(tau_s, celsius));
        let operated = values.stuck.is_none() && celsius >= values.operate_c;
        let mut part = Self {
            contact: Contact::new(false),
            values,
            defect,
            body,
            disc,
            operated,
            next_c: 0.0,
            cycles: 0,
            operations_c: Vec::new(),
            flip_us: None,
            extra_edges: 0,
            closure_mohm: 0.0,
            measured_mohm: Vec::new(),
            draw,
        };
        part.contact = Contact::new(part.at_rest());
        part.draw_closure();
        part.draw_event();
        part
    }

    /// Returns the temperature of the disc, degrees Celsius.
    pub fn disc_c(&self) -> f64 {
        self.disc.celsius()
    }

    /// Returns the contact, for its changes.
    pub fn contact_mut(&mut self) -> &mut Contact {
        &mut self.contact
    }

    /// Returns the contact.
    pub fn contact(&self) -> &Contact {
        &self.contact
    }

    /// Returns the state of the contact without bounce, chatter and openings: true for closed.
    fn at_rest(&self) -> bool {
        match self.values.stuck {
            Some(Stuck::Closed) => true,
            Some(Stuck::Open) => false,
            Some(Stuck::Operated) | None => self.operated != self.values.breaks,
        }
    }

    fn draw_closure(&mut self) {
        let (median, ln_sd) = (self.values.contact_mohm, self.values.closure_ln_sd);
        self.closure_mohm = self.draw.lognormal(median, ln_sd);
    }

    /// Draws the temperature of the next event at random.
    fn draw_event(&mut self) {
        let values = &self.values;
        let aged_k = values.drift_k * (1.0 + self.cycles as f64 / 1e3).log10();
        let mean_c = if self.operated {
            values.reset_c
        } else {
            values.operate_c
        };
        self.next_c = self.draw.normal(mean_c + aged_k, values.scatter_k);
    }

    /// Advances from `from_us` by `dt_s` while the socket moves linearly to `celsius`.
    pub fn step(&mut self, from_us: u64, dt_s: f64, celsius: f64) {
        let before_c = self.disc.celsius();
        let body_c = self.body.step(dt_s, celsius);
        let after_c = self.disc.step(dt_s, body_c);
        let dt_us = dt_s * 1e6;
        let end_us = from_us + dt_us as u64;
        let passed = if self.operated {
            after_c <= self.next_c
        } else {
            after_c >= self.next_c
        };
        if passed && !matches!(self.values.stuck, Some(Stuck::Closed | Stuck::Open)) {
            let share = (self.next_c - before_c) / (after_c - before_c);
            // The disc passes at once a threshold that was drawn beyond its present temperature.
            let share = if share.is_finite() {
                share.clamp(0.0, 1.0)
            } else {
                0.0
            };
            self.switch(from_us + (share * dt_us) as u64);
        }
        self.disturb(from_us, end_us, after_c);
    }

    /// Operates or resets at `t_us`.
    fn switch(&mut self, t_us: u64) {
        if self.values.stuck == Some(Stuck::Operated) && self.operated {
            return;
        }
        self.operated = !self.operated;
        if self.operated {
            self.operations_c.push(self.next_c);
        } else {
            self.cycles += 1;
        }
        self.draw_event();
        let closed = self.at_rest();
        self.contact.change(t_us, closed);
        if closed {
            self.draw_closure();
            self.bounce(t_us);
        }
    }

    /// Opens the contact once after its first touch.
    fn bounce(&mut self, t_us: u64) {
        let [shortest, longest] = self.values.bounce_ms;
        let bounce_us = self.draw.between([shortest, longest]) * 1e3;
        let open_us = self.draw.between([0.1, 0.5]) * bounce_us;
        self.contact.change(t_us + open_us as u64, false);
        self.contact.change(t_us + bounce_us as u64, true);
    }

    /// Adds the changes of a chattering, creeping or intermittent contact between two instants.
    fn disturb(&mut self, from_us: u64, end_us: u64, celsius: f64) {
        if let Some(chatter) = self.values.chatter {
            if (celsius - self.values.operate_c).abs() < chatter.band_k {
                self.flip(from_us, end_us, 1e6 / chatter.per_s);
            } else if self.flip_us.take().is_some() {
                self.contact.change(end_us, self.at_rest());
            }
        }
        if let Some(it) = self.values.intermittent {
            self.open_for_moments(from_us, end_us, it);
        }
    }

    fn flip(&mut self, from_us: u64, end_us: u64, mean_us: f64) {
        let mut at_us = self.flip_us.unwrap_or(from_us);
        while at_us < end_us {
            if at_us >= from_us {
                let closed = !self.contact.last();
                self.contact.change(at_us, closed);
                self.extra_edges += 1;
            }
            let wait_us = (mean_us * self.draw.between([0.5, 1.5])) as u64;
            at_us += wait_us.max(DWELL_US);
        }
        self.flip_us = Some(at_us);
    }

    fn open_for_moments(&mut self, from_us: u64, end_us: u64, it: Intermittent) {
        let open_us = it.open_ms.map(|ms| ms * 1e3);
        let period_us = open_us[0].midpoint(open_us[1]) / it.share;
        let wait = |draw: &mut Draw| (-(1.0 - draw.uniform()).ln() * period_us) as u64;
        let mut at_us = match self.flip_us {
            Some(at_us) => at_us,
            None => from_us + wait(&mut self.draw),
        };
        while at_us < end_us {
            if self.at_rest() && self.contact.last() {
                let length_us = self.draw.between(open_us) as u64;
                self.contact.change(at_us, false);
                self.contact.change(at_us + length_us, true);
                at_us += length_us;
            }
            at_us += wait(&mut self.draw).max(DWELL_US);
        }
        self.flip_us = Some(at_us);
    }

    /// Returns the present resistance of the contact, ohm; `None` while it is open.
    pub fn ohm(&self) -> Option<f64> {
        let mohm = self.contact.is_closed().then_some(self.closure_mohm)?;
        let w = self.values.creep_k;
        let rise = match w > 0.0 {
            true => ((self.disc_c() - self.values.operate_c + w) / (w / 5.0)).exp(),
            false => 0.0,
        };
        Some(mohm * 1e-3 * (1.0 + rise))
    }

    /// Records that the test current has flowed through this closure.
    pub fn measured(&mut self) {
        if self.contact.is_closed() && self.measured_mohm.last() != Some(&self.closure_mohm) {
            self.measured_mohm.push(self.closure_mohm);
        }
    }

    /// Returns the true values so far.
    pub fn truth(&self) -> ThermostatTruth {
        let values = &self.values;
        let follows = !matches!(values.stuck, Some(Stuck::Closed | Stuck::Open));
        let resets = values.stuck.is_none();
        let measured = &self.measured_mohm;
        let mean_mohm = match measured.is_empty() {
            true => values.contact_mohm,
            false => measured.iter().sum::<f64>() / measured.len() as f64,
        };
        ThermostatTruth {
            operate_temperature_c: follows.then_some(values.operate_c),
            reset_temperature_c: resets.then_some(values.reset_c),
            differential_k: resets.then(|| values.differential_k()),
            contact_resistance_mohm: (values.stuck != Some(Stuck::Open)).then_some(mean_mohm),
            creep_k: values.creep_k,
            chatter_edges: self.extra_edges,
            repeatability_k: spread_k(&self.operations_c),
            scatter_k: values.scatter_k,
            lag_s: values.lag_s,
            defect: self.defect.map(Defect::name),
        }
    }
}

/// Returns largest minus smallest temperature; `None` for fewer than two.
fn spread_k(celsius: &[f64]) -> Option<f64> {
    let high = celsius.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = celsius.iter().copied().fold(f64::INFINITY, f64::min);
    (celsius.len() > 1).then_some(high - low)
}
