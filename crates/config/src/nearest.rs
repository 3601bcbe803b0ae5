//! Suggests the known word that a misspelt word resembles.

use strsim::levenshtein;

/// Returns the word in `known` that is nearest to `word`; `None` when even that word is more edits away than a third of
/// the characters of `word`, at least 2 edits.
pub fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let reach = (word.chars().count() / 3).max(2);
    known
        .iter()
        .map(|candidate| (levenshtein(word, candidate), *candidate))
        .filter(|(steps, _)| *steps <= reach)
        .min_by_key(|(steps, _)| *steps)
        .map(|(_, candidate)| candidate)
}

/// Returns the suggestion as a message shows it: the nearest word in quotes with a question mark.
pub(super) fn suggestion(near: &str) -> String {
    format!("\"{near}\"?")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_finger_finds_its_word() {
        assert_eq!(
            nearest("adress", &["line", "address", "model"]),
            Some("address")
        );
        assert_eq!(
            nearest(
                "operate_voltage_mv",
                &["operate_time_ms", "operate_voltage_v"]
            ),
            Some("operate_voltage_v")
        );
        assert_eq!(nearest("zebra", &["line", "address"]), None);
    }
}
