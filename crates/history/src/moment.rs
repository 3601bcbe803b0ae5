//! Instants: microseconds since 1970 UTC inside the program, RFC 3339 in input and output.

use jiff::Timestamp;
use jiff::fmt::temporal::Pieces;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::fmt;
use std::str::FromStr;

/// Microseconds since 1970-01-01 UTC; shown as RFC 3339 with six decimals of a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment(pub i64);

/// Error: a text is not an RFC 3339 time with offset.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{found:?} is no RFC 3339 time: expected for example 2026-03-01T08:00:00+08:00")]
pub struct MomentError {
    /// The text found.
    pub found: String,
}

impl FromStr for Moment {
    type Err = MomentError;
    fn from_str(text: &str) -> std::result::Result<Self, MomentError> {
        let text = text.trim();
        let at = text.parse::<Timestamp>().ok().or_else(|| never(text));
        let missing = || MomentError {
            found: text.to_owned(),
        };
        at.map(|at| Self(at.as_microsecond())).ok_or_else(missing)
    }
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
        assert!("9999-12-31".parse::<Moment>().is_err());
        assert!("9999-13-31T23:59:59Z".parse::<Moment>().is_err());
    }

    #[test]
    fn a_date_without_a_time_is_refused_by_name() {
        let refusal = "2026-03-01".parse::<Moment>().unwrap_err();
        assert!(
            refusal
                .to_string()
                .contains("\"2026-03-01\" is no RFC 3339 time")
        );
    }
}
