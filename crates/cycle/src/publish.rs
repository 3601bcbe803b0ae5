//! Builds the view of the machine from station, image and outputs; parses orders for the station.

use super::{Cycle, Snapshot};
use machine::dut::verdict::Bin;
use machine::guard::{Actuator, Position};
use machine::handling::Place;
use machine::handling::ledger::{Part, PartRole};
use machine::handling::mechanism::SENSOR_AGE;
use machine::rig::point::DigitalInput;
use machine::station::Station;
use machine::station::annunciator::ListedAlarm;
use machine::station::orders::{self, Order, Refused};
use machine::station::packml::{Command, Mode};
use machine::view::{self, ActuatorView, AlarmLine, Button, Machine, RackView, Reaction, Token};
use std::collections::BTreeMap;
use std::mem::take;
use texts::Lang;
use units::{RigTime, Span};

/// Translates an order of a screen for the station; refuses an incomplete order, and one that only changes the history.
pub fn read(order: &view::Order) -> Result<Order, Refused> {
    use view::Order as From;
    let command = |it| Ok(Order::Command(it));
    match order {
        From::Start { lot: Some(_), .. } | From::HoldLot { .. } => Ok(Order::Leave),
        From::Start {
            lot: None,
            recipe: None,
            count: None,
            retest: None,
        } => command(Command::Start),
        From::Start { lot: None, .. } => Err(Refused::StartWithoutLot),
        From::Reset {} => command(Command::Reset),
        From::Stop {} => command(Command::Stop),
        From::Hold {} => command(Command::Hold),
        From::Unhold {} => command(Command::Unhold),
        From::Suspend {} => command(Command::Suspend),
        From::Unsuspend {} => command(Command::Unsuspend),
        From::Abort {} => command(Command::Abort),
        From::Clear {} => command(Command::Clear),
        From::Complete {} => command(Command::Complete),
        From::CloseLot { .. } => Ok(Order::Close),
        From::Mode { mode } => Ok(Order::Mode(*mode)),
        From::Jog { motion } => Ok(Order::Jog(*motion)),
        From::Step {} => Ok(Order::Step),
        From::LampTest {} => Ok(Order::LampTest),
        From::Scan { serial } => Ok(Order::Scan(serial.clone())),
        From::Answer { prompt, choice } => Ok(Order::Answer(prompt.clone(), choice.clone())),
        From::Unscan {} => Ok(Order::Unscan),
        From::Acknowledge { alarm } => Ok(Order::Acknowledge(alarm.clone())),
        From::Shelve { reason, .. } if reason.trim().is_empty() => {
            Err(Refused::ShelveWithoutReason)
        }
        From::Shelve { alarm, minutes, .. } => {
            let minutes = orders::shelf_minutes(*minutes);
            Ok(Order::Shelve(alarm.clone(), minutes))
        }
        From::ReleaseLot { .. } | From::ReopenLot { .. } | From::Replaced { .. } => {
            Err(Refused::NotOfTheRig)
        }
    }
}

impl Cycle {
    /// Sends a snapshot to the screens, at most one per [`Snapshots::every`](super::Snapshots::every); the `last` one goes
    /// out at any time.
    pub(super) fn publish(&mut self, now: RigTime, last: bool) {
        let Some(snapshots) = self.links.snapshots.clone() else {
            return;
        };
        if now < self.publish_at && !last {
            return;
        }
        self.publish_at = now + snapshots.every;
        let mut machine = self.machine(now);
        machine.buttons = buttons(&self.station, &mut self.refusals);
        machine.jogs = self.jog_preview(now);
        let station = &self.station;
        let (activity, ledger) = (station.activity(), station.ledger());
        let in_lot = !station.is_between_lots();
        // A full channel drops the snapshot: screens lag behind, the rig does not.
        let _ = snapshots.channel.try_send(Snapshot {
            at_us: jiff::Timestamp::now().as_microsecond(),
            state: activity.name(),
            doing: activity.code(),
            stage: activity.stage(),
            inside: ledger.inside(),
            counts: in_lot.then_some((ledger.came_in, ledger.went_out)),
            alarms: lines(station, self.links.epoch_us),
            machine,
            lateness: self.lateness.view(),
        });
    }

