//! Makes the rows of a run other than those of its parts: state of the lot, alarms and their acknowledgement, reference
//! checks, wear, end of the run.

use crate::alarm_order;
use crate::exit::Exit;
use history::{
    AlarmChange, AlarmChangeRecord, AlarmRecord, HoldReason, InsideRecord, LotState,
    LotStateRecord, OrderRecord, ReferenceCheckRecord, Row, RunEndRecord, WearRecord,
};
use machine::handling::inside::Inside;
use machine::handling::wear::Uses;
use machine::station::annunciator::ListedAlarm;
use machine::station::catalogue::AlarmCode;
use machine::station::trouble::Alarm;
use machine::station::turn::{Checked, Ending};
use machine::view::AnsweredOrder;
use texts::Lang;

/// Alarms that put the lot on hold until a person releases it.
const HOLD_ALARMS: [AlarmCode; 2] = [AlarmCode::ReferenceCheckFailed, AlarmCode::RejectRateLimit];
/// Alarm of a run whose references or reference parts give no calibration; counts as a failed reference check.
const NOT_CALIBRATED: AlarmCode = AlarmCode::CalibrationFailed;

/// State of the run according to the rows so far, on which the next rows depend.
#[derive(Debug)]
pub struct Journal {
    /// Name of the lot; `None` between lots.
    lot: Option<String>,
    simulated: bool,
    /// Alarms whose cause is present.
    active: Vec<Alarm>,
    /// Code of the alarm that put the lot on hold; `None` when the lot is not on hold.
    held: Option<String>,
    uses: Uses,
}

impl Journal {
    /// Creates a journal without a lot.
    pub fn new(simulated: bool) -> Self {
        Self {
            lot: None,
            simulated,
            active: Vec::new(),
            held: None,
            uses: Uses::default(),
        }
    }

    /// Begins a run of `lot`; returns the row that marks the lot as running.
    pub fn begin(&mut self, lot: &str, at_us: i64) -> Option<Row> {
        self.lot = Some(lot.to_owned());
        self.lot(LotState::Running, None, at_us)
    }

    /// Returns true until [`Self::begin`] begins a run of a lot.
    pub fn has_no_lot(&self) -> bool {
        self.lot.is_none()
    }

    /// Returns the row that puts the lot into this state.
    fn lot(&self, state: LotState, why: Option<HoldReason>, at_us: i64) -> Option<Row> {
        let row = |lot: &String| {
            Row::LotState(LotStateRecord {
                lot: lot.clone(),
                state,
                why,
                at_us,
            })
        };
        self.lot.as_ref().map(row)
    }

    /// Returns the rows of a new alarm.
    pub fn alarm(&mut self, alarm: &Alarm, at_us: i64) -> Vec<Row> {
        let text = alarm.text(Lang::En);
        let mut rows = vec![Row::Alarm(AlarmRecord {
            lot: self.lot.clone(),
            code: alarm.code.name(),
            args: alarm.args.clone(),
            line: None,
            text: text.clone(),
            raised_at_us: at_us,
            cleared_at_us: None,
        })];
        if alarm.code == NOT_CALIBRATED {
            rows.extend(self.check(&text, Some(alarm), at_us));
        }
        if HOLD_ALARMS.contains(&alarm.code) {
            self.held = Some(alarm.code.name());
            let why = HoldReason::Alarm(alarm.clone());
            rows.extend(self.lot(LotState::Held, Some(why), at_us));
        }
        rows
    }

    /// Returns the rows that follow from a changed alarm list: one for each alarm whose cause is gone, and one for a
    /// lot that is no longer on hold.
    pub fn standing(&mut self, standing: &[ListedAlarm], at_us: i64) -> Vec<Row> {
        let active = standing.iter().filter(|one| one.is_active());
        let active: Vec<Alarm> = active.map(|one| one.alarm.clone()).collect();
        let remains = |one: &Alarm| active.iter().any(|it| it.is_same(one));
        let gone = self.active.iter().filter(|one| !remains(one));
        let mut rows: Vec<Row> = gone.map(|one| self.returned(one, at_us)).collect();
        let holds = |held: &str| active.iter().any(|it| it.code.name() == held);
        if self.held.take_if(|held| !holds(held)).is_some() {
            rows.extend(self.lot(LotState::Running, None, at_us));
        }
        self.active = active;
        rows
    }

