//! The name of a bin: where a part ends.
//!
//! Bins are data: `[bin]` of `config/rig.toml` says which ones a rig has, a kind of device which ones it needs. The
//! machine itself knows two: one for good parts, one for those that are not judged.

use std::fmt;

/// A bin by its name, 1 to 15 characters of a to z, 0 to 9 and underscore.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Bin {
    /// The name, zeros behind it.
    bytes: [u8; Self::LONGEST],
    length: u8,
}

impl Bin {
    /// Characters of the longest name.
    pub const LONGEST: usize = 15;
    /// Good parts.
    pub const PASS: Self = Self::named("pass");
    /// Parts that are not judged.
    pub const RETEST: Self = Self::named("retest");

    /// The bin of a name that stands in the program.
    ///
    /// # Panics
    /// A name that [`Self::from_name`] refuses, while compiling where it stands in a constant.
    pub const fn named(name: &str) -> Self {
        match Self::from_name(name) {
            Some(bin) => bin,
            None => panic!("the name of a bin has 1 to 15 characters of a-z, 0-9 and _"),
        }
    }

    /// The bin of this name; `None` for a text that cannot name one.
    pub const fn from_name(name: &str) -> Option<Self> {
        let text = name.as_bytes();
        if text.is_empty() || text.len() > Self::LONGEST {
            return None;
        }
        let mut bytes = [0; Self::LONGEST];
        let mut at = 0;
        while at < text.len() {
            if !matches!(text[at], b'a'..=b'z' | b'0'..=b'9' | b'_') {
                return None;
            }
            bytes[at] = text[at];
            at += 1;
        }
        let length = text.len() as u8;
        Some(Self { bytes, length })
    }

    /// The name used in files, rows and messages.
    pub fn name(&self) -> &str {
        let text = std::str::from_utf8(&self.bytes[..usize::from(self.length)]);
        debug_assert!(text.is_ok(), "only ASCII gets into a name");
        text.unwrap_or_default()
    }
}

impl fmt::Debug for Bin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Bin({})", self.name())
    }
}

impl fmt::Display for Bin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::Bin;

    #[test]
    fn a_bin_is_its_name() {
        for name in ["pass", "a", "grade_2", "fifteen_letters"] {
            let bin = Bin::from_name(name);
            assert_eq!(bin.map(|bin| bin.to_string()).as_deref(), Some(name));
        }
        assert_eq!(Bin::from_name("retest"), Some(Bin::RETEST));
        assert_ne!(Bin::PASS, Bin::RETEST);
    }

    #[test]
    fn a_text_that_is_no_name_is_no_bin() {
        for text in ["", "sixteen_letters_", "Pass", "bin 1", "料", "a-b"] {
            assert_eq!(Bin::from_name(text), None, "{text}");
        }
    }
}
