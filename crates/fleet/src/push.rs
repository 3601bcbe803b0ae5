//! Sends what a database lacks; gives a rig to another file.

use crate::error::{FleetError, Refusal, Result};
use crate::handshake::{Facts, Known, Step, next_step};
use crate::link::Link;
use crate::session::{Pushed, Session};
use config::{FleetSettings, FleetTarget};
use history::outbox::{Outbox, Restart, Target};
use tokio_postgres::Row;
use tokio_postgres::types::ToSql;

/// Sends until the database lacks nothing, or until `stop` returns true between two batches.
///
/// # Errors
/// Fails when the database refuses the file or cannot be reached. The database keeps the batches committed before; the
/// other rows stay in the queue.
pub async fn push(
    outbox: &mut Outbox,
    fleet: &FleetSettings,
    target: &FleetTarget,
    stop: impl Fn() -> bool,
) -> Result<Pushed> {
    let sent = async {
        let mut session = Session::open(target).await?;
        session.send_queue(outbox, fleet, target, stop).await
    };
    sent.await.map_err(FleetError::while_sending)
}

/// Queues every row again, after the database has lost rows; the database keeps what it has.
///
/// # Errors
/// Fails when the database cannot be reached, or another file sends under the name of this rig.
pub async fn start_again(
    outbox: &mut Outbox,
    fleet: &FleetSettings,
    target: &FleetTarget,
) -> Result<()> {
    let link = Link::open(target).await?;
    let file = outbox.target(&target.url)?;
    let facts = facts(&link, fleet, &file).await?;
    let current = facts.current.clone();
    let ours = current
        .as_ref()
        .is_none_or(|it| it.identity == file.identity);
    if !ours {
        return Err(refused(&link, next_step(&rig(fleet), &file, &facts)));
    }
    let last = current.and_then(|it| it.last);
    Ok(outbox.restart(&target.url, &Restart::Again { last })?)
}

/// Makes this file the current one of its rig, as a new epoch. Queues the runs that the database lacks.
///
/// # Errors
/// Fails when the database cannot be reached.
pub async fn take_over(
    outbox: &mut Outbox,
    fleet: &FleetSettings,
    target: &FleetTarget,
) -> Result<()> {
    const DOING: &str = "taking over a rig";
    let link = Link::open(target).await?;
    outbox.target(&target.url)?;
    let of_rig = "FROM relayrig.history JOIN relayrig.rig ON rig.id = history.rig_id WHERE site = $1 AND rig = $2";
    let runs =
        format!("SELECT uuid FROM relayrig.run WHERE history_id IN (SELECT history.id {of_rig})");
    let runs = link.rows(DOING, &runs, &[&fleet.site, &fleet.rig]).await?;
    let since = format!(
        "SELECT coalesce(max((extract(epoch FROM rig_clock) * 1000000)::bigint), 0) FROM relayrig.batch
         WHERE history_id IN (SELECT history.id {of_rig})"
    );
    let since_us = link
        .row(DOING, &since, &[&fleet.site, &fleet.rig])
        .await?
        .get(0);
    let known = runs.iter().map(|row| row.get(0)).collect();
    outbox.restart(&target.url, &Restart::TakeOver { known, since_us })?;
    let file = outbox.target(&target.url)?;
    begin(&link, fleet, &file).await.map(drop)
}

/// Compares file and database; returns the number that the history of this file has in the database.
pub(crate) async fn shake_hands(
    link: &Link,
    outbox: &mut Outbox,
    fleet: &FleetSettings,
    target: &FleetTarget,
) -> Result<i32> {
    let file = outbox.target(&target.url)?;
    let facts = facts(link, fleet, &file).await?;
    let id = facts.current.as_ref().map(|it| it.id);
    match next_step(&rig(fleet), &file, &facts) {
        Ok(Step::Begin) => begin(link, fleet, &file).await,
        Ok(Step::Send) => Ok(id.unwrap_or_default()),
        Ok(Step::Confirm(batch)) => {
            outbox.confirm(&target.url, &batch)?;
            Ok(id.unwrap_or_default())
        }
        refused_step @ Err(_) => Err(refused(link, refused_step)),
    }
}