    fn returned(&self, alarm: &Alarm, at_us: i64) -> Row {
        let own = |(name, value): (&'static str, &str)| (name, value.to_owned());
        Row::AlarmChange(AlarmChangeRecord {
            simulated: self.simulated,
            code: Some(alarm.code.name()),
            at_us,
            change: AlarmChange::Returned {
                only: alarm.distinction().map(own),
            },
        })
    }

    /// Returns the rows of an answered order: the order itself, and any change that the order makes to alarms.
    pub fn ordered(&self, it: &AnsweredOrder, at_us: i64) -> Vec<Row> {
        let by = &it.by;
        let mut rows = vec![Row::Order(OrderRecord {
            lot: self.lot.clone(),
            at_us,
            who: by.who.clone(),
            role: by.role.clone(),
            origin: by.origin.clone(),
            what: serde_json::to_string(&it.order).unwrap_or_else(|_| "null".into()),
            refused: it.refused.clone(),
        })];
        if it.refused.is_none() {
            rows.extend(alarm_order::change(self.simulated, &it.order, by, at_us));
        }
        rows
    }

    /// Returns the row of a reference check.
    pub fn checked(&self, checked: &Checked, at_us: i64) -> Option<Row> {
        self.check(&checked.text, checked.failure.as_ref(), at_us)
    }

    /// Returns the row of the passed reference check that a calibration includes.
    pub fn calibrated(&self, at_us: i64) -> Option<Row> {
        self.check("calibration", None, at_us)
    }

    fn check(&self, text: &str, failure: Option<&Alarm>, at_us: i64) -> Option<Row> {
        let row = |lot: &String| {
            Row::ReferenceCheck(ReferenceCheckRecord {
                lot: lot.clone(),
                at_us,
                text: text.to_owned(),
                failure: failure.cloned(),
            })
        };
        self.lot.as_ref().map(row)
    }

    /// Returns one row for each use count that has grown since the last call, with its increase.
    pub fn uses(&mut self, uses: Uses) -> Vec<Row> {
        let before = std::mem::replace(&mut self.uses, uses);
        let each = uses.each().into_iter().zip(before.each());
        each.filter(|((_, now), (_, before))| now > before)
            .map(|((name, now), (_, before))| {
                Row::Wear(WearRecord {
                    simulated: self.simulated,
                    name: name.to_owned(),
                    more: now - before,
                })
            })
            .collect()
    }

    /// Returns the row of the machine's contents.
    pub fn inside(&self, inside: Inside) -> Row {
        Row::Inside(InsideRecord {
            simulated: self.simulated,
            inside,
        })
    }

    /// Returns the row that ends the run, with the cause, and the row with the new state of the lot, unless an alarm
    /// holds the lot.
    pub fn ended(&self, ending: &Ending, exit: &Exit, at_us: i64) -> Vec<Row> {
        let Some(lot) = &self.lot else {
            return Vec::new();
        };
        let mut rows = vec![Row::RunEnded(RunEndRecord {
            lot: lot.clone(),
            ended: *ending,
            cause: exit.cause().map(|it| (it.code.clone(), it.text.clone())),
        })];
        let state = match ending {
            Ending::Complete => LotState::Complete,
            Ending::Stopped | Ending::Alarm => LotState::Open,
        };
        if self.held.is_none() {
            rows.extend(self.lot(state, None, at_us));
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exit::Cause;
    use machine::station::annunciator::Annunciator;
    use units::RigTime;

    fn journal() -> Journal {
        let mut journal = Journal::new(false);
        journal.begin("A", 0);
        journal
    }

    fn fault() -> texts::Message {
        texts::Message::new("fault", "line").with("detail", "silent")
    }

    fn states(rows: &[Row]) -> Vec<LotState> {
        let state = |row: &Row| match row {
            Row::LotState(it) => Some(it.state),
            _other => None,
        };
        rows.iter().filter_map(state).collect()
    }

    #[test]
    fn failed_check_holds_the_lot_until_its_alarm_clears() {
        let mut journal = journal();
        let alarm = Alarm::reference_check_failed(&fault());
        let mut list = Annunciator::default();
        list.raise(&alarm, RigTime(1));
        assert_eq!(states(&journal.alarm(&alarm, 1)), [LotState::Held]);
        assert!(journal.standing(list.listed(), 1).is_empty());
        let trouble = Exit::Trouble(Cause::from(&alarm));
        let ended = journal.ended(&Ending::Alarm, &trouble, 2);
        assert!(states(&ended).is_empty());
        let cause = ("golden_check_failed".to_owned(), alarm.text(Lang::En));
        assert!(matches!(&ended[..], [Row::RunEnded(it)] if it.cause == Some(cause)));
        list.cleared();
        let rows = journal.standing(list.listed(), 3);
        assert_eq!(states(&rows), [LotState::Running]);
        assert_eq!(rows.len(), 2, "the alarm has returned and the lot runs");
        let rows = journal.ended(&Ending::Complete, &Exit::Done, 4);
        assert_eq!(states(&rows), [LotState::Complete]);
    }

    #[test]
    fn an_alarm_of_the_machine_leaves_the_lot_open() {
        let mut journal = journal();
        let alarm: Alarm = AlarmCode::PartNotArrived.into();
        assert!(states(&journal.alarm(&alarm, 1)).is_empty());
        let trouble = Exit::Trouble(Cause::from(&alarm));
        let rows = journal.ended(&Ending::Alarm, &trouble, 2);
        assert_eq!(states(&rows), [LotState::Open]);
    }

    #[test]
    fn an_alarm_between_lots_belongs_to_no_lot() {
        let mut journal = Journal::new(false);
        let rows = journal.alarm(&Alarm::reference_check_failed(&fault()), 1);
        assert!(matches!(&rows[..], [Row::Alarm(it)] if it.lot.is_none()));
        let ended = journal.ended(&Ending::Stopped, &Exit::Stopped, 2);
        assert!(ended.is_empty());
    }

    #[test]
    fn only_an_accepted_acknowledgement_changes_the_alarm() {
        let asked = |refused: Option<texts::Message>| AnsweredOrder {
            order: machine::view::Order::Acknowledge {
                alarm: Some("door_open".into()),
            },
            by: machine::view::By {
                who: "li".into(),
                ..Default::default()
            },
            refused,
        };
        let rows = journal().ordered(&asked(None), 5);
        let [Row::Order(order), Row::AlarmChange(change)] = &rows[..] else {
            panic!("{rows:?}")
        };
        assert_eq!((order.who.as_str(), order.at_us), ("li", 5));
        assert_eq!(order.what, r#"{"order":"acknowledge","alarm":"door_open"}"#);
        assert_eq!(change.code.as_deref(), Some("door_open"));
        let refused = texts::Message::new("refusal", "no_such_alarm");
        assert_eq!(journal().ordered(&asked(Some(refused)), 5).len(), 1);
    }

    #[test]
    fn wear_rows_hold_the_increase() {
        let mut journal = journal();
        let uses = |probe_touches| Uses {
            probe_touches,
            jaw_closings: 0,
        };
        assert_eq!(journal.uses(uses(3)).len(), 1);
        assert!(journal.uses(uses(3)).is_empty());
        let rows = journal.uses(uses(5));
        assert!(matches!(&rows[..], [Row::Wear(it)] if it.more == 2));
    }
}
