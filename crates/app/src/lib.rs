//! The application layer: a lot, a day of service, a story, a calibration and a follower of the traffic as types.
//!
//! The command line turns arguments into these types and results into text; no module here reads a command-line
//! argument. Only [`progress`] writes to the terminal; log messages go through `tracing`.
//!
//! | module | holds |
//! |---|---|
//! | [`order`], [`source`] | the ordered lot, and its rig |
//! | [`admission`] | checks before a lot may run |
//! | [`lot`] | a run: one stream of events and its subscribers |
//! | [`real_time`] | the thread of the lines and the cycle |
//! | [`host_check`] | whether this computer keeps the rig's time |
//! | [`planning`] | what blocks the elements of a scene, and in which order they come off and go on |
//! | [`exit`] | reasons why a run ends |
//! | [`service`] | one lot after another, ordered at a page |
//! | [`calibration`], [`gauge_study`] | runs that measure the rig itself |
//! | `story` | scripted faults and operator orders on the simulated rig |
//!
//! ```no_run
//! use app::lot::Purpose;
//! use app::order::{Files, LotOrder};
//! use app::source::RigSource;
//! use config::Folder;
//!
//! let files = Files { config: Folder::built_in(), db: "relayrig.db".into() };
//! let order = LotOrder {
//!     lot: "A".to_owned(),
//!     recipe: "jzc-22f-012".to_owned(),
//!     count: Some(20),
//!     retest: None,
//! };
//! // The rig at the serial ports of rig.toml.
//! let rig = RigSource::Serial(Vec::new());
//! let exit = app::run_lot(&files, &rig, &order, Purpose::Lot, &mut ())?;
//! println!("{exit:?}");
//! # Ok::<(), anyhow::Error>(())
//! ```

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
pub mod experiment;
#[cfg(feature = "fleet")]
pub mod fleet_page;
pub mod follower;
pub mod gauge_study;
pub mod generate;
pub mod host_check;
pub mod import;
pub mod instrument;
mod instrument_log;
mod instrument_tasks;
pub mod links;
pub mod lot;
pub mod lot_decision;
pub mod order;
pub mod order_queue;
pub mod planning;
pub mod progress;
pub mod real_time;
pub mod restore;
#[cfg_attr(not(feature = "fleet"), path = "sending_absent.rs")]
mod sending;
pub mod service;
mod signals;
#[cfg(feature = "sim")]
pub mod simulated;
pub mod source;
pub mod stop_signals;
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
use std::pin::pin;
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

/// Runs one unattended lot, which Ctrl-C stops. `answers` go to the prompts of the lot; `outer` receives every event.
///
/// # Errors
/// Fails on bad input: a configuration, lot, rig or answer that the program refuses before anything moves.
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
        && let Some(why) = admission::calibration_refusal((&files.db, &plant), &recipe, source)?
    {
        let cause = admission::refuse(&files.db, &recipe, order, &why)?;
        tracing::error!(code = cause.code, "{}", cause.text);
        return Ok(Exit::Trouble(cause));
    }
    let controls = Controls::new(false);
    let _sending = sending::start(files, &controls)?;
    let runner = LotRunner {
        db: &files.db,
        context: LotContext::new(&plant, (order, &recipe), source, purpose),
        controls: &controls,
    };
    let _signals = controls.stop_on_signals()?;
    block_on(source, async {
        let (orders, taken) = mpsc::channel(1);
        let mut outer = Answering {
            answers,
            orders,
            outer,
        };
        runner.run(OrderQueue::from(taken), &mut outer).await
    })
}

/// Runs `work` on a runtime of one thread; in virtual time the clock of the thread is the clock of the rig.
///
/// # Errors
/// Fails as `work` does, or when the runtime cannot start.
pub fn block_on<T>(
    source: &RigSource,
    work: impl Future<Output = anyhow::Result<T>>,
) -> anyhow::Result<T> {
    let runtime = runtime(source)?;
    let mut done = None;
    {
        let work = pin!(async { done = Some(work.await) });
        bus::block_on(&runtime, work);
    }
    runtime.shutdown_timeout(Duration::from_secs(1));
    done.context("the run has no result")?
}

/// Creates a runtime of one thread for runs on `source`. In virtual time it has neither I/O nor timers of the wall clock:
/// a rig in this process has no file or socket, and I/O would call the kernel at each jump of the clock. One blocking
/// thread does all work on the history: each thread that SQLite works on keeps memory of its own.
///
/// # Errors
/// Fails when the operating system refuses the runtime.
pub fn runtime(source: &RigSource) -> anyhow::Result<tokio::runtime::Runtime> {
    let mut builder = match source.is_virtual() {
        true => virtual_time::builder(),
        false => {
            let mut real = tokio::runtime::Builder::new_current_thread();
            real.enable_all();
            real
        }
    };
    let built = builder.max_blocking_threads(1).build();
    built.context("starting the runtime")
}
