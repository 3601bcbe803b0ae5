//! `relayrig run`: a lot on a rig, or on the simulated rig in real or virtual time.

pub(super) mod assemble;
mod counts;
mod diary;
pub(super) mod gate;
mod grr;
mod known;
pub(super) mod lines;
mod orders;
pub(super) mod recorder;
mod rows;
mod screen;
mod stage;
mod summary;
mod table;
mod traces;

use super::rig::RigArgs;
use anyhow::Context;
use app::cycle::{Event, Outside};
use bus::Pace;
use config::Plant;
use machine::dut::Calibration;
use machine::dut::Recipe;
use machine::station::catalogue::AlarmCode;
use machine::station::packml::State;
use machine::station::wants::Ending;
use machine::view::{LineTraffic, View};
use orders::Desk;
pub use orders::Orders;
use recorder::{Recorder, Setup};
pub use stage::Stage;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use tokio::sync::{mpsc, watch};
use traces::Traces;

/// A lot to run.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  relayrig run --sim --lot A --recipe jzc-22f-012 --count 20
  relayrig run --sim --pace real --lot A --recipe jzc-22f-012 --count 5 --json
  relayrig run --lot A --recipe jzc-22f-012 --count 12 --retest 'Li Na'
  relayrig run --sim --study grr --lot G --recipe jzc-22f-012
  relayrig run --lot A --recipe jzc-22f-012 --line measure=/dev/ttyUSB0 --line motion=/dev/ttyUSB1")]
pub struct RunArgs {
    /// The rig it runs on.
    #[command(flatten)]
    pub rig: RigArgs,
    /// Lot the parts belong to
    #[arg(long, value_name = "ID")]
    pub lot: String,
    /// Recipe in config/recipes
    #[arg(long, value_name = "NAME")]
    pub recipe: String,
    /// Parts of the lot; without it the lot goes on until it is stopped
    #[arg(long, value_name = "N")]
    pub count: Option<u64>,
    /// True values of every specimen go to this file
    #[arg(long, value_name = "FILE", requires = "sim")]
    pub truth: Option<PathBuf>,
    /// One JSON object per part, then a summary
    #[arg(long)]
    pub json: bool,
    /// Test parts of the lot again, to which NAME has agreed; the first results stay
    #[arg(long, value_name = "NAME")]
    pub retest: Option<String>,
    /// Instead of one lot: ten parts (or --count) three times over three rigs, and what the gauge adds
    #[arg(long, value_enum, value_name = "NAME", requires = "sim")]
    pub study: Option<StudyArg>,
}

/// A study that feeds parts again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum StudyArg {
    /// Gauge repeatability and reproducibility
    Grr,
}

/// What outlives a run and is shared with a page.
#[derive(Debug, Clone)]
pub struct Controls {
    /// Ends the lot after the parts inside.
    pub stop: Arc<AtomicBool>,
    /// Ends it at once.
    pub abort: Arc<AtomicBool>,
    /// A person is at a screen: alarms and stops do not end the run.
    pub stays: bool,
    /// What screens see.
    pub view: watch::Sender<View>,
    /// Traffic of the run under way; none before its lines are open.
    pub traces: Arc<Mutex<Option<Traces>>>,
    /// No rows to stdout.
    pub quiet: bool,
    /// Between lots: the rig is connected and rests in this state; the run's lot is that of parts found inside.
    pub between_lots: Option<State>,
    /// The run only calibrates, whatever is stored, and leaves what it found here instead of in the history.
    pub calibrates: Option<Arc<OnceLock<Calibration>>>,
    /// A study stands in for the world outside.
    pub stage: Option<Stage>,
}

impl Controls {
    /// Nothing ordered, nothing seen.
    pub fn new(quiet: bool) -> Self {
        Self {
            stop: Arc::new(AtomicBool::new(false)),
            abort: Arc::new(AtomicBool::new(false)),
            stays: false,
            view: watch::channel(View::default()).0,
            traces: Arc::default(),
            quiet,
            between_lots: None,
            calibrates: None,
            stage: None,
        }
    }

    /// From now on Ctrl-C stops, and once more aborts. Inside of a runtime.
    pub fn heed_signals(&self) {
        let flags = [Arc::clone(&self.stop), Arc::clone(&self.abort)];
        tokio::spawn(interruptions(flags));
    }

    fn show_traffic(&self, traces: &Traces) {
        let mut held = self.traces.lock().unwrap_or_else(PoisonError::into_inner);
        *held = Some(traces.clone());
    }

    /// Gives the last so many messages of every line.
    pub fn traffic(&self) -> impl Fn(usize) -> Vec<LineTraffic> + use<> {
        let traces = Arc::clone(&self.traces);
        move |last| {
            let held = traces.lock().unwrap_or_else(PoisonError::into_inner);
            let traces = held.as_ref();
            traces.map_or_else(Vec::new, |traces| traces.messages(last))
        }
    }
}

/// Runs the command; the result is the exit status.
pub fn run(config: &Path, db: &Path, args: &RunArgs) -> anyhow::Result<i32> {
    if let Some(StudyArg::Grr) = args.study {
        return grr::run(config, db, args);
    }
    run_with(config, db, args, &Controls::new(false), Orders::Nobody)
}

