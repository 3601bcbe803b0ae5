//! Instrument profiles: what an instrument is and which commands carry out a program, as a file states it. The crate
//! `config` checks the keys; a link needs neither class nor accuracy.

use super::accuracy::Accuracy;
use super::address::{Flow, LinkAddress, Transport};
use super::framing::{Framing, Terminator};
use super::program::{Program, Step};
use super::reply::{BLOCK_LIMIT, Form};
use super::settings::{Echo, ExpectedIdentity, LinkSettings};
use super::waveform::Dialect;
use serde::Deserialize;
use std::collections::BTreeMap;
use thiserror::Error;
use units::Span;

/// Profile of a model, or of a class of models with the same commands.
#[derive(Debug, Clone, Deserialize)]
pub struct Profile {
    /// Name of the profile: that of its file.
    pub name: String,
    /// How the instrument codes waveforms.
    pub dialect: Dialect,
    /// Beginnings of the first and the second field of `*IDN?`.
    #[serde(flatten)]
    pub identity: ExpectedIdentity,
    /// Time allowed for a reply, unless the query states its own, milliseconds.
    pub timeout_ms: u64,
    /// Typical time from a query to its reply, milliseconds; `instrument check` compares it with the measured time.
    pub latency_ms: f64,
    /// Number of entries that the error queue holds.
    pub error_depth: u8,
    /// Proof that replies and queries are in step.
    #[serde(default)]
    pub echo: Echo,
    /// End of a command on a raw stream.
    #[serde(default)]
    pub terminator: Terminator,
    /// Flow control of a serial port.
    #[serde(default)]
    pub flow: Flow,
    /// Command that ends local mode; the link sends it first.
    pub remote: Option<String>,
    /// How far the instrument may err, by quantity and range.
    #[serde(default)]
    pub accuracy: Vec<Accuracy>,
    set_up: Vec<StepText>,
    safe: Vec<StepText>,
    program: BTreeMap<String, ProgramText>,
}

#[derive(Debug, Clone, Deserialize)]
struct ProgramText {
    steps: Vec<StepText>,
    #[serde(default)]
    argument: BTreeMap<String, Bounds>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
struct Bounds {
    low: f64,
    high: f64,
}

#[derive(Debug, Clone, Default, Deserialize)]
struct StepText {
    send: Option<String>,
    ask: Option<String>,
    reply: Option<ReplyForm>,
    most_bytes: Option<usize>,
    timeout_ms: Option<u64>,
    expect: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ReplyForm {
    Line,
    Number,
    Numbers,
    Text,
    Block,
}

/// Reason why a profile is not acceptable, with the path of its key.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{key}: found {found}, expected {expected}")]
pub struct ProfileFault {
    /// Path of the key; list items are numbered from 0.
    pub key: String,
    /// Value found, in words.
    pub found: String,
    /// Values that would be accepted.
    pub expected: &'static str,
}

/// Reason why a profile does not yield a program.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProgramError {
    /// The profile has no such program.
    #[error("profile {profile}: found program \"{name}\", expected one of {}", known.join(", "))]
    Unknown {
        /// Name of the profile.
        profile: String,
        /// Name that the caller asked for.
        name: String,
        /// Names of its programs.
        known: Vec<String>,
    },
    /// The program has no such argument.
    #[error(
        "program {program}: found argument \"{name}\", expected {}",
        either(known)
    )]
    UnknownArgument {
        /// Name of the program.
        program: String,
        /// Name given.
        name: String,
        /// Names of its arguments.
        known: Vec<String>,
    },
    /// An argument is missing, given twice, or out of range.
    #[error("program {program}, argument {argument}: found {found}, expected {expected}")]
    Argument {
        /// Name of the program.
        program: String,
        /// Name of the argument.
        argument: String,
        /// Value found, in words.
        found: String,
        /// Permitted range, or the rule that is broken, in words.
        expected: String,
    },
}

/// Returns the permitted names of an argument, in words.
fn either(known: &[String]) -> String {
    match known {
        [] => "no argument".to_owned(),
        known => known.join(" or "),
    }
}

