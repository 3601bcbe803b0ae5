//! `relayrig bus scan`: who is on the line.

use super::PortArgs;
use crate::bus::{self, Answer, LineLog, Pace, Request};
use crate::dcon::{Address, BaudCode, Command, Common, Config, Reply};
use anyhow::{anyhow, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;
use tokio::sync::mpsc;

/// Find modules.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig bus scan --port /dev/ttyUSB0
  relayrig bus scan --port /dev/ttyUSB0 --baud 115200 --baud 9600 --addresses 01-20 --checksum on

A module is asked for its configuration word ($AA2), which changes nothing. All addresses at all rates with and without
checksum take about three minutes. Exit status 1 when nobody answers.")]
pub struct ScanArgs {
    #[command(flatten)]
    port: PortArgs,
    /// Bits per second; may be given several times. All rates of the protocol without it
    #[arg(long, value_parser = baud)]
    baud: Vec<u32>,
    /// Addresses, hexadecimal, FIRST-LAST
    #[arg(long, value_name = "RANGE", default_value = "00-FF", value_parser = addresses)]
    addresses: (u8, u8),
    /// With checksum, without, or both
    #[arg(long, value_enum, default_value = "both")]
    checksum: Checksums,
    /// Milliseconds that a module may think; more for slow modules, converters in a network, a busy computer
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

/// A rate of the protocol.
pub(super) fn baud(text: &str) -> Result<u32, String> {
    text.parse()
        .ok()
        .filter(|rate| BaudCode::of(*rate).is_some())
        .ok_or_else(|| {
            format!("found \"{text}\", expected 1200 2400 4800 9600 19200 38400 57600 or 115200")
        })
}

fn addresses(text: &str) -> Result<(u8, u8), String> {
    let number = |part: &str| u8::from_str_radix(part, 16).ok();
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    match (number(first), number(last)) {
        (Some(first), Some(last)) if first <= last => Ok((first, last)),
        _ => Err(format!(
            "found \"{text}\", expected hexadecimal addresses as 01-20"
        )),
    }
}

/// Most likely rates first.
const RATES: [u32; 8] = [115_200, 9_600, 19_200, 38_400, 57_600, 4_800, 2_400, 1_200];

/// Times each found module is asked again for the spread of its latency.
const ASKED_AGAIN: usize = 16;

struct Found {
    asked: Address,
    stored: Address,
    baud: u32,
    checksum: bool,
    config: Config,
    name: String,
    firmware: String,
    log: LineLog,
}

pub(super) async fn run(args: &ScanArgs) -> anyhow::Result<i32> {
    let rates = if args.baud.is_empty() {
        RATES.to_vec()
    } else {
        args.baud.clone()
    };
    let (first, last) = args.addresses;
    let each = u64::from(last - first) + 1;
    let rounds = rates.len() * args.checksum.list().len();
    let bar = bar(each * rounds as u64);
    let mut found: Vec<Found> = Vec::new();
    for rate in rates {
        for checksum in args.checksum.list() {
            bar.set_message(format!(
                "{rate} baud, {} checksum",
                if *checksum { "with" } else { "no" }
            ));
            let mut line = Asking::open(args, rate, *checksum)?;
            for address in (first..=last).map(Address) {
                bar.inc(1);
                // A module listens at one rate only; a terminal without a rate would show it at each.
                if found.iter().all(|module| module.asked != address)
                    && let Some(module) = line.who(address, rate, *checksum).await?
                {
                    found.push(module);
                }
            }
        }
    }
    bar.finish_and_clear();
    found.sort_by_key(|module| module.asked);
    print(&found, args.json);
    Ok(if found.is_empty() {
        1
    } else {
        super::super::DONE
    })
}

/// A line that is asked one thing after the other.
struct Asking {
    requests: mpsc::Sender<Request>,
    answers: mpsc::Receiver<Answer>,
    log: LineLog,
}

impl Asking {
    fn open(args: &ScanArgs, rate: u32, checksum: bool) -> anyhow::Result<Self> {
        let port = args.port.open(rate)?;
        let mut settings = args.port.settings(rate, checksum);
        settings.digital_allowance_ms = args.allowance;
        let log = settings.log.clone();
        let (requests, to_line) = mpsc::channel(1);
        let (from_line, answers) = mpsc::channel(1);
        tokio::spawn(bus::run(port, settings, Pace::real(), to_line, from_line));
        Ok(Self {
            requests,
            answers,
            log,
        })
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
        if let Err(lost @ bus::LineError::PortLost { .. }) = &answer.outcome {
            bail!(lost.clone());
        }
        Ok(answer)
    }

    async fn who(
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
        let name = self.text(Common::ReadName.to(asked)).await?;
        let firmware = self.text(Common::ReadFirmware.to(asked)).await?;
        for _ in 0..ASKED_AGAIN {
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

    async fn text(&mut self, command: Command) -> anyhow::Result<String> {
        let answer = self.ask(command, 3).await?;
        Ok(match answer.outcome {
            Ok(Reply::Text(text)) => text.as_str().to_owned(),
            Ok(_) | Err(_) => "?".to_owned(),
        })
    }
}

fn print(found: &[Found], as_json: bool) {
    if !as_json {
        println!(
            "{:<4} {:>6} {:<8} {:<6} {:<8} {:<4} {:<6} {:>7} {:>7} {:>5} {:>4}  remarks",
            "addr",
            "baud",
            "checksum",
            "name",
            "firmware",
            "type",
            "format",
            "p50 ms",
            "p99 ms",
            "asked",
            "bad"
        );
    }
    for module in found {
        let health = module.log.health();
        let counts = health.module(module.asked).cloned().unwrap_or_default();
        let ms = |share| {
            counts
                .latency
                .percentile(share)
                .map(|span| span.as_seconds() * 1e3)
        };
        let bad = counts.time_outs + counts.checksum_errors + counts.other_errors;
        let (config, remarks) = (module.config, remarks(module));
        if as_json {
            println!(
                "{}",
                json!({
                    "address": module.asked.to_string(), "stored_address": module.stored.to_string(),
                    "baud": module.baud, "checksum": module.checksum, "name": module.name,
                    "firmware": module.firmware, "type": format!("{:02X}", config.type_code.0),
                    "stored_baud": config.baud.rate(), "format": format!("{:02X}", config.format.0),
                    "p50_ms": ms(0.5), "p99_ms": ms(0.99), "transactions": counts.transactions,
                    "time_outs": counts.time_outs, "checksum_errors": counts.checksum_errors,
                    "other_errors": counts.other_errors, "resets": counts.resets, "remarks": remarks,
                })
            );
        } else {
            println!(
                "{:<4} {:>6} {:<8} {:<6} {:<8} {:<4} {:<6} {:>7.2} {:>7.2} {:>5} {:>4}  {}",
                module.asked.to_string(),
                module.baud,
                if module.checksum { "on" } else { "off" },
                module.name,
                module.firmware,
                format!("{:02X}", config.type_code.0),
                format!("{:02X}", config.format.0),
                ms(0.5).unwrap_or(0.0),
                ms(0.99).unwrap_or(0.0),
                counts.transactions,
                bad,
                remarks.join("; ")
            );
        }
    }
}

/// What differs between how the module was found and what it has stored.
fn remarks(module: &Found) -> Vec<String> {
    let mut remarks = Vec::new();
    if module.stored != module.asked {
        remarks.push(format!("INIT* mode, stored address {}", module.stored));
    }
    if let Some(stored) = module
        .config
        .baud
        .rate()
        .filter(|rate| *rate != module.baud)
    {
        remarks.push(format!("has {stored} baud stored"));
    }
    if module.config.format.checksum() != module.checksum {
        let stored = if module.config.format.checksum() {
            "on"
        } else {
            "off"
        };
        remarks.push(format!("has checksum {stored} stored"));
    }
    if !module.checksum {
        remarks.push("without checksum a damaged digit is believed".to_owned());
    }
    remarks
}

fn bar(length: u64) -> ProgressBar {
    let target = if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg} {eta}") {
        bar.set_style(style);
    }
    bar
}
