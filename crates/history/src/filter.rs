//! The filter that command line, page and exports share, and its SQL.
//!
//! Without the member `param`, the indexes of the table `part` find the parts. With `param`, the index
//! `measurement_value` (parameter, population, run, verdict, value) gives their row numbers: SQLite enters this index
//! once per run and verdict, at the least value, and then visits the matching parts in ascending order, so a page of
//! results ends the search early. On a server, the index of the same name begins with the run; a value has no copy of
//! the verdict, so the query joins the part. `filter/related.rs` selects runs, alarms and orders.

mod related;

use super::Moment;
use super::gates::SUSPECT;
use super::source::{Dialect, Read, Row, Source};
use rusqlite::types::Value;

/// Selects parts; a member that is absent selects all.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Filter {
    /// Name of the lot.
    pub lot: Option<String>,
    /// Number of the run within its lot.
    pub run: Option<u32>,
    /// Name of the recipe.
    pub recipe: Option<String>,
    /// Judged at this instant or later.
    pub since: Option<Moment>,
    /// Judged before this instant.
    pub until: Option<Moment>,
    /// `pass`, `fail`, `void` or `unjudged`.
    pub verdict: Option<String>,
    /// Name of the bin that the verdict assigns.
    pub bin: Option<String>,
    /// Serial number of the part.
    pub serial: Option<String>,
    /// `lot` for production parts (also when absent), `golden` for reference parts, or `all`.
    pub kind: Option<String>,
    /// Key of a parameter; selects parts with a usable value of it: a number from the last attempt, unless this attempt
    /// is void.
    pub param: Option<String>,
    /// Least value of `param`, included.
    pub min: Option<f64>,
    /// Greatest value of `param`, included.
    pub max: Option<f64>,
    /// True selects only suspect parts: judged before a failed reference check and after the check before it.
    pub suspect: bool,
    /// Largest number of parts to return, the first in order of judgement.
    pub limit: Option<u64>,
    /// Number of parts to skip first.
    pub offset: Option<u64>,
}

/// An SQL statement with the values of its parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Select {
    /// Statement with a `?` for each of `values`.
    pub sql: String,
    /// Values in the order of the `?`.
    pub values: Vec<Value>,
}

impl Select {
    fn new(sql: impl Into<String>) -> Self {
        Self {
            sql: sql.into(),
            values: Vec::new(),
        }
    }