impl Profile {
    /// Checks what no single key shows: that some instrument can match, that each step is either a command or a query,
    /// and that every name in braces is an argument.
    ///
    /// # Errors
    /// Fails with the first fault.
    pub fn check(&self) -> Result<(), ProfileFault> {
        for (key, list) in [
            ("makers", &self.identity.makers),
            ("models", &self.identity.models),
        ] {
            if list.is_empty() {
                let (key, found) = (key.to_owned(), "an empty list".to_owned());
                return Err(ProfileFault {
                    key,
                    found,
                    expected: "at least one beginning",
                });
            }
        }
        let none = BTreeMap::new();
        check_steps("set_up", &self.set_up, &none)?;
        check_steps("safe", &self.safe, &none)?;
        for (name, program) in &self.program {
            check_steps(
                &format!("program.{name}.steps"),
                &program.steps,
                &program.argument,
            )?;
            for (argument, bounds) in &program.argument {
                let key = format!("program.{name}.argument.{argument}");
                if bounds.low > bounds.high {
                    let (found, expected) = (bounds.low.to_string(), "at most its high end");
                    return Err(ProfileFault {
                        key: format!("{key}.low"),
                        found,
                        expected,
                    });
                }
                let named = braced(argument);
                let uses = |it: &StepText| it.texts().any(|text| text.contains(&named));
                if !program.steps.iter().any(uses) {
                    let found = "an argument without use".to_owned();
                    return Err(ProfileFault {
                        key,
                        found,
                        expected: "its name in a step, in braces",
                    });
                }
            }
        }
        Ok(())
    }

    /// Returns the names of the programs in alphabetical order.
    pub fn programs(&self) -> impl Iterator<Item = &str> {
        self.program.keys().map(String::as_str)
    }

    /// Returns the program `name` with its arguments filled in.
    ///
    /// # Errors
    /// Fails for an unknown program or argument, a missing argument, and a value out of its range.
    pub fn program(&self, name: &str, arguments: &[(&str, f64)]) -> Result<Program, ProgramError> {
        let Some(program) = self.program.get(name) else {
            let known = self.programs().map(str::to_owned).collect();
            let (profile, name) = (self.name.clone(), name.to_owned());
            return Err(ProgramError::Unknown {
                profile,
                name,
                known,
            });
        };
        let is_known = |it: &&(&str, f64)| program.argument.contains_key(it.0);
        if let Some((other, _)) = arguments.iter().find(|it| !is_known(it)) {
            return Err(ProgramError::UnknownArgument {
                program: name.to_owned(),
                name: (*other).to_owned(),
                known: program.argument.keys().cloned().collect(),
            });
        }
        let mut filled = Vec::new();
        for (argument, Bounds { low, high }) in &program.argument {
            let given = arguments.iter().filter(|it| it.0 == argument);
            let given: Vec<f64> = given.map(|it| it.1).collect();
            match given[..] {
                [value] if (*low..=*high).contains(&value) => {
                    filled.push((braced(argument), value.to_string()));
                }
                _ => return Err(wrong_argument(name, argument, &given, (*low, *high))),
            }
        }
        Ok(steps(&program.steps, &filled))
    }

    /// Returns the program that makes the instrument safe.
    pub fn safe(&self) -> Program {
        steps(&self.safe, &[])
    }

    /// Returns the settings of a link to the instrument at `address`.
    pub fn link_settings(&self, address: &LinkAddress) -> LinkSettings {
        let serial = matches!(address.transport, Transport::Serial { .. });
        LinkSettings {
            identity: Some(self.identity.clone()),
            remote: self.remote.clone(),
            set_up: steps(&self.set_up, &[]),
            echo: self.echo,
            error_depth: self.error_depth,
            framing: address
                .gpib
                .map_or(Framing::Direct(self.terminator), Framing::Adapter),
            reopen: !serial,
            limit: Span::ms(self.timeout_ms),
            ..LinkSettings::default()
        }
    }
}

fn wrong_argument(program: &str, argument: &str, given: &[f64], ends: (f64, f64)) -> ProgramError {
    let found: Vec<String> = given.iter().map(f64::to_string).collect();
    ProgramError::Argument {
        program: program.to_owned(),
        argument: argument.to_owned(),
        found: match found[..] {
            [] => "nothing".to_owned(),
            _ => found.join(" and "),
        },
        expected: format!("a number from {} to {}", ends.0, ends.1),
    }
}

