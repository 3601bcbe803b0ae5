//! Names of elements, stored one after another in one string, so that a name needs no allocation of its own.

/// Place of the name of an element in [`Names`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Name {
    start: u32,
    length: u32,
}

/// Names of all elements. A released name leaves a gap; when the gaps outweigh the names ([`Names::is_mostly_gaps`]),
/// the model rewrites all names.
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    text: String,
    gaps: usize,
}

/// Total length of the gaps, bytes, below which rewriting does not pay.
const SMALL: usize = 4096;

impl Names {
    /// Appends a name.
    #[inline]
    pub(crate) fn keep(&mut self, text: &str) -> Name {
        let start = self.text.len() as u32;
        self.text.push_str(text);
        Name {
            start,
            length: text.len() as u32,
        }
    }

    pub(crate) fn text(&self, name: &Name) -> &str {
        &self.text[name.start as usize..][..name.length as usize]
    }

    /// Releases a name.
    #[inline]
    pub(crate) fn release(&mut self, name: &Name) {
        // The last name leaves no gap, so that inserting and removing one element again and again does not grow the
        // text.
        if (name.start + name.length) as usize == self.text.len() {
            self.text.truncate(name.start as usize);
        } else {
            self.gaps += name.length as usize;
        }
    }

    /// Returns true when the names should be written anew.
    pub(crate) fn is_mostly_gaps(&self) -> bool {
        self.gaps > SMALL && 2 * self.gaps > self.text.len()
    }

    /// Returns the heap in use, bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.text.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_comes_back_as_it_was_given() {
        let mut names = Names::default();
        let texts: Vec<String> = ["", "x", "\u{fc}", "\u{6f22}"]
            .map(|it| it.repeat(30))
            .into();
        let kept: Vec<Name> = texts.iter().map(|text| names.keep(text)).collect();
        for (text, name) in texts.iter().zip(&kept) {
            assert_eq!(names.text(name), text);
        }
    }

    #[test]
    fn the_last_name_leaves_no_gap() {
        let mut names = Names::default();
        let first = names.keep("first");
        for _ in 0..3 {
            let last = names.keep("last");
            names.release(&last);
        }
        assert_eq!((names.text.as_str(), names.gaps), ("first", 0));
        names.release(&first);
        assert_eq!(names.gaps, 0);
    }
}
