//! Interprets the traffic of a line, for traces and for commands typed by hand: which commands a family of modules has,
//! which requests must never be sent, and what a request and its reply mean together.
//!
//! A request may fit several commands ([`decode_request`]). Its reply shows which of them the host meant: [`interpret`]
//! returns those that the reply fits.

use super::frame::{self, hex_digit};
use super::{Command, Reply, ReplyError, decode_request};

/// Family of a module, which decides what commands it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// 7017, 7018, 7033.
    AnalogIn,
    /// 7021, 7022, 7024.
    AnalogOut,
    /// 7041 to 7067, except analog modules.
    Digital,
    /// 7080.
    Counter,
}

impl Family {
    /// Returns the family of a model or of a name that a module reports (`7017F`, `I-7043`); `None` for an unknown
    /// name.
    pub fn of_name(name: &str) -> Option<Self> {
        let digits = &name[name.find('7')?..];
        match digits.get(..4)? {
            "7011" | "7012" | "7013" | "7014" | "7015" | "7016" | "7017" | "7018" | "7019"
            | "7033" => Some(Self::AnalogIn),
            "7021" | "7022" | "7024" => Some(Self::AnalogOut),
            "7041" | "7042" | "7043" | "7044" | "7045" | "7050" | "7051" | "7052" | "7053"
            | "7055" | "7060" | "7063" | "7065" | "7066" | "7067" => Some(Self::Digital),
            "7080" | "7083" => Some(Self::Counter),
            _ => None,
        }
    }

    /// Returns true when modules of this family have this command.
    pub fn has_command(self, command: &Command) -> bool {
        match command {
            Command::HostOk | Command::SampleAll | Command::Common(..) => true,
            Command::AnalogIn(..) => self == Self::AnalogIn,
            Command::AnalogOut(..) => self == Self::AnalogOut,
            Command::Digital(..) => self == Self::Digital,
            Command::Counter(..) => self == Self::Counter,
        }
    }
}

/// Returns why a request must never be sent; `None` when it may be. Factory calibration and trim need instruments that
/// a rig does not have, and can spoil a module for good.
pub fn factory_command(request: &[u8]) -> Option<&'static str> {
    let [lead, _, _, rest @ ..] = request else {
        return None;
    };
    let number = |text: &[u8]| text.iter().all(|byte| hex_digit(*byte).is_some());
    match (lead, rest) {
        (b'$', [b'0', channel @ ..]) if channel.len() <= 2 && number(channel) => {
            Some("span calibration, or calibration of an output")
        }
        (b'$', [b'1', channel @ ..]) if channel.len() <= 2 && number(channel) => {
            Some("zero calibration, or calibration of an output")
        }
        (b'$', [b'0' | b'1', b'C', ..]) => Some("calibration of one input"),
        (b'$', [b'3', trim @ ..]) if (2..=3).contains(&trim.len()) && number(trim) => {
            Some("trim of an output")
        }
        (b'$', [b'9', b'+' | b'-', ..]) => Some("offset of the cold junction"),
        (b'~', [b'E', ..]) => Some("release of calibration"),
        _ => None,
    }
}

/// Returns the commands of `request` that `reply` fits; both are as on the wire. If the reply fits no command, returns
/// each command with its error.
pub fn interpret(
    request: &[u8],
    reply: &[u8],
    checksum: bool,
) -> Vec<(Command, Result<Reply, ReplyError>)> {
    let Ok((text, _)) = frame::open(request, checksum) else {
        return Vec::new();
    };
    let mut found: Vec<_> = decode_request(text)
        .into_iter()
        .map(|command| (command, command.decode(reply, checksum)))
        .collect();
    if found.iter().any(|(_, reply)| reply.is_ok()) {
        found.retain(|(_, reply)| reply.is_ok());
    }
    found
}
