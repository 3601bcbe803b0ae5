//! SQL for the runs, alarms and orders that a filter selects.

use super::{Filter, Select};
use crate::OrderChoice;
use crate::source::Dialect;

impl Filter {
    /// Selects the runs of the filter.
    pub(in super::super) fn runs(&self) -> Select {
        let mut select = Select::new(
            "SELECT run.id FROM run JOIN lot ON lot.id = run.lot_id \
             JOIN recipe ON recipe.id = run.recipe_id WHERE true",
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
             LEFT JOIN run ON run.id = alarm.run_id LEFT JOIN lot ON lot.id = run.lot_id WHERE true",
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
             LEFT JOIN lot ON lot.id = run.lot_id WHERE true",
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
                select.add(
                    " AND ordered.what ->> 'order' IS DISTINCT FROM ?",
                    order.to_owned(),
                );
            }
        }
        select.sql.push_str(" ORDER BY ordered.id");
        self.page(&mut select);
        select
    }

    /// Counts the parts judged in first tests, those of them that passed, and the parts that passed in a retest.
    pub(in super::super) fn lot_yield(&self) -> Select {
        self.counted("", "", "")
    }

    /// Counts as [`Self::lot_yield`] does, rig by rig; the last column names the rig.
    pub(in super::super) fn yield_by_rig(&self, dialect: Dialect) -> Select {
        let join = match dialect {
            Dialect::File => "",
            Dialect::Server => " JOIN run ON run.id = part.run_id",
        };
        let rig = format!(", {} AS rig", dialect.rig());
        self.counted(&rig, join, ", rig")
    }

    fn counted(&self, column: &str, join: &str, rig: &str) -> Select {
        let mut tests = Select::new(format!(
            "SELECT part.verdict AS verdict, part.run_id IN (SELECT run_id FROM retest) AS again{column} \
             FROM part{join} WHERE part.verdict <> 'unjudged'"
        ));
        self.run_conditions(&mut tests, "part");
        self.part_conditions(&mut tests, false);
        let by_rig = if rig.is_empty() {
            ""
        } else {
            " GROUP BY rig ORDER BY rig"
        };
        Select {
            sql: format!(
                "SELECT count(*) FILTER (WHERE NOT again), count(*) FILTER (WHERE NOT again AND verdict = 'pass'),
                   count(*) FILTER (WHERE again AND verdict = 'pass'){rig} FROM ({}) AS tested{by_rig}",
                tests.sql
            ),
            values: tests.values,
        }
    }
}
