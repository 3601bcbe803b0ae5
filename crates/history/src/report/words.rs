//! Names and figures as printed pages show them.

use machine::dut::{Characteristic, External, Reason};
use texts::{Lang, Message};

/// Returns the name of a parameter with its unit; for an unknown parameter, the key itself.
pub fn parameter(lang: Lang, key: &str) -> String {
    let measured = Characteristic::from_key(key).map(|it| (it.name(lang), it.unit()));
    let external = || External::from_key(key).map(|it| (it.name(lang), it.unit()));
    match measured.or_else(external) {
        Some((name, unit)) => format!("{name} / {}", unit.sign()),
        None => key.to_owned(),
    }
}

/// Returns the text of a reason, with the name of its characteristic if it has one.
pub fn reason(lang: Lang, reason: &Reason) -> String {
    let text = reason.text(lang);
    match reason.characteristic() {
        None => text,
        Some(it) => Message::new("paper", "of_characteristic")
            .with("name", parameter(lang, it.key()))
            .with("text", text)
            .say(lang),
    }
}

/// Joins name and unit with unbreakable spaces, so that they stay on one line.
pub(super) fn unbroken(name: &str) -> String {
    name.replace(" / ", "\u{a0}/\u{a0}")
}

/// Returns the first 16 digits of a hash.
pub(crate) fn short_hash(hash: &str) -> String {
    hash.get(..16).unwrap_or(hash).to_owned()
}

/// Formats a value with five significant digits and without trailing zeros; a dash for `None`.
pub(crate) fn figure(value: Option<f64>) -> String {
    let Some(value) = value.filter(|it| it.is_finite()) else {
        return "–".to_owned();
    };
    let is_plain = value == 0.0 || (-4.0..7.0).contains(&value.abs().log10().floor());
    match is_plain {
        true => significant(value, 5),
        false => format!("{value:.3e}"),
    }
}

/// Returns the number of decimals that show an uncertainty above zero with two significant digits (GUM 7.2.6).
pub(super) fn doubt_decimals(doubt: f64) -> usize {
    (1.0 - doubt.log10().floor()).clamp(0.0, 9.0) as usize
}

/// Formats a value with `digits` significant digits, without trailing zeros or exponent.
pub fn significant(value: f64, digits: u8) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let before = value.abs().log10().floor();
    let decimals = (f64::from(digits) - 1.0 - before).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Formats `part` of `of` as percent with two decimals; a dash when `of` is 0.
pub(super) fn percent(part: u64, of: u64) -> String {
    if of == 0 {
        return "–".to_owned();
    }
    format!("{:.2} %", 100.0 * part as f64 / of as f64)
}

/// Formats seconds as `h:mm:ss`.
pub(super) fn span(seconds: f64) -> String {
    let whole = seconds.round().max(0.0) as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}
