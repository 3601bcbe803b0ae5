//! SQL for the runs, alarms and orders that a filter selects.

use super::{Filter, Select};
use crate::OrderChoice;

impl Filter {
    /// Selects the runs of the filter.
    pub(in super::super) fn runs(&self) -> Select {
        let mut select = Select::new(
            "SELECT run.id FROM run JOIN lot ON lot.id = run.lot_id \
             JOIN recipe ON recipe.id = run.recipe_id WHERE 1",
        );
        if let Some(lot) = &self.lot {
            select.add(" AND lot.name = ?", lot.clone());
        }
        if let Some(recipe) = &self.recipe {
            select.add(" AND recipe.name = ?", recipe.clone());
        }
        if let Some(run) = self.run {
            select.add(" AND run.number = ?", i64::from(run));
        }
        select
    }

    /// Selects the alarms of the filter, with their lot and run, in order of time.
    pub(in super::super) fn alarms(&self) -> Select {
        let mut select = Select::new(
            "SELECT lot.name, run.number, alarm.code, alarm.line, alarm.text, alarm.raised_at_us, \
             alarm.cleared_at_us, alarm_state.acknowledged_at_us, alarm_state.acknowledged_by, \
             alarm_state.shelved_until_us, alarm_state.shelved_by, alarm_state.shelf_reason, alarm.args \
             FROM alarm LEFT JOIN alarm_state ON alarm_state.alarm_id = alarm.id \
             LEFT JOIN run ON run.id = alarm.run_id LEFT JOIN lot ON lot.id = run.lot_id WHERE 1",
        );
        self.run_conditions(&mut select, "alarm");
        self.span(&mut select, "alarm.raised_at_us");
        select
            .sql
            .push_str(" ORDER BY alarm.raised_at_us, alarm.id");
        self.page(&mut select);
        select
    }

    /// Selects the orders of the filter, with their lot and run, in order of time.
    pub(in super::super) fn orders(&self, choice: &OrderChoice) -> Select {
        let mut select = Select::new(
            "SELECT ordered.at_us, lot.name, run.number, ordered.who, ordered.role, ordered.origin, \
             ordered.what, ordered.refused, ordered.refusal FROM ordered LEFT JOIN run ON run.id = ordered.run_id \
             LEFT JOIN lot ON lot.id = run.lot_id WHERE 1",
        );
        self.run_conditions(&mut select, "ordered");
        self.span(&mut select, "ordered.at_us");
        if let Some(who) = &choice.who {
            select.add(" AND ordered.who = ?", who.clone());
        }
        if let Some(order) = &choice.order {
            select.add(" AND ordered.what ->> 'order' = ?", order.clone());
        }
        if choice.without_people {
            for order in OrderChoice::OF_PEOPLE {
                select.add(" AND ordered.what ->> 'order' IS NOT ?", order.to_owned());
            }
        }
        select.sql.push_str(" ORDER BY ordered.id");
        self.page(&mut select);
        select
    }
}
