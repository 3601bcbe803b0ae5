//! The commands, a file each, turn arguments into types of [`app`] and answers into text.

pub mod alarm;
pub mod bus;
pub mod calibrate;
pub mod card;
pub mod check;
pub mod config;
#[cfg(feature = "sim")]
pub mod demo;
pub mod doctor;
pub mod experiment;
#[cfg(feature = "fleet")]
pub mod fleet;
pub mod history;
pub mod host;
pub mod init;
mod installed;
pub mod instrument;
pub mod lot;
mod output;
pub mod plan;
pub mod rig;
pub mod run;
pub mod serve;
#[cfg(feature = "sim")]
pub mod sim;
#[cfg(feature = "sim")]
pub mod story;
#[cfg_attr(not(feature = "study"), path = "cli/study_absent.rs")]
pub mod study;
mod table;
mod terminal;
pub mod user;
pub mod wear;

use ::config::Folder;
use anyhow::Context;
use app::exit::Exit;
use clap::{Parser, Subcommand};
use machine::view::By;
use std::io::{BufRead, IsTerminal};
use std::path::PathBuf;

/// Controller of a JZC-22F relay performance tester with automatic feed and discharge.
#[derive(Debug, Parser)]
#[command(
    name = "relayrig",
    version,
    after_help = "Examples:
  relayrig demo
  relayrig serve --line measure=/dev/ttyUSB0 --line motion=/dev/ttyUSB1
  relayrig run --sim --pace virtual --lot A --recipe jzc-22f-012 --count 20
  relayrig history list
  relayrig init rig1
  relayrig config check

Exit status: 0 done, 1 done and the answer is no, 2 bad input, 3 the rig has trouble, 4 stopped by the operator."
)]
pub struct Cli {
    /// Directory of the configuration, as `init` writes it [default: config; demo: the one inside this program;
    /// /etc/relayrig of an installed rig where the working folder has neither config nor relayrig.db]
    #[arg(long, global = true, value_name = "DIR")]
    pub config: Option<PathBuf>,
    /// History file of one rig, real or simulated [default: relayrig.db; relayrig-demo.db for demo, relayrig-story.db
    /// for story; /var/lib/relayrig/relayrig.db with --config /etc/relayrig by default]
    #[arg(long, global = true, value_name = "FILE")]
    pub db: Option<PathBuf>,
    /// Log on stderr: off, error, warn, info, debug, trace, or a filter per module (warn,app=debug); the word json,
    /// alone or beside a filter, turns the log into JSON lines [default: RUST_LOG, else info]
    #[arg(long, global = true, value_name = "FILTER")]
    pub log: Option<String>,
    /// What to do
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulated rig, a running lot and the page on 127.0.0.1:8080, without preparation
    #[cfg(feature = "sim")]
    Demo(demo::DemoArgs),
    /// Serve the page and the API of a rig; lots start there
    Serve(serve::ServeArgs),
    /// Run a lot, on a rig or on the simulated one
    Run(Box<run::RunArgs>),
    /// Calibrate a rig by its standards and reference parts, or verify its calibration
    Calibrate(calibrate::CalibrateArgs),
    /// Measure how a chamber answers its heater, or find settings of its controller
    Chamber(experiment::ChamberArgs),
    /// Only the simulated rig, on pseudo-terminals in real time
    #[cfg(feature = "sim")]
    Sim(sim::SimArgs),
    /// Play a script of troubles and orders on the simulated rig and print the events
    #[cfg(feature = "sim")]
    Story(story::StoryArgs),
    /// Reproducible figures, each with the limit (bar) that it must meet
    Study(study::StudyArgs),
    /// Write a configuration of your own, with comments, in a new directory
    Init(init::InitArgs),
    /// Check the configuration, or print the schema of a file
    #[command(subcommand)]
    Config(config::Args),
    /// Test how late this computer wakes the rig
    #[command(subcommand)]
    Host(host::Args),
    /// Find what is wrong with this installation, and what to do
    Doctor(doctor::DoctorArgs),
    /// Find modules, send one command, watch a line
    Bus(bus::BusArgs),
    /// SCPI instruments: find them, send one command, watch a link, try a profile
    Instrument(instrument::InstrumentArgs),
    /// Tell whether moves in a scene collide; needs no rig
    Check(check::CheckArgs),
    /// What blocks the elements of a scene, and in which order they come off and go on; needs no rig
    Plan(plan::PlanArgs),
    /// Lots, parts, filters, statistics
    History(history::HistoryArgs),
    /// PostgreSQL behind the histories of many rigs
    #[cfg(feature = "fleet")]
    Fleet(fleet::FleetArgs),
    /// List, acknowledge or shelve the unacknowledged alarms
    Alarm(alarm::AlarmArgs),
    /// State of a lot; hold, release, close or reopen it
    Lot(lot::LotArgs),
    /// Use counts of probes and jaws since their last replacement
    Wear(wear::WearArgs),
    /// People who may log in at the screen
    User(user::UserArgs),
    /// The operation process card of a recipe
    Card(card::CardArgs),
    /// Gauge repeatability and reproducibility
    Quality(history::QualityArgs),
}