    fn machine(&self, now: RigTime) -> Machine {
        let (station, wiring) = (&self.station, &self.wiring);
        let input = |point: DigitalInput| self.image.input(point, now, SENSOR_AGE);
        let ms = |span: Span| span.as_seconds() * 1e3;
        Machine {
            state: station.outer().name().into(),
            mode: station.mode().name().into(),
            buttons: Vec::new(),
            actuators: Actuator::ALL
                .iter()
                .filter_map(|actuator| self.actuator(*actuator, now))
                .collect(),
            places: places(station),
            bins: wiring
                .bins()
                .iter()
                .map(|it| it.name().to_owned())
                .collect(),
            inputs: wiring
                .digital_inputs()
                .map(|(name, point)| (name.to_owned(), input(point)))
                .collect(),
            outputs: wiring
                .digital_outputs()
                .map(|(name, point)| (name.to_owned(), self.outputs.is_on(point)))
                .collect(),
            reaction: Reaction {
                bound_ms: ms(wiring.longest_reaction()),
                accepted_ms: wiring.safety.estop_reaction_ms,
                worst_age_ms: ms(self.worst_age),
            },
            phases_s: self.phases_s(),
            jogs: Vec::new(),
            refused: self.refused.clone(),
            wear: station
                .wear()
                .into_iter()
                .map(|(name, count)| (name.to_owned(), count))
                .collect(),
            probe_contact_ohm: station.probe_contact().map(|it| it.0),
            prompt: station.prompt().cloned(),
            rack: self.rack(now),
            scans: station.serials().waiting().map(|it| it.cloned().collect()),
        }
    }

    /// Returns the view of the rack; `None` on a rig with a feeder.
    fn rack(&self, now: RigTime) -> Option<RackView> {
        let batch = self.station.batch()?;
        let contact = |number: u16| {
            let socket = batch.rack().socket(number)?;
            self.image.input(socket.contact, now, SENSOR_AGE)
        };
        Some(RackView::new(batch, contact))
    }

    fn phases_s(&self) -> BTreeMap<String, f64> {
        let profile = &self.profile;
        let phases = [
            ("scan", profile.scan_s),
            ("step", profile.step_s),
            ("clear", profile.clear_s),
            ("apply", profile.apply_s),
            ("publish", profile.publish_s),
        ];
        phases.map(|(name, s)| (name.to_owned(), s)).into()
    }

    /// Returns the view of an actuator; `None` on a rig where nothing moves.
    fn actuator(&self, actuator: Actuator, now: RigTime) -> Option<ActuatorView> {
        let mechanism = self.station.mechanism()?;
        let (from_mm, to_mm) = match mechanism.position(actuator, now, &self.image) {
            Position::At(mm) => (mm, mm),
            Position::Between { from_mm, to_mm } => (from_mm.min(to_mm), from_mm.max(to_mm)),
        };
        let strokes = mechanism.strokes();
        Some(ActuatorView {
            name: actuator.name().into(),
            from_mm,
            to_mm,
            moving: mechanism
                .moving()
                .any(|movement| movement.motion(strokes).target_mm(actuator).is_some()),
        })
    }
}

fn buttons(station: &Station, refusals: &mut Refusals) -> Vec<Button> {
    let commands = Command::ALL
        .iter()
        .map(|it| (it.name(), "", station.may(*it)));
    let modes = Mode::ALL
        .iter()
        .map(|it| ("mode", it.name(), station.may_change_mode()));
    let jogs = orders::JOGS
        .iter()
        .map(|it| ("jog", it.code(), station.may_jog()));
    let others = [
        ("step", "", station.may_step()),
        ("lamp_test", "", Ok(())),
        ("start", "lot", station.may_leave()),
        ("close_lot", "", station.may_close()),
    ];
    refusals.next_view();
    let button = |(order, with, may): (&str, &str, Result<(), Refused>)| Button {
        order: order.into(),
        with: with.into(),
        enabled: may.is_ok(),
        ..may.err().map(|why| refusals.of(why)).unwrap_or_default()
    };
    let all = commands.chain(modes).chain(jogs).chain(others);
    all.map(button).collect()
}

/// Refused buttons by their reason. Most of them share a few reasons, which stay from view to view, and the texts of a
/// reason take longer than all else of the view.
#[derive(Default)]
pub(super) struct Refusals {
    view: Vec<(Refused, Button)>,
    last_view: Vec<(Refused, Button)>,
}

impl Refusals {
    /// Begins a view; reasons that are not in the last one are forgotten.
    fn next_view(&mut self) {
        self.last_view = take(&mut self.view);
    }

    /// Returns a button without an order that is refused for this reason.
    fn of(&mut self, why: Refused) -> Button {
        if let Some((_, known)) = self.view.iter().find(|it| it.0 == why) {
            return known.clone();
        }
        let place = self.last_view.iter().position(|it| it.0 == why);
        let known = match place {
            Some(place) => self.last_view.swap_remove(place),
            None => (why.clone(), refused(&why)),
        };
        self.view.push(known.clone());
        known.1
    }
}

