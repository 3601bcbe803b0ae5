//! Alarms: trouble of the rig as a code with its arguments; `parts` has the alarms about parts and their places.

mod parts;

use super::catalogue::AlarmCode;
use crate::dut::Reason;
use crate::dut::batch::{BatchTrouble, HeatTrouble};
use crate::dut::promise::Broken;
use crate::handling::Move;
use crate::handling::trouble::Trouble;
use crate::handling::wear::Wearing;
use crate::rig::point::DigitalIn;
use crate::rig::supply::RangeMismatch;
use texts::{Args, Lang, Message};
use units::Span;

/// One alarm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Alarm {
    /// What happened.
    pub code: AlarmCode,
    /// Arguments of the alarm's text.
    pub args: Args,
}

impl From<AlarmCode> for Alarm {
    fn from(code: AlarmCode) -> Self {
        let args = Args::default();
        Self { code, args }
    }
}

impl From<Trouble> for Alarm {
    fn from(trouble: Trouble) -> Self {
        match trouble {
            Trouble::NotReached(movement, limit) => Self::not_reached(movement, limit),
            Trouble::Retried(movement, limit) => Self::retried(movement, limit),
            Trouble::LeftEnd(movement) => Self::left_end(movement),
            Trouble::BothEnds(movement) => Self::both_ends(movement),
            Trouble::AxisDrive => AlarmCode::AxisDrive.into(),
            Trouble::NoPart => AlarmCode::PartNotArrived.into(),
            Trouble::MagazineEmpty => AlarmCode::MagazineEmpty.into(),
            Trouble::NestEmpty => AlarmCode::PartNotInNest.into(),
            Trouble::Beam(bin, counted) => Self::beam(bin, counted),
            Trouble::Found(place) => Self::part_found(place),
            Trouble::Lost(place) => Self::part_lost(place),
            Trouble::Gone(place) => Self::part_gone(place),
            Trouble::FallUnseen(bin) => Self::fall_unseen(bin),
            Trouble::Dropped => AlarmCode::PartDropped.into(),
            Trouble::Sticks => Self::part_sticks(),
            Trouble::Stuck => AlarmCode::PartStuck.into(),
            Trouble::SupplyRange(mismatch) => Self::supply_range(mismatch),
            Trouble::SocketLive => AlarmCode::SocketLive.into(),
            Trouble::DoorNotLocked => AlarmCode::DoorNotLocked.into(),
            Trouble::RackUnread => AlarmCode::RackUnread.into(),
            Trouble::RackStuck => AlarmCode::RackStuck.into(),
            Trouble::CoolsSlowly(after) => {
                Self::from(AlarmCode::CoolsSlowly).with("minutes", after.0 / 60_000_000)
            }
            Trouble::Batch(met) => met.into(),
            Trouble::TooLong(step, waited) => Self::step_too_long(step, waited),
            Trouble::ReferenceRepeated(serial, why) => Self::reference_repeated(&serial, &why),
        }
    }
}

impl From<BatchTrouble> for Alarm {
    fn from(met: BatchTrouble) -> Self {
        match met {
            BatchTrouble::Heat(met) => code_of(met).into(),
            BatchTrouble::SocketsOpen(sockets) => {
                Self::from(AlarmCode::SocketsOpen).with("sockets", sockets)
            }
            BatchTrouble::LagUnexpected(found_s, expected_s) => {
                Self::from(AlarmCode::LagUnexpected)
                    .with("found_s", found_s)
                    .with("expected_s", expected_s)
            }
        }
    }
}

fn code_of(trouble: HeatTrouble) -> AlarmCode {
    match trouble {
        HeatTrouble::ThermometerBroken => AlarmCode::ThermometerBroken,
        HeatTrouble::ThermometerJump => AlarmCode::ThermometerJump,
        HeatTrouble::ThermometersDiffer => AlarmCode::ThermometersDiffer,
        HeatTrouble::ThermometerStuck => AlarmCode::ThermometerStuck,
        HeatTrouble::EnergyBalance => AlarmCode::EnergyBalance,
        HeatTrouble::HeatWithoutCommand => AlarmCode::HeatWithoutCommand,
        HeatTrouble::OverSetPoint => AlarmCode::OverSetPoint,
        HeatTrouble::RampNotReached => AlarmCode::RampNotReached,
        HeatTrouble::RampTooFast => AlarmCode::RampTooFast,
        HeatTrouble::CoolingTooSlow => AlarmCode::CoolingTooSlow,
        HeatTrouble::NotIdentified => AlarmCode::HeatingNotIdentified,
        HeatTrouble::LimiterTripped => AlarmCode::LimiterTripped,
        HeatTrouble::AirflowLost => AlarmCode::AirflowLost,
        HeatTrouble::MainsLost => AlarmCode::MainsLost,
        HeatTrouble::ChainNotRead => AlarmCode::ChainNotRead,
    }
}

