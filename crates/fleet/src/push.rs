//! Sends what a database lacks, batch by batch.

use crate::copy;
use crate::error::{FleetError, Refusal, Result};
use crate::handshake::{Facts, Known, Step, next_step};
use crate::link::Link;
use config::{FleetSettings, FleetTarget, SampleChoice};
use history::outbox::{self, Batch, Outbox, Restart, Target};
use tokio_postgres::Row;
use tokio_postgres::types::ToSql;

/// Entries of the queue in one batch. A batch of 2,000 parts with 24 measurements each takes the server about a second.
const ENTRIES: u32 = 2000;

/// Counts of a transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pushed {
    /// Number of batches that the database has committed.
    pub batches: u64,
    /// Number of parts in these batches.
    pub parts: u64,
}

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
    let mut link = Link::open(target).await?;
    let history = shake_hands(&link, outbox, fleet, target).await?;
    link.step("making staging tables", copy::prepare(&link.client))
        .await?;
    let mut pushed = Pushed::default();
    let mut months = None;
    while !stop() {
        let Some(batch) = outbox.prepare(&target.url, ENTRIES, samples(target.samples))? else {
            break;
        };
        ensure_months(&link, &batch, &mut months).await?;
        send(&mut link, (fleet, history), &batch).await?;
        outbox.confirm(&target.url, &batch.uuid)?;
        pushed.batches += 1;
        pushed.parts += batch.parts.len() as u64;
    }
    Ok(pushed)
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

/// Compares file and database; returns the number of the history there.
async fn shake_hands(
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

/// Registers the file as the current one of its rig; returns its number.
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

/// Makes the partitions for the parts of a batch; `made` is the time span that has them already.
async fn ensure_months(link: &Link, batch: &Batch, made: &mut Option<(i64, i64)>) -> Result<()> {
    let times = || batch.parts.iter().map(|it| it.judged_at_us);
    let (Some(first), Some(last)) = (times().min(), times().max()) else {
        return Ok(());
    };
    if made.is_some_and(|(low, high)| low <= first && last <= high) {
        return Ok(());
    }
    let ensure = "SELECT relayrig.ensure_months($1, $2)";
    link.row("making partitions", ensure, &[&first, &last])
        .await?;
    *made = Some((first, last));
    Ok(())
}

/// Sends a batch in one transaction. The number of the batch comes first: it waits for another program that sends the
/// same number, and fails when that one commits.
async fn send(
    link: &mut Link,
    (fleet, history): (&FleetSettings, i32),
    batch: &Batch,
) -> Result<()> {
    const DOING: &str = "sending a batch";
    let target = link.target.clone();
    let work = async {
        let tx = link.client.transaction().await?;
        let parts = i32::try_from(batch.parts.len()).unwrap_or(i32::MAX);
        let clock = std::time::SystemTime::now();
        tx.execute(
            "INSERT INTO relayrig.batch (uuid, history_id, number, watermark, parts, rig_clock)
             VALUES ($1, $2, $3, $4, $5, $6)",
            &[
                &batch.uuid,
                &history,
                &batch.number,
                &batch.to,
                &parts,
                &clock,
            ],
        )
        .await?;
        let differing = copy::write(&tx, history, batch).await?;
        if differing == 0 {
            tx.commit().await?;
        }
        Ok(differing)
    };
    let limit = std::time::Duration::from_secs(120);
    let done = tokio::time::timeout(limit, work).await;
    let done: std::result::Result<i64, tokio_postgres::Error> =
        done.map_err(|_| FleetError::TimeOut {
            target: target.clone(),
            doing: DOING,
            seconds: limit.as_secs(),
        })?;
    match done.map_err(|error| FleetError::of(&target, DOING, error))? {
        0 => Ok(()),
        count => Err(FleetError::Refused {
            target,
            refusal: Refusal::RunDiffers {
                rig: rig(fleet),
                count,
            },
        }),
    }
}

const fn samples(choice: SampleChoice) -> outbox::SampleChoice {
    match choice {
        SampleChoice::None => outbox::SampleChoice::None,
        SampleChoice::Rejects => outbox::SampleChoice::Rejects,
        SampleChoice::All => outbox::SampleChoice::All,
    }
}

/// Returns the name of this computer.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname");
    name.map_or_else(|_| "unknown".to_owned(), |it| it.trim().to_owned())
}
