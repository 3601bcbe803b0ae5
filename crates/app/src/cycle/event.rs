//! Events of a run for the history.

use machine::dut::Calibration;
use machine::dut::promise::Broken;
use machine::handling::inside::Inside;
use machine::handling::output::{Interrupted, Judged, Landed, NestExit};
use machine::handling::wear::Uses;
use machine::station::annunciator::ListedAlarm;
use machine::station::packml;
use machine::station::trouble::Alarm;
use machine::station::turn::Checked;
use machine::view::AnsweredOrder;
use units::RigTime;

/// An event of a run, sent in the order of occurrence.
#[derive(Debug, Clone)]
pub enum Event {
    /// The outer machine entered a state.
    State(packml::State),
    /// A part has its verdict.
    Judged(Box<Judged>),
    /// The beam of a bin saw the part.
    Landed(Landed),
    /// The part left the nest.
    Left(NestExit),
    /// A judged part goes to retest despite its verdict.
    Interrupted(Interrupted),
    /// An alarm came, at this rig time.
    Alarm(Alarm, RigTime),
    /// The list of active or unacknowledged alarms changed.
    ListedAlarms(Vec<ListedAlarm>, RigTime),
    /// Calibration and reference parts are complete.
    Calibrated(Box<Calibration>),
    /// Rig or parts scatter more than promised; later parts have the larger uncertainty.
    PromiseBroken(Broken),
    /// A reference check has its result.
    Checked(Checked, RigTime),
    /// An order has its answer.
    Ordered(Box<AnsweredOrder>, RigTime),
    /// Parts moved inside the machine: contents for the next run, and uses of wearing parts since the start.
    Inside(Inside, Uses),
    /// The lot itself began, after calibration and reference parts.
    LotBegan(RigTime),
}