fn refused(why: &Refused) -> Button {
    let message = why.message();
    Button {
        why_en: message.say(Lang::En),
        why_zh: message.say(Lang::Zh),
        why: Some(message),
        ..Button::default()
    }
}

fn places(station: &Station) -> BTreeMap<String, Token> {
    let unnumbered = || Token {
        kind: "unnumbered".into(),
        ..Token::default()
    };
    let each = station.ledger().each();
    let name = |place: Place| match place {
        Place::Socket(number) => format!("socket_{number}"),
        Place::Pocket | Place::Nest(_) | Place::Gripper | Place::Falling => place.name().to_owned(),
    };
    each.map(|(place, part)| (name(place), part.map_or_else(unnumbered, token)))
        .collect()
}

fn token(part: &Part) -> Token {
    let (kind, name) = match &part.role {
        PartRole::Reference(serial) => ("golden", serial.clone()),
        PartRole::Lot(seq) => ("lot", seq.to_string()),
    };
    Token {
        kind: kind.into(),
        name,
        bin: part.bin.as_ref().map_or("", Bin::name).into(),
        interrupted: part.interrupted.clone().unwrap_or_default(),
        serial: part.serial.clone().unwrap_or_default(),
    }
}

fn lines(station: &Station, epoch_us: i64) -> Vec<AlarmLine> {
    let standing = station.annunciator().listed();
    let (first, others): (Vec<_>, Vec<_>) = standing.iter().partition(|one| one.first_out);
    first
        .into_iter()
        .chain(others)
        .map(|one| line(one, epoch_us))
        .collect()
}

/// Returns an alarm as one line of the alarm list on pages.
pub fn line(one: &ListedAlarm, epoch_us: i64) -> AlarmLine {
    let alarm = &one.alarm;
    let help = |lang| alarm.code.help(lang).map(str::to_owned);
    let raised = epoch_us + i64::try_from(one.raised.0).unwrap_or(i64::MAX);
    AlarmLine {
        code: alarm.code.name(),
        args: alarm.args.clone(),
        text_en: alarm.text(Lang::En),
        text_zh: alarm.text(Lang::Zh),
        state: one.condition.name().into(),
        first_out: one.first_out,
        count: one.count,
        raised_at_us: (!one.inherited).then_some(raised),
        shelved: one.shelved_until.is_some(),
        stops: alarm.code.entry().reaction.name().into(),
        help_en: help(Lang::En),
        help_zh: help(Lang::Zh),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::read;
    use machine::guard::Actuator;
    use machine::rig::point::{DigitalIn, DigitalOut};
    use machine::station::orders::{JOGS, Order as StationOrder, Refused};
    use machine::station::packml::{Command, Mode, State};
    use machine::view::Order;
    use serde_json::json;
    use std::collections::BTreeSet;

    #[test]
    fn every_signal_motion_mode_and_state_has_a_text() {
        let signals = DigitalIn::ALL.iter().map(|it| it.name());
        let signals = signals.chain(DigitalOut::ALL.iter().map(|it| it.name()));
        let keys = (signals.map(|it| format!("signal-{it}")))
            .chain(JOGS.iter().map(|it| format!("motion-{}", it.code())))
            .chain(Actuator::names().map(|it| format!("actuator-{it}")))
            .chain(Mode::ALL.iter().map(|it| format!("mode-{}", it.name())))
            .chain(
                State::ALL
                    .iter()
                    .map(|it| format!("state-{}", it.name().to_lowercase())),
            );
        let words: BTreeSet<&str> = texts::plain().map(|it| it.id).collect();
        let missing: Vec<String> = keys.filter(|it| !words.contains(it.as_str())).collect();
        assert!(missing.is_empty(), "{missing:?}");
    }

    fn order(json: serde_json::Value) -> Order {
        serde_json::from_value(json).unwrap()
    }

    #[test]
    fn parts_of_a_lot_without_its_name_are_refused() {
        for json in [
            json!({"order": "start", "recipe": "jzc-22f-012"}),
            json!({"order": "start", "count": 5}),
            json!({"order": "start", "retest": "zhao"}),
        ] {
            assert_eq!(read(&order(json)), Err(Refused::StartWithoutLot));
        }
        let bare = read(&order(json!({"order": "start"})));
        assert_eq!(bare, Ok(StationOrder::Command(Command::Start)));
    }

    #[test]
    fn shelving_requires_a_reason() {
        let blank = json!({"order": "shelve", "alarm": "door_open", "reason": " "});
        assert_eq!(read(&order(blank)), Err(Refused::ShelveWithoutReason));
    }
}