impl Alarm {
    /// Returns the text of the alarm; only its cause if an older version stored the alarm without arguments.
    pub fn text(&self, lang: Lang) -> String {
        let said = self.code.message(self.args.clone()).try_say(lang);
        let [cause, ..] = self.code.help(lang);
        said.unwrap_or_else(|| cause.to_owned())
    }

    /// Returns the message of the refusal named `refusal`, with this alarm as its arguments.
    pub fn inside(&self, refusal: &'static str) -> Message {
        let args = self.args.clone().with("alarm", self.code.text_id());
        Message::of("refusal", refusal, args)
    }

    /// Returns name and value of the argument that distinguishes this alarm from others of its code, if it has one.
    pub fn distinction(&self) -> Option<(&'static str, &str)> {
        let name = self.code.distinguished_by()?;
        Some((name, self.args.get(name)?))
    }

    /// Returns true when both alarms have the same code and distinction, so that they share a line of the list.
    pub fn is_same(&self, other: &Self) -> bool {
        self.code == other.code && self.distinction() == other.distinction()
    }

    fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.args = self.args.with(name, value);
        self
    }

    fn of_a_move(code: AlarmCode, movement: Move) -> Self {
        let alarm = Self::from(code).with("motion", movement.code());
        match movement.bin() {
            Some(bin) => alarm.with("bin", bin),
            None => alarm,
        }
    }

    /// Adds `inner` to the arguments: its code as argument `name`, for which texts show the text of `inner`, and its
    /// arguments.
    fn with_inner(mut self, name: &'static str, inner: &Message) -> Self {
        self.args = self.args.with_inner(name, inner);
        self
    }

    /// Returns the alarm that an actuator did not show the end of its motion in time.
    pub fn not_reached(movement: Move, limit: Span) -> Self {
        let wanted = movement.arrival();
        let wanted = wanted
            .iter()
            .map(|(point, state)| format!("{point}={}", u8::from(*state)));
        Self::of_a_move(AlarmCode::NotReached(movement.key()), movement)
            .with("place", movement.actuator_key())
            .with("limit_ms", limit.0 / 1000)
            .with("expects", wanted.collect::<Vec<_>>().join(", "))
    }

    /// Returns the alarm that a stroke has not arrived; the machine repeats the stroke once.
    pub fn retried(movement: Move, limit: Span) -> Self {
        Self::of_a_move(AlarmCode::Retried(movement.key()), movement)
            .with("limit_ms", limit.0 / 1000)
    }

    /// Returns the alarm that an actuator left its end by itself.
    pub fn left_end(movement: Move) -> Self {
        Self::of_a_move(AlarmCode::LeftEnd(movement.key()), movement)
            .with("place", movement.actuator_key())
    }

    /// Returns the alarm that both end sensors of an actuator are on.
    pub fn both_ends(movement: Move) -> Self {
        Self::of_a_move(AlarmCode::BothEnds(movement.key()), movement)
            .with("place", movement.actuator_key())
    }

    /// Returns the alarm that the guard refused a motion.
    pub fn refused(movement: Move, refusal: &Message) -> Self {
        Self::of_a_move(AlarmCode::MotionRefused, movement).with_inner("detail", refusal)
    }

    /// Returns the alarm that a line or module fails to answer correctly.
    pub fn bus(detail: &Message) -> Self {
        Self::from(AlarmCode::BusTrouble).with_inner("detail", detail)
    }

    /// Returns the alarm that the instrument with this name brings no values.
    pub fn instrument(name: &str, detail: &Message) -> Self {
        Self::from(AlarmCode::InstrumentTrouble)
            .with("instrument", name)
            .with_inner("detail", detail)
    }

    /// Returns the alarm that the instrument with this name has not confirmed its safe state.
    pub fn instrument_not_safe(name: &str) -> Self {
        Self::from(AlarmCode::InstrumentNotSafe).with("instrument", name)
    }

    /// Returns the alarm that the port of the code reader is lost, for this reason.
    pub fn serial_reader_lost(reason: impl ToString) -> Self {
        Self::from(AlarmCode::SerialReaderLost).with("reason", reason)
    }

    /// Returns the alarm that a safety input has no fresh sample.
    pub fn stale(input: DigitalIn) -> Self {
        Self::from(AlarmCode::SensorStale).with("input", input)
    }

    /// Returns the alarm that a reply or sample is missing because this computer was late; `missed` names it.
    pub fn host_late(missed: &Message, late: Span) -> Self {
        Self::from(AlarmCode::HostLate)
            .with_inner("missed", missed)
            .with("late_ms", format!("{:.0}", late.as_seconds() * 1e3))
    }

    /// Returns the alarm that a push button stays down.
    pub fn button_stuck(button: DigitalIn) -> Self {
        Self::from(AlarmCode::ButtonStuck).with("input", button)
    }

    /// Returns the alarm that a step has exceeded its timeout.
    pub fn step_too_long(step: &str, waited: Span) -> Self {
        Self::from(AlarmCode::StepTooLong)
            .with("step", step)
            .with("waited_s", format!("{:.0}", waited.as_seconds()))
    }

    /// Returns the alarm that the host watchdog of a module has made its outputs safe.
    pub fn watchdog_tripped(module: &str) -> Self {
        Self::from(AlarmCode::WatchdogTripped).with("module", module)
    }

    /// Returns the alarm that the mean probe contact over the last parts exceeds its limit.
    pub fn probe_contact(mean_ohm: f64, limit_ohm: f64) -> Self {
        Self::from(AlarmCode::ProbeContact)
            .with("mean_ohm", format!("{mean_ohm:.2}"))
            .with("limit_ohm", format!("{limit_ohm:.2}"))
    }

    /// Returns the alarm that a reference check is due by time, so the operator must load the reference part.
    pub fn reference_check_due(serial: &str) -> Self {
        Self::from(AlarmCode::ReferenceCheckDue).with("serial", serial)
    }

    /// Returns the alarm that a reference part disagrees with its certificate.
    pub fn reference_check_failed(fault: &Message) -> Self {
        Self::from(AlarmCode::ReferenceCheckFailed).with_inner("fault", fault)
    }

    /// Returns the alarm that the test of a reference part was interrupted and begins again.
    pub fn reference_repeated(serial: &str, why: &Reason) -> Self {
        Self::from(AlarmCode::ReferenceRepeated)
            .with_inner("reason", &why.message())
            .with("said", why)
            .with("serial", serial)
    }

    /// Returns the alarm that more parts have failed than the reject-rate limit allows.
    pub fn reject_rate_limit(failed: u64, judged: u64, limit_pct: f64) -> Self {
        Self::from(AlarmCode::RejectRateLimit)
            .with("failed", failed)
            .with("judged", judged)
            .with("limit_pct", limit_pct)
    }

    /// Returns the alarm that the supply is in another range than the one selected.
    fn supply_range(RangeMismatch { selected, found }: RangeMismatch) -> Self {
        Self::from(AlarmCode::SupplyRange)
            .with("selected", selected)
            .with("found", found)
    }

    /// Returns the alarm that the use count of a wearing part has reached its limit.
    pub fn worn(what: Wearing, count: u64, limit: u64) -> Self {
        Self::from(AlarmCode::Worn(what))
            .with("wears", what.name())
            .with("count", count)
            .with("limit", limit)
    }

    /// Returns the alarm that the rig scatters more than `rig.toml` or the recipe promises.
    pub fn promise_broken(broken: &Broken) -> Self {
        Self::from(AlarmCode::PromiseBroken(broken.promise))
            .with("promise", broken.promise.name())
            .with("key", broken.promise.key())
            .with("promised", broken.promised)
            .with("seen", format!("{:.2}", broken.seen))
            .with("low", format!("{:.2}", broken.interval.0))
            .with("high", format!("{:.2}", broken.interval.1))
            .with("freedom", format!("{:.0}", broken.freedom))
    }

    /// Returns the alarm that an interrupted calibration has left its channel mask in a module.
    pub fn calibration_cut_off(module: &str) -> Self {
        Self::from(AlarmCode::CalibrationCutOff).with("module", module)
    }

    /// Returns the alarm that references or reference parts give no calibration.
    pub fn calibration(fault: &Message) -> Self {
        Self::from(AlarmCode::CalibrationFailed).with_inner("fault", fault)
    }

    /// Returns the alarm that the program cannot write the history file; `refusal` is the code of the reason, `why` its
    /// English text.
    pub fn history_lost(file: &str, refusal: &str, why: &str) -> Self {
        Self::from(AlarmCode::HistoryLost)
            .with("file", file)
            .with("refusal", refusal)
            .with("said", why)
    }

    /// Returns the alarm that a database of the fleet lacks parts for longer than `limit_s`, seconds.
    pub fn fleet_late(database: &str, limit_s: u32) -> Self {
        Self::from(AlarmCode::FleetLate)
            .with("database", database)
            .with("limit_s", limit_s)
    }

    /// Returns the alarm that the stored calibration is unusable, so that no lot begins.
    pub fn calibration_invalid(why: &Message) -> Self {
        Self::from(AlarmCode::CalibrationInvalid).with_inner("detail", why)
    }
}
