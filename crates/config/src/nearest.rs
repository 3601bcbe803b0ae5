//! The known word nearest to a mistyped one.

/// The nearest of `known`, when at most a third of the word (at least two letters) was mistyped.
pub fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let reach = (word.chars().count() / 3).max(2);
    known
        .iter()
        .map(|candidate| (distance(word, candidate), *candidate))
        .filter(|(steps, _)| *steps <= reach)
        .min_by_key(|(steps, _)| *steps)
        .map(|(_, candidate)| candidate)
}

/// Least number of letters inserted, removed or replaced that turns one word into the other.
fn distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, letter) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, other) in to.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[to.len()]
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
