//! Rule for the name of a lot: a person must be able to read it on a screen, on paper and in a terminal.

/// Length of the longest allowed name, characters; the schema has the same limit.
const LONGEST: usize = 200;

/// The rule of [`is_lot_name`] in words.
pub const LOT_NAME: &str =
    "1 to 200 characters, none of them a control character, and not blanks alone";

/// Returns true when a new lot may have this name. Lots that exist already keep their names.
pub fn is_lot_name(name: &str) -> bool {
    !name.trim().is_empty()
        && name.chars().count() <= LONGEST
        && !name.chars().any(char::is_control)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blank_long_and_control_names_are_refused() {
        let good = ["A", "批次 7 'b' \"c\" <d>", &"批".repeat(LONGEST)];
        assert!(good.into_iter().all(is_lot_name));
        let bad = [
            "",
            "  ",
            "a\nb",
            "a\tb",
            "\u{1b}[31m",
            &"x".repeat(LONGEST + 1),
        ];
        assert!(!bad.into_iter().any(is_lot_name));
    }
}
