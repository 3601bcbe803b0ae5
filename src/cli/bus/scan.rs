//! `relayrig bus scan`: finds the modules of a line.

use super::PortArgs;
use super::found::{Found, listing};
use crate::cli::output::print;
use anyhow::{Context, anyhow, bail};
use app::controls::Interrupts;
use app::exit::Exit;
use app::progress::progress;
use bus::{Answer, LineLog, Pace, Request};
use dcon::{Address, BaudCode, Command, Common, Reply};
use thiserror::Error;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;

/// Find modules.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig bus scan --port /dev/ttyUSB0
  relayrig bus scan --port /dev/ttyUSB0 --baud 115200 --baud 9600 --addresses 01-20 --checksum on

The scan reads the configuration word of each module ($AA2), which changes nothing. All addresses at all rates with and without \
checksum take about ten minutes, at 115200 and 9600 one and a half; Ctrl-C ends it and prints what was found. Exit status 1 when no module answers, 4 after \
Ctrl-C.")]
pub struct ScanArgs {
    #[command(flatten)]
    port: PortArgs,
    /// Bits per second; may be given several times; when absent, all rates of the protocol
    #[arg(long, value_parser = baud)]
    baud: Vec<u32>,
    /// Addresses, hexadecimal, FIRST-LAST
    #[arg(long, value_name = "RANGE", default_value = "00-FF", value_parser = addresses)]
    addresses: (u8, u8),
    /// Checksum on, off, or both
    #[arg(long, value_enum, default_value = "both")]
    checksum: Checksums,
    /// Milliseconds that a module may take to reply, besides the time on the wire; more for slow modules, converters in
    /// a network, a busy computer
    #[arg(long, value_name = "MS", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=1_000))]
    allowance: u64,
    /// One JSON object per module
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Checksums {
    On,
    Off,
    Both,
}

impl Checksums {
    fn list(self) -> &'static [bool] {
        match self {
            Self::On => &[true],
            Self::Off => &[false],
            Self::Both => &[true, false],
        }
    }
}

/// Why a rate or an address range is refused.
#[derive(Debug, Error)]
pub(super) enum ScanArgError {
    /// The protocol has no such rate.
    #[error("found \"{0}\", expected 1200 2400 4800 9600 19200 38400 57600 or 115200")]
    Rate(String),
    /// The text is no range of addresses.
    #[error("found \"{0}\", expected hexadecimal addresses as 01-20")]
    Addresses(String),
}

/// Reads a rate of the protocol, bits per second.
pub(super) fn baud(text: &str) -> Result<u32, ScanArgError> {
    text.parse()
        .ok()
        .filter(|rate| BaudCode::of(*rate).is_some())
        .ok_or_else(|| ScanArgError::Rate(text.to_owned()))
}

fn addresses(text: &str) -> Result<(u8, u8), ScanArgError> {
    let number = |part: &str| u8::from_str_radix(part, 16).ok();
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    match (number(first), number(last)) {
        (Some(first), Some(last)) if first <= last => Ok((first, last)),
        _ => Err(ScanArgError::Addresses(text.to_owned())),
    }
}

/// Rates of the protocol, bits per second, the most likely first.
const RATES: [u32; 8] = [115_200, 9_600, 19_200, 38_400, 57_600, 4_800, 2_400, 1_200];

/// Number of further transactions with each module found, which measure the spread of its latency.
const REPETITIONS: usize = 16;

pub(super) async fn run(args: &ScanArgs) -> anyhow::Result<Exit> {
    let mut found: Vec<Found> = Vec::new();
    let mut interrupts = Interrupts::listen()?;
    let interrupted = tokio::select! {
        asked = scan_all(args, &mut found) => asked.map(|()| false)?,
        () = interrupts.next() => true,
    };
    found.sort_by_key(|module| module.asked);
    print(&listing(&found, args.json))?;
    Ok(match (interrupted, found.is_empty()) {
        (true, _) => Exit::Stopped,
        (false, true) => Exit::AnswerIsNo,
        (false, false) => Exit::Done,
    })
}

