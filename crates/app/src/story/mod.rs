//! A story: a script of troubles and orders on the simulated rig, and what happened, line by line.
//!
//! A script ([`script`]) says which faults strike the rig and what a person at the screen does, each after an event,
//! not at a time: so it tells the same story on a faster line. The `narrator` writes down what a mechanic
//! beside the rig sees. It counts whole seconds from the first trouble and leaves out what has nothing to do with it.
//!
//! A person is at the screen: alarms and stops end nothing. The story ends when the script has been played and the
//! lot is complete, or when nothing has happened for [`PATIENCE`].

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
use super::source::{RigSource, Simulated};
use bus::Pace;
use config::Plant;
use play::Play;
pub use play::{PATIENCE, StoryReport};
use script::Script;
use std::fs::File;
use std::sync::Arc;
use tokio::sync::mpsc;

/// Plays `script` beside the lot of `order` on a rig that is built for it; what the outputs did goes to `journal`.
/// Returns the story, and how the run ended; `outer` hears every event.
///
/// # Errors
/// Bad input, as of any lot.
pub fn tell(
    files: &Files,
    rig: Simulated,
    order: &LotOrder,
    (script, journal): (Script, Option<File>),
    outer: &mut dyn Subscriber,
) -> anyhow::Result<(Option<StoryReport>, Exit)> {
    let plant = Plant::load(&files.config)?;
    let recipe = admit(&files.db, &plant, order, Purpose::Lot)?;
    let live = simulated::build(&plant, &rig, order)?;
    let source = RigSource::Simulated(Simulated {
        live: Some(Box::new(LiveRig {
            rig: live.clone(),
            epoch_us: jiff::Timestamp::now().as_microsecond(),
            calibration: None,
        })),
        ..rig
    });
    let controls = Controls::new(true);
    let runner = LotRunner {
        db: &files.db,
        context: LotContext::new(&plant, (order, &recipe), &source, Purpose::Lot),
        controls: &controls,
    };
    super::block_on(&source, async {
        controls.heed_signals();
        let (onlooker, events) = mpsc::unbounded_channel();
        let (orders, asked) = mpsc::channel(1);
        let stop = Arc::clone(&controls.stop);
        let play = Play::new(script, journal);
        let pace = Pace::virtual_time();
        let playing = tokio::spawn(play.run(events, orders, live, pace, stop));
        let mut both = (onlooker, outer);
        let exit = runner.run(OrderQueue::from(asked), &mut both).await?;
        drop(both);
        let told = playing.await.ok();
        let played = match &told {
            Some(told) if told.whole => Exit::Done,
            Some(_) => Exit::AnswerIsNo,
            None => Exit::Trouble(Cause::script()),
        };
        // An alarm is part of the story; trouble of the program itself is not.
        let own = exit.cause().is_some_and(Cause::is_program_failure);
        Ok((told, if own { exit } else { played }))
    })
}
