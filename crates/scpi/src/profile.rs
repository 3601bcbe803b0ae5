//! Instrument profiles: what an instrument is and which commands carry out a program, as a file states it. The crate
//! `config` checks the keys; a link needs neither class, dialect nor accuracy.

use super::address::{Flow, LinkAddress, Transport};
use super::framing::{Framing, Terminator};
use super::program::{Program, Step};
use super::reply::{BLOCK_LIMIT, Form};
use super::settings::{Echo, ExpectedIdentity, LinkSettings};
use serde::Deserialize;
use std::collections::BTreeMap;
use thiserror::Error;
use units::Span;

/// Profile of a model, or of a class of models with the same commands.
#[derive(Debug, Clone, Deserialize)]
pub struct Profile {
    /// Name of the profile, as its file is called.
    pub name: String,
    /// Beginnings of the first and the second field of `*IDN?`.
    #[serde(flatten)]
    pub identity: ExpectedIdentity,
    /// Time allowed for a reply without time of its own, milliseconds.
    pub timeout_ms: u64,
    /// Usual time from a query to its reply, milliseconds; `instrument check` compares it.
    pub latency_ms: f64,
    /// Number of entries of the error queue.
    pub error_depth: u8,
    /// Proof that replies and queries are in step.
    #[serde(default)]
    pub echo: Echo,
    /// End of a message on a raw stream.
    #[serde(default)]
    pub terminator: Terminator,
    /// Flow control of a serial port.
    #[serde(default)]
    pub flow: Flow,
    /// Command that ends local mode; sent first.
    pub remote: Option<String>,
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

/// Reason why a profile is not accepted, with the path of its key.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{key}: found {found}, expected {expected}")]
pub struct ProfileFault {
    /// Path of the key; items of lists by number from 0.
    pub key: String,
    /// Value found, in words.
    pub found: String,
    /// Values that would be accepted.
    pub expected: &'static str,
}

/// Reason why a profile gives no program.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProgramError {
    /// The profile has no such program.
    #[error("profile {profile}: found program \"{name}\", expected one of {}", known.join(", "))]
    Unknown {
        /// Name of the profile.
        profile: String,
        /// Name asked for.
        name: String,
        /// Names of its programs.
        known: Vec<String>,
    },
    /// An argument is missing, unknown or out of range.
    #[error("program {program}, argument {argument}: found {found}, expected {expected}")]
    Argument {
        /// Name of the program.
        program: String,
        /// Name of the argument.
        argument: String,
        /// Value found, in words.
        found: String,
        /// Range.
        expected: String,
    },
}

impl Profile {
    /// Checks what no single key shows: each step is a command or a query, every placeholder is an argument.
    ///
    /// # Errors
    /// Fails with the first fault.
    pub fn check(&self) -> Result<(), ProfileFault> {
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
                let place = format!("{{{argument}}}");
                if !program.steps.iter().any(|it| it.text().contains(&place)) {
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
        let wrong = |argument: &str, found: String, expected: String| ProgramError::Argument {
            program: name.to_owned(),
            argument: argument.to_owned(),
            found,
            expected,
        };
        if let Some((other, value)) = arguments
            .iter()
            .find(|it| !program.argument.contains_key(it.0))
        {
            return Err(wrong(
                other,
                value.to_string(),
                "no such argument".to_owned(),
            ));
        }
        let mut filled = Vec::new();
        for (argument, Bounds { low, high }) in &program.argument {
            let value = arguments.iter().find(|it| it.0 == argument).map(|it| it.1);
            let good = value.filter(|it| (*low..=*high).contains(it));
            let found = || value.map_or_else(|| "nothing".to_owned(), |it| it.to_string());
            let expected = || format!("a number from {low} to {high}");
            let good = good.ok_or_else(|| wrong(argument, found(), expected()))?;
            filled.push((format!("{{{argument}}}"), good.to_string()));
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

impl StepText {
    fn text(&self) -> &str {
        let text = self.send.as_ref().or(self.ask.as_ref());
        text.map_or("", String::as_str)
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
        filled.iter().fold(text.to_owned(), |text, (place, value)| {
            text.replace(place, value)
        })
    };
    let step = |it: &StepText| match &it.ask {
        None => Step::Send(fill(it.text())),
        Some(command) => Step::Ask {
            command: fill(command),
            form: it.form(),
            limit: it.timeout_ms.map(Span::ms),
            expect: it.expect.clone(),
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
    for (number, step) in steps.iter().enumerate() {
        check_step(step, arguments).map_err(|(name, found, expected)| {
            let place = if name.is_empty() {
                String::new()
            } else {
                format!(".{name}")
            };
            ProfileFault {
                key: format!("{key}.{number}{place}"),
                found,
                expected,
            }
        })?;
    }
    Ok(())
}

type StepFault = (&'static str, String, &'static str);

fn check_step(step: &StepText, arguments: &BTreeMap<String, Bounds>) -> Result<(), StepFault> {
    let quoted = |text: &str| format!("{text:?}");
    let text = step.text();
    let name = if step.ask.is_some() { "ask" } else { "send" };
    if step.send.is_some() == step.ask.is_some() {
        let found = if step.ask.is_some() {
            "both send and ask"
        } else {
            "neither send nor ask"
        };
        return Err(("", found.to_owned(), "one of send and ask"));
    }
    if !text.bytes().all(|it| (0x20..0x7F).contains(&it)) {
        return Err((name, quoted(text), "printable ASCII characters"));
    }
    let queries = text.matches('?').count();
    if step.ask.is_some() && (queries == 0 || text.contains(';')) {
        return Err((name, quoted(text), "one query with ?, without ;"));
    }
    if step.send.is_some() && queries > 0 {
        return Err((
            name,
            quoted(text),
            "a command without reply; a query is an `ask`",
        ));
    }
    let asks_only = step.reply.is_some() || step.expect.is_some() || step.timeout_ms.is_some();
    if step.send.is_some() && (asks_only || step.most_bytes.is_some()) {
        return Err((
            name,
            quoted(text),
            "no reply, expect, timeout_ms or most_bytes beside send",
        ));
    }
    if step.ask.is_some() && step.reply.is_some() == step.expect.is_some() {
        return Err((name, quoted(text), "one of reply and expect beside it"));
    }
    let is_block = step.reply == Some(ReplyForm::Block);
    if is_block != step.most_bytes.is_some() {
        return Err((
            "",
            "no match".to_owned(),
            "most_bytes beside reply = \"block\" and nowhere else",
        ));
    }
    match unknown_place(text, arguments) {
        Some(place) => Err((name, quoted(place), "the name of an argument in braces")),
        None => Ok(()),
    }
}

/// Returns the first placeholder that is no argument.
fn unknown_place<'a>(text: &'a str, arguments: &BTreeMap<String, Bounds>) -> Option<&'a str> {
    let mut opened = text.split('{').skip(1);
    opened.find_map(|rest| match rest.split_once('}') {
        Some((name, _)) if arguments.contains_key(name) => None,
        Some((name, _)) => Some(name),
        None => Some(rest),
    })
}
