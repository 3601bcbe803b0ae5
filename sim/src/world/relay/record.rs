//! Results of one relay: the last full-voltage operation and release, and its contact closures.

use super::values::RelayValues;
use crate::world::probes::Contact;
use std::ops::RangeInclusive;

/// Voltages that count as full, as fractions of nominal: leads take some, and a search may operate a stiff relay at a
/// higher one, which makes it faster.
const FULL: RangeInclusive<f64> = 0.98..=1.005;
/// Highest voltage that counts as off, as a fraction of nominal.
const NONE: f64 = 0.05;

/// Closures of one contact.
#[derive(Debug, Clone, Copy, Default)]
struct Closures {
    now_mohm: f64,
    counted: bool,
    sum_mohm: f64,
    count: u32,
}

/// Operate or release time, and bounce, of the last switching of a contact.
#[derive(Debug, Clone, Copy, Default)]
struct Timing {
    start_us: Option<f64>,
    time_ms: Option<f64>,
    bounce_us: f64,
    open_since_us: Option<f64>,
    following: bool,
}

/// Results of one relay on the probes.
#[derive(Debug, Clone)]
pub struct RelayRecord {
    nominal_v: f64,
    closures: [Closures; 2],
    timing: [Timing; 2],
    operations: u64,
}

impl RelayRecord {
    /// Creates a record without results.
    pub fn new(drawn: &RelayValues) -> Self {
        Self {
            nominal_v: drawn.nominal_v,
            closures: Default::default(),
            timing: Default::default(),
            operations: 0,
        }
    }

    /// Returns the resistance of the present or last closure, milliohm.
    pub fn contact_mohm(&self, contact: Contact) -> f64 {
        self.closures[contact as usize].now_mohm
    }

    /// Returns the time of the last full-voltage make of this contact, ms: operate for NO, release for NC.
    pub fn time_ms(&self, contact: Contact) -> Option<f64> {
        self.timing[contact as usize].time_ms
    }

    /// Returns the number of full-voltage operations, drive on to first make of NO.
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// Returns the open time of this contact after its last full-voltage make, ms.
    pub fn bounce_ms(&self, contact: Contact) -> Option<f64> {
        let timing = &self.timing[contact as usize];
        timing.time_ms.map(|_| timing.bounce_us / 1000.0)
    }

    /// Returns the mean resistance over the closures that carried source current, milliohm.
    pub fn mean_mohm(&self, contact: Contact) -> Option<f64> {
        let c = &self.closures[contact as usize];
        (c.count > 0).then(|| c.sum_mohm / f64::from(c.count))
    }

    /// Records a new closure of a contact with this resistance.
    pub(super) fn close(&mut self, contact: Contact, mohm: f64) {
        let c = &mut self.closures[contact as usize];
        c.now_mohm = mohm;
        c.counted = false;
    }

    /// Records that the current of the source flows through a contact.
    pub(super) fn source_on(&mut self, contact: Contact) {
        let c = &mut self.closures[contact as usize];
        if !c.counted {
            c.counted = true;
            c.sum_mohm += c.now_mohm;
            c.count += 1;
        }
    }

    /// Records a step of the supply; `still` means that the armature was at a stop, so that an operate or release time
    /// may begin.
    pub(super) fn supply_step(&mut self, t_us: f64, old_v: f64, new_v: f64, still: bool) {
        let is_full = |volts: f64| FULL.contains(&(volts / self.nominal_v));
        let is_off = |volts: f64| volts <= NONE * self.nominal_v;
        if (new_v - old_v).abs() < 0.02 * self.nominal_v {
            return;
        }
        let [no, nc] = &mut self.timing;
        no.following = false;
        nc.following = false;
        no.start_us = (still && is_off(old_v) && is_full(new_v)).then_some(t_us);
        nc.start_us = (still && is_full(old_v) && is_off(new_v)).then_some(t_us);
    }

    /// Records the first make of a contact after the armature has moved across from the other one.
    pub(super) fn make(&mut self, contact: Contact, t_us: f64) {
        let timing = &mut self.timing[contact as usize];
        timing.following = timing.start_us.is_some();
        if let Some(start) = timing.start_us.take() {
            timing.time_ms = Some((t_us - start) / 1000.0);
            timing.bounce_us = 0.0;
            timing.open_since_us = None;
            self.operations += u64::from(contact == Contact::No);
        }
    }

    /// Records an opening or closing; it counts as bounce while the supply stays constant.
    pub(super) fn moved(&mut self, contact: Contact, t_us: f64, closed: bool) {
        let timing = &mut self.timing[contact as usize];
        if !timing.following {
            return;
        }
        match (closed, timing.open_since_us.take()) {
            (true, Some(since)) => timing.bounce_us += t_us - since,
            (true, None) => {}
            (false, _) => timing.open_since_us = Some(t_us),
        }
    }
}
