//! The values of one parameter in order of judgement, and the limits they were judged by: what the
//! statistics need, read from the packed values of whole runs or else from the index of values alone.

use super::error::{Doing, Result};
use super::{Archive, Filter};
use rusqlite::{OptionalExtension, params, params_from_iter};

/// Values of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Finite, in order of judgement (of the file, on import).
    pub values: Vec<f64>,
    /// Limits in force.
    pub limits: LimitsSeen,
}

/// Limits found on the runs that the values come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LimitsSeen {
    /// No run had any.
    None,
    /// All runs agree.
    Same {
        /// Lower limit.
        low: Option<f64>,
        /// Upper limit.
        high: Option<f64>,
    },
    /// Runs differ, so that a capability over all of them means nothing.
    Differ,
}

/// Limits of one run.
pub(super) const LIMITS: &str = "SELECT low, high FROM measurement
    WHERE parameter_id = (SELECT id FROM parameter WHERE key = ?1)
      AND population = 'lot' AND run_id = ?2 LIMIT 1";

impl Archive {
    /// Values of `param` on the parts that the filter leaves. Superseded attempts, values that
    /// could not be judged and (unless asked for) golden parts do not count. The filter's `limit`
    /// and `offset` count values in order of judgement.
    pub fn values(&self, param: &str, filter: &Filter) -> Result<Values> {
        let values = self.series(param, filter).doing("reading values")?;
        let limits = self.limits(param, filter).doing("reading limits")?;
        Ok(Values { values, limits })
    }

    fn series(&self, param: &str, filter: &Filter) -> rusqlite::Result<Vec<f64>> {
        let mut values = match self.side_by_side(param, filter)? {
            Some(values) => values,
            None => self.one_by_one(param, filter)?,
        };
        let whole = |it: u64| usize::try_from(it).unwrap_or(usize::MAX);
        values.drain(..filter.offset.map_or(0, whole).min(values.len()));
        values.truncate(filter.limit.map_or(usize::MAX, whole));
        Ok(values)
    }

    fn one_by_one(&self, param: &str, filter: &Filter) -> rusqlite::Result<Vec<f64>> {
        let select = filter.series(param);
        let mut statement = self.connection.prepare(&select.sql)?;
        let mut rows = statement.query(params_from_iter(&select.values))?;
        let mut found: Vec<(i64, f64)> = Vec::new();
        while let Some(row) = rows.next()? {
            found.push((row.get(0)?, row.get(1)?));
        }
        Ok(in_order(found).collect())
    }

    /// A recipe is frozen during a run, so one measurement speaks for all of its run.
    fn limits(&self, param: &str, filter: &Filter) -> rusqlite::Result<LimitsSeen> {
        let mut one = self.connection.prepare_cached(LIMITS)?;
        let mut seen: Option<(Option<f64>, Option<f64>)> = None;
        for run in self.run_rows(filter)? {
            let pair = one.query_row(params![param, run], |row| Ok((row.get(0)?, row.get(1)?)));
            match (pair.optional()?, seen) {
                (None, _) => {}
                (Some(pair), Some(first)) if pair != first => return Ok(LimitsSeen::Differ),
                (Some(pair), _) => seen = Some(pair),
            }
        }
        Ok(match seen {
            None | Some((None, None)) => LimitsSeen::None,
            Some((low, high)) => LimitsSeen::Same { low, high },
        })
    }
}

/// So many places may stay empty for each value that is placed by its part.
const EMPTY: usize = 3;

/// Values by the row number of their part, which grows in order of judgement. Row numbers have few gaps, so
/// that a value is put in its place at once; only where they are far apart they are sorted.
fn in_order(mut found: Vec<(i64, f64)>) -> Box<dyn Iterator<Item = f64>> {
    let parts = found.iter().map(|&(part, _)| part);
    let (Some(first), Some(last)) = (parts.clone().min(), parts.max()) else {
        return Box::new(std::iter::empty());
    };
    let places = usize::try_from(last.abs_diff(first)).unwrap_or(usize::MAX);
    if places / (1 + EMPTY) >= found.len() {
        found.sort_unstable_by_key(|&(part, _)| part);
        return Box::new(found.into_iter().map(|(_, value)| value));
    }
    let mut placed = vec![f64::NAN; places + 1];
    for (part, value) in found {
        placed[part.abs_diff(first) as usize] = value;
    }
    // Only finite values have a place in the index.
    Box::new(placed.into_iter().filter(|value| !value.is_nan()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_in_order_of_their_parts_whether_these_are_close_or_far_apart() {
        let close = vec![(7, 3.0), (5, 1.0), (9, 4.0), (6, 2.0)];
        let far = vec![(i64::MAX, 4.0), (5, 2.0), (i64::MIN, 1.0), (1 << 40, 3.0)];
        for found in [close, far] {
            assert_eq!(in_order(found).collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0]);
        }
        assert_eq!(in_order(Vec::new()).count(), 0);
        assert_eq!(in_order(vec![(3, 1.5)]).collect::<Vec<_>>(), [1.5]);
    }
}
