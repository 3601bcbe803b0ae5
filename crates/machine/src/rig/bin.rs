//! The name of a bin: the container in which a part ends up.
//!
//! Bins are data: `[bin]` of `config/rig.toml` lists the bins of a rig, and a kind of device lists the bins it needs.
//! The machine itself needs two: for good parts and for void parts.

use std::fmt;

/// A bin by its name, 1 to 15 characters of a to z, 0 to 9 and underscore.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Bin {
    /// The name, padded with zeros.
    bytes: [u8; Self::LONGEST],
    length: u8,
}

impl Bin {
    /// Characters of the longest name.
    pub const LONGEST: usize = 15;
    /// Bin for good parts.
    pub const PASS: Self = Self::named("pass");
    /// Bin for void parts.
    pub const RETEST: Self = Self::named("retest");

    /// Returns the bin with a constant name.
    ///
    /// # Panics
    /// Panics for a name that [`Self::from_name`] refuses; in a constant that is a compile error.
    pub const fn named(name: &str) -> Self {
        match Self::from_name(name) {
            Some(bin) => bin,
            None => panic!("the name of a bin has 1 to 15 characters of a-z, 0-9 and _"),
        }
    }

    /// Returns the bin with this name; `None` for an invalid name.
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

    /// Returns the name used in files, rows and messages.
    pub fn name(&self) -> &str {
        let text = std::str::from_utf8(&self.bytes[..usize::from(self.length)]);
        debug_assert!(text.is_ok(), "a name is ASCII");
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