    /// Runs the statement and returns all rows, each converted by `read`.
    pub fn rows<T>(&self, source: &Source, read: impl FnMut(&Row<'_>) -> Read<T>) -> Read<Vec<T>> {
        source.rows(&self.sql, &self.values, read)
    }

    /// Runs the statement and returns the first row, converted by `read`; `None` without a row.
    pub fn first<T>(
        &self,
        source: &Source,
        read: impl FnMut(&Row<'_>) -> Read<T>,
    ) -> Read<Option<T>> {
        source.first(&self.sql, &self.values, read)
    }

    /// Returns true when the statement gives a row.
    pub fn exists(&self, source: &Source) -> Read<bool> {
        let found = self.first(source, |_| Ok(()));
        Ok(found?.is_some())
    }

    pub fn add(&mut self, sql: &str, value: impl Into<Value>) {
        self.sql.push_str(sql);
        self.values.push(value.into());
    }
}

const COLUMNS: &str = "part.id, part.run_id, part.kind, part.seq, part.serial, part.verdict, \
    part.bin, part.reasons, part.judged_at_us, part.test_s, part.cycle_s, part.landed_bin, \
    part.landed_at_us";

/// Selects the latest test of a reference part.
pub(super) fn reference_part() -> String {
    format!(
        "SELECT {COLUMNS} FROM part WHERE part.serial = ?1 AND part.kind = 'golden'
         ORDER BY part.id DESC LIMIT 1"
    )
}

impl Filter {
    /// Returns true when the filter selects every part of its runs, reference parts included.
    pub fn takes_whole_runs(&self) -> bool {
        let runs = Self {
            lot: self.lot.clone(),
            run: self.run,
            recipe: self.recipe.clone(),
            kind: Some("all".to_owned()),
            ..Self::default()
        };
        *self == runs
    }

    /// Selects the columns of the parts, in order of judgement; over several rigs, rig by rig.
    pub(super) fn parts(&self, dialect: Dialect) -> Select {
        let mut select = match (&self.param, dialect) {
            (Some(param), Dialect::File) => {
                let mut select = self.values(param, "m.part_id", false);
                select.sql = format!(
                    "SELECT {COLUMNS} FROM part WHERE part.id IN ({})",
                    select.sql
                );
                select
            }
            (Some(param), Dialect::Server) => self.joined_values(param, COLUMNS),
            (None, Dialect::File | Dialect::Server) => {
                let mut select = Select::new(format!("SELECT {COLUMNS} FROM part WHERE true"));
                self.run_conditions(&mut select, "part");
                select
            }
        };
        self.part_conditions(&mut select, self.param.is_some());
        select.sql.push_str(" ORDER BY part.id");
        self.page(&mut select);
        select
    }

    /// Adds the filter's limit and offset to a statement.
    fn page(&self, select: &mut Select) {
        let signed = |it: u64| i64::try_from(it).unwrap_or(i64::MAX);
        if self.limit.is_some() || self.offset.is_some() {
            select.add(" LIMIT ?", self.limit.map_or(i64::MAX, signed));
            select.add(" OFFSET ?", self.offset.map_or(0, signed));
        }
    }

    /// Selects the row number of each part and its value of a parameter, in no particular order. Reads only the index
    /// `measurement_value`, unless the filter has a bin, a serial number, a time span or `suspect`.
    pub(super) fn series(&self, param: &str, dialect: Dialect) -> Select {
        const SERIES: &str = "m.part_id, m.value";
        let mut select = match dialect {
            Dialect::File if !self.restricts_part() => return self.values(param, SERIES, false),
            Dialect::File => self.values(param, SERIES, true),
            Dialect::Server => self.joined_values(param, SERIES),
        };
        self.part_conditions(&mut select, true);
        select
    }

    /// Counts the selected parts. In a file, with `param`, reads only the index `measurement_value` when this index has
    /// a column for every member of the filter.
    pub(super) fn count(&self, dialect: Dialect) -> Select {
        let found = match (&self.param, dialect) {
            (Some(param), Dialect::File) if !self.restricts_part() => {
                let mut found = self.values(param, "1", false);
                self.page(&mut found);
                found
            }
            _ => self.parts(dialect),
        };
        Select {
            sql: format!("SELECT count(*) FROM ({}) AS found", found.sql),
            values: found.values,
        }
    }

    /// Returns true when the filter, its limit and offset aside, selects all production parts of the runs that it
    /// names.
    pub(super) fn selects_whole_runs(&self) -> bool {
        let production = self.kind.as_deref().is_none_or(|kind| kind == "lot");
        let ranged = self.min.is_some() || self.max.is_some();
        production && self.verdict.is_none() && !ranged && !self.restricts_part()
    }

    /// Returns true when a member of the filter needs a column that the index `measurement_value` lacks.
    fn restricts_part(&self) -> bool {
        let of_part = self.bin.is_some() || self.serial.is_some();
        self.suspect || of_part || self.since.is_some() || self.until.is_some()
    }

    /// Selects the cycle times of the parts that have one.
    pub(super) fn cycles(&self) -> Select {
        let mut select =
            Select::new("SELECT part.cycle_s FROM part WHERE part.cycle_s IS NOT NULL");
        self.run_conditions(&mut select, "part");
        self.part_conditions(&mut select, false);
        select
    }

    /// Selects from the index `measurement_value` of a file; `joined` adds the columns of the table `part`.
    fn values(&self, param: &str, columns: &str, joined: bool) -> Select {
        let join = if joined {
            " CROSS JOIN part ON part.id = m.part_id"
        } else {
            ""
        };
        let mut select = self.values_from(&format!("{columns} FROM measurement AS m{join}"), param);
        self.add_runs(&mut select, "m");
        match &self.verdict {
            Some(verdict) => select.add(" AND m.part_verdict = ?", verdict.clone()),
            None => {
                select
                    .sql
                    .push_str(" AND m.part_verdict IN ('pass', 'fail', 'void', 'unjudged')");
            }
        }
        self.range(&mut select);
        select
    }

    /// Selects from values and parts of a server, partition by partition.
    fn joined_values(&self, param: &str, columns: &str) -> Select {
        const JOINED: &str = "FROM measurement AS m JOIN part ON part.id = m.part_id AND part.judged_at_us = m.judged_at_us";
        let mut select = self.values_from(&format!("{columns} {JOINED}"), param);
        self.add_runs(&mut select, "m");
        if let Some(verdict) = &self.verdict {
            select.add(" AND part.verdict = ?", verdict.clone());
        }
        self.range(&mut select);
        self.span(&mut select, "m.judged_at_us");
        select
    }

    fn values_from(&self, columns: &str, param: &str) -> Select {
        let mut select = Select::new(format!("SELECT {columns} WHERE "));
        select.add(
            "m.parameter_id = (SELECT id FROM parameter WHERE key = ?)",
            param.to_owned(),
        );
        let population = match self.kind.as_deref() {
            Some("all") => " AND m.population IN ('lot', 'golden')",
            Some("golden") => " AND m.population = 'golden'",
            Some(_) | None => " AND m.population = 'lot'",
        };
        select.sql.push_str(population);
        select
    }

    fn range(&self, select: &mut Select) {
        select.add(" AND m.value >= ?", self.min.unwrap_or(f64::MIN));
        select.add(" AND m.value <= ?", self.max.unwrap_or(f64::MAX));
    }

    fn run_conditions(&self, select: &mut Select, table: &str) {
        if self.lot.is_some() || self.recipe.is_some() || self.run.is_some() {
            self.add_runs(select, table);
        }
    }

    fn add_runs(&self, select: &mut Select, table: &str) {
        let runs = self.runs();
        let sql = format!(" AND {table}.run_id IN ({})", runs.sql);
        select.sql.push_str(&sql);
        select.values.extend(runs.values);
    }

    /// Adds the condition that `column` lies in the time span of the filter: `since` included, `until` excluded.
    fn span(&self, select: &mut Select, column: &str) {
        if let Some(since) = self.since {
            select.add(&format!(" AND {column} >= ?"), since.0);
        }
        if let Some(until) = self.until {
            select.add(&format!(" AND {column} < ?"), until.0);
        }
    }

    /// Adds the conditions on the table `part`. With `by_value`, leaves out kind and verdict, because [`Self::values`]
    /// adds them.
    fn part_conditions(&self, select: &mut Select, by_value: bool) {
        if !by_value {
            match self.kind.as_deref() {
                Some("all") => {}
                Some(kind) => select.add(" AND part.kind = ?", kind.to_owned()),
                None => select.sql.push_str(" AND part.kind = 'lot'"),
            }
            if let Some(verdict) = &self.verdict {
                select.add(" AND part.verdict = ?", verdict.clone());
            }
        }
        self.span(select, "part.judged_at_us");
        if let Some(bin) = &self.bin {
            select.add(" AND part.bin = ?", bin.clone());
        }
        if let Some(serial) = &self.serial {
            select.add(" AND part.serial = ?", serial.clone());
        }
        if self.suspect {
            select.sql.push_str(SUSPECT);
        }
    }
}
