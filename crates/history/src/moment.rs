//! Instants: microseconds since 1970 UTC inside the program, RFC 3339 in files and answers; people may write them
//! shorter.

use jiff::civil::DateTime;
use jiff::fmt::temporal::Pieces;
use jiff::tz::TimeZone;
use jiff::{Span, Timestamp, Zoned};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::fmt;
use std::str::FromStr;
use utoipa::ToSchema;

/// Microseconds since 1970-01-01 UTC; shown as RFC 3339 with six decimals of a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ToSchema)]
#[schema(value_type = String, format = DateTime, example = "2026-11-22T08:00:00Z")]
pub struct Moment(pub i64);

/// Error: a text names no instant.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{found:?} is no time: expected for example 2026-03-01, 2026-03-01T08:00 (local time), today, -8h, or RFC 3339 as 2026-03-01T08:00:00+08:00"
)]
pub struct MomentError {
    /// The text found.
    pub found: String,
}

impl Moment {
    /// Reads RFC 3339 with an offset, as files hold it.
    ///
    /// # Errors
    /// Fails for any other text.
    pub fn exact(text: &str) -> std::result::Result<Self, MomentError> {
        Self::found(text, |text| text.parse().ok().or_else(|| never(text)))
    }

    /// Returns the instant as local time of this computer, in RFC 3339 with six decimals of a second.
    pub fn local(self) -> String {
        let Ok(at) = Timestamp::from_microsecond(self.0) else {
            return self.to_string();
        };
        let offset = TimeZone::system().to_offset(at);
        format!("{:.6}", at.display_with_offset(offset))
    }

    fn found(
        text: &str,
        read: impl Fn(&str) -> Option<Timestamp>,
    ) -> std::result::Result<Self, MomentError> {
        let text = text.trim();
        let missing = || MomentError {
            found: text.to_owned(),
        };
        let at = read(text).ok_or_else(missing)?;
        Ok(Self(at.as_microsecond()))
    }
}

impl FromStr for Moment {
    type Err = MomentError;
    /// Reads an instant as a person writes it: RFC 3339, a local date (its midnight) or time, `now`, `today`,
    /// `yesterday`, or a span before now such as `-8h`, `-30m` or `-2d`.
    fn from_str(text: &str) -> std::result::Result<Self, MomentError> {
        let exact = Self::exact(text);
        exact.or_else(|_| Self::found(text, |text| said(text, &Zoned::now())))
    }
}

fn said(text: &str, now: &Zoned) -> Option<Timestamp> {
    let date = now.date();
    let local = |at: DateTime| at.to_zoned(now.time_zone().clone());
    let at = match text {
        "now" => Ok(now.clone()),
        "today" => local(date.into()),
        "yesterday" => local(date.yesterday().ok()?.into()),
        _ if text.starts_with('-') => now.checked_add(text.parse::<Span>().ok()?),
        _ => local(text.parse().ok()?),
    };
    at.ok().map(|it| it.timestamp())
}

/// Reads any time in the year 9999, which people write to mean "never", as the latest possible instant.
fn never(text: &str) -> Option<Timestamp> {
    let said = Pieces::parse(text).ok()?;
    let is_last_year = said.date().year() == 9999;
    (is_last_year && said.time().is_some() && said.offset().is_some()).then_some(Timestamp::MAX)
}

impl fmt::Display for Moment {
    /// Writes RFC 3339; an instant beyond the year 9999 is written as its number of microseconds.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match Timestamp::from_microsecond(self.0) {
            Ok(at) => write!(f, "{at:.6}"),
            Err(_) => write!(f, "{} us", self.0),
        }
    }
}

impl Serialize for Moment {
    fn serialize<S: Serializer>(&self, out: S) -> std::result::Result<S::Ok, S::Error> {
        out.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Moment {
    fn deserialize<D: Deserializer<'de>>(input: D) -> std::result::Result<Self, D::Error> {
        String::deserialize(input)?
            .parse()
            .map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn an_instant_keeps_its_microsecond_and_loses_its_zone() {
        let moment: Moment = "2026-03-01T08:00:00.000001+08:00".parse().unwrap();
        assert_eq!(moment.to_string(), "2026-03-01T00:00:00.000001Z");
        assert_eq!(moment.to_string().parse(), Ok(moment));
    }

    #[test]
    fn the_last_days_of_the_calendar_mean_never() {
        let never: Moment = "9999-12-31T23:59:59Z".parse().unwrap();
        assert_eq!(never.0, Timestamp::MAX.as_microsecond());
        assert!(Moment::exact("9999-12-31").is_err());
        assert!("9999-13-31T23:59:59Z".parse::<Moment>().is_err());
    }

    #[test]
    fn people_say_local_dates_and_spans() {
        let now: Zoned = "2026-11-22T10:30:00+08:00[Asia/Shanghai]".parse().unwrap();
        for (text, expected) in [
            ("2026-11-21", "2026-11-20T16:00:00Z"),
            ("2026-11-21T08:00", "2026-11-21T00:00:00Z"),
            ("2026-11-21 08:00:30", "2026-11-21T00:00:30Z"),
            ("today", "2026-11-21T16:00:00Z"),
            ("yesterday", "2026-11-20T16:00:00Z"),
            ("now", "2026-11-22T02:30:00Z"),
            ("-8h", "2026-11-21T18:30:00Z"),
            ("-1d12h", "2026-11-20T14:30:00Z"),
        ] {
            assert_eq!(said(text, &now).unwrap().to_string(), expected, "{text}");
        }
        for text in ["8h", "-8", "tomorrow", "2026-13-01", ""] {
            assert_eq!(said(text, &now), None, "{text}");
        }
        assert!(Moment::exact("today").is_err() && "today".parse::<Moment>().is_ok());
    }

    #[test]
    fn a_text_without_a_time_is_refused_by_name() {
        let refusal = "March".parse::<Moment>().unwrap_err().to_string();
        assert!(
            refusal.contains("\"March\" is no time") && refusal.contains("today"),
            "{refusal}"
        );
    }
}