fn refused(link: &Link, step: std::result::Result<Step, Refusal>) -> FleetError {
    match step {
        Err(refusal) => FleetError::Refused {
            target: link.target.clone(),
            refusal,
        },
        Ok(_) => unreachable!("a file that another one replaced is refused"),
    }
}

/// Returns plant and rig as messages name them.
pub(crate) fn rig(fleet: &FleetSettings) -> String {
    format!("{}/{}", fleet.site, fleet.rig)
}

/// Reads what the database knows of the rig and of the file.
pub(crate) async fn facts(link: &Link, fleet: &FleetSettings, file: &Target) -> Result<Facts> {
    const DOING: &str = "asking for the last batch";
    const CURRENT: &str = "
        SELECT history.id, history.uuid, epoch, host, to_char(begun_at, 'YYYY-MM-DD HH24:MI \"UTC\"'), last.number,
          last.uuid, last_run.uuid, (SELECT count(*) FROM relayrig.part WHERE part.run_id = last_run.id)
        FROM relayrig.history JOIN relayrig.rig ON rig.id = history.rig_id
          LEFT JOIN LATERAL (SELECT number, uuid FROM relayrig.batch WHERE history_id = history.id
            ORDER BY number DESC LIMIT 1) AS last ON true
          LEFT JOIN LATERAL (SELECT id, uuid FROM relayrig.run WHERE history_id = history.id
            ORDER BY id DESC LIMIT 1) AS last_run ON true
        WHERE site = $1 AND rig = $2 ORDER BY epoch DESC LIMIT 1";
    const OWN: &str = "
        SELECT EXISTS (SELECT 1 FROM relayrig.batch WHERE uuid = $1),
          EXISTS (SELECT 1 FROM relayrig.history WHERE uuid = $2)";
    let current = link
        .rows(DOING, CURRENT, &[&fleet.site, &fleet.rig])
        .await?;
    let own = link
        .row(DOING, OWN, &[&file.confirmed, &file.identity])
        .await?;
    Ok(Facts {
        current: current.first().map(known),
        has_confirmed: own.get(0),
        was_ours: own.get(1),
    })
}

fn known(row: &Row) -> Known {
    let pair = |first: Option<i64>, second: Option<String>| first.zip(second);
    Known {
        id: row.get(0),
        identity: row.get(1),
        epoch: row.get(2),
        host: row.get(3),
        since: row.get(4),
        last: pair(row.get(5), row.get(6)),
        last_run: row.get::<_, Option<String>>(7).map(|run| (run, row.get(8))),
    }
}

/// Registers the file as the current one of its rig; returns the number that its history gets in the database.
async fn begin(link: &Link, fleet: &FleetSettings, file: &Target) -> Result<i32> {
    const DOING: &str = "registering the rig";
    let rig = "INSERT INTO relayrig.rig (site, rig) VALUES ($1, $2) ON CONFLICT DO NOTHING";
    link.rows(DOING, rig, &[&fleet.site, &fleet.rig]).await?;
    let program = concat!("relayrig ", env!("CARGO_PKG_VERSION"));
    // A second program that begins at the same moment gets the same epoch and fails.
    let history = "INSERT INTO relayrig.history (rig_id, epoch, uuid, host, program)
        SELECT rig.id, (SELECT coalesce(max(epoch), 0) + 1 FROM relayrig.history WHERE rig_id = rig.id), $3, $4, $5
        FROM relayrig.rig WHERE site = $1 AND rig = $2 RETURNING id";
    let host = host();
    let values: [&(dyn ToSql + Sync); 5] =
        [&fleet.site, &fleet.rig, &file.identity, &host, &program];
    Ok(link.row(DOING, history, &values).await?.get(0))
}

/// Returns the name of this computer.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname");
    name.map_or_else(|_| "unknown".to_owned(), |it| it.trim().to_owned())
}
