//! Builds the view of the machine from station, image and outputs; parses orders for the station.

use super::{Cycle, Snapshot};
use machine::dut::verdict::Bin;
use machine::guard::{Actuator, Position};
use machine::handling::ledger::{Part, PartRole};
use machine::handling::mechanism::SENSOR_AGE;
use machine::rig::point::DigitalInput;
use machine::station::Station;
use machine::station::annunciator::ListedAlarm;
use machine::station::catalogue;
use machine::station::orders::{self, Order, Refused};
use machine::station::packml::{Command, Mode};
use machine::view::{self, ActuatorView, AlarmLine, Button, Machine, Reaction, Token};
use std::collections::BTreeMap;
use texts::Lang;
use units::{RigTime, Span};

/// Shortest time between two views.
pub const PACE: Span = Span::ms(50);

/// Parses an order; an error says which word it has and which words are known.
pub fn read(order: &view::Order) -> Result<Order, Refused> {
    let expected = |member, known: Vec<&'static str>, found: Option<&str>| Refused::UnknownWord {
        member,
        found: found.unwrap_or_default().to_owned(),
        known,
    };
    let named = order.alarm.clone();
    match order.order.as_str() {
        "start" if order.lot.is_some() => Ok(Order::Leave),
        "hold_lot" => Ok(Order::Leave),
        "close_lot" => Ok(Order::Close),
        "mode" => order
            .mode
            .as_deref()
            .and_then(Mode::from_name)
            .map(Order::Mode)
            .ok_or_else(|| {
                let known = Mode::ALL.iter().map(|mode| mode.name()).collect();
                expected("mode", known, order.mode.as_deref())
            }),
        "jog" => order
            .motion
            .as_deref()
            .and_then(orders::jog)
            .map(Order::Jog)
            .ok_or_else(|| {
                let known = orders::JOGS.iter().map(|(name, _)| *name).collect();
                expected("motion", known, order.motion.as_deref())
            }),
        "step" => Ok(Order::Step),
        "lamp_test" => Ok(Order::LampTest),
        "acknowledge" => Ok(Order::Acknowledge(named)),
        "shelve" => match (named, order.reason.as_deref().map(str::trim)) {
            (Some(code), Some(reason)) if !reason.is_empty() => {
                Ok(Order::Shelve(code, orders::shelf_minutes(order.minutes)))
            }
            (Some(_), _) => Err(Refused::ShelveWithoutReason),
            (None, _) => Err(expected("alarm", vec!["the code of an alarm"], None)),
        },
        other => Command::from_name(other)
            .map(Order::Command)
            .ok_or_else(|| expected("order", view::ORDERS.to_vec(), Some(other))),
    }
}

