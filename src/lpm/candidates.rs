//! Standing pieces whose boxes the mover meets, the earliest first.

/// Pieces that are kept at a time; with more, some are judged out of turn, which costs time and
/// nothing else.
const MOST: usize = 16;

/// A few candidates.
#[derive(Debug, Clone)]
pub(crate) struct Candidates {
    /// Fraction of the way before which it is not met, whose bits are in order because it is not
    /// below zero, and then the number of the piece.
    keys: [u64; MOST],
    count: usize,
    /// The one that came last: a piece may have been added for several cells.
    last: u64,
}

impl Candidates {
    pub(crate) const NONE: Candidates = Candidates {
        keys: [0; MOST],
        count: 0,
        last: u64::MAX,
    };

    #[inline]
    pub(crate) fn is_full(&self) -> bool {
        self.count == MOST
    }

    /// Adds a piece, where there is room.
    #[inline]
    pub(crate) fn push(&mut self, entry: f32, piece: u32) {
        self.keys[self.count] = u64::from(entry.to_bits()) << 32 | u64::from(piece);
        self.count += 1;
    }

    /// Takes the earliest one out, each once; of those after `until` none is left.
    #[inline]
    pub(crate) fn earliest(&mut self, until: f64) -> Option<u32> {
        while self.count > 0 {
            let mut first = 0;
            for at in 1..self.count {
                if self.keys[at] < self.keys[first] {
                    first = at;
                }
            }
            let key = self.keys[first];
            if f64::from(f32::from_bits((key >> 32) as u32)) > until {
                self.count = 0;
                return None;
            }
            self.count -= 1;
            self.keys[first] = self.keys[self.count];
            if key != self.last {
                self.last = key;
                return Some(key as u32);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_come_in_the_order_of_their_entries_as_long_as_they_matter() {
        let mut candidates = Candidates::NONE;
        for (element, entry) in [0.5, 0.0, 1e-30, 0.75, 0.25].into_iter().enumerate() {
            candidates.push(entry, element as u32);
            candidates.push(entry, element as u32);
        }
        let pieces = std::iter::from_fn(|| candidates.earliest(0.5));
        assert_eq!(pieces.collect::<Vec<_>>(), [1, 2, 4, 0]);
        assert_eq!(candidates.earliest(1.0), None);
    }
}
