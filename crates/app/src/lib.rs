//! The application layer: a lot, a day of service, a story, a calibration and a follower of the traffic as types.
//!
//! The command line turns arguments into these types and results into text; nothing here reads an argument. Only
//! [`progress`] writes to the terminal; log messages go through `tracing`.
//!
//! | module | holds |
//! |---|---|
//! | [`order`], [`source`] | the lot ordered, and its rig |
//! | [`admission`] | checks before a lot may run |
//! | [`lot`] | a run: one stream of events and its subscribers |
//! | [`real_time`] | the thread of the lines and the cycle |
//! | [`host_check`] | whether this computer keeps the rig's time |
//! | [`exit`] | reasons why a run ends |
//! | [`service`] | one lot after another, ordered at a page |
//! | [`calibration`], [`gauge_study`] | runs that measure the rig itself |
//! | `story` | scripted faults and operator orders on the simulated rig |

pub mod admission;
pub mod alarm_order;
pub mod answers;
pub mod backup_folder;
pub mod calibration;
pub mod collision;
pub mod controls;
pub mod copies;
pub mod doctor;
pub mod exit;
pub mod follower;
pub mod gauge_study;
pub mod generate;
pub mod host_check;
pub mod import;
pub mod instrument;
mod instrument_tasks;
pub mod links;
pub mod lot;
pub mod lot_decision;
pub mod order;
pub mod order_queue;
pub mod progress;
pub mod real_time;
pub mod restore;
pub mod service;
mod signals;
#[cfg(feature = "sim")]
pub mod simulated;
pub mod source;
#[cfg(feature = "sim")]
pub mod story;
mod trace_files;
pub mod traces;
#[cfg(feature = "sim")]
pub mod truth_file;

use admission::admit;
use answers::{Answering, Answers};
use anyhow::Context;
use config::Plant;
use controls::Controls;
use exit::Exit;
use lot::{LotContext, LotRunner, Purpose, Subscriber};
use order::{Files, LotOrder};
use order_queue::OrderQueue;
use source::RigSource;
use std::time::Duration;
use tokio::sync::mpsc;

/// Runs one unattended lot without prompts, as [`run_answered`] does.
///
/// # Errors
/// Fails as [`run_answered`] does.
pub fn run_lot(
    files: &Files,
    source: &RigSource,
    order: &LotOrder,
    purpose: Purpose,
    outer: &mut dyn Subscriber,
) -> anyhow::Result<Exit> {
    let none = Answers::default();
    run_answered(files, source, order, purpose, (&none, outer))
}

/// Runs one unattended lot; Ctrl-C stops it. `answers` go to the prompts of the lot; `outer` receives every event.
///
/// # Errors
/// Fails on bad input: a configuration, lot, rig or answer that is refused before anything moves.
pub fn run_answered(
    files: &Files,
    source: &RigSource,
    order: &LotOrder,
    purpose: Purpose,
    (answers, outer): (&Answers, &mut dyn Subscriber),
) -> anyhow::Result<Exit> {
    let plant = Plant::load(&files.config)?;
    history::check_rig(&files.db, source.is_simulated())?;
    let recipe = admit(&files.db, &plant, order, purpose)?;
    if purpose == Purpose::Lot {
        admission::check_unattended(&plant, &recipe, answers)?;
    }
    if purpose == Purpose::Lot
        && let Some(why) = admission::calibration_refusal(&files.db, &recipe, source)?
    {
        let cause = admission::refuse(&files.db, &recipe, order, &why)?;
        tracing::error!(code = cause.code, "{}", cause.text);
        return Ok(Exit::Trouble(cause));
    }
    let controls = Controls::new(false);
    let runner = LotRunner {
        db: &files.db,
        context: LotContext::new(&plant, (order, &recipe), source, purpose),
        controls: &controls,
    };
    block_on(source, async {
        controls.stop_on_signals();
        let (orders, taken) = mpsc::channel(1);
        let mut outer = Answering {
            answers,
            orders,
            outer,
        };
        runner.run(OrderQueue::from(taken), &mut outer).await
    })
}

/// Runs `work` on a runtime of one thread; in virtual time the runtime's clock is that of the rig.
///
/// # Errors
/// Fails as `work` does, or when the runtime cannot start.
pub fn block_on<T>(
    source: &RigSource,
    work: impl Future<Output = anyhow::Result<T>>,
) -> anyhow::Result<T> {
    let runtime = runtime(source)?;
    let done = runtime.block_on(work);
    runtime.shutdown_timeout(Duration::from_secs(1));
    done
}

/// Creates a runtime of one thread for runs on `source`; its clock is paused when rig time is virtual.
///
/// # Errors
/// Fails when the operating system refuses it.
pub fn runtime(source: &RigSource) -> anyhow::Result<tokio::runtime::Runtime> {
    let mut builder = tokio::runtime::Builder::new_current_thread();
    builder.enable_all();
    #[cfg(feature = "sim")]
    builder.start_paused(source.is_virtual());
    let _ = source;
    builder.build().context("starting the runtime")
}
