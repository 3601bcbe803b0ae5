//! Parses the script of a story.
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
//! The first comment is the title. The player carries out the lines that begin with `after` one after the other.

use anyhow::{Context, bail};
use machine::station::packml::State;
use machine::view::Order;
use units::Span;

/// Number of parts in a lot when the script does not give one.
const PARTS: u64 = 4;
/// Longest delay after an event, seconds.
const LONGEST_S: f64 = 3600.0;

/// A parsed script.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    /// Title, from the first comment.
    pub title: String,
    /// Number of parts in the lot.
    pub parts: u64,
    /// Faults active from the start.
    pub faults: Vec<String>,
    /// Steps, in order.
    pub steps: Vec<Step>,
}

/// A step: an event, a delay and an action.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Event that triggers the step.
    pub event: Awaited,
    /// Delay after the event.
    pub after: Span,
    /// Action of the step.
    pub action: Action,
}

/// Event that triggers a step. A past event triggers the step at once, but a state only while the machine is in it.
#[derive(Debug, Clone, PartialEq)]
pub enum Awaited {
    /// The lot has begun, after calibration and reference parts.
    Lot,
    /// The machine as a whole is in this PackML state.
    State(State),
    /// An alarm with this code has been raised.
    Alarm(String),
    /// The part of the lot with this number has its verdict.
    Judged(u64),
    /// The part of the lot with this number has left the nest.
    Left(u64),
    /// The beam of a bin has seen the part of the lot with this number.
    Landed(u64),
}

/// Action of a step.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// A fault of the simulated rig, `NAME[=VALUE]`.
    Fault(String),
    /// An order of a person at the screen: words as written, and the parsed order.
    Order(String, Box<Order>),
}

/// Parses a script.
///
/// # Errors
/// Fails on the first invalid line; the error names its number.
pub fn parse(text: &str) -> anyhow::Result<Script> {
    let title = text.lines().find_map(|line| line.strip_prefix('#'));
    let mut script = Script {
        title: title.unwrap_or_default().trim().to_owned(),
        parts: PARTS,
        faults: Vec::new(),
        steps: Vec::new(),
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
        ["after", ref rest @ ..] => script.steps.push(step(rest)?),
        _ => bail!("found {text:?}, expected parts N, fault NAME[=VALUE] or after EVENT ACTION"),
    }
    Ok(())
}

fn step(words: &[&str]) -> anyhow::Result<Step> {
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
    let action = match *rest {
        ["fault", fault] => Action::Fault(fault.to_owned()),
        ["order", ref words @ ..] if !words.is_empty() => {
            Action::Order(words.join(" "), Box::new(order(words)?))
        }
        _ => bail!(
            "found {:?}, expected fault NAME[=VALUE] or order WORD",
            rest.join(" ")
        ),
    };
    Ok(Step {
        event,
        after,
        action,
    })
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

/// Parses an order, `WORD [MEMBER=VALUE]...`; refuses unknown members, as the page does. A value that is valid JSON,
/// such as a number, is read as JSON, any other value as text; `lot="7"` is the text 7.
fn order(words: &[&str]) -> anyhow::Result<Order> {
    let (word, members) = words.split_first().context("found no order")?;
    let mut json = serde_json::json!({ "order": word });
    for member in members {
        let Some((name, value)) = member.split_once('=') else {
            bail!("found {member:?}, expected MEMBER=VALUE");
        };
        let value = serde_json::from_str(value).unwrap_or_else(|_| (*value).into());
        json[name] = value;
    }
    Ok(config::strict::from_slice(json.to_string().as_bytes())?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_script_parses_into_title_parts_faults_and_steps() {
        let text = "# By hand.\nparts 2\nfault fall=1\n\nafter judged 1 +1.5 fault door # now\n\
                    after state Idle order jog motion=pusher_extend\n";
        let script = parse(text).unwrap();
        assert_eq!((script.title.as_str(), script.parts), ("By hand.", 2));
        assert_eq!(script.faults, ["fall=1"]);
        let [door, jog] = &script.steps[..] else {
            panic!("{:?}", script.steps)
        };
        assert_eq!(
            (&door.event, door.after, &door.action),
            (
                &Awaited::Judged(1),
                Span::ms(1500),
                &Action::Fault("door".into())
            )
        );
        let Action::Order(words, order) = &jog.action else {
            panic!("{jog:?}")
        };
        assert_eq!(
            (jog.event.clone(), words.as_str()),
            (Awaited::State(State::Idle), "jog motion=pusher_extend")
        );
        let motion = machine::handling::Move::PusherExtend;
        assert_eq!(**order, Order::Jog { motion });
    }

    #[test]
    fn a_member_of_an_order_may_be_a_number() {
        let words = ["start", "lot=\"7\"", "recipe=jzc-22f-012", "count=3"];
        let expected = Order::Start {
            lot: Some("7".into()),
            recipe: Some("jzc-22f-012".into()),
            count: Some(3),
            retest: None,
        };
        assert_eq!(order(&words).unwrap(), expected);
    }

    #[test]
    fn an_invalid_line_is_named_with_what_is_expected() {
        for (text, expected) in [
            (
                "parts 1\nparts none",
                "line 2: found \"none\", expected a number of parts from 1",
            ),
            (
                "run",
                "expected parts N, fault NAME[=VALUE] or after EVENT ACTION",
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
            ("after lot order jog pusher", "expected MEMBER=VALUE"),
            (
                "after lot order jog mtion=pusher_extend",
                "mtion: found an unknown member, expected \"motion\"?",
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
