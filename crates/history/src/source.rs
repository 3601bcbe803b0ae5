//! Where an archive reads: the file of one rig, or a server that holds the histories of many rigs.
//!
//! A question is one SQL text, written for the file, and one function that reads its rows. A [`Server`] knows the
//! tables of the file by their names and translates the text. SQL selects and orders; Rust does all arithmetic, so that
//! file and server give the same figures to the last digit. Where file and server store rows in different ways, the
//! text depends on [`Dialect`].

use super::error::{HistoryError, Result};
pub use rusqlite::types::Value;
use rusqlite::types::{FromSql, ValueRef};
use rusqlite::{Connection, params_from_iter};
use std::fmt;
use std::ops::ControlFlow;

/// Error of a server, with its name and the remedy.
pub type ServerError = Box<dyn std::error::Error + Send + Sync>;

/// Receives the values of one row; ends the reading with `Break`.
pub type Receiver<'a> = dyn FnMut(&[Value]) -> ControlFlow<()> + 'a;

/// A server that answers SQL written for the tables of a history file.
pub trait Server: fmt::Debug + Send {
    /// Returns the name for messages, without a password.
    fn name(&self) -> &str;

    /// Runs a statement in the SQL of the file and returns all its rows.
    ///
    /// # Errors
    /// Fails when the server cannot be reached or refuses the statement.
    fn rows(
        &self,
        sql: &str,
        values: &[Value],
    ) -> std::result::Result<Vec<Vec<Value>>, ServerError>;

    /// Runs a statement and gives its rows to `each`, page by page; the memory needed does not grow with their number.
    /// `each` may ask further questions.
    ///
    /// # Errors
    /// Fails as [`Self::rows`] does.
    fn each(
        &self,
        sql: &str,
        values: &[Value],
        each: &mut Receiver<'_>,
    ) -> std::result::Result<(), ServerError>;
}

/// Source from which an archive reads.
#[derive(Debug)]
pub(crate) enum Source {
    /// The file of a rig.
    File(Connection),
    /// A server with many rigs.
    Server(Box<dyn Server>),
}

/// How a source stores the rows of a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dialect {
    /// SQLite, one rig. Values carry the verdict of their part, and packed copies of closed runs.
    File,
    /// PostgreSQL, many rigs, tables in partitions by the time of judgement. Values join their part.
    Server,
}

/// Why a row could not be read.
#[derive(Debug)]
pub(crate) enum ReadError {
    File(rusqlite::Error),
    Server(ServerError),
}

/// Result of reading rows.
pub(crate) type Read<T> = std::result::Result<T, ReadError>;

impl From<rusqlite::Error> for ReadError {
    fn from(error: rusqlite::Error) -> Self {
        Self::File(error)
    }
}

impl From<ServerError> for ReadError {
    fn from(error: ServerError) -> Self {
        Self::Server(error)
    }
}

/// One row of an answer.
pub(crate) enum Row<'a> {
    File(&'a rusqlite::Row<'a>),
    Server(&'a [Value]),
}

impl Row<'_> {
    /// Returns the value in column `at`, from 0.
    pub fn get<T: FromSql>(&self, at: usize) -> Read<T> {
        let values = match self {
            Self::File(row) => return Ok(row.get(at)?),
            Self::Server(values) => values,
        };
        let value = values.get(at).map_or(ValueRef::Null, ValueRef::from);
        T::column_result(value).map_err(|error| {
            let error = Box::new(error);
            rusqlite::Error::FromSqlConversionFailure(at, value.data_type(), error).into()
        })
    }
}

impl Source {
    /// Returns how this source stores rows.
    pub const fn dialect(&self) -> Dialect {
        match self {
            Self::File(_) => Dialect::File,
            Self::Server(_) => Dialect::Server,
        }
    }

