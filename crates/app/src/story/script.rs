//! What a script says, read from its text.
//!
//! ```text
//! # The door is opened while a part is under test.
//! parts 4
//! fault jam_pusher=2
//!
//! after judged 2 +0.5         fault door
//! after state Aborted +5      order clear
//! after state Stopped         order jog motion=probes_up
//! ```
//! The first comment is the title. Lines that begin with `after` are played one after the other.

use anyhow::{Context, bail};
use machine::station::packml::State;
use machine::view::{ORDERS, Order};
use units::Span;

/// Parts of a lot whose script does not say.
const PARTS: u64 = 4;
/// Longest time after an event, seconds.
const LONGEST_S: f64 = 3600.0;

/// A script.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    /// What it is about.
    pub title: String,
    /// Parts of the lot.
    pub parts: u64,
    /// Faults from the start.
    pub faults: Vec<String>,
    /// What is done, in this order.
    pub lines: Vec<Line>,
}

/// One thing that is done.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// What it waits for.
    pub event: Awaited,
    /// And then for so long.
    pub after: Span,
    /// What it does.
    pub deed: Deed,
}

/// What a line waits for; all of them go on being so once they were, but a state.
#[derive(Debug, Clone, PartialEq)]
pub enum Awaited {
    /// The lot itself has begun.
    Lot,
    /// The outer machine is in this state.
    State(State),
    /// An alarm of this code has come.
    Alarm(String),
    /// This part of the lot was judged.
    Judged(u64),
    /// It has left the nest.
    Left(u64),
    /// The beam of its bin has seen it.
    Landed(u64),
}

/// What a line does.
#[derive(Debug, Clone, PartialEq)]
pub enum Deed {
    /// A fault strikes the rig.
    Fault(String),
    /// A person at the screen orders something; as written, and as the cycle takes it.
    Order(String, Box<Order>),
}

/// Reads a script.
///
/// # Errors
/// The first line that is none, with its number.
pub fn parse(text: &str) -> anyhow::Result<Script> {
    let title = text.lines().find_map(|line| line.strip_prefix('#'));
    let mut script = Script {
        title: title.unwrap_or_default().trim().to_owned(),
        parts: PARTS,
        faults: Vec::new(),
        lines: Vec::new(),
    };
    for (number, text) in (1..).zip(text.lines()) {
        let text = text.split('#').next().unwrap_or_default().trim();
        if !text.is_empty() {
            add(&mut script, text).with_context(|| format!("line {number}"))?;
        }
    }
    Ok(script)
}

fn add(script: &mut Script, text: &str) -> anyhow::Result<()> {
    let words: Vec<&str> = text.split_whitespace().collect();
    match words[..] {
        ["parts", count] => script.parts = number(count)?,
        ["fault", fault] => script.faults.push(fault.to_owned()),
        ["after", ref rest @ ..] => script.lines.push(line(rest)?),
        _ => bail!("found {text:?}, expected parts N, fault NAME[=VALUE] or after EVENT DEED"),
    }
    Ok(())
}

fn line(words: &[&str]) -> anyhow::Result<Line> {
    let (event, rest) = match *words {
        ["lot", ref rest @ ..] => (Awaited::Lot, rest),
        ["state", name, ref rest @ ..] => (Awaited::State(state(name)?), rest),
        ["alarm", code, ref rest @ ..] => (Awaited::Alarm(code.to_owned()), rest),
        ["judged", part, ref rest @ ..] => (Awaited::Judged(number(part)?), rest),
        ["left", part, ref rest @ ..] => (Awaited::Left(number(part)?), rest),
        ["landed", part, ref rest @ ..] => (Awaited::Landed(number(part)?), rest),
        _ => bail!(
            "found {:?}, expected lot, state NAME, alarm CODE, judged N, left N or landed N",
            words.join(" ")
        ),
    };
    let (after, rest) = match rest {
        [first, rest @ ..] if first.starts_with('+') => (seconds(first)?, rest),
        rest => (Span(0), rest),
    };
    let deed = match *rest {
        ["fault", fault] => Deed::Fault(fault.to_owned()),
        ["order", ref words @ ..] if !words.is_empty() => {
            Deed::Order(words.join(" "), Box::new(order(words)?))
        }
        _ => bail!(
            "found {:?}, expected fault NAME[=VALUE] or order WORD",
            rest.join(" ")
        ),
    };
    Ok(Line { event, after, deed })
}

