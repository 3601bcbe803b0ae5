//! `relayrig instrument scan`: asks the instrument at each link for its identity.

use super::{Place, sentence};
use crate::cli::output::{Fixed, latency_ms, listing, print};
use anyhow::bail;
use app::controls::Interrupts;
use app::exit::Exit;
use app::progress::progress;
use bus::{Histogram, Pace};
use config::{ConfigError, Folder, instrument_names, load_instrument};
use scpi::{Failure, Form, Identity, LinkAddress, Profile, Transport};
use serde_json::json;

/// Find instruments.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig instrument scan --host 192.168.1.20 --host 192.168.1.30
  relayrig instrument scan --link serial:/dev/ttyUSB0:9600 --link gpib-tcp:192.168.1.30:1234:9 --json

A host is tried at the ports 5025 (most makers) and 5555 (Rigol), and at port 1234 for a GPIB adapter with the addresses 0 to 30. \
The scan sends *IDN? only, which changes nothing. Exit status 1 when no instrument answers, 4 after Ctrl-C.")]
pub struct ScanArgs {
    /// A link to try; may be given several times
    #[arg(long, value_name = "LINK")]
    link: Vec<LinkAddress>,
    /// A host to try; may be given several times
    #[arg(long, value_name = "HOST")]
    host: Vec<String>,
    /// Longest wait for a reply, milliseconds
    #[arg(long, value_name = "MS", default_value_t = 500, value_parser = clap::value_parser!(u64).range(1..=60_000))]
    timeout: u64,
    /// One JSON object per instrument
    #[arg(long)]
    json: bool,
}

/// Usual ports of raw sockets of instruments.
const RAW_PORTS: [u16; 2] = [5025, 5555];
/// Usual port of GPIB adapters.
const ADAPTER_PORT: u16 = 1234;
/// Greatest GPIB address.
const LAST_ADDRESS: u8 = 30;
/// Number of further queries to each instrument, which measure its latency.
const REPETITIONS: usize = 8;

/// An instrument that answered.
struct Found {
    link: LinkAddress,
    identity: Identity,
    latencies: Histogram,
    profiles: Vec<String>,
}

pub(super) async fn run(folder: &Folder, args: &ScanArgs) -> anyhow::Result<Exit> {
    if args.link.is_empty() && args.host.is_empty() {
        bail!("found neither --link nor --host, expected at least one");
    }
    let mut found = Vec::new();
    let mut interrupts = Interrupts::listen()?;
    let interrupted = tokio::select! {
        () = scan(folder, args, &mut found) => false,
        () = interrupts.next() => true,
    };
    let object = args.json.then_some(object as fn(&Found) -> String);
    print(&listing(&found, &COLUMNS, "no instrument answered", object))?;
    Ok(match (interrupted, found.is_empty()) {
        (true, _) => Exit::Stopped,
        (false, true) => Exit::AnswerIsNo,
        (false, false) => Exit::Done,
    })
}

async fn scan(folder: &Folder, args: &ScanArgs, found: &mut Vec<Found>) {
    let links = args
        .link
        .iter()
        .cloned()
        .chain(args.host.iter().flat_map(|it| of_host(it)));
    let links: Vec<LinkAddress> = links.collect();
    let known = profiles(folder);
    let bar = progress(Some(links.len() as u64), "{bar:30} {pos}/{len} {msg} {eta}");
    let mut unreachable: Option<Transport> = None;
    for link in links {
        bar.set_message(link.to_string());
        bar.inc(1);
        // A GPIB adapter that refuses the connection for one address refuses it for every address.
        if unreachable.as_ref() == Some(&link.transport) {
            continue;
        }
        match identify(&link, args.timeout).await {
            Ok((identity, latencies)) => {
                let fits = known.iter().filter(|it| it.identity.accepts(&identity));
                let profiles = fits.map(|it| it.name.clone()).collect();
                found.push(Found {
                    link,
                    identity,
                    latencies,
                    profiles,
                });
            }
            Err(failure) => {
                // Warns only of links that the user named: the ports of a host are guesses.
                match args.link.contains(&link) {
                    true => tracing::warn!("{link}: {}", sentence(&failure)),
                    false => tracing::debug!("{link}: {}", sentence(&failure)),
                }
                if let Failure::Disconnected { .. } = failure {
                    unreachable = Some(link.transport);
                }
            }
        }
    }
    bar.finish_and_clear();
}

fn of_host(host: &str) -> impl Iterator<Item = LinkAddress> {
    let link = |port, gpib| {
        let host = host.to_owned();
        LinkAddress {
            transport: Transport::Tcp { host, port },
            gpib,
        }
    };
    let raw = RAW_PORTS.map(|port| link(port, None)).into_iter();
    let behind = (0..=LAST_ADDRESS).map(move |address| link(ADAPTER_PORT, Some(address)));
    raw.chain(behind)
}

async fn identify(address: &LinkAddress, timeout: u64) -> Result<(Identity, Histogram), Failure> {
    let args = Place {
        link: address.clone(),
        timeout: Some(timeout),
    };
    let mut link = args.link(None);
    let pace = Pace::real();
    let mut line = String::new();
    let mut latencies = Histogram::default();
    for number in 0..=REPETITIONS {
        let began = pace.now();
        let raw = link.exchange("*IDN?", Some(Form::Line)).await?;
        // The first query also opens the connection.
        if number > 0 {
            latencies.add(pace.now().since(began));
        }
        line = raw
            .and_then(|it| it.text().ok().map(str::to_owned))
            .unwrap_or_default();
    }
    Ok((Identity::read(&line), latencies))
}

/// Returns the profiles of the folder; warns of each faulty one.
fn profiles(folder: &Folder) -> Vec<Profile> {
    let warn = |error: &ConfigError| tracing::warn!("{error}");
    let names = instrument_names(folder).into_iter();
    let loaded = names.map(|name| load_instrument(folder, &name).inspect_err(warn));
    loaded.filter_map(Result::ok).collect()
}

const COLUMNS: [Fixed<Found>; 7] = [
    ("link", -32, |it| it.link.to_string()),
    ("maker", -22, |it| it.identity.maker.clone()),
    ("model", -14, |it| it.identity.model.clone()),
    ("serial", -12, |it| it.identity.serial.clone()),
    ("firmware", -12, |it| it.identity.firmware.clone()),
    ("p50 ms", 7, |it| {
        format!("{:.2}", latency_ms(&it.latencies, 0.5).unwrap_or(0.0))
    }),
    (" profile", 0, |it| format!(" {}", it.profiles.join(", "))),
];

fn object(found: &Found) -> String {
    let Identity {
        maker,
        model,
        serial,
        firmware,
    } = &found.identity;
    json!({
        "link": found.link.to_string(), "maker": maker, "model": model, "serial": serial, "firmware": firmware,
        "p50_ms": latency_ms(&found.latencies, 0.5), "p99_ms": latency_ms(&found.latencies, 0.99),
        "profiles": found.profiles,
    })
    .to_string()
}
