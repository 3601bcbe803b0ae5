//! Asks a database what all its rigs do and made, for the page of all rigs.
//!
//! - [`watch`] keeps one connection and asks every [`EVERY`], whatever the number of screens; it asks for shifts,
//!   reasons and reference parts every [`DAY_EVERY`]. Each answer is one snapshot: a transaction that only reads and
//!   ends at once.
//! - A question reads the last 36 hours, rig by rig, through the indexes of the partitions, and the last 200 alarms,
//!   50 calibrations and 100 reference checks of a rig. Its cost does not grow with the age of the database.
//! - `OFFSET 0` keeps a subquery about one rig apart, so that the server enters the index once per rig instead of
//!   reading a month of all rigs.
//! - When the database is lost, the last answers stay, with the trouble; the next question connects again.

mod day;
mod now;
mod references;

use crate::error::{FleetError, Result};
use crate::link::Link;
use config::FleetTarget;
use history::Moment;
use history::inquiry::rigs::{Overview, Trouble};
use history::inquiry::shifts::Shift;
use jiff::tz::TimeZone;
use std::time::Duration;
use tokio::sync::watch::Sender;
use tokio::time::{Instant, sleep};

const DOING: &str = "asking for the state of the rigs";

/// Pause between two questions.
pub const EVERY: Duration = Duration::from_secs(5);
/// Least time between two questions about shifts, reasons and reference parts.
pub const DAY_EVERY: Duration = Duration::from_secs(60);
/// Longest time for one statement.
const PATIENCE: Duration = Duration::from_secs(20);

/// Time that the overview looks back, µs: a day, and a shift that began before that day.
const BACK_US: i64 = 36 * HOUR_US;
const HOUR_US: i64 = 3_600_000_000;

/// What [`watch`] asks about.
#[derive(Debug, Clone)]
pub struct Watched {
    /// Database to ask.
    pub target: FleetTarget,
    /// Shifts of the plant; empty for a plant without shifts.
    pub shifts: Vec<Shift>,
    /// Time zone of the shifts.
    pub zone: TimeZone,
}

/// Asks every [`EVERY`] and sends each new overview to `seen`; ends when every receiver is gone.
pub async fn watch(watched: &Watched, seen: &Sender<Overview>) {
    let mut link = None;
    let mut turns = DayTurns::default();
    while !seen.is_closed() {
        if let Err(error) = turn(watched, &mut link, &mut turns, seen).await {
            link = None;
            note(&error, seen);
        }
        tokio::select! {
            () = sleep(EVERY) => {}
            () = seen.closed() => {}
        }
    }
}

/// The last question about what the rigs made.
#[derive(Debug, Default)]
struct DayTurns {
    /// Time of the last question.
    asked: Option<Instant>,
    /// True while the question has no answer.
    failed: bool,
}

/// Asks what the rigs do and, when [`DAY_EVERY`] has passed, what they made. A database that is too slow for the second
/// question still answers the first; the trouble stays until both questions have answers.
async fn turn(
    watched: &Watched,
    link: &mut Option<Link>,
    turns: &mut DayTurns,
    seen: &Sender<Overview>,
) -> Result<()> {
    let link = match link {
        Some(link) => link,
        None => link.insert(connected(&watched.target).await?),
    };
    let now = snapshot(link, now::ask(link, None)).await?;
    let at = now.at;
    seen.send_modify(|it| it.now = Some(now));
    if turns.asked.is_none_or(|it| it.elapsed() >= DAY_EVERY) {
        *turns = DayTurns {
            asked: Some(Instant::now()),
            failed: true,
        };
        let day = snapshot(link, day::ask(link, watched, at)).await?;
        turns.failed = false;
        seen.send_modify(|it| it.day = Some(day));
    }
    let is_over = !turns.failed && seen.borrow().trouble.is_some();
    if is_over {
        tracing::info!(target = watched.target.url, "database reached again");
        seen.send_modify(|it| it.trouble = None);
    }
    Ok(())
}

/// Notes a failure; logs it when its text differs from that of the failure before.
fn note(error: &FleetError, seen: &Sender<Overview>) {
    let text = error.to_string();
    seen.send_modify(|it| {
        let before = it.trouble.take();
        if before.as_ref().is_none_or(|before| before.text != text) {
            tracing::warn!("fleet: {text}");
        }
        it.trouble = Some(Trouble {
            text,
            remedy: error.remedy().code(),
            since: before.map_or_else(
                || Moment(jiff::Timestamp::now().as_microsecond()),
                |it| it.since,
            ),
        });
    });
}

/// Runs `work` in a transaction that only reads. Drop the connection after an error.
async fn snapshot<T>(link: &Link, work: impl Future<Output = Result<T>>) -> Result<T> {
    let begin = "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY";
    link.step(DOING, link.client.batch_execute(begin)).await?;
    let found = work.await?;
    link.step(DOING, link.client.batch_execute("COMMIT"))
        .await?;
    Ok(found)
}

async fn connected(target: &FleetTarget) -> Result<Link> {
    let link = Link::open(target).await?.patient(PATIENCE);
    let settings = "SET jit = off; SET statement_timeout = '18s'";
    link.step(DOING, link.client.batch_execute(settings))
        .await?;
    Ok(link)
}

/// Asks a database once, over a connection of its own; looks back from `as_of`, or from now.
///
/// # Errors
/// Fails as [`Link::open`] does.
pub async fn overview(watched: &Watched, as_of: Option<Moment>) -> Result<Overview> {
    let link = connected(&watched.target).await?;
    let answers = async {
        let now = now::ask(&link, as_of).await?;
        let day = day::ask(&link, watched, now.at).await?;
        Ok((now, day))
    };
    let (now, day) = snapshot(&link, answers).await?;
    Ok(Overview {
        target: watched.target.url.clone(),
        trouble: None,
        now: Some(now),
        day: Some(day),
    })
}
