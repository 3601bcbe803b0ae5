//! Collects the stationary pieces whose boxes the mover meets, and returns them in the order in which it meets the
//! boxes. A piece that lies in several cells of the grid appears once per cell.

use super::space::{Bundle, LANES, Onset};

/// Greatest number of candidates kept. When there are more, some are checked out of order, which costs time but changes
/// no answer.
const MOST: usize = 32;

/// The candidates found so far, at most [`MOST`].
#[derive(Debug, Clone)]
pub(crate) struct Candidates {
    /// High half: fraction of the path before which the mover does not meet the piece, as bits of an f32 (never
    /// negative, so the bits sort like numbers). Low half: number of the piece. Places that are not in use hold
    /// [`FREE`].
    keys: [u64; MOST],
    /// Number of places used since the candidates were last empty, the first ones.
    count: usize,
}

/// Key of a place that is not in use, beyond every other key.
const FREE: u64 = u64::MAX;
/// Number of keys that are compared without a branch between them.
const BLOCK: usize = 4;

impl Candidates {
    pub(crate) const NONE: Candidates = Candidates {
        keys: [FREE; MOST],
        count: 0,
    };

    /// Returns true when there is no room for all pieces of another bundle.
    #[inline]
    pub(crate) fn is_full(&self) -> bool {
        self.count > MOST - LANES
    }

    /// Adds the lanes of a bundle that `lanes` marks, usually one or two. The caller ensures that there is room
    /// ([`Self::is_full`]).
    #[inline]
    pub(crate) fn push(&mut self, bundle: &Bundle, lanes: u32, onset: &Onset) {
        let mut left = lanes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            self.add(bundle.entry(lane, onset), bundle.piece(lane));
        }
    }

    #[inline]
    fn add(&mut self, entry: f32, piece: u32) {
        self.keys[self.count % MOST] = u64::from(entry.to_bits()) << 32 | u64::from(piece);
        self.count += 1;
    }

    /// Removes and returns the candidate met earliest; when the mover meets even this one after `until`, drops all
    /// candidates and returns `None`.
    ///
    /// Compares whole blocks and removes all keys that are equal, those of one piece in several cells, because the
    /// number of candidates and the place of the least key are unpredictable.
    #[inline]
    pub(crate) fn earliest(&mut self, until: f64) -> Option<u32> {
        if self.count == 0 {
            return None;
        }
        let used = self.count.min(MOST).div_ceil(BLOCK);
        let blocks = &mut self.keys.as_chunks_mut::<BLOCK>().0[..used];
        let least_of = |block: &[u64; BLOCK]| block.iter().copied().fold(FREE, u64::min);
        let least = blocks.iter().map(least_of).fold(FREE, u64::min);
        // The entry of a free place is not a number, so it never counts.
        let counts = f64::from(f32::from_bits((least >> 32) as u32)) <= until;
        if !counts {
            blocks.fill([FREE; BLOCK]);
            self.count = 0;
            return None;
        }
        for key in blocks.iter_mut().flatten() {
            *key |= if *key == least { FREE } else { 0 };
        }
        Some(least as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_come_in_order_of_entry_up_to_until() {
        let mut candidates = Candidates::NONE;
        // Piece 3 lies in two cells.
        for (entry, piece) in [
            (0.5, 3),
            (0.5, 3),
            (0.0, 8),
            (1e-30, 1),
            (0.75, 2),
            (0.25, 5),
            (0.4, 9),
        ] {
            candidates.add(entry, piece);
        }
        let pieces: Vec<u32> = std::iter::from_fn(|| candidates.earliest(0.5)).collect();
        assert_eq!(pieces, [8, 1, 5, 9, 3]);
        assert_eq!(candidates.earliest(1.0), None);
    }
}
