//! `relayrig instrument monitor`: repeats a query and shows its values or the traffic, or listens to a serial port.

use super::{LinkArgs, sentence, text};
use crate::cli::output::print;
use anyhow::{Context, bail};
use app::controls::Interrupts;
use app::exit::Exit;
use bus::instrument::Link;
use bus::{Pace, escaped, open_serial};
use config::Folder;
use scpi::{Form, Program, Step, Transport};
use std::time::Duration;
use tokio::io::AsyncReadExt;
use units::{RigTime, Span};

/// Watch a link.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig instrument monitor --link tcp:192.168.1.20:5025 --query 'READ?' --every 500
  relayrig instrument monitor --link tcp:192.168.1.20:5025 --query '*STB?' --traffic
  relayrig instrument monitor --link serial:/dev/ttyUSB0:9600

With --query the monitor asks and shows each value, or why there is none; it goes on after a failure. Without --query it \
listens to a serial port and sends nothing; a network connection cannot be listened to. Ctrl-C ends it.")]
pub struct MonitorArgs {
    #[command(flatten)]
    link: LinkArgs,
    /// Profile; its set-up goes to the instrument before the first query
    #[arg(long, value_name = "NAME", requires = "query")]
    profile: Option<String>,
    /// Query to repeat
    #[arg(long, value_name = "QUERY")]
    query: Option<String>,
    /// Milliseconds from one query to the next
    #[arg(long, value_name = "MS", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=3_600_000))]
    every: u64,
    /// Show every message on the link in place of the values
    #[arg(long, requires = "query")]
    traffic: bool,
    /// Ends after S seconds
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..=86_400))]
    seconds: Option<u64>,
}

pub(super) async fn run(folder: &Folder, args: &MonitorArgs) -> anyhow::Result<Exit> {
    let seconds = Duration::from_secs(args.seconds.unwrap_or(u64::from(u32::MAX)));
    let mut interrupts = Interrupts::listen()?;
    let (place, profile) = args.link.place(folder, args.profile.as_ref())?;
    let mut link = place.link(profile.as_ref());
    let watching = async {
        match (&args.query, &place.link.transport) {
            (Some(query), _) if !query.contains('?') => {
                bail!("--query: found {query:?}, expected a query with ?")
            }
            (Some(query), _) => repeat(&mut link, args, query).await,
            (None, Transport::Serial { path, baud }) => listen(path, *baud).await,
            (None, Transport::Tcp { .. }) => {
                bail!(
                    "--query: found nothing, expected a query: a network connection cannot be listened to"
                )
            }
        }
    };
    tokio::select! {
        ended = watching => ended?,
        () = interrupts.next() => {}
        () = tokio::time::sleep(seconds) => {}
    }
    Ok(Exit::Done)
}

async fn repeat(link: &mut Link, args: &MonitorArgs, query: &str) -> anyhow::Result<()> {
    let pace = Pace::real();
    let program = Program {
        steps: vec![Step::ask(query, Form::Any)],
    };
    let mut shown = None;
    loop {
        let began = pace.now();
        let outcome = link.run(program.clone()).await;
        if args.traffic {
            print_traffic(link, &mut shown)?;
        } else {
            let values = outcome.map(|it| it.iter().map(text).collect::<Vec<_>>().join(", "));
            let found = values.unwrap_or_else(|failure| sentence(&failure));
            print(&format!("{:>12.3} {found}\n", began.0 as f64 / 1e6))?;
        }
        pace.sleep_until(began + Span::ms(args.every)).await;
    }
}

/// Prints the messages of the queries since the last call; `shown` is the number of the last printed query.
fn print_traffic(link: &Link, shown: &mut Option<u64>) -> anyhow::Result<()> {
    let traffic = link.log().traffic();
    let new = traffic
        .iter()
        .filter(|it| shown.is_none_or(|last| it.program > last));
    let text: String = new.map(|it| format!("{it}\n")).collect();
    *shown = traffic.last().map(|it| it.program).or(*shown);
    print(&text)
}

/// Shows the lines of text that arrive at a serial port until the port goes away.
async fn listen(path: &str, baud: u32) -> anyhow::Result<()> {
    let mut port =
        open_serial(path, baud).with_context(|| format!("--link serial:{path}:{baud}"))?;
    let pace = Pace::real();
    let mut line = Vec::new();
    let mut piece = [0; 256];
    loop {
        let count = port
            .read(&mut piece)
            .await
            .with_context(|| format!("--link serial:{path}:{baud}"))?;
        if count == 0 {
            bail!("--link serial:{path}:{baud}: the port went away");
        }
        for byte in &piece[..count] {
            line.push(*byte);
            if *byte == b'\n' || line.len() == 4096 {
                print(&row(pace.now(), &line))?;
                line.clear();
            }
        }
    }
}

fn row(at: RigTime, line: &[u8]) -> String {
    let text = escaped(line.trim_ascii_end());
    format!("{:>12.3} {text}\n", at.0 as f64 / 1e6)
}
