//! Names of elements, one behind the other in one text: no allocation for each.

/// Where the name of an element stands in [`Names`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Name {
    start: u32,
    length: u32,
}

/// The names of all elements. A name that is no longer wanted leaves a gap; its owners are asked for
/// theirs again when the gaps outweigh the rest ([`Names::is_mostly_gaps`]).
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    text: String,
    gaps: usize,
}

/// Gaps below this are not worth the trouble, bytes.
const SMALL: usize = 4096;

impl Names {
    /// Writes a name down.
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

    /// The name is not wanted any more.
    pub(crate) fn leave(&mut self, name: &Name) {
        self.gaps += name.length as usize;
        // The last one leaves no gap: what is put in and taken out again costs nothing.
        if (name.start + name.length) as usize == self.text.len() {
            self.text.truncate(name.start as usize);
            self.gaps -= name.length as usize;
        }
    }

    /// Whether it is time to write the wanted names into a fresh text.
    pub(crate) fn is_mostly_gaps(&self) -> bool {
        self.gaps > SMALL && 2 * self.gaps > self.text.len()
    }

    /// Heap in use, bytes.
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
            names.leave(&last);
        }
        assert_eq!((names.text.as_str(), names.gaps), ("first", 0));
        names.leave(&first);
        assert_eq!(names.gaps, 0);
    }
}