    /// Returns all rows of a statement, each converted by `read`.
    pub fn rows<T>(
        &self,
        sql: &str,
        values: &[Value],
        mut read: impl FnMut(&Row<'_>) -> Read<T>,
    ) -> Read<Vec<T>> {
        match self {
            Self::File(file) => {
                let mut statement = file.prepare_cached(sql)?;
                let mut rows = statement.query(params_from_iter(values))?;
                let mut all = Vec::new();
                while let Some(row) = rows.next()? {
                    all.push(read(&Row::File(row))?);
                }
                Ok(all)
            }
            Self::Server(server) => {
                let rows = server.rows(sql, values)?;
                rows.iter().map(|row| read(&Row::Server(row))).collect()
            }
        }
    }

    /// Returns the first row of a statement, converted by `read`; `None` without a row.
    pub fn first<T>(
        &self,
        sql: &str,
        values: &[Value],
        mut read: impl FnMut(&Row<'_>) -> Read<T>,
    ) -> Read<Option<T>> {
        match self {
            Self::File(file) => {
                let mut statement = file.prepare_cached(sql)?;
                let mut rows = statement.query(params_from_iter(values))?;
                rows.next()?.map(|row| read(&Row::File(row))).transpose()
            }
            Self::Server(server) => {
                let rows = server.rows(sql, values)?;
                rows.first().map(|row| read(&Row::Server(row))).transpose()
            }
        }
    }

    /// Gives every row to `each`, which may ask further questions, until it returns `Break`.
    pub fn each(
        &self,
        sql: &str,
        values: &[Value],
        mut each: impl FnMut(&Row<'_>) -> Read<ControlFlow<()>>,
    ) -> Read<()> {
        let server = match self {
            Self::Server(server) => server,
            Self::File(file) => {
                let mut statement = file.prepare(sql)?;
                let mut rows = statement.query(params_from_iter(values))?;
                while let Some(row) = rows.next()? {
                    if each(&Row::File(row))?.is_break() {
                        break;
                    }
                }
                return Ok(());
            }
        };
        let mut failed = None;
        server.each(sql, values, &mut |row| match each(&Row::Server(row)) {
            Ok(next) => next,
            Err(error) => {
                failed = Some(error);
                ControlFlow::Break(())
            }
        })?;
        failed.map_or(Ok(()), Err)
    }

    /// Returns the connection of a file, for questions that only a file can answer; fails on a server.
    pub fn file(&self) -> Result<&Connection> {
        match self {
            Self::File(file) => Ok(file),
            Self::Server(server) => Err(HistoryError::OnlyFile {
                server: server.name().to_owned(),
            }),
        }
    }
}

impl Dialect {
    /// Returns the condition that `column` is one of `ids`, with the values of its parameters.
    pub fn among(self, column: &str, ids: &[i64]) -> (String, Vec<Value>) {
        assert!(!ids.is_empty(), "a list of no rows");
        let list = || ids.iter().map(i64::to_string).collect::<Vec<_>>().join(",");
        match self {
            // The text stays the same for every list, so SQLite keeps the prepared statement.
            Self::File => (
                format!("{column} IN (SELECT value FROM json_each(?))"),
                vec![Value::Text(format!("[{}]", list()))],
            ),
            Self::Server => (format!("{column} IN ({})", list()), Vec::new()),
        }
    }

    /// Returns a condition by which a server finds the partition of `table` for parts judged from `first_us` to
    /// `last_us`; an empty text for a file, whose tables have no partitions.
    pub fn judged(self, table: &str, (first_us, last_us): (i64, i64)) -> String {
        assert!(
            first_us <= last_us,
            "a time span that ends before it begins"
        );
        match self {
            Self::File => String::new(),
            Self::Server => format!(" AND {table}.judged_at_us BETWEEN {first_us} AND {last_us}"),
        }
    }

    /// Returns the expression for plant and name of the rig of a `run`; null in a file, which has one rig.
    pub const fn rig(self) -> &'static str {
        match self {
            Self::File => "NULL",
            Self::Server => "run.rig",
        }
    }
}
