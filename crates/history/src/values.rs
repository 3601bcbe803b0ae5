//! Values of one parameter in order of judgement, with their limits: the input of the statistics. The values come from
//! the packed values of closed runs, or else from the index `measurement_value`.

use super::error::{Doing, Result};
use super::source::{Read, Row};
use super::{Archive, Filter};
use rusqlite::types::Value;

/// Values of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Finite values in order of judgement; the values of an import are in order of the file.
    pub values: Vec<f64>,
    /// Limits of the runs that the values come from.
    pub limits: LimitsSeen,
}

/// Limits of the runs that the values come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LimitsSeen {
    /// No run has a limit.
    None,
    /// All runs have the same limits.
    Same {
        /// Lower limit.
        low: Option<f64>,
        /// Upper limit.
        high: Option<f64>,
    },
    /// Runs have different limits, so a capability over all of them has no meaning.
    Differ,
}

/// Selects the limits of a parameter in one run.
pub(super) const LIMITS: &str = "SELECT low, high FROM measurement
    WHERE parameter_id = (SELECT id FROM parameter WHERE key = ?)
      AND population = 'lot' AND run_id = ? LIMIT 1";

impl Archive {
    /// Returns the values of `param` for the selected parts; leaves out attempts that were repeated and values that
    /// could not be judged. `limit` and `offset` of the filter count values.
    pub fn values(&self, param: &str, filter: &Filter) -> Result<Values> {
        let values = self.series(param, filter).doing("reading values")?;
        let limits = self.limits_of(param, filter)?;
        Ok(Values { values, limits })
    }

    /// Returns the limits of `param` in the selected runs.
    pub fn limits_of(&self, param: &str, filter: &Filter) -> Result<LimitsSeen> {
        self.limits(param, filter).doing("reading limits")
    }

    fn series(&self, param: &str, filter: &Filter) -> Read<Vec<f64>> {
        let mut values = match self.side_by_side(param, filter)? {
            Some(values) => values,
            None => self.one_by_one(param, filter)?,
        };
        let whole = |it: u64| usize::try_from(it).unwrap_or(usize::MAX);
        values.drain(..filter.offset.map_or(0, whole).min(values.len()));
        values.truncate(filter.limit.map_or(usize::MAX, whole));
        Ok(values)
    }

    fn one_by_one(&self, param: &str, filter: &Filter) -> Read<Vec<f64>> {
        let select = filter.series(param, self.source.dialect());
        let found = select.rows(&self.source, |row| Ok((row.get(0)?, row.get(1)?)))?;
        Ok(in_order(found).collect())
    }

    /// Reads the limits of one measurement per run; that is enough, because the recipe does not change within a run.
    fn limits(&self, param: &str, filter: &Filter) -> Read<LimitsSeen> {
        let mut seen: Option<(Option<f64>, Option<f64>)> = None;
        for run in self.run_rows(filter)? {
            let of_run = [Value::Text(param.to_owned()), Value::Integer(run)];
            let pair = |row: &Row<'_>| Ok((row.get(0)?, row.get(1)?));
            match (self.source.first(LIMITS, &of_run, pair)?, seen) {
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

/// Largest number of empty places per value; with more, [`in_order`] sorts the values instead of placing them by row
/// number.
const EMPTY: usize = 3;

/// Orders values by the row number of their part, which grows in order of judgement: places each value by its row
/// number while the gaps between row numbers are few, and sorts otherwise.
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
    // NaN marks an empty place; the values themselves are finite.
    Box::new(placed.into_iter().filter(|value| !value.is_nan()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_in_order_of_their_parts() {
        let close = vec![(7, 3.0), (5, 1.0), (9, 4.0), (6, 2.0)];
        let far = vec![(i64::MAX, 4.0), (5, 2.0), (i64::MIN, 1.0), (1 << 40, 3.0)];
        for found in [close, far] {
            assert_eq!(in_order(found).collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0]);
        }
        assert_eq!(in_order(Vec::new()).count(), 0);
        assert_eq!(in_order(vec![(3, 1.5)]).collect::<Vec<_>>(), [1.5]);
    }
}
