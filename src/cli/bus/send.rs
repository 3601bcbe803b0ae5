//! `relayrig bus send`: sends one command as typed and decodes the reply.

use super::PortArgs;
use crate::cli::output::print;
use anyhow::bail;
use app::exit::Exit;
use bus::{LineSettings, Pace, RawReply, escaped, send_raw};
use dcon::{Command, Model};
use serde_json::json;
use texts::Lang;
use tokio_serial::SerialStream;

/// A command to send, and how to send it.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig bus send --port /dev/ttyUSB0 --baud 9600 '$01M'
  relayrig bus send --port /dev/ttyUSB0 --checksum '#01' --model 7017F

Exit status: 0 a reply that can be read, 1 refused, silent or garbled, 2 bad input. Factory calibration and trim are \
never sent. A setting that is in effect already is not written again; --model tells settings with the same characters apart.")]
pub struct SendArgs {
    #[command(flatten)]
    port: PortArgs,
    /// Bits per second
    #[arg(long, default_value_t = 115_200, value_parser = super::scan::baud)]
    baud: u32,
    /// Add a checksum, and check the checksum of the reply
    #[arg(long)]
    checksum: bool,
    /// Milliseconds that the module may take to reply, besides the time on the wire
    #[arg(long, value_name = "MS", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=1_000))]
    allowance: u64,
    /// Model of the module, where a reply has several meanings
    #[arg(long, value_name = "NAME")]
    model: Option<String>,
    /// One JSON object
    #[arg(long)]
    json: bool,
    /// The command, without checksum
    command: String,
}

pub(super) async fn run(args: &SendArgs) -> anyhow::Result<Exit> {
    let model = model(args.model.as_deref())?;
    let text = checked(&args.command)?;
    let mut request = text.to_vec();
    if args.checksum {
        request.extend(format!("{:02X}", dcon::checksum(text)).bytes());
    }
    request.push(b'\r');
    let mut port = args.port.open(args.baud)?;
    let mut settings = args.port.settings(args.baud, args.checksum);
    settings.store_allowance_ms = args.allowance;
    if let Some(command) = unambiguous(text, model)
        && let Some((reply, meaning)) = in_effect(&mut port, &settings, &command).await?
    {
        return print_unchanged(args, &reply, &meaning);
    }
    let reply = send_raw(&mut port, &settings, Pace::real(), &request).await?;
    let found = dcon::interpret(&request, &reply.bytes, args.checksum, model);
    let words = bus::meanings(&found, model, Lang::En);
    let broadcast = text.ends_with(b"**");
    let good = !reply.more && found.iter().any(|(_, reply)| reply.is_ok());
    print(&if args.json {
        let object = json!({
            "request": escaped(&request), "reply": escaped(&reply.bytes), "more": reply.more,
            "taken_ms": reply.taken.as_seconds() * 1e3, "meanings": words,
        });
        format!("{object}\n")
    } else {
        transcript(&request, &reply, &words, broadcast)
    })?;
    Ok(if good || broadcast {
        Exit::Done
    } else {
        Exit::AnswerIsNo
    })
}

/// Returns the request, the reply and the meanings of the reply, a line each.
fn transcript(request: &[u8], reply: &RawReply, words: &[String], broadcast: bool) -> String {
    let taken_ms = reply.taken.as_seconds() * 1e3;
    let mut rows = vec![format!("> {}", escaped(request))];
    if reply.bytes.is_empty() {
        rows.push(if broadcast {
            format!("  {}; no module answers", words.join(" | "))
        } else {
            format!(
                "  no reply within {taken_ms:.1} ms: no module with this address, rate and checksum knows this command"
            )
        });
    } else {
        rows.push(format!("< {}   {taken_ms:.1} ms", escaped(&reply.bytes)));
    }
    if reply.more {
        rows.push("  more characters behind the reply".to_owned());
    }
    if !reply.bytes.is_empty() && words.is_empty() {
        rows.push("  not a command of the modules known here".to_owned());
    }
    let meant = words.iter().filter(|_| !reply.bytes.is_empty());
    rows.extend(meant.map(|word| format!("  {word}")));
    rows.join("\n") + "\n"
}

/// Returns the only command that `text` can mean; `None` when it can mean several, or none.
fn unambiguous(text: &[u8], model: Option<Model>) -> Option<Command> {
    let mut commands = dcon::decode_request(text);
    commands.retain(|command| model.is_none_or(|model| model.has_command(command)));
    match commands[..] {
        [command] => Some(command),
        _ => None,
    }
}

/// Reads back the setting that `command` writes; returns the reply and its meaning when the setting already has this
/// value, so that the module's EEPROM need not be written.
async fn in_effect(
    port: &mut SerialStream,
    settings: &LineSettings,
    command: &Command,
) -> anyhow::Result<Option<(String, String)>> {
    let Some(setting) = command.setting() else {
        return Ok(None);
    };
    let mut question = Vec::new();
    setting.encode(settings.checksum, &mut question);
    let said = send_raw(port, settings, Pace::real(), &question).await?;
    let found = setting.decode(&said.bytes, settings.checksum);
    let words = bus::reply(&setting, &found, None).say(Lang::En);
    Ok(found
        .is_ok_and(|found| command.is_in_effect(&found))
        .then(|| (escaped(&said.bytes), words)))
}

fn print_unchanged(args: &SendArgs, reply: &str, meaning: &str) -> anyhow::Result<Exit> {
    print(&if args.json {
        let object = json!({
            "request": args.command, "written": false, "found": reply, "meaning": meaning,
        });
        format!("{object}\n")
    } else {
        format!("  in effect already, {reply} ({meaning}): not written again, an EEPROM wears\n")
    })?;
    Ok(Exit::Done)
}

/// Refuses a text that is no request of the protocol, and factory commands, which can make a module unusable.
fn checked(command: &str) -> anyhow::Result<&[u8]> {
    let text = command.as_bytes();
    let plain = text.iter().all(|byte| (0x20..0x7F).contains(byte));
    let lead = text.first().is_some_and(|lead| b"#$%@~".contains(lead));
    if !plain || !lead || text.len() > 24 {
        bail!("COMMAND: found \"{command}\", expected # $ % @ or ~ and at most 24 characters");
    }
    let address = text.get(1..3).unwrap_or_default();
    let capital = |byte: &u8| matches!(byte, b'0'..=b'9' | b'A'..=b'F');
    if address != b"**" && !(address.len() == 2 && address.iter().all(capital)) {
        bail!(
            "COMMAND: found \"{command}\", expected two hexadecimal digits in capitals behind its first character, or **"
        );
    }
    if let Some(what) = dcon::factory_command(text) {
        bail!("COMMAND: \"{command}\" is {what}: only the factory may do that, it is never sent");
    }
    Ok(text)
}

fn model(name: Option<&str>) -> anyhow::Result<Option<Model>> {
    let Some(name) = name else {
        return Ok(None);
    };
    match Model::of_name(name) {
        Some(model) => Ok(Some(model)),
        None => bail!(
            "--model: found \"{name}\", expected a model of the list in docs/bus.md, such as 7017F"
        ),
    }
}
