//! What a lot may be called: text that a person can read back from a screen, a sheet and a terminal.

/// Longest name, characters; the schema refuses longer ones, too.
const LONGEST: usize = 200;

/// What [`is_lot_name`] expects, for a message.
pub const LOT_NAME: &str =
    "1 to 200 characters, none of them a control character, and not blanks alone";

/// Whether a new lot may have this name. Lots of earlier versions keep theirs.
pub fn is_lot_name(name: &str) -> bool {
    !name.trim().is_empty()
        && name.chars().count() <= LONGEST
        && !name.chars().any(char::is_control)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lot_has_a_name_that_a_person_can_read_back() {
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
