//! Names of elements without a heap: most are short.

/// Characters kept in place; a longer name has its own allocation.
const SHORT: usize = 22;

/// Text of an element's name.
#[derive(Debug, Clone)]
pub(crate) enum Name {
    /// UTF-8 in the first `length` bytes.
    Short { length: u8, bytes: [u8; SHORT] },
    /// Longer than [`SHORT`].
    Long(Box<str>),
}

impl Name {
    pub(crate) fn of(text: &str) -> Name {
        let mut bytes = [0; SHORT];
        match bytes.get_mut(..text.len()) {
            Some(place) => {
                place.copy_from_slice(text.as_bytes());
                Name::Short {
                    length: text.len() as u8,
                    bytes,
                }
            }
            None => Name::Long(text.into()),
        }
    }

    pub(crate) fn as_str(&self) -> &str {
        match self {
            Name::Short { length, bytes } => {
                let used = &bytes[..usize::from(*length)];
                std::str::from_utf8(used).expect("copied from a whole text")
            }
            Name::Long(text) => text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_comes_back_as_it_was_given() {
        for length in 0..50 {
            for letter in ["x", "ü", "漢"] {
                let text = letter.repeat(length);
                assert_eq!(Name::of(&text).as_str(), text);
            }
        }
    }
}
