//! Interprets the traffic of a line, for traces and for commands typed by hand: the commands that a family of modules
//! has, the requests that must never be sent, and the joint meaning of a request and its reply.
//!
//! A request may fit several commands ([`decode_request()`]). Its reply shows which of them the host meant:
//! [`interpret`] returns those that the reply fits.

use super::frame::{self, hex_digit};
use super::{AnalogIn, Bits, Command, Reply, ReplyError, decode_request};

/// Family of a module, which decides what commands it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// 7011 to 7019, 7033.
    AnalogIn,
    /// 7021, 7022, 7024.
    AnalogOut,
    /// 7041 to 7067.
    Digital,
    /// 7080.
    Counter,
}

/// Properties of a module that determine its commands and the meaning of its replies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Model {
    /// Family of its commands.
    pub family: Family,
    /// Number of inputs: analog, digital or counter inputs, by family.
    pub inputs: u8,
    /// Number of outputs: analog in family `AnalogOut`, else digital.
    pub outputs: u8,
}

impl Model {
    /// Returns the model for a name as printed or as the module reports it (`I-7043`, `7017F`); `None` for an unknown
    /// name.
    pub fn of_name(name: &str) -> Option<Self> {
        let digits = &name[name.find('7')?..];
        let (family, inputs, outputs) = match digits.get(..4)? {
            "7011" | "7012" | "7013" | "7014" | "7016" => (Family::AnalogIn, 1, 0),
            "7015" => (Family::AnalogIn, 6, 0),
            "7017" | "7018" | "7019" => (Family::AnalogIn, 8, 0),
            "7033" => (Family::AnalogIn, 3, 0),
            "7021" => (Family::AnalogOut, 0, 1),
            "7022" => (Family::AnalogOut, 0, 2),
            "7024" => (Family::AnalogOut, 0, 4),
            "7041" => (Family::Digital, 14, 0),
            "7042" => (Family::Digital, 0, 13),
            "7043" | "7045" => (Family::Digital, 0, 16),
            "7044" => (Family::Digital, 4, 8),
            "7050" => (Family::Digital, 7, 8),
            "7051" | "7053" => (Family::Digital, 16, 0),
            "7052" => (Family::Digital, 8, 0),
            "7055" => (Family::Digital, 8, 8),
            "7060" => (Family::Digital, 4, 4),
            "7063" => (Family::Digital, 8, 3),
            "7065" => (Family::Digital, 4, 5),
            "7066" | "7067" => (Family::Digital, 0, 7),
            "7080" => (Family::Counter, 2, 2),
            _ => return None,
        };
        Some(Self {
            family,
            inputs,
            outputs,
        })
    }

    /// Returns true when the command belongs to the family of this model. A command that reads all analog inputs must
    /// expect as many as the model has; one that reads a single input needs a model with several.
    pub fn has_command(self, command: &Command) -> bool {
        match command {
            Command::HostOk | Command::SampleAll | Command::Common(..) => true,
            Command::AnalogIn(_, AnalogIn::ReadAll(form) | AnalogIn::ReadAllHex(form)) => {
                self.family == Family::AnalogIn && form.channels() == self.inputs
            }
            Command::AnalogIn(_, AnalogIn::ReadOne { .. }) => {
                self.family == Family::AnalogIn && self.inputs > 1
            }
            Command::AnalogIn(..) => self.family == Family::AnalogIn,
            Command::AnalogOut(..) => self.family == Family::AnalogOut,
            Command::Digital(..) => self.family == Family::Digital,
            Command::Counter(..) => self.family == Family::Counter,
        }
    }

    /// Splits the two bytes of a digital module into the states of its inputs and of its outputs, bit n = channel n. On
    /// a module with both, the first byte holds the outputs. On any other module, up to eight channels use the first
    /// byte, and more channels use both.
    pub fn split(self, bits: Bits) -> (u16, u16) {
        let alone = |channels: u8| match channels {
            0 => 0,
            1..=8 => u16::from(bits.first),
            9.. => bits.word(),
        };
        match (self.inputs, self.outputs) {
            (inputs, 0) => (alone(inputs), 0),
            (0, outputs) => (0, alone(outputs)),
            (1.., 1..) => (u16::from(bits.second), u16::from(bits.first)),
        }
    }
}

/// Returns why a request must never be sent; `None` when it is permitted. Factory calibration and trim need instruments
/// that a rig does not have, and can spoil a module for good.
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
/// each command with its error. With `model`, leaves out commands that the model does not have.
pub fn interpret(
    request: &[u8],
    reply: &[u8],
    checksum: bool,
    model: Option<Model>,
) -> Vec<(Command, Result<Reply, ReplyError>)> {
    let Ok((text, _)) = frame::open(request, checksum) else {
        return Vec::new();
    };
    let mut found: Vec<_> = decode_request(text)
        .into_iter()
        .filter(|command| model.is_none_or(|model| model.has_command(command)))
        .map(|command| (command, command.decode(reply, checksum)))
        .collect();
    if found.iter().any(|(_, reply)| reply.is_ok()) {
        found.retain(|(_, reply)| reply.is_ok());
    }
    found
}