/// Returns the placeholder of an argument in a step, which its value replaces.
fn braced(argument: &str) -> String {
    format!("{{{argument}}}")
}

impl StepText {
    /// Returns the texts of the step that may contain placeholders.
    fn texts(&self) -> impl Iterator<Item = &str> {
        let all = [&self.send, &self.ask, &self.expect];
        all.into_iter().flatten().map(String::as_str)
    }

    fn form(&self) -> Form {
        match self.reply {
            Some(ReplyForm::Number) => Form::Number,
            Some(ReplyForm::Numbers) => Form::Numbers,
            Some(ReplyForm::Text) => Form::Text,
            Some(ReplyForm::Block) => Form::Block(self.most_bytes.unwrap_or(BLOCK_LIMIT)),
            Some(ReplyForm::Line) | None => Form::Line,
        }
    }
}

fn steps(texts: &[StepText], filled: &[(String, String)]) -> Program {
    let fill = |text: &str| {
        filled.iter().fold(text.to_owned(), |text, (named, value)| {
            text.replace(named, value)
        })
    };
    let step = |it: &StepText| match &it.ask {
        None => Step::Send(fill(it.send.as_deref().unwrap_or_default())),
        Some(command) => Step::Ask {
            command: fill(command),
            form: it.form(),
            limit: it.timeout_ms.map(Span::ms),
            expect: it.expect.as_deref().map(fill),
        },
    };
    Program {
        steps: texts.iter().map(step).collect(),
    }
}

fn check_steps(
    key: &str,
    steps: &[StepText],
    arguments: &BTreeMap<String, Bounds>,
) -> Result<(), ProfileFault> {
    let mut numbered = steps.iter().enumerate();
    numbered.try_for_each(|(number, step)| check_step(&format!("{key}.{number}"), step, arguments))
}

fn check_step(
    key: &str,
    step: &StepText,
    arguments: &BTreeMap<String, Bounds>,
) -> Result<(), ProfileFault> {
    let fault = |key: String, found: &str, expected| {
        let found = found.to_owned();
        Err(ProfileFault {
            key,
            found,
            expected,
        })
    };
    let one = "one of send and ask";
    let (name, text) = match (&step.send, &step.ask) {
        (Some(text), None) => ("send", text),
        (None, Some(text)) => ("ask", text),
        (Some(_), Some(_)) => return fault(key.to_owned(), "both send and ask", one),
        (None, None) => return fault(key.to_owned(), "neither send nor ask", one),
    };
    let (own, quoted) = (format!("{key}.{name}"), format!("{text:?}"));
    if !text.bytes().all(|it| (0x20..0x7F).contains(&it)) {
        return fault(own, &quoted, "printable ASCII characters");
    }
    if step.send.is_some() {
        if text.contains('?') {
            let expected = "a command without reply; a query is an `ask`";
            return fault(own, &quoted, expected);
        }
        let asks = step.reply.is_some() || step.expect.is_some() || step.timeout_ms.is_some();
        if asks || step.most_bytes.is_some() {
            let expected = "no reply, expect, timeout_ms or most_bytes beside send";
            return fault(own, &quoted, expected);
        }
    } else {
        if !text.contains('?') || text.contains(';') {
            return fault(own, &quoted, "one query with ?, without ;");
        }
        if step.reply.is_some() == step.expect.is_some() {
            return fault(own, &quoted, "one of reply and expect beside it");
        }
        let is_block = step.reply == Some(ReplyForm::Block);
        if is_block != step.most_bytes.is_some() {
            let expected = "most_bytes beside reply = \"block\", and nowhere else";
            return fault(own, &quoted, expected);
        }
    }
    match step.texts().find_map(|it| unknown_name(it, arguments)) {
        Some(name) => fault(
            own,
            &format!("{name:?}"),
            "the name of an argument in braces",
        ),
        None => Ok(()),
    }
}

/// Returns the first name in braces that is not an argument.
fn unknown_name<'a>(text: &'a str, arguments: &BTreeMap<String, Bounds>) -> Option<&'a str> {
    let mut opened = text.split('{').skip(1);
    opened.find_map(|rest| match rest.split_once('}') {
        Some((name, _)) if arguments.contains_key(name) => None,
        Some((name, _)) => Some(name),
        None => Some(rest),
    })
}
