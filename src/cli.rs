//! The commands, a file each, turn arguments into types of [`app`] and answers into text.

pub mod alarm;
pub mod bus;
pub mod calibrate;
pub mod card;
pub mod check;
pub mod config;
#[cfg(feature = "sim")]
pub mod demo;
pub mod history;
pub mod host;
pub mod init;
pub mod lot;
mod output;
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
use app::exit::Exit;
use app::order::Files;
use clap::{Parser, Subcommand};
use machine::view::By;
#[cfg(feature = "sim")]
use std::path::Path;
use std::path::PathBuf;

/// Directory of the configuration without `--config`.
const CONFIG: &str = "config";

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
    /// Directory of the configuration, as `init` writes it [default: config; demo: the one inside this program]
    #[arg(long, global = true, value_name = "DIR")]
    pub config: Option<PathBuf>,
    /// History file of one rig, real or simulated [default: relayrig.db, or relayrig-demo.db for demo]
    #[arg(long, global = true, value_name = "FILE")]
    pub db: Option<PathBuf>,
    /// Level of the log on stderr: error, warn, info, debug, or a filter per module
    #[arg(long, global = true, default_value = "info", value_name = "FILTER")]
    pub log: String,
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
    /// Factors of the rig from its standards and reference parts, or their verification
    Calibrate(calibrate::CalibrateArgs),
    /// Only the simulated rig, on pseudo-terminals in real time
    #[cfg(feature = "sim")]
    Sim(sim::SimArgs),
    /// Play a script of troubles and orders on the simulated rig and print the events
    #[cfg(feature = "sim")]
    Story(story::StoryArgs),
    /// Reproducible figures, each beside its bar
    Study(study::StudyArgs),
    /// Write a configuration of your own, with comments, in a new directory
    Init(init::InitArgs),
    /// Check the configuration, or print the schema of a file
    #[command(subcommand)]
    Config(config::Args),
    /// Whether this computer keeps the rig's time
    #[command(subcommand)]
    Host(host::Args),
    /// Find modules, send one command, watch a line
    Bus(bus::BusArgs),
    /// Collision answers for a scene, no rig
    Check(check::CheckArgs),
    /// Lots, parts, filters, statistics
    History(history::HistoryArgs),
    /// Unacknowledged alarms; acknowledge or shelve them
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
    /// Returns the name of the history file without `--db`.
    const fn own_history(&self) -> &'static str {
        match self {
            #[cfg(feature = "sim")]
            Self::Demo(_) => "relayrig-demo.db",
            _ => "relayrig.db",
        }
    }

    /// Returns the configuration without `--config`. A demo does not read the directory `config`, so that it is the same
    /// everywhere.
    fn own_config(&self) -> Folder {
        match self {
            #[cfg(feature = "sim")]
            Self::Demo(_) => Folder::built_in(),
            #[cfg(feature = "sim")]
            Self::Sim(args) if args.faults && !Path::new(CONFIG).exists() => Folder::built_in(),
            _ => Folder::Directory(CONFIG.into()),
        }
    }
}

impl Cli {
    /// Runs the command. An error is bad input; the caller prints it once.
    pub fn execute(self) -> anyhow::Result<Exit> {
        let (own_config, own_history) = (self.command.own_config(), self.command.own_history());
        let files = Files {
            config: self.config.clone().map_or(own_config, Folder::Directory),
            db: self.db.unwrap_or_else(|| own_history.into()),
        };
        let (config, db) = (&files.config, &files.db);
        match self.command {
            #[cfg(feature = "sim")]
            Command::Demo(args) => demo::run(&files, &args),
            Command::Serve(args) => serve::run(&files, &args, None),
            Command::Run(args) => run::run(&files, &args),
            Command::Calibrate(args) => calibrate::run(&files, &args),
            #[cfg(feature = "sim")]
            Command::Sim(args) => sim::run(config, &args),
            #[cfg(feature = "sim")]
            Command::Story(args) => story::run(&files, &args),
            Command::Study(args) => {
                study::run(&self.config.unwrap_or_else(|| CONFIG.into()), &args)
            }
            Command::Init(args) => init::run(&args),
            Command::Config(args) => config::run(config, &args),
            Command::Host(args) => unless_pipe_closed(host::run(&files, &args)),
            Command::Bus(args) => bus::run(&args),
            Command::Check(args) => check::run(args),
            Command::History(args) => history::run(config, db, args),
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

/// Treats a closed pipe as a normal end.
fn unless_pipe_closed(done: anyhow::Result<Exit>) -> anyhow::Result<Exit> {
    let left = |cause: &(dyn std::error::Error + 'static)| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|it| it.kind() == std::io::ErrorKind::BrokenPipe)
    };
    match done {
        Err(error) if error.chain().any(left) => Ok(Exit::Done),
        done => done,
    }
}