fn number(text: &str) -> anyhow::Result<u64> {
    match text.parse() {
        Ok(number) if number > 0 => Ok(number),
        Ok(_) | Err(_) => bail!("found {text:?}, expected a number of parts from 1"),
    }
}

fn state(name: &str) -> anyhow::Result<State> {
    State::from_name(name).with_context(|| {
        let known: Vec<&str> = State::ALL.iter().map(|state| state.name()).collect();
        format!("found {name:?}, expected one of {}", known.join(", "))
    })
}

fn seconds(text: &str) -> anyhow::Result<Span> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=LONGEST_S).contains(&seconds) => Ok(Span::seconds(seconds)),
        Ok(_) | Err(_) => bail!("found {text:?}, expected +SECONDS, 0 to {LONGEST_S}"),
    }
}

/// What the cycle does not know is refused there, as a screen's order would be.
fn order(words: &[&str]) -> anyhow::Result<Order> {
    let Some((word, members)) = words
        .split_first()
        .filter(|(word, _)| ORDERS.contains(word))
    else {
        bail!(
            "found {:?}, expected one of {}",
            words.join(" "),
            ORDERS.join(", ")
        );
    };
    let mut order = Order {
        order: (*word).to_owned(),
        ..Order::default()
    };
    for member in members {
        match member.split_once('=') {
            Some(("motion", value)) => order.motion = Some(value.to_owned()),
            Some(("mode", value)) => order.mode = Some(value.to_owned()),
            Some(("alarm", value)) => order.alarm = Some(value.to_owned()),
            Some((..)) | None => bail!("found {member:?}, expected motion=, mode= or alarm="),
        }
    }
    Ok(order)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_script_is_a_title_a_lot_faults_and_what_is_done_after_what() {
        let text = "# By hand.\nparts 2\nfault fall=1\n\nafter judged 1 +1.5 fault door # now\n\
                    after state Idle order jog motion=pusher_extend\n";
        let script = parse(text).unwrap();
        assert_eq!((script.title.as_str(), script.parts), ("By hand.", 2));
        assert_eq!(script.faults, ["fall=1"]);
        let [door, jog] = &script.lines[..] else {
            panic!("{:?}", script.lines)
        };
        assert_eq!(
            (&door.event, door.after, &door.deed),
            (
                &Awaited::Judged(1),
                Span::ms(1500),
                &Deed::Fault("door".into())
            )
        );
        let Deed::Order(words, order) = &jog.deed else {
            panic!("{jog:?}")
        };
        assert_eq!(
            (jog.event.clone(), words.as_str()),
            (Awaited::State(State::Idle), "jog motion=pusher_extend")
        );
        assert_eq!(order.motion.as_deref(), Some("pusher_extend"));
    }

    #[test]
    fn what_is_no_line_is_refused_with_its_number_and_what_was_expected() {
        for (text, expected) in [
            (
                "parts 1\nparts none",
                "line 2: found \"none\", expected a number of parts from 1",
            ),
            (
                "run",
                "expected parts N, fault NAME[=VALUE] or after EVENT DEED",
            ),
            (
                "after state Running order stop",
                "found \"Running\", expected one of Stopped",
            ),
            ("after dawn order stop", "expected lot, state NAME"),
            ("after lot +soon order stop", "expected +SECONDS"),
            (
                "after lot order fly",
                "found \"fly\", expected one of reset",
            ),
            (
                "after lot order jog pusher",
                "expected motion=, mode= or alarm=",
            ),
            (
                "after lot sleep",
                "expected fault NAME[=VALUE] or order WORD",
            ),
        ] {
            let found = format!("{:#}", parse(text).unwrap_err());
            assert!(found.contains(expected), "{text}: {found}");
        }
    }
}
