//! Answers the questions of a history from a database with many rigs.
//!
//! A reader has one transaction that only reads, so that all answers of a command come from one snapshot. A reader
//! needs no more than the role `relayrig_reader`. A command reads without a time limit; a page opens a reader with a
//! limit for each request.

use crate::error::{FleetError, Result};
use crate::link::Link;
use crate::tables::{Scope, translated};
use crate::value::{Bound, Cell};
use config::FleetTarget;
use history::{Receiver, Server, ServerError, Value};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};
use tokio_postgres::Row;
use tokio_postgres::types::ToSql;

const DOING: &str = "asking";

/// Rows of one page.
const PAGE: usize = 1000;

/// Selection of the rigs that answer; an absent member selects all.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Rigs {
    /// Name of the plant.
    pub site: Option<String>,
    /// Name of the rig.
    pub rig: Option<String>,
}

/// A connection that answers questions.
#[derive(Debug)]
pub struct Reader {
    /// Absent only while the reader is dropped.
    runtime: Option<Runtime>,
    link: Link,
    scope: Scope,
    /// Number of cursors opened so far.
    cursors: AtomicU32,
}

impl Reader {
    /// Connects to a database and begins to read.
    ///
    /// # Errors
    /// Fails as [`Link::open`] does, and when the database has no rig of this name.
    pub fn open(target: &FleetTarget, rigs: &Rigs) -> Result<Self> {
        Self::open_within(target, rigs, None)
    }

    /// Connects and begins to read. The server ends a statement after `limit`, and the transaction when it stays idle
    /// for 60 s (an hour without `limit`).
    ///
    /// # Errors
    /// Fails as [`Reader::open`] does.
    pub fn open_within(target: &FleetTarget, rigs: &Rigs, limit: Option<Duration>) -> Result<Self> {
        let runtime = Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|error| FleetError::Runtime { error })?;
        let (link, scope) = runtime.block_on(async {
            let mut link = Link::open(target).await?;
            if let Some(limit) = limit {
                // The server ends a statement first, and says so.
                link = link.patient(limit + Duration::from_secs(2));
            }
            link.step(DOING, link.client.batch_execute(&begin(limit)))
                .await?;
            let scope = scope(&link, rigs).await?;
            Ok::<_, FleetError>((link, scope))
        })?;
        Ok(Self {
            runtime: Some(runtime),
            link,
            scope,
            cursors: AtomicU32::new(0),
        })
    }

    fn ask(&self, sql: &str, values: &[Value]) -> Result<Vec<Row>> {
        let bound: Vec<Bound<'_>> = values.iter().map(Bound).collect();
        let bound: Vec<&(dyn ToSql + Sync)> = bound.iter().map(|it| it as _).collect();
        let runtime = self.runtime.as_ref();
        let runtime = runtime.expect("a reader that is not being dropped");
        runtime.block_on(self.link.rows(DOING, sql, &bound))
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        // When a client gives up a request, the reader is dropped on a thread that must not wait.
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

/// Returns the statements that set the limits and begin the transaction.
fn begin(limit: Option<Duration>) -> String {
    let limits = match limit {
        None => "SET idle_in_transaction_session_timeout = '1h'".to_owned(),
        Some(limit) => format!(
            "SET idle_in_transaction_session_timeout = '60s'; SET statement_timeout = {}",
            limit.as_millis()
        ),
    };
    format!(
        "{limits}; SET enable_partitionwise_join = on; SET jit = off; SET work_mem = '64MB';
         BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY"
    )
}

impl Server for Reader {
    fn name(&self) -> &str {
        &self.link.target
    }

    fn rows(
        &self,
        sql: &str,
        values: &[Value],
    ) -> std::result::Result<Vec<Vec<Value>>, ServerError> {
        let rows = self.ask(&translated(sql, &self.scope), values)?;
        Ok(rows.iter().map(cells).collect())
    }

    fn each(
        &self,
        sql: &str,
        values: &[Value],
        each: &mut Receiver<'_>,
    ) -> std::result::Result<(), ServerError> {
        let cursor = format!("c{}", self.cursors.fetch_add(1, Ordering::Relaxed));
        let sql = translated(sql, &self.scope);
        self.ask(
            &format!("DECLARE {cursor} NO SCROLL CURSOR FOR {sql}"),
            values,
        )?;
        let next = format!("FETCH {PAGE} FROM {cursor}");
        loop {
            let rows = self.ask(&next, &[])?;
            let stopped = rows.iter().any(|row| each(&cells(row)).is_break());
            if stopped || rows.len() < PAGE {
                break;
            }
        }
        self.ask(&format!("CLOSE {cursor}"), &[])?;
        Ok(())
    }
}

fn cells(row: &Row) -> Vec<Value> {
    (0..row.len()).map(|at| row.get::<_, Cell>(at).0).collect()
}

/// Finds the histories of the rigs.
async fn scope(link: &Link, rigs: &Rigs) -> Result<Scope> {
    let Rigs { site, rig } = rigs;
    if site.is_none() && rig.is_none() {
        return Ok(Scope::All);
    }
    let select =
        "SELECT history.id FROM relayrig.history JOIN relayrig.rig ON rig.id = history.rig_id
        WHERE ($1::text IS NULL OR site = $1) AND ($2::text IS NULL OR rig = $2) ORDER BY 1";
    let found = link.rows(DOING, select, &[site, rig]).await?;
    if !found.is_empty() {
        return Ok(Scope::Histories(
            found.iter().map(|row| row.get(0)).collect(),
        ));
    }
    let known = "SELECT coalesce(string_agg(site || '/' || rig, ', ' ORDER BY site, rig), 'none') FROM (SELECT site, rig
        FROM relayrig.rig ORDER BY 1, 2 LIMIT 20) AS known";
    let named = |it: &Option<String>| it.as_deref().unwrap_or("*").to_owned();
    Err(FleetError::NoRig {
        target: link.target.clone(),
        found: format!("{}/{}", named(site), named(rig)),
        expected: link.row(DOING, known, &[]).await?.get(0),
    })
}
