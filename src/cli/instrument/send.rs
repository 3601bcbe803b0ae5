//! `relayrig instrument send`: sends one command as typed, shows the reply and the error queue.

use super::{LinkArgs, decimal, sentence};
use crate::cli::output::print;
use anyhow::bail;
use app::exit::Exit;
use app::instrument::message;
use bus::instrument::Link;
use bus::{Pace, escaped};
use config::Folder;
use scpi::{ErrorEntry, Failure, Form, Raw, ReplyError, number, string};
use serde_json::json;

/// A command to send, and how to send it.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig instrument send --link tcp:192.168.1.20:5025 '*IDN?'
  relayrig instrument send --link serial:/dev/ttyUSB0:9600 --profile dmm-34461a 'CONF:CURR:DC 0.0001'
  relayrig instrument send --link tcp:192.168.1.21:5555 ':WAV:DATA?' --json

The command goes out as typed, without resynchronisation; the error queue is read behind it. Exit status: 0 done, 1 no \
reply, a damaged one, an error of the instrument, or no error queue to read, 2 bad input.")]
pub struct SendArgs {
    #[command(flatten)]
    link: LinkArgs,
    /// Profile that gives end of message, flow control and times
    #[arg(long, value_name = "NAME")]
    profile: Option<String>,
    /// Leave the error queue as it is
    #[arg(long)]
    keep_errors: bool,
    /// One JSON object
    #[arg(long)]
    json: bool,
    /// The command; a command with ? has a reply
    command: String,
}

/// Greatest number of entries that the command reads from the error queue.
const ENTRIES: usize = 32;

pub(super) async fn run(folder: &Folder, args: &SendArgs) -> anyhow::Result<Exit> {
    if !args.command.bytes().all(|it| (0x20..0x7F).contains(&it)) || args.command.is_empty() {
        bail!(
            "COMMAND: found {:?}, expected printable ASCII characters",
            args.command
        );
    }
    let (place, profile) = args.link.place(folder, args.profile.as_ref())?;
    let mut link = place.link(profile.as_ref());
    let pace = Pace::real();
    if let Some(remote) = profile.and_then(|it| it.remote) {
        // After a failure here the command itself fails too, and reports the failure.
        let _ = link.exchange(&remote, None).await;
    }
    let began = pace.now();
    let form = args.command.contains('?').then_some(Form::Any);
    let outcome = link.exchange(&args.command, form).await;
    let taken_ms = pace.now().since(began).as_seconds() * 1e3;
    let (errors, unread) = match (&outcome, args.keep_errors) {
        (Ok(_) | Err(Failure::Timeout { .. }), false) => errors(&mut link).await,
        _ => (Vec::new(), None),
    };
    let is_good = outcome.is_ok() && errors.is_empty() && unread.is_none();
    print(&if args.json {
        let list: Vec<_> = errors
            .iter()
            .map(|it| json!({ "code": it.code, "text": it.text }))
            .collect();
        let reply = outcome.as_ref().ok().and_then(Option::as_ref);
        let object = json!({
            "command": args.command, "reply": reply.map(shown), "meaning": reply.map(meaning), "taken_ms": taken_ms,
            "failure": outcome.as_ref().err().or(unread.as_ref()).map(message), "errors": list,
        });
        format!("{object}\n")
    } else {
        let mut rows = transcript(&args.command, &outcome, taken_ms);
        let queue = errors.iter();
        rows.extend(queue.map(|it| format!("  error {}: {}", it.code, it.text)));
        rows.extend(
            unread.map(|it| format!("  the error queue cannot be read: {}", sentence(&it))),
        );
        rows.join("\n") + "\n"
    })?;
    Ok(if is_good {
        Exit::Done
    } else {
        Exit::AnswerIsNo
    })
}

/// Reads at most [`ENTRIES`] entries of the error queue; returns them, and the failure that stopped the reading.
async fn errors(link: &mut Link) -> (Vec<ErrorEntry>, Option<Failure>) {
    let mut found = Vec::new();
    while found.len() < ENTRIES {
        match error(link).await {
            Ok(entry) if entry.code == 0 => break,
            Ok(entry) => found.push(entry),
            Err(failure) => return (found, Some(failure)),
        }
    }
    (found, None)
}

async fn error(link: &mut Link) -> Result<ErrorEntry, Failure> {
    let command = "SYST:ERR?";
    let raw = link.exchange(command, Some(Form::Line)).await?;
    let line = raw.as_ref().map_or(Err(ReplyError::Empty), Raw::text);
    line.and_then(ErrorEntry::read)
        .map_err(|reason| Failure::Malformed {
            command: command.to_owned(),
            reason,
        })
}

fn transcript(command: &str, outcome: &Result<Option<Raw>, Failure>, taken_ms: f64) -> Vec<String> {
    let mut rows = vec![format!("> {command}")];
    match outcome {
        Ok(Some(raw)) => {
            rows.push(format!("< {}   {taken_ms:.1} ms", shown(raw)));
            rows.push(format!("  {}", meaning(raw)));
        }
        Ok(None) => {}
        Err(failure) => rows.push(format!("  {}", sentence(failure))),
    }
    rows
}

/// Number of bytes of a block that the answer shows.
const SHOWN: usize = 32;

fn shown(raw: &Raw) -> String {
    match raw {
        Raw::Line(line) => escaped(line),
        Raw::Block(bytes) => {
            let head = &bytes[..bytes.len().min(SHOWN)];
            let head: Vec<String> = head.iter().map(|it| format!("{it:02X}")).collect();
            let more = if bytes.len() > SHOWN { " ..." } else { "" };
            head.join(" ") + more
        }
    }
}

fn meaning(raw: &Raw) -> String {
    let text = match (raw, raw.text()) {
        (Raw::Block(bytes), _) => return format!("a block of {} bytes", bytes.len()),
        (Raw::Line(_), Err(reason)) => return reason.to_string(),
        (Raw::Line(_), Ok(text)) => text,
    };
    match number(text) {
        Ok(value) => return format!("the number {}", decimal(value)),
        Err(reason @ (ReplyError::OverRange | ReplyError::NotANumber)) => {
            return reason.to_string();
        }
        Err(_) => {}
    }
    match (
        Form::Numbers.read(raw),
        string(text),
        ErrorEntry::read(text),
    ) {
        (Ok(numbers), _, _) => super::text(&numbers),
        (_, Ok(text), _) => format!("the string {text}"),
        (_, _, Ok(entry)) => format!("the entry {} of an error queue, {}", entry.code, entry.text),
        (Err(_), Err(_), Err(_)) => "text".to_owned(),
    }
}
