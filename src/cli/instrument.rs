//! `relayrig instrument`: finds SCPI instruments, sends one command, watches a link, tries a profile.

mod check;
mod monitor;
mod scan;
mod send;

use anyhow::Context;
use app::exit::Exit;
use app::instrument::message;
use bus::Pace;
use bus::instrument::{Link, Opener};
use config::{ConfigError, Folder, folder_of_profiles, load_instrument};
use scpi::{
    Failure, Flow, Framing, LinkAddress, LinkSettings, Profile, Reply, Terminator, Transport,
};
use std::time::{SystemTime, UNIX_EPOCH};
use texts::Lang;
use units::Span;

/// Tools for SCPI instruments.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig instrument scan --host 192.168.1.20
  relayrig instrument send --link tcp:192.168.1.20:5025 '*IDN?'
  relayrig instrument check --link gpib-tcp:192.168.1.30:1234:9 --profile ac-source-61500
  relayrig instrument monitor --link serial:/dev/ttyUSB0:9600 --query 'READ?'

A link is tcp:HOST:PORT, serial:PATH:BAUD, or one of them behind a Prologix-type GPIB adapter: gpib-tcp:HOST:PORT:ADDR, \
gpib-serial:PATH:BAUD:ADDR.")]
pub struct InstrumentArgs {
    #[command(subcommand)]
    command: InstrumentCommand,
}

#[derive(Debug, clap::Subcommand)]
enum InstrumentCommand {
    /// Find instruments: identity, latency, matching profiles
    Scan(scan::ScanArgs),
    /// Send one command, show the reply and the error queue
    Send(send::SendArgs),
    /// Repeat a query, or listen to a serial port
    Monitor(monitor::MonitorArgs),
    /// Try a profile: identity, set-up, error queue, latency
    Check(check::CheckArgs),
}

/// The link to an instrument.
#[derive(Debug, Clone, clap::Args)]
struct LinkArgs {
    /// tcp:HOST:PORT, serial:PATH:BAUD, gpib-tcp:HOST:PORT:ADDR or gpib-serial:PATH:BAUD:ADDR
    #[arg(long, value_name = "LINK")]
    link: LinkAddress,
    /// Longest wait for a reply, milliseconds; without it that of the profile, or 1000
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u64).range(1..=60_000))]
    timeout: Option<u64>,
}

impl LinkArgs {
    /// Returns the time that this number of characters takes on a serial port, milliseconds; 0 on a network.
    fn wire_ms(&self, characters: usize) -> f64 {
        match self.link.transport {
            Transport::Tcp { .. } => 0.0,
            Transport::Serial { baud, .. } => 1e4 * characters as f64 / f64::from(baud),
        }
    }

    /// Returns a link with the settings of `profile`; without one, with default settings that suit most instruments.
    fn link(&self, profile: Option<&Profile>) -> Link {
        let gpib = self.link.gpib;
        let mut settings = profile.map_or_else(
            || LinkSettings {
                framing: gpib.map_or(Framing::Direct(Terminator::Lf), Framing::Adapter),
                reopen: matches!(self.link.transport, Transport::Tcp { .. }),
                ..LinkSettings::default()
            },
            |it| it.link_settings(&self.link),
        );
        if let Some(timeout) = self.timeout {
            settings.limit = Span::ms(timeout);
        }
        let flow = profile.map_or(Flow::None, |it| it.flow);
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH);
        let seed = since_1970.map_or(0, |it| it.as_nanos() as u64);
        Link::new(
            Opener::At(self.link.clone(), flow),
            settings,
            Pace::real(),
            seed,
        )
    }
}

/// Runs the command with the profiles in `folder`.
pub fn run(folder: &Folder, args: &InstrumentArgs) -> anyhow::Result<Exit> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let runtime = runtime.context("starting the runtime")?;
    let folder = profiles(folder)?;
    let done = runtime.block_on(async {
        match &args.command {
            InstrumentCommand::Scan(args) => scan::run(&folder, args).await,
            InstrumentCommand::Send(args) => send::run(&folder, args).await,
            InstrumentCommand::Monitor(args) => monitor::run(&folder, args).await,
            InstrumentCommand::Check(args) => check::run(&folder, args).await,
        }
    });
    super::unless_pipe_closed(done, Exit::Done)
}

/// Returns the folder with the profiles: `folder` if it has any, otherwise the profiles inside the program.
fn profiles(folder: &Folder) -> Result<Folder, ConfigError> {
    folder.check_exists()?;
    Ok(folder_of_profiles(folder))
}

fn profile(folder: &Folder, name: Option<&String>) -> Result<Option<Profile>, ConfigError> {
    name.map(|name| load_instrument(folder, name)).transpose()
}

/// Returns the English text of a failure.
fn sentence(failure: &Failure) -> String {
    message(failure).say(Lang::En)
}

/// Returns a value for a person to read.
fn text(reply: &Reply) -> String {
    match reply {
        Reply::Line(line) | Reply::Text(line) => line.clone(),
        Reply::Number(number) => decimal(*number),
        Reply::Numbers(numbers) => format!("{} numbers", numbers.len()),
        Reply::Block(bytes) => format!("a block of {} bytes", bytes.len()),
    }
}

/// Returns a number for a person to read: a small or large one with its power of ten.
fn decimal(value: f64) -> String {
    match value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        true => value.to_string(),
        false => format!("{value:e}"),
    }
}
