//! Plays a story: scripted faults and orders on the simulated rig, with a line-by-line account of what follows.
//!
//! A script ([`script`]) names faults and operator orders, each after an event instead of at a time, so a faster line
//! gives the same story. The `narrator` writes what a mechanic beside the rig sees, leaves out unrelated events, and
//! counts whole seconds from the first action of the script or the first alarm.
//!
//! A story is attended: alarms and stops do not end the run. The story ends when the script is played and the lot is
//! complete or stopped, or after [`SILENCE_TIMEOUT`] without an event.

mod narrator;
mod play;
pub mod script;

use super::admission::admit;
use super::controls::Controls;
use super::exit::{Cause, Exit};
use super::lot::{LotContext, LotRunner, Purpose, Subscriber};
use super::order::{Files, LotOrder};
use super::order_queue::OrderQueue;
use super::simulated::{self, LiveRig};
use super::source::Simulated;
use bus::Pace;
use config::Plant;
use play::Player;
pub use play::{SILENCE_TIMEOUT, StoryReport};
use script::Script;
use std::fs::File;
use std::sync::Arc;
use tokio::sync::mpsc;

/// Plays `script` during the lot of `order` on a new rig; writes the rig's journal (changes of outputs, faults, expired
/// watchdogs) to `journal`. Returns the account and the exit; `outer` receives every event.
///
/// # Errors
/// Fails on bad input, as any lot does.
pub fn run(
    files: &Files,
    rig: Simulated,
    order: &LotOrder,
    (script, journal): (Script, Option<File>),
    outer: &mut dyn Subscriber,
) -> anyhow::Result<(Option<StoryReport>, Exit)> {
    let plant = Plant::load(&files.config)?;
    history::check_rig(&files.db, true)?;
    let recipe = admit(&files.db, &plant, order, Purpose::Lot)?;
    let live = simulated::build(&plant, &rig, order)?;
    let source = rig.on(LiveRig::new(live.clone()));
    let controls = Controls::new(true);
    let runner = LotRunner {
        db: &files.db,
        context: LotContext::new(&plant, (order, &recipe), &source, Purpose::Lot),
        controls: &controls,
    };
    let _signals = controls.stop_on_signals()?;
    super::block_on(&source, async {
        let (onlooker, events) = mpsc::unbounded_channel();
        let (orders, asked) = mpsc::channel(1);
        let stop = Arc::clone(&controls.stop);
        let play = Player::new(script, journal);
        let pace = Pace::virtual_time();
        let playing = tokio::spawn(play.run(events, orders, live, pace, stop));
        let mut both = (onlooker, outer);
        let exit = runner.run(OrderQueue::from(asked), &mut both).await?;
        drop(both);
        let report = playing.await.ok();
        let played = match &report {
            Some(report) if report.complete => Exit::Done,
            Some(_) => Exit::AnswerIsNo,
            None => Exit::Trouble(Cause::script()),
        };
        // Alarms belong to the story and do not fail the command; a failure of the program does.
        let own = exit.cause().is_some_and(Cause::is_program_failure);
        Ok((report, if own { exit } else { played }))
    })
}