/// As [`run`], with controls that somebody else holds too.
pub fn run_with(
    config: &Path,
    db: &Path,
    args: &RunArgs,
    controls: &Controls,
    orders: Orders,
) -> anyhow::Result<i32> {
    args.rig.check()?;
    if let Some(path) = &args.truth {
        std::fs::File::create(path).with_context(|| format!("--truth {}", path.display()))?;
    }
    let plant = Plant::load(config)?;
    let calibrates = controls.calibrates.is_some();
    let recipe = gate::admit(db, &plant, args, calibrates)?;
    if !calibrates && let Some(why) = gate::uncalibrated(db, &recipe, args)? {
        tracing::error!(code = AlarmCode::CalibrationInvalid.name(), "{why}");
        gate::refuse(db, &recipe, args, &why)?;
        return Ok(super::RIG_TROUBLE);
    }
    let runtime = runtime(&args.rig)?;
    let bench = (&plant, &recipe);
    let status = runtime.block_on(async {
        controls.heed_signals();
        run_lot(bench, config, db, args, controls, orders).await
    });
    runtime.shutdown_timeout(std::time::Duration::from_secs(1));
    status
}

/// One thread, whose clock is the rig's in virtual time.
pub(super) fn runtime(rig: &RigArgs) -> anyhow::Result<tokio::runtime::Runtime> {
    let mut builder = tokio::runtime::Builder::new_current_thread();
    builder.enable_all();
    #[cfg(feature = "sim")]
    builder.start_paused(rig.is_virtual());
    let _ = rig;
    builder.build().context("starting the runtime")
}

/// The lot itself; what was checked in [`run_with`] is taken for granted.
pub(super) async fn run_lot(
    (plant, recipe): (&Plant, &Arc<Recipe>),
    config: &Path,
    db: &Path,
    args: &RunArgs,
    controls: &Controls,
    orders: Orders,
) -> anyhow::Result<i32> {
    let pace = if args.rig.is_virtual() {
        Pace::virtual_time()
    } else {
        Pace::real()
    };
    let epoch_us = controls.epoch_us();
    let held_back = args
        .rig
        .speed
        .map(|speed| tokio::spawn(pace.hold_back(speed)));
    let (mut lines, rig) = lines::open(plant, config, args, controls, &pace)?;
    let setup = Setup {
        plant,
        recipe,
        args,
        epoch_us,
    };
    let desk = Desk::open(orders, &rig, pace, &controls.stop)?;
    let traces = Traces::new(db, plant, &lines.logs);
    controls.show_traffic(&traces);
    let (mut recorder, known) = Recorder::open(db, &setup, controls, rig.eeprom_count(), traces)?;
    let (events, received) = mpsc::unbounded_channel::<Event>();
    let recorded = Arc::new(AtomicU64::new(0));
    let history_lost = Arc::new(AtomicBool::new(false));
    let outside = Outside {
        events,
        recorded: Arc::clone(&recorded),
        stop: Arc::clone(&controls.stop),
        abort: Arc::clone(&controls.abort),
        orders: desk.orders,
        epoch_us,
        history_lost: Arc::clone(&history_lost),
        view: controls.view.clone(),
    };
    let cycle = assemble::cycle(
        &setup,
        known,
        pace,
        std::mem::take(&mut lines.ends),
        outside,
        controls,
    )?;
    let running = tokio::spawn(cycle.run());
    let kept = recorder.keep(received, &recorded, desk.onlooker).await;
    if let Err(error) = &kept {
        tracing::error!("history: {error:#}");
        history_lost.store(true, Ordering::Release);
    }
    let ended = running.await;
    if let Some(held_back) = held_back {
        held_back.abort();
    }
    let Ok((ending, profile)) = ended else {
        tracing::error!(
            "the control cycle ended by an assertion; the modules' watchdogs make the outputs safe"
        );
        return Ok(super::RIG_TROUBLE);
    };
    let closed = recorder.close(&ending, &profile, &lines.logs);
    rig.finish(args)?;
    if kept.is_err() {
        return Ok(super::RIG_TROUBLE);
    }
    closed?;
    if let Some(playing) = desk.playing {
        return Ok(playing.await.unwrap_or(super::RIG_TROUBLE));
    }
    Ok(match ending {
        Ending::Complete => super::DONE,
        Ending::Stopped => super::STOPPED,
        Ending::Alarm => super::RIG_TROUBLE,
    })
}

/// Ctrl-C, or the signal that a service manager ends a program with: the first one finishes the parts inside, the
/// second does not wait for them. One that comes while the one before is being told is not lost.
async fn interruptions(flags: [Arc<AtomicBool>; 2]) -> std::io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut pressed = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let said = [
        "stopping when the parts inside are finished; once more stops at once",
        "stopping at once, outputs safe",
    ];
    for (flag, said) in flags.into_iter().zip(said) {
        tokio::select! {
            _ = pressed.recv() => {}
            _ = terminate.recv() => {}
        }
        flag.store(true, Ordering::Release);
        tracing::warn!("{said}");
    }
    Ok(())
}
