//! SQL for the runs, alarms and orders that a filter selects.

use super::{Filter, Select};
use crate::OrderChoice;

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
        let mut tests = Select::new(
            "SELECT part.verdict AS verdict, part.run_id IN (SELECT run_id FROM retest) AS again \
             FROM part WHERE part.verdict <> 'unjudged'",
        );
        self.run_conditions(&mut tests, "part");
        self.part_conditions(&mut tests, false);
        Select {
            sql: format!(
                "SELECT count(*) FILTER (WHERE NOT again), count(*) FILTER (WHERE NOT again AND verdict = 'pass'),
                   count(*) FILTER (WHERE again AND verdict = 'pass') FROM ({}) AS tested",
                tests.sql
            ),
            values: tests.values,
        }
    }

    /// Counts the judged parts by time span, run and verdict. Span `n` ends before `edges[n]`, microseconds, ascending;
    /// the last span has no end.
    pub(in super::super) fn by_span(&self, edges: &[i64]) -> Select {
        assert!(edges.is_sorted(), "spans out of order");
        let mut counted = Select::new(format!(
            "SELECT {} AS span, part.run_id, part.verdict, count(*) FROM part WHERE part.verdict <> 'unjudged'",
            span(edges, 0)
        ));
        self.run_conditions(&mut counted, "part");
        self.part_conditions(&mut counted, false);
        counted.sql.push_str(" GROUP BY 1, 2, 3");
        counted
    }
}

/// Returns an SQL expression for the number of the span in which a part was judged: a binary search over `edges`.
/// `first` is the number of the span before the first edge.
fn span(edges: &[i64], first: usize) -> String {
    let half = edges.len() / 2;
    let Some(edge) = edges.get(half) else {
        return first.to_string();
    };
    format!(
        "CASE WHEN part.judged_at_us < {edge} THEN {} ELSE {} END",
        span(&edges[..half], first),
        span(&edges[half + 1..], first + half + 1)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_found_by_halves() {
        assert_eq!(span(&[], 3), "3");
        let two = "CASE WHEN part.judged_at_us < 20 THEN CASE WHEN part.judged_at_us < 10 THEN 0 ELSE 1 END ELSE 2 END";
        assert_eq!(span(&[10, 20], 0), two);
    }
}
