//! A connection that sends the queue of a file, batch by batch, each in one transaction.

use crate::copy;
use crate::error::{FleetError, Refusal, Result};
use crate::link::Link;
use crate::push::{rig, shake_hands};
use config::{FleetSettings, FleetTarget, SampleChoice};
use history::outbox::{self, Batch, Outbox};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Entries of the queue in one batch. A batch of 2,000 parts with 24 measurements each takes the server about a second.
const ENTRIES: u32 = 2000;
/// Longest time for one batch.
const BATCH: Duration = Duration::from_secs(120);

/// Number of batches and parts that were sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pushed {
    /// Batches that the database has committed.
    pub batches: u64,
    /// Parts in these batches.
    pub parts: u64,
}

/// Month of a judgement, UTC.
type Month = (i16, i8);

/// A connection with staging tables; drop it after an error.
#[derive(Debug)]
pub(crate) struct Session {
    link: Link,
    /// Months that have partitions.
    months: BTreeSet<Month>,
}

impl Session {
    /// Connects.
    ///
    /// # Errors
    /// Fails as [`Link::open`] does.
    pub(crate) async fn open(target: &FleetTarget) -> Result<Self> {
        let link = Link::open(target).await?;
        link.step("making staging tables", copy::prepare(&link.client))
            .await?;
        Ok(Self {
            link,
            months: BTreeSet::new(),
        })
    }

    /// Sends until the database lacks nothing, or until `stop` returns true between two batches.
    ///
    /// # Errors
    /// Fails as [`push`](crate::push()) does.
    pub(crate) async fn send_queue(
        &mut self,
        outbox: &mut Outbox,
        fleet: &FleetSettings,
        target: &FleetTarget,
        stop: impl Fn() -> bool,
    ) -> Result<Pushed> {
        let history = shake_hands(&self.link, outbox, fleet, target).await?;
        let mut pushed = Pushed::default();
        while !stop() {
            let Some(batch) = outbox.prepare(&target.url, ENTRIES, samples(target.samples))? else {
                break;
            };
            self.ensure_months(&batch).await?;
            self.send((fleet, history), &batch).await?;
            outbox.confirm(&target.url, &batch.uuid)?;
            pushed.batches += 1;
            pushed.parts += batch.parts.len() as u64;
        }
        Ok(pushed)
    }

    /// Makes the partitions of the months in which the parts of a batch were judged. The months in between get none,
    /// because a computer whose clock jumped must not make hundreds of partitions.
    async fn ensure_months(&mut self, batch: &Batch) -> Result<()> {
        let judged = batch.parts.iter().map(|it| it.judged_at_us);
        let months: BTreeMap<Month, i64> = judged.map(|at_us| (month(at_us), at_us)).collect();
        for (month, at_us) in months {
            if self.months.contains(&month) {
                continue;
            }
            let ensure = "SELECT relayrig.ensure_months($1, $1)";
            self.link
                .row("making partitions", ensure, &[&at_us])
                .await?;
            self.months.insert(month);
        }
        Ok(())
    }

    /// Sends a batch in one transaction. The insert of the batch number comes first: it waits for another program that
    /// sends the same number, and fails when that program commits.
    async fn send(&mut self, (fleet, history): (&FleetSettings, i32), batch: &Batch) -> Result<()> {
        const DOING: &str = "sending a batch";
        let target = self.link.target.clone();
        let work = write(&mut self.link, history, batch);
        let done = tokio::time::timeout(BATCH, work).await;
        let done = done.map_err(|_| FleetError::TimeOut {
            target: target.clone(),
            doing: DOING,
            seconds: BATCH.as_secs(),
            queued: true,
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
}

/// Writes a batch and commits it. Returns the number of runs whose numbers belong to other runs; above 0, nothing is
/// committed.
async fn write(
    link: &mut Link,
    history: i32,
    batch: &Batch,
) -> std::result::Result<i64, tokio_postgres::Error> {
    const BEGIN: &str =
        "INSERT INTO relayrig.batch (uuid, history_id, number, watermark, parts, rig_clock)
        VALUES ($1, $2, $3, $4, $5, $6)";
    let tx = link.client.transaction().await?;
    let parts = i32::try_from(batch.parts.len()).unwrap_or(i32::MAX);
    let clock = std::time::SystemTime::now();
    let (uuid, number, to) = (&batch.uuid, &batch.number, &batch.to);
    tx.execute(BEGIN, &[uuid, &history, number, to, &parts, &clock])
        .await?;
    let differing = copy::write(&tx, history, batch).await?;
    if differing == 0 {
        tx.commit().await?;
    }
    Ok(differing)
}

/// Returns the month, UTC, of an instant in microseconds since 1970; beyond the calendar, its last month.
fn month(at_us: i64) -> Month {
    let at = jiff::Timestamp::from_microsecond(at_us).unwrap_or(jiff::Timestamp::MAX);
    let date = at.to_zoned(jiff::tz::TimeZone::UTC);
    (date.year(), date.month())
}

const fn samples(choice: SampleChoice) -> outbox::SampleChoice {
    match choice {
        SampleChoice::None => outbox::SampleChoice::None,
        SampleChoice::Rejects => outbox::SampleChoice::Rejects,
        SampleChoice::All => outbox::SampleChoice::All,
    }
}
