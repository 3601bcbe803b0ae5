//! `relayrig bus monitor`: shows the traffic of a line, from a serial port without sending anything, from a running
//! controller, or from the trace of an alarm.

use super::PortArgs;
use crate::cli::output::input;
use crate::cli::output::print;
use anyhow::{Context, bail};
use app::controls::Interrupts;
use app::exit::Exit;
use app::follower::{self, Update, UpdateContent};
use bus::{Direction, Entry, Meaning, Pace, Recorded, arrow, escaped, unescaped};
use std::path::{Path, PathBuf};
use std::time::Duration;
use texts::Lang;
use tokio::io::AsyncReadExt;

/// Watch a line.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig bus monitor --port /dev/ttyUSB0 --baud 115200 --checksum
  relayrig bus monitor --from http://127.0.0.1:8080 --line motion
  relayrig bus monitor --trace relayrig.alarm-1-motion.trace
  relayrig bus monitor --trace relayrig.alarm-1-motion.trace --level bytes

A port does not tell the directions apart: a frame with # $ % @ ~ counts as a request, one with ! > ? as the reply to \
the request before it. The monitor sends nothing. A running controller owns its ports; the monitor reads the traffic that it \
keeps of every line over the address of its page. Ctrl-C ends it.")]
pub struct MonitorArgs {
    /// Serial port to listen to
    #[arg(long, value_name = "PATH", required_unless_present_any = ["trace", "from"])]
    port: Option<PathBuf>,
    /// Address of the page of a running controller
    #[arg(long, value_name = "URL", value_parser = follower::page, conflicts_with_all = ["port", "trace"])]
    from: Option<follower::Page>,
    /// Only this line of the controller
    #[arg(long, value_name = "NAME", requires = "from")]
    line: Option<String>,
    /// Trace of an alarm, - for stdin
    #[arg(long, value_name = "FILE", conflicts_with = "port")]
    trace: Option<PathBuf>,
    /// Bits per second of the port
    #[arg(long, default_value_t = 115_200, value_parser = super::scan::baud)]
    baud: u32,
    /// Frames on the port carry checksums
    #[arg(long)]
    checksum: bool,
    /// Detail of a row
    #[arg(long, value_enum, default_value = "meaning")]
    level: Level,
    /// Ends after S seconds
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..=86_400))]
    seconds: Option<u64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Level {
    /// Every byte in hexadecimal, one row per message
    Bytes,
    /// Frames as text
    Frames,
    /// Frames with the meaning of request and reply
    Meaning,
}

pub(super) async fn run(args: &MonitorArgs) -> anyhow::Result<Exit> {
    if let Some(path) = &args.trace {
        let named = || format!("--trace {}", path.display());
        let text = input(path).and_then(std::io::read_to_string);
        let recorded = Recorded::parse(&text.with_context(named)?).with_context(named)?;
        let mut writer = RowWriter::new(args.level, recorded.checksum);
        for entry in &recorded.entries {
            print(&writer.row(entry))?;
        }
        return Ok(Exit::Done);
    }
    let seconds = Duration::from_secs(args.seconds.unwrap_or(u64::from(u32::MAX)));
    let mut interrupts = Interrupts::listen()?;
    tokio::select! {
        ended = watch(args) => ended?,
        () = interrupts.next() => {}
        () = tokio::time::sleep(seconds) => {}
    }
    Ok(Exit::Done)
}

/// Watches until the controller or the port goes away.
async fn watch(args: &MonitorArgs) -> anyhow::Result<()> {
    if let Some(page) = &args.from {
        return follower::follow(page, |news| {
            let wanted = args.line.as_ref().is_none_or(|line| news.line == *line);
            if wanted {
                print(&format!("{}\n", row(news, args.level)))?;
            }
            Ok(())
        })
        .await;
    }
    let Some(path) = &args.port else {
        bail!("--port, --from or --trace is needed");
    };
    listen(args, path).await
}

/// Returns the row of a message of a running controller, without line end.
fn row(news: &Update, level: Level) -> String {
    let (seconds, line) = (news.at_us as f64 / 1e6, &news.line);
    let UpdateContent::Message(message) = &news.what else {
        return format!("{seconds:>14.6} {line} - messages were lost here");
    };
    let shown = detail(level, &message.text, &message.meaning);
    format!("{seconds:>14.6} {line} {} {shown}", message.way)
}

/// Returns a message in the detail that `level` asks for; `text` is the message with escapes.
fn detail(level: Level, text: &str, meaning: &str) -> String {
    let bytes = || unescaped(text).unwrap_or_default().into_iter();
    let shown = match level {
        Level::Bytes => bytes().map(|byte| format!("{byte:02X} ")).collect(),
        Level::Frames => text.to_owned(),
        Level::Meaning => format!("{text:<24} {meaning}"),
    };
    shown.trim_end().to_owned()
}

/// Shows frames until the port goes away.
async fn listen(args: &MonitorArgs, path: &Path) -> anyhow::Result<()> {
    let (port, path) = (path.to_owned(), path.display());
    let mut stream = PortArgs { port }.open(args.baud)?;
    let pace = Pace::real();
    let mut writer = RowWriter::new(args.level, args.checksum);
    let mut frame: Vec<u8> = Vec::new();
    let mut piece = [0; 256];
    loop {
        let read = stream.read(&mut piece).await;
        let count = read.with_context(|| format!("--port {path}"))?;
        if count == 0 {
            bail!("--port {path}: the port went away");
        }
        let now = pace.now();
        for byte in &piece[..count] {
            frame.push(*byte);
            if *byte == b'\r' || frame.len() == dcon::FRAME_LIMIT {
                if let Some(entry) = Entry::new(now, direction(&frame), &frame) {
                    print(&writer.row(&entry))?;
                }
                frame.clear();
            }
        }
    }
}

fn direction(frame: &[u8]) -> Direction {
    match frame.first() {
        Some(b'#' | b'$' | b'%' | b'@' | b'~') => Direction::Sent,
        Some(b'!' | b'>' | b'?') => Direction::Received,
        Some(_) | None => Direction::Stray,
    }
}

/// Turns entries of a trace into rows.
struct RowWriter {
    level: Level,
    meaning: Meaning,
}

impl RowWriter {
    fn new(level: Level, checksum: bool) -> Self {
        Self {
            level,
            meaning: Meaning::new(checksum),
        }
    }

    /// Returns one row with its line end.
    fn row(&mut self, entry: &Entry) -> String {
        let seconds = entry.at.0 as f64 / 1e6;
        let [meaning] = self.meaning.of(entry, [Lang::En]);
        let shown = detail(self.level, &escaped(entry.bytes()), &meaning);
        format!("{seconds:>14.6} {} {shown}\n", arrow(entry.direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use app::follower::Message;

    #[test]
    fn a_level_sets_the_detail_of_a_message() {
        let news = |what| Update {
            at_us: 4,
            line: "motion".to_owned(),
            what,
        };
        let message = news(UpdateContent::Message(Message {
            at_us: 4,
            way: "<".to_owned(),
            text: ">3E\\r".to_owned(),
            meaning: "module 11, read the digital channels: done".to_owned(),
        }));
        let bytes = row(&message, Level::Bytes);
        assert_eq!(bytes, "      0.000004 motion < 3E 33 45 0D");
        let frames = row(&message, Level::Frames);
        assert_eq!(frames, "      0.000004 motion < >3E\\r");
        assert!(row(&message, Level::Meaning).ends_with(": done"));
        let gap = row(&news(UpdateContent::Gap), Level::Meaning);
        assert!(gap.ends_with("motion - messages were lost here"));
    }
}
