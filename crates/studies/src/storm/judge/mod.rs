//! The judge: what the simulated rig knows and what the history holds, never what the controller believed.
//!
//! | file | what must hold |
//! |---|---|
//! | `bodies` | every body lies in the one bin that its row names, or an alarm declared it lost; no row without a body, none twice |
//! | `values` | no value but the body's own; no defect in the pass bin, no good part in the bin of a defect |
//! | `motion` | nothing is driven after a stop, while a safety input is open, or without a controller |
//! | `endings` | every life ends, a trouble has its name, and when faults cease production resumes |
//!
//! And no two bodies touched where they must not: the rig's own list.

mod bodies;
mod endings;
mod motion;
#[cfg(test)]
mod tests;
mod values;

use super::life::{EPOCH_US, Lived};
use history::{Alarm, Moment, Part};
use rigsim::truth::BodyTruth;
use units::Span;

/// Everything that is judged. All times are microseconds of rig time, over all lives.
#[derive(Debug, Clone)]
pub struct Case {
    /// Lives in their order.
    pub lives: Vec<Lived>,
    /// Every body that has left the magazine.
    pub bodies: Vec<BodyTruth>,
    /// What began to move because an output told it to.
    pub driven: Vec<(u64, &'static str)>,
    /// Bodies that touched, in the words of the rig.
    pub touched: Vec<String>,
    /// Rows of parts in order of judgement, golden ones too.
    pub rows: Vec<Part>,
    /// Alarms in order of time.
    pub alarms: Vec<Alarm>,
    /// What was asked of the rig.
    pub faults: Vec<String>,
    /// From when a safety input was open.
    pub disturbed_us: Vec<u64>,
    /// Limits of the recipe: key, low, high; infinite where there is none.
    pub limits: Vec<(&'static str, f64, f64)>,
    /// Longest reaction to a safety input that the configuration promises.
    pub reaction: Span,
    /// The same when lines or modules have troubles of their own: outputs wait for the host watchdogs.
    pub reaction_in_trouble: Span,
    /// Lines or modules had troubles.
    pub lines_suffer: bool,
}

impl Case {
    /// Every rule that was broken, in words.
    pub fn broken(&self) -> Vec<String> {
        let touched = self
            .touched
            .iter()
            .map(|it| format!("bodies touched: {it}"));
        let mut broken: Vec<String> = touched.collect();
        broken.extend(bodies::broken(self));
        broken.extend(values::broken(self));
        broken.extend(motion::broken(self));
        broken.extend(endings::broken(self));
        broken
    }

    /// The life in which an instant lies.
    fn life_at(&self, t_us: u64) -> Option<&Lived> {
        let mut lives = self.lives.iter();
        lives.find(|life| (life.began_us..=life.ended_us).contains(&t_us))
    }

    /// Alarms of a life.
    fn alarms_of<'a>(&'a self, life: &'a Lived) -> impl Iterator<Item = (u64, &'a Alarm)> {
        let own = |alarm: &&Alarm| alarm.lot.as_deref() == Some(life.lot.as_str());
        let timed = |alarm: &'a Alarm| (rig_us(alarm.raised), alarm);
        self.alarms.iter().filter(own).map(timed)
    }
}

/// An instant of the history as rig time, microseconds.
pub fn rig_us(moment: Moment) -> u64 {
    u64::try_from(moment.0 - EPOCH_US).unwrap_or(0)
}

/// As people read it.
pub fn seconds(t_us: u64) -> String {
    format!("{:.3} s", t_us as f64 * 1e-6)
}
