//! Failures of SCPI instruments as messages of the catalogue.

use scpi::Failure;
use texts::Message;

/// Returns the message of a failure: family `instrument`, and its code.
///
/// Argument `said` is what the instrument or the system reported, in English; only some failures have it. Programs that
/// read JSON expect this text as `detail`, so the message holds it under both names.
pub fn message(failure: &Failure) -> Message {
    let message = bus::instrument::message(failure);
    match message.args().get("said").map(str::to_owned) {
        Some(said) => message.with("detail", said),
        None => message,
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
        let short: Vec<String> = texts::plain().map(|it| it.id.to_owned()).collect();
        for code in codes {
            assert!(short.contains(&format!("failure-{code}")), "{code}");
        }
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
