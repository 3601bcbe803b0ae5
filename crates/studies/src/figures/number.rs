//! Numbers for people: three significant digits, or more where rounding would move a value across its bar.

use crate::figure::{Bar, shown};

/// Significant digits of a value.
const DIGITS: usize = 3;
/// Significant digits with which a bar is printed; a value is printed with no more.
const MOST: usize = 6;
/// Decimal exponent below which a number appears in scientific notation.
const SMALL: i32 = -5;

/// Formats a value so that the rounded value meets its bar if and only if the value does.
pub fn value(value: f64, bar: Option<Bar>) -> String {
    let same_side = |text: &String| {
        let rounded: Option<f64> = text.replace(',', "").parse().ok();
        bar.zip(rounded)
            .is_none_or(|(bar, rounded)| bar.is_met(rounded) == bar.is_met(value))
    };
    let mut texts = (DIGITS..=MOST).map(|digits| number(value, digits));
    texts.find(same_side).unwrap_or_else(|| shown(value))
}

/// Formats a bar in words.
pub fn bar(bar: Bar) -> String {
    let plain = |it: f64| trimmed(&number(it, MOST));
    match bar {
        Bar::AtMost(0.0) => "0".to_owned(),
        Bar::AtMost(high) => format!("at most {}", plain(high)),
        Bar::Below(high) => format!("below {}", plain(high)),
        Bar::AtLeast(low) => format!("at least {}", plain(low)),
        Bar::Within(low, high) => format!("{} to {}", plain(low), plain(high)),
    }
}

/// Formats a count with a comma between groups of three digits.
pub fn count(n: u64) -> String {
    grouped(&n.to_string())
}

/// Formats a number to `digits` significant digits; an integer keeps all of its digits.
fn number(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.fract() == 0.0 && value.abs() < 1e15 {
        return grouped(&format!("{value:.0}"));
    }
    let exponent = value.abs().log10().floor() as i32;
    if exponent < SMALL {
        return format!("{value:.*e}", digits - 1);
    }
    let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
    grouped(&format!("{value:.decimals$}"))
}

/// Removes zeros at the end of the decimals.
fn trimmed(text: &str) -> String {
    let (mantissa, exponent) = text.split_at(text.find('e').unwrap_or(text.len()));
    match mantissa.contains('.') {
        true => format!(
            "{}{exponent}",
            mantissa.trim_end_matches('0').trim_end_matches('.')
        ),
        false => text.to_owned(),
    }
}

/// Puts a comma before every three digits in front of the decimal point.
fn grouped(text: &str) -> String {
    let (whole, decimals) = text.split_at(text.find('.').unwrap_or(text.len()));
    let (sign, digits) = match whole.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None => ("", whole),
    };
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    format!("{sign}{grouped}{decimals}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_three_digits_and_counts_commas() {
        let table = [
            (0.0, "0"),
            (5.2987, "5.30"),
            (1962.34, "1,962"),
            (-1_234_567.0, "-1,234,567"),
            (0.081_37, "0.0814"),
            (2.7e-10, "2.70e-10"),
            (115.04, "115"),
        ];
        for (given, expected) in table {
            assert_eq!(value(given, None), expected);
        }
    }

    #[test]
    fn a_missed_value_does_not_round_to_its_bar() {
        assert_eq!(value(0.850_04, Some(Bar::AtMost(0.85))), "0.85004");
        assert_eq!(value(0.849_96, Some(Bar::AtMost(0.85))), "0.850");
        assert_eq!(value(9.9996, Some(Bar::AtLeast(10.0))), "9.9996");
    }

    #[test]
    fn bars_are_words_without_needless_digits() {
        let table = [
            (Bar::AtMost(0.0), "0"),
            (Bar::AtMost(417.900_000_000_3), "at most 417.9"),
            (Bar::Below(0.5), "below 0.5"),
            (Bar::AtLeast(2000.0), "at least 2,000"),
            (Bar::Within(93.0, 98.0), "93 to 98"),
            (Bar::AtMost(1e-12), "at most 1e-12"),
        ];
        for (given, expected) in table {
            assert_eq!(bar(given), expected);
        }
    }
}