/// Tries every address at every rate, with checksum and without.
async fn scan_all(args: &ScanArgs, found: &mut Vec<Found>) -> anyhow::Result<()> {
    let rates = if args.baud.is_empty() {
        &RATES[..]
    } else {
        &args.baud
    };
    let (first, last) = args.addresses;
    let checksums = args.checksum.list();
    let each = u64::from(last - first) + 1;
    let length = each * (rates.len() * checksums.len()) as u64;
    let bar = progress(Some(length), "{bar:30} {pos}/{len} {msg} {eta}");
    for (rate, checksum) in rates
        .iter()
        .flat_map(|rate| checksums.iter().map(move |it| (*rate, *it)))
    {
        let with = if checksum { "with" } else { "no" };
        bar.set_message(format!("{rate} baud, {with} checksum"));
        let mut line = OpenLine::open(args, rate, checksum)?;
        for address in (first..=last).map(Address) {
            bar.inc(1);
            // A module listens at one rate only, but on a pseudo-terminal, which has no rate, it answers at every rate.
            if found.iter().all(|module| module.asked != address)
                && let Some(module) = line.identify(address, rate, checksum).await?
            {
                found.push(module);
            }
        }
        line.close().await?;
    }
    bar.finish_and_clear();
    Ok(())
}

/// An open line with one transaction at a time.
struct OpenLine {
    requests: mpsc::Sender<Request>,
    answers: mpsc::Receiver<Answer>,
    log: LineLog,
    task: JoinHandle<()>,
}

impl OpenLine {
    fn open(args: &ScanArgs, rate: u32, checksum: bool) -> anyhow::Result<Self> {
        let port = args.port.open(rate)?;
        let mut settings = args.port.settings(rate, checksum);
        settings.digital_allowance_ms = args.allowance;
        let log = settings.log.clone();
        let (requests, to_line) = mpsc::channel(1);
        let (from_line, answers) = mpsc::channel(1);
        let task = tokio::spawn(bus::run(port, settings, Pace::real(), to_line, from_line));
        Ok(Self {
            requests,
            answers,
            log,
            task,
        })
    }

    /// Closes the port, so that it can be opened at another rate.
    async fn close(self) -> anyhow::Result<()> {
        let Self { requests, task, .. } = self;
        drop(requests);
        task.await.context("the task of the line")
    }

    async fn ask(&mut self, command: Command, tries: u8) -> anyhow::Result<Answer> {
        let request = Request {
            ticket: 0,
            command,
            tries,
        };
        let ended = || anyhow!("the task of the line ended");
        self.requests.send(request).await.map_err(|_| ended())?;
        let answer = self.answers.recv().await.ok_or_else(ended)?;
        if let Err(lost) = &answer.outcome
            && matches!(lost.failure, bus::Failure::PortLost(_))
        {
            bail!(lost.clone());
        }
        Ok(answer)
    }

    async fn identify(
        &mut self,
        asked: Address,
        baud: u32,
        checksum: bool,
    ) -> anyhow::Result<Option<Found>> {
        let word = self.ask(Common::ReadConfig.to(asked), 1).await?;
        let Ok(Reply::Config {
            address: stored,
            config,
        }) = word.outcome
        else {
            return Ok(None);
        };
        let name = self.text(Common::ReadName.to(asked), stored).await?;
        let firmware = self.text(Common::ReadFirmware.to(asked), stored).await?;
        // In INIT* mode a reply names the stored address, so `bus` refuses it as the reply of another module.
        let again = if stored == asked { REPETITIONS } else { 0 };
        for _ in 0..again {
            self.ask(Common::ReadConfig.to(asked), 1).await?;
        }
        let log = self.log.clone();
        Ok(Some(Found {
            asked,
            stored,
            baud,
            checksum,
            config,
            name,
            firmware,
            log,
        }))
    }

    /// Returns the text in the reply to `command`; the reply names the address `stored`. A module in INIT* mode sends
    /// no checksum.
    async fn text(&mut self, command: Command, stored: Address) -> anyhow::Result<String> {
        let is_init = command.address() != Some(stored);
        let answer = self.ask(command, if is_init { 1 } else { 3 }).await?;
        let said = answer.raw.strip_prefix(&format!("!{stored}"));
        Ok(match answer.outcome {
            Ok(Reply::Text(text)) => text.as_str().to_owned(),
            Ok(_) => "?".to_owned(),
            Err(_) => said.filter(|_| is_init).unwrap_or("?").to_owned(),
        })
    }
}
