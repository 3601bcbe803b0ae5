//! State of a target database: what it lacks, whether it takes this file, whether the clocks agree.

use crate::error::Result;
use crate::handshake::next_step;
use crate::link::Link;
use crate::push::{facts, rig};
use config::{FleetSettings, FleetTarget};
use history::outbox::{Lag, Outbox};
use serde::Serialize;

/// Largest difference of the clocks that is no fault, seconds.
const CLOCKS_S: f64 = 60.0;
/// Least number of months that must have partitions ahead.
const AHEAD: i64 = 3;

/// Answer of a database.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// URL of the database, without password.
    pub url: String,
    /// Number of the schema in the database.
    pub schema: i32,
    /// Number of parts of this rig in the database, of all epochs.
    pub parts: i64,
    /// Number of rigs in the database.
    pub rigs: i64,
    /// Number of entries of the queue that the database lacks.
    pub lag_entries: u64,
    /// Number of parts that the database lacks.
    pub lag_parts: u64,
    /// Time since the judgement of the oldest part that the database lacks, s; 0 when it lacks none.
    pub lag_s: f64,
    /// Clock of this computer minus that of the server, s.
    pub clock_ahead_s: f64,
    /// Number of months from now that have partitions.
    pub months_ahead: i64,
    /// Faults, each a text with its remedy.
    pub faults: Vec<String>,
}

/// Asks a database; writes nothing.
///
/// # Errors
/// Fails when the database cannot be reached or has no schema of this program.
pub async fn report(
    outbox: &Outbox,
    fleet: &FleetSettings,
    target: &FleetTarget,
) -> Result<Report> {
    const DOING: &str = "asking for the state";
    let link = Link::open(target).await?;
    let schema = link.schema().await?.unwrap_or_default();
    let before = jiff::Timestamp::now();
    let row = link.row(
        DOING,
        "SELECT (extract(epoch FROM clock_timestamp()) * 1000000)::bigint, (SELECT count(*) FROM relayrig.rig),
           (SELECT count(*) FROM relayrig.part JOIN relayrig.history ON history.id = part.history_id
            JOIN relayrig.rig ON rig.id = history.rig_id WHERE site = $1 AND rig = $2),
           (SELECT count(*) FROM generate_series(1, 60) AS ahead WHERE to_regclass('relayrig.part' ||
             to_char(now() + ahead * interval '1 month', '_YYYY_MM')) IS NOT NULL)",
        &[&fleet.site, &fleet.rig],
    )
    .await?;
    let clock_ahead_s = (before.as_microsecond() - row.get::<_, i64>(0)) as f64 / 1e6;
    let known = outbox.known(&target.url)?;
    let lag = known
        .as_ref()
        .map_or(Ok(Lag::default()), |it| outbox.lag(it))?;
    let mut faults = Vec::new();
    if let Some(known) = &known {
        let facts = facts(&link, fleet, known).await?;
        faults.extend(
            next_step(&rig(fleet), known, &facts)
                .err()
                .map(|it| it.to_string()),
        );
    } else {
        faults.push("nothing was sent yet; run `relayrig fleet push`, or `serve`".to_owned());
    }
    if clock_ahead_s.abs() > CLOCKS_S {
        faults.push(format!(
            "the clock of this computer differs from that of the server by {clock_ahead_s:.0} s; set up time \
             synchronisation on both"
        ));
    }
    let months_ahead = row.get(3);
    if months_ahead < AHEAD {
        faults.push(format!(
            "partitions for {months_ahead} months ahead, expected {AHEAD}; run `relayrig fleet init` as the owner"
        ));
    }
    Ok(Report {
        url: target.url.clone(),
        schema,
        parts: row.get(2),
        rigs: row.get(1),
        lag_entries: lag.entries,
        lag_parts: lag.parts,
        lag_s: age_s(lag),
        clock_ahead_s,
        months_ahead,
        faults,
    })
}

/// Returns the age of the oldest part that a target lacks, seconds.
pub(crate) fn age_s(lag: Lag) -> f64 {
    let now_us = jiff::Timestamp::now().as_microsecond();
    lag.oldest_us
        .map_or(0.0, |oldest| (now_us - oldest).max(0) as f64 / 1e6)
}
