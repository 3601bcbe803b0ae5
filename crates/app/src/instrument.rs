//! Failures of SCPI instruments as messages of the catalogue.

use scpi::Failure;
use texts::Message;

/// Returns the message of a failure: family `instrument`, and its code.
pub fn message(failure: &Failure) -> Message {
    let message = Message::new("instrument", failure.code());
    match failure {
        Failure::Timeout { command, limit } => message
            .with("command", command)
            .with("limit_ms", limit.0 / 1000),
        Failure::Disconnected { reason } => message.with("detail", reason),
        Failure::Malformed { command, reason } => {
            message.with("command", command).with("detail", reason)
        }
        Failure::Instrument { code, text } => message.with("number", code).with("detail", text),
        Failure::OverRange { command }
        | Failure::NotANumber { command }
        | Failure::OutOfStep { command } => message.with("command", command),
        Failure::Local { text } => message.with("detail", text),
        Failure::Identity { found, expected } | Failure::AdapterAddress { found, expected } => {
            message.with("found", found).with("expected", expected)
        }
        Failure::ReadBack {
            command,
            found,
            expected,
        } => message
            .with("command", command)
            .with("found", found)
            .with("expected", expected),
        Failure::Overdue { limit } => message.with("limit_ms", limit.0 / 1000),
        Failure::Down { attempts, last } => message.with("attempts", attempts).with("detail", last),
        Failure::QueueOverflow | Failure::PowerCycled | Failure::NeverSilent => message,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scpi::ReplyError;
    use texts::Lang;
    use units::Span;

    #[test]
    fn every_failure_has_a_text_in_both_languages() {
        let command = || "READ?".to_owned();
        let (text, limit) = ("text".to_owned(), Span::ms(5));
        let (found, expected) = ("a".to_owned(), "b".to_owned());
        let all = [
            Failure::Timeout {
                command: command(),
                limit,
            },
            Failure::Disconnected {
                reason: "closed".to_owned(),
            },
            Failure::Malformed {
                command: command(),
                reason: ReplyError::Empty,
            },
            Failure::Instrument {
                code: -113,
                text: text.clone(),
            },
            Failure::QueueOverflow,
            Failure::OverRange { command: command() },
            Failure::NotANumber { command: command() },
            Failure::Local { text },
            Failure::Identity {
                found: found.clone(),
                expected: expected.clone(),
            },
            Failure::PowerCycled,
            Failure::OutOfStep { command: command() },
            Failure::ReadBack {
                command: command(),
                found: found.clone(),
                expected: expected.clone(),
            },
            Failure::AdapterAddress { found, expected },
            Failure::NeverSilent,
            Failure::Overdue { limit },
            Failure::Down {
                attempts: 3,
                last: Box::new(Failure::NeverSilent),
            },
        ];
        let codes: Vec<&str> = all.iter().map(Failure::code).collect();
        assert_eq!(codes, Failure::CODES);
        for failure in &all {
            for lang in Lang::ALL {
                assert!(
                    message(failure).try_say(lang).is_some(),
                    "{failure:?} in {lang:?}"
                );
            }
        }
    }
}
