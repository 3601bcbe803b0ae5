//! The date on which a laboratory issued a certificate.

/// Microseconds of a day.
const DAY_US: i64 = 86_400_000_000;
/// Days from 1 March of year 0 to 1 January 1970.
const DAYS_TO_1970: i64 = 719_468;

/// Returns the begin of a date such as `2026-01-15` in UTC, microseconds since 1970; `None` for other text.
pub fn begin_us(date: &str) -> Option<i64> {
    let mut parts = date.split('-');
    let [year, month, day] = [4, 2, 2].map(|digits| number(parts.next(), digits));
    let (year, month, day) = (year?, month?, day?);
    let fits = (1..=days_in(year, month)).contains(&day);
    (fits && parts.next().is_none()).then(|| days_since_1970(year, month, day) * DAY_US)
}

fn number(text: Option<&str>, digits: usize) -> Option<i64> {
    let fits = |it: &&str| it.len() == digits && it.bytes().all(|it| it.is_ascii_digit());
    text.filter(fits)?.parse().ok()
}

/// Returns the number of days of a month; 0 for a month that no year has.
fn days_in(year: i64, month: i64) -> i64 {
    let is_leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    let days = [
        31,
        28 + i64::from(is_leap),
        31,
        30,
        31,
        30,
        31,
        31,
        30,
        31,
        30,
        31,
    ];
    let place = usize::try_from(month - 1).ok();
    place.and_then(|it| days.get(it).copied()).unwrap_or(0)
}

/// Counts years from March, so that a leap day ends its year.
fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    let year = year - i64::from(month <= 2);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    365 * year + year / 4 - year / 100 + year / 400 + of_year - DAYS_TO_1970
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_count_from_1970() {
        for (date, seconds) in [
            ("1970-01-01", 0),
            ("2000-02-29", 951_782_400),
            ("2024-12-31", 1_735_603_200),
            ("2026-11-02", 1_793_577_600),
        ] {
            assert_eq!(begin_us(date), Some(seconds * 1_000_000), "{date}");
        }
    }

    #[test]
    fn other_text_is_no_date() {
        for text in [
            "",
            "2026",
            "2026-1-2",
            "2026-13-01",
            "2025-02-29",
            "2026-04-31",
            "2026-01-15-",
            "+026-01-15",
        ] {
            assert_eq!(begin_us(text), None, "{text}");
        }
    }
}
