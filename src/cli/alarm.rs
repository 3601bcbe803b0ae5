//! `relayrig alarm`: unacknowledged alarms of runs that have ended.
//!
//! A running controller does not see these changes: use its page or `POST /api/orders` instead.

use super::output::Output;
use super::person;
use anyhow::ensure;
use app::alarm_order;
use app::exit::Exit;
use history::{Moment, Store, UnacknowledgedAlarm};
use machine::station::orders::shelf_minutes;
use machine::view::Order;
use serde_json::json;
use std::path::Path;

/// Lists, acknowledges or shelves alarms.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig alarm list
  relayrig alarm acknowledge door_open --by li
  relayrig alarm acknowledge --by li
  relayrig alarm shelve bin_full --minutes 60 --by li --reason 'sensor is on its way'")]
pub struct AlarmArgs {
    /// Alarms of the simulated rig
    #[arg(long, global = true)]
    sim: bool,
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// List unacknowledged alarms
    #[command(after_help = "Example: relayrig alarm list --sim --json")]
    List {
        /// One JSON object per alarm
        #[arg(long)]
        json: bool,
    },
    /// Acknowledge an alarm, or all of them
    #[command(after_help = "Example: relayrig alarm acknowledge door_open --by li")]
    Acknowledge {
        /// Code of the alarm; when absent, every alarm
        code: Option<String>,
        /// Person who acknowledges the alarm
        #[arg(long, value_name = "NAME")]
        by: String,
    },
    /// Hide an alarm for a while
    #[command(
        after_help = "Example: relayrig alarm shelve bin_full --by li --reason 'sensor is on its way'"
    )]
    Shelve {
        /// Code of the alarm
        code: String,
        /// Minutes for which the alarm is hidden, 1 to 480
        #[arg(long, value_name = "N", default_value_t = 30)]
        minutes: u32,
        /// Person who shelves the alarm
        #[arg(long, value_name = "NAME")]
        by: String,
        /// Reason
        #[arg(long, value_name = "TEXT")]
        reason: String,
    },
}

/// Runs `relayrig alarm`; an error is bad input (exit status 2).
pub fn run(db: &Path, args: &AlarmArgs) -> anyhow::Result<Exit> {
    let mut store = Store::open(db)?;
    let (order, by) = match &args.action {
        Action::List { json } => {
            list(&store.unacknowledged_alarms(args.sim)?, *json)?;
            return Ok(Exit::Done);
        }
        Action::Acknowledge { code, by } => {
            let order = Order::Acknowledge {
                alarm: code.clone(),
            };
            (order, by)
        }
        Action::Shelve {
            code,
            minutes,
            by,
            reason,
        } => {
            ensure!(
                !reason.trim().is_empty(),
                "--reason: found nothing, expected the reason"
            );
            let order = Order::Shelve {
                alarm: code.clone(),
                minutes: Some(shelf_minutes(Some(*minutes))),
                reason: reason.clone(),
            };
            (order, by)
        }
    };
    alarm_order::write(&mut store, args.sim, &order, &person(by)?)?;
    Ok(Exit::Done)
}

fn list(left: &[UnacknowledgedAlarm], as_json: bool) -> anyhow::Result<()> {
    let shelved = |it: &UnacknowledgedAlarm| it.shelved_until_us.map(Moment);
    let object = |it: &UnacknowledgedAlarm| json!({"code": it.code, "count": it.count, "text": it.text, "shelved_until": shelved(it)});
    let row = |it: &UnacknowledgedAlarm| {
        let shelved =
            shelved(it).map_or_else(String::new, |it| format!(", shelved until {}", it.local()));
        format!("{} ({} times{shelved}): {}", it.code, it.count, it.text)
    };
    Ok(Output::stdout().lines(as_json, left, object, row)?)
}