impl Command {
    /// Returns the default history file of a command that has a history of its own; `None` for every other command.
    const fn own_history(&self) -> Option<&'static str> {
        match self {
            #[cfg(feature = "sim")]
            Self::Demo(_) => Some("relayrig-demo.db"),
            #[cfg(feature = "sim")]
            Self::Story(_) => Some("relayrig-story.db"),
            _ => None,
        }
    }

    /// Returns the built-in configuration for a command that uses it by default; `None` for every other command. A demo
    /// does not read the directory `config`, so that the demo is the same everywhere.
    fn own_config(&self) -> Option<Folder> {
        match self {
            #[cfg(feature = "sim")]
            Self::Demo(args) => Folder::built_in_rig(&args.rig),
            #[cfg(feature = "sim")]
            Self::Sim(args) if args.faults && !installed::has("sim.toml") => {
                Some(Folder::built_in())
            }
            Self::Instrument(_)
                if !installed::has("instruments") && !installed::has("rig.toml") =>
            {
                Some(Folder::built_in())
            }
            _ => None,
        }
    }
}

impl Cli {
    /// Runs the command. Every error is bad input; the caller prints it once.
    pub fn execute(self) -> anyhow::Result<Exit> {
        let config = self.config.map(Folder::Directory);
        let config = config.or_else(|| self.command.own_config());
        let own_history = self.command.own_history().map(PathBuf::from);
        let files = installed::files(config, self.db.or(own_history));
        let (config, db) = (&files.config, &files.db);
        match self.command {
            #[cfg(feature = "sim")]
            Command::Demo(args) => demo::run(&files, &args),
            Command::Serve(args) => serve::run(&files, &args, None),
            Command::Run(args) => run::run(&files, &args),
            Command::Calibrate(args) => calibrate::run(&files, &args),
            Command::Chamber(args) => experiment::run(&files, &args),
            #[cfg(feature = "sim")]
            Command::Sim(args) => sim::run(config, &args),
            #[cfg(feature = "sim")]
            Command::Story(args) => story::run(&files, &args),
            Command::Study(args) => study::run(config.root(), &args),
            Command::Init(args) => init::run(&args),
            Command::Config(args) => config::run(config, db, &args),
            Command::Host(args) => host::run(&files, &args),
            Command::Doctor(args) => doctor::run(&files, &args),
            Command::Bus(args) => bus::run(&args),
            Command::Instrument(args) => instrument::run(config, &args),
            Command::Check(args) => check::run(args),
            Command::Plan(args) => plan::run(config, &args),
            Command::History(args) => history::run(&files, args),
            #[cfg(feature = "fleet")]
            Command::Fleet(args) => fleet::run(&files, &args),
            Command::Alarm(args) => alarm::run(db, &args),
            Command::Lot(args) => lot::run(db, &args),
            Command::Wear(args) => wear::run(db, &args),
            Command::User(args) => user::run(db, args),
            Command::Card(args) => card::run(config, &args),
            Command::Quality(args) => history::run_quality(args),
        }
    }
}

/// Returns the person of `--by`, without a role. Fails for a blank name.
fn person(name: &str) -> anyhow::Result<By> {
    anyhow::ensure!(
        !name.trim().is_empty(),
        "--by: found nothing, expected a name"
    );
    Ok(By {
        who: name.to_owned(),
        role: String::new(),
        origin: "command line".into(),
    })
}

/// Reads the password of `who`: at a terminal without showing it, else from the first line of stdin.
fn password_of(who: &str) -> anyhow::Result<String> {
    if std::io::stdin().is_terminal() {
        return rpassword::prompt_password(format!("Password of {who}: "))
            .context("reading the password from the terminal");
    }
    let mut line = String::new();
    std::io::stdin()
        .lock()
        .read_line(&mut line)
        .context("reading the password from stdin")?;
    Ok(line.trim_end_matches(['\r', '\n']).to_owned())
}

/// Returns `closed` when `done` is the error of a closed pipe, which is a normal end; returns any other `done`
/// unchanged.
fn unless_pipe_closed<T>(done: anyhow::Result<T>, closed: T) -> anyhow::Result<T> {
    let left = |cause: &(dyn std::error::Error + 'static)| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|it| it.kind() == std::io::ErrorKind::BrokenPipe)
    };
    match done {
        Err(error) if error.chain().any(left) => Ok(closed),
        done => done,
    }
}
