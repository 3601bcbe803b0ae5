//! `relayrig instrument`: finds SCPI instruments, sends one command, watches a link, tries a profile.

mod check;
mod monitor;
mod scan;
mod send;

use anyhow::{Context, bail};
use app::exit::Exit;
use app::instrument::message;
use bus::Pace;
use bus::instrument::{Link, Opener};
use config::{Folder, Plant, folder_of_profiles, load_instrument};
use machine::rig::instruments::InstrumentWiring;
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
  relayrig instrument check --instrument dmm

--instrument names an instrument of rig.toml. A link is tcp:HOST:PORT, serial:PATH:BAUD, or one of them behind a Prologix-type GPIB adapter: gpib-tcp:HOST:PORT:ADDR, \
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
    #[arg(long, value_name = "LINK", required_unless_present = "instrument")]
    link: Option<LinkAddress>,
    /// Instrument of rig.toml; its link and profile apply unless --link or --profile is given
    #[arg(long, value_name = "NAME")]
    instrument: Option<String>,
    /// Longest wait for a reply, milliseconds [default: that of the profile, else 1000]
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u64).range(1..=60_000))]
    timeout: Option<u64>,
}

impl LinkArgs {
    /// Returns the place of the instrument, and its profile: the one named `profile`, or else that of --instrument in
    /// rig.toml, if any.
    fn place(
        &self,
        folder: &Folder,
        profile: Option<&String>,
    ) -> anyhow::Result<(Place, Option<Profile>)> {
        let wired = match &self.instrument {
            Some(name) => Some(wired(folder, name)?),
            None => None,
        };
        let link = self.link.clone();
        let link = link.or_else(|| wired.as_ref().map(|it| it.link.clone()));
        let place = Place {
            link: link.context("--link: found nothing, expected a link")?,
            timeout: self.timeout,
        };
        let profile = match profile {
            Some(name) => Some(load_instrument(&folder_of_profiles(folder), name)?),
            None => wired.map(|it| (*it.profile).clone()),
        };
        Ok((place, profile))
    }
}

/// Returns the instrument of rig.toml with this name.
fn wired(folder: &Folder, name: &str) -> anyhow::Result<InstrumentWiring> {
    let wiring = Plant::load(folder)?.wiring;
    let Some(found) = wiring.instrument_named(name) else {
        let known: Vec<&str> = wiring
            .instruments
            .iter()
            .map(|it| it.name.as_str())
            .collect();
        let known = match known[..] {
            [] => "none, because rig.toml has no instruments".to_owned(),
            _ => format!("one of {}", known.join(", ")),
        };
        bail!("--instrument: found {name:?}, expected {known}");
    };
    Ok(wiring.instrument(found).clone())
}

/// Where an instrument is.
#[derive(Debug, Clone)]
struct Place {
    link: LinkAddress,
    /// Longest wait for a reply, ms; overrides the profile.
    timeout: Option<u64>,
}

impl Place {
    /// Returns the time that this number of characters takes on a serial port, milliseconds; 0 on a network.
    fn wire_ms(&self, characters: usize) -> f64 {
        match self.link.transport {
            Transport::Tcp { .. } => 0.0,
            Transport::Serial { baud, .. } => 1e4 * characters as f64 / f64::from(baud),
        }
    }

    /// Returns a link with the settings of `profile`; for `None`, with default settings that suit most instruments.
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

/// Runs `relayrig instrument` with the profiles in `folder`.
pub fn run(folder: &Folder, args: &InstrumentArgs) -> anyhow::Result<Exit> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let runtime = runtime.context("starting the runtime")?;
    folder.check_exists()?;
    let done = runtime.block_on(async {
        match &args.command {
            InstrumentCommand::Scan(args) => scan::run(&folder_of_profiles(folder), args).await,
            InstrumentCommand::Send(args) => send::run(folder, args).await,
            InstrumentCommand::Monitor(args) => monitor::run(folder, args).await,
            InstrumentCommand::Check(args) => check::run(folder, args).await,
        }
    });
    super::unless_pipe_closed(done, Exit::Done)
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

/// Returns a number for a person to read: below 0.001 or from a million on, with its power of ten.
fn decimal(value: f64) -> String {
    match value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        true => value.to_string(),
        false => format!("{value:e}"),
    }
}
