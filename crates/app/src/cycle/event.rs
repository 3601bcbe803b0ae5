//! What a run leaves for the history.

use machine::dut::Calibration;
use machine::handling::inside::Inside;
use machine::handling::output::{Interrupted, Judged, Landed, NestExit};
use machine::handling::wear::Uses;
use machine::station::annunciator::ListedAlarm;
use machine::station::packml;
use machine::station::trouble::Alarm;
use machine::station::turn::Checked;
use machine::view::AnsweredOrder;
use units::RigTime;

/// What a run leaves for the history, in the order it happened.
#[derive(Debug, Clone)]
pub enum Event {
    /// The outer machine has entered a state.
    State(packml::State),
    /// A part was judged.
    Judged(Box<Judged>),
    /// Its beam saw it.
    Landed(Landed),
    /// It left the nest.
    Left(NestExit),
    /// A judged part goes to retest all the same.
    Interrupted(Interrupted),
    /// An alarm was raised.
    Alarm(Alarm, RigTime),
    /// The list of alarms that stand has changed.
    Standing(Vec<ListedAlarm>, RigTime),
    /// Calibration and golden parts are complete.
    Calibrated(Box<Calibration>),
    /// A golden check has come out.
    Checked(Checked, RigTime),
    /// An order was answered.
    Ordered(Box<AnsweredOrder>, RigTime),
    /// A part has moved on inside: what the next run has to look for, and the uses of what wears since the start.
    Inside(Inside, Uses),
    /// The lot itself began.
    LotBegan(RigTime),
}