impl Cycle {
    /// Sends a snapshot at most once per [`PACE`], and only on a rig with a screen.
    pub(super) fn publish(&mut self, now: RigTime, last: bool) {
        let Some(snapshots) = self.links.snapshots.clone() else {
            return;
        };
        if now < self.publish_at && !last {
            return;
        }
        self.publish_at = now + PACE;
        let mut machine = self.machine(now);
        machine.jogs = self.jog_preview(now);
        let station = &self.station;
        let (activity, ledger) = (station.activity(), station.ledger());
        let in_lot = !station.is_between_lots();
        // When no snapshot can wait, screens lag behind; the rig does not.
        let _ = snapshots.try_send(Snapshot {
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
            buttons: buttons(station),
            actuators: Actuator::ALL
                .iter()
                .map(|actuator| self.actuator(*actuator, now))
                .collect(),
            places: places(station),
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
        }
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

    fn actuator(&self, actuator: Actuator, now: RigTime) -> ActuatorView {
        let mechanism = self.station.mechanism();
        let (from_mm, to_mm) = match mechanism.position(actuator, now, &self.image) {
            Position::At(mm) => (mm, mm),
            Position::Between { from_mm, to_mm } => (from_mm.min(to_mm), from_mm.max(to_mm)),
        };
        let strokes = mechanism.strokes();
        ActuatorView {
            name: actuator.name().into(),
            from_mm,
            to_mm,
            moving: mechanism
                .moving()
                .any(|movement| movement.motion(strokes).target_mm(actuator).is_some()),
        }
    }
}

fn buttons(station: &Station) -> Vec<Button> {
    let button = |order: &str, with: &str, may: Result<(), Refused>| {
        let why = may.err().map(|why| why.message());
        let said = |lang| why.as_ref().map(|it| it.say(lang)).unwrap_or_default();
        Button {
            order: order.into(),
            with: with.into(),
            enabled: why.is_none(),
            why_en: said(Lang::En),
            why_zh: said(Lang::Zh),
            why,
        }
    };
    let commands = Command::ALL
        .iter()
        .map(|command| button(command.name(), "", station.may(*command)));
    let modes = Mode::ALL
        .iter()
        .map(|mode| button("mode", mode.name(), station.may_change_mode()));
    let jogs = orders::JOGS
        .iter()
        .map(|(name, _)| button("jog", name, station.may_jog()));
    commands
        .chain(modes)
        .chain(jogs)
        .chain([
            button("step", "", station.may_step()),
            button("lamp_test", "", Ok(())),
            button("start", "lot", station.may_leave()),
            button("close_lot", "", station.may_close()),
        ])
        .collect()
}

fn places(station: &Station) -> BTreeMap<String, Token> {
    let unnumbered = || Token {
        kind: "unnumbered".into(),
        ..Token::default()
    };
    let each = station.ledger().each();
    each.map(|(place, part)| (place.name().to_owned(), part.map_or_else(unnumbered, token)))
        .collect()
}

fn token(part: &Part) -> Token {
    let (kind, name) = match &part.kind {
        PartRole::Reference(serial) => ("golden", serial.clone()),
        PartRole::Lot(seq) => ("lot", seq.to_string()),
    };
    Token {
        kind: kind.into(),
        name,
        bin: part.bin.as_ref().map_or("", Bin::name).into(),
        interrupted: part.interrupted.clone().unwrap_or_default(),
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

/// Returns an alarm as pages show it.
pub fn line(one: &ListedAlarm, epoch_us: i64) -> AlarmLine {
    let alarm = &one.alarm;
    let help = |lang| alarm.code.help(lang).map(str::to_owned);
    let stops = match alarm.code.entry().reaction {
        catalogue::Reaction::Abort => "abort",
        catalogue::Reaction::Hold => "hold",
        catalogue::Reaction::Suspend => "suspend",
        catalogue::Reaction::Nothing => "nothing",
    };
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
        stops: stops.into(),
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
    use machine::station::orders::JOGS;
    use machine::station::packml::{Mode, State};
    use machine::view::{ORDERS, Order};
    use std::collections::BTreeSet;
    use texts::Lang;

    #[test]
    fn every_signal_motion_mode_and_state_has_a_text() {
        let signals = DigitalIn::ALL.iter().map(|it| it.name());
        let signals = signals.chain(DigitalOut::ALL.iter().map(|it| it.name()));
        let keys = (signals.map(|it| format!("signal-{it}")))
            .chain(JOGS.iter().map(|(name, _)| format!("motion-{name}")))
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

    #[test]
    fn every_order_parses() {
        for word in ORDERS {
            let order = Order {
                order: word.into(),
                mode: Some("manual".into()),
                motion: Some("pusher_extend".into()),
                alarm: Some("door_open".into()),
                reason: Some("sensor is on its way".into()),
                ..Order::default()
            };
            assert!(read(&order).is_ok(), "{word}");
        }
    }

    #[test]
    fn an_order_without_its_argument_names_what_is_expected() {
        for (word, expected) in [
            ("mode", "production"),
            ("jog", "pusher_extend"),
            ("shelve", "alarm"),
            ("fly", "reset"),
        ] {
            let order = Order {
                order: word.into(),
                ..Order::default()
            };
            let why = read(&order)
                .map(|_| ())
                .map_err(|why| why.message().say(Lang::En));
            assert!(why.is_err_and(|why| why.contains(expected)), "{word}");
        }
    }

    #[test]
    fn shelving_requires_a_reason() {
        for reason in [None, Some(" ".to_owned())] {
            let order = Order {
                order: "shelve".into(),
                alarm: Some("door_open".into()),
                reason,
                ..Order::default()
            };
            let why = read(&order)
                .map(|_| ())
                .map_err(|why| why.message().say(Lang::En));
            assert!(why.is_err_and(|why| why.contains("why the alarm is shelved")));
        }
    }
}
