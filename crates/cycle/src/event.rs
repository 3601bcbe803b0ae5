//! Events of a run for the history.

use machine::dut::Calibration;
use machine::dut::experiment::Found;
use machine::dut::promise::Broken;
use machine::dut::prompt::Prompt;
use machine::handling::inside::Inside;
use machine::handling::output::{EndedBatch, Interrupted, Judged, Landed, NestExit};
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
    /// The machine as a whole entered a state (PackML).
    State(packml::State),
    /// A part was judged; it has a verdict now.
    Judged(Box<Judged>),
    /// The test of a batch ended; its parts were judged before.
    BatchEnded(Box<EndedBatch>),
    /// The beam of a bin detected the falling part.
    Landed(Landed),
    /// The part left the nest.
    Left(NestExit),
    /// A judged part goes to retest despite its verdict, because its way to the bin was interrupted.
    Interrupted(Interrupted),
    /// An alarm occurred, at this rig time.
    Alarm(Alarm, RigTime),
    /// The list of active or unacknowledged alarms changed.
    ListedAlarms(Vec<ListedAlarm>, RigTime),
    /// The rig is calibrated: references and reference parts are measured.
    Calibrated(Box<Calibration>),
    /// An experiment without parts has a result.
    Found(Found),
    /// Rig or parts scatter more than promised; budgets of later parts use the larger standard deviation.
    PromiseBroken(Broken),
    /// A reference check ended with this result, at this rig time.
    Checked(Checked, RigTime),
    /// The station answered an order, at this rig time.
    Ordered(Box<AnsweredOrder>, RigTime),
    /// Parts moved inside the machine: its contents, and the use counts of the wearing parts since the start of the
    /// run.
    Inside(Inside, Uses),
    /// A prompt opened; it waits for the order `answer`.
    Prompted(Box<Prompt>),
    /// The lot itself began, after calibration and reference parts, at this rig time.
    LotBegan(RigTime),
}
