//! The code that adds the first engineer.

use super::error::Result;
use super::password;
use data_encoding::BASE32;
use std::fmt;

/// Random bytes of a code. 40 bits suffice, because the register checks at most five wrong codes in five minutes.
const BYTES: usize = 5;

/// A code of eight letters and digits that the program prints while there is no engineer, and keeps in memory only.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetupCode(String);

impl SetupCode {
    /// Draws a code. Fails when the random source of the system fails.
    pub(super) fn draw() -> Result<Self> {
        Ok(Self(BASE32.encode(&password::random(BYTES)?)))
    }

    /// Returns true when `typed` is the code; hyphens, blanks and case do not count.
    pub(crate) fn fits(&self, typed: &str) -> bool {
        let signs = typed.chars().filter(char::is_ascii_alphanumeric);
        signs.map(|it| it.to_ascii_uppercase()).eq(self.0.chars())
    }
}

impl fmt::Display for SetupCode {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (front, back) = self.0.split_at(self.0.len() / 2);
        write!(out, "{front}-{back}")
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_code_fits_as_printed_and_as_people_type_it() {
        let code = SetupCode::draw().unwrap();
        let printed = code.to_string();
        assert_eq!(printed.len(), 9, "{printed}");
        for typed in [
            printed.clone(),
            printed.to_lowercase(),
            printed.replace('-', " "),
        ] {
            assert!(code.fits(&typed), "{typed}");
        }
        assert!(!code.fits("") && !code.fits(&printed[1..]) && !code.fits(&(printed + "2")));
        assert_ne!(code, SetupCode::draw().unwrap());
    }
}
