//! Collects the stationary pieces whose boxes the mover meets, and returns them in the order in which it meets the
//! boxes. A piece that lies in several cells of the grid appears once per cell.

use super::space::LANES;

/// Greatest number of candidates kept. When there are more, some are checked out of order, which costs time but changes
/// no answer.
const MOST: usize = 32;

/// The candidates found so far, at most [`MOST`].
#[derive(Debug, Clone)]
pub(crate) struct Candidates {
    /// High half: fraction of the path before which the mover does not meet the piece, as bits of an f32 (never
    /// negative, so the bits sort like numbers). Low half: [`Place`] of the piece.
    keys: [u64; MOST],
    count: usize,
}

/// Place of a candidate: number of its bundle ([`LANES`] pieces that are tested together), and its lane in the bundle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place(u32);

impl Place {
    pub(crate) fn bundle(self) -> u32 {
        self.0 / LANES as u32
    }

    pub(crate) fn lane(self) -> usize {
        self.0 as usize % LANES
    }
}

impl Candidates {
    pub(crate) const NONE: Candidates = Candidates {
        keys: [0; MOST],
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
    pub(crate) fn push(&mut self, bundle: u32, lanes: u32, entry: &[f32; LANES]) {
        let place = u64::from(bundle * LANES as u32);
        let mut left = lanes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let key = u64::from(entry[lane].to_bits()) << 32 | (place + lane as u64);
            self.keys[self.count % MOST] = key;
            self.count += 1;
        }
    }

    /// Removes and returns the candidate met earliest; when the mover meets even this one after `until`, drops all
    /// candidates and returns `None`.
    #[inline]
    pub(crate) fn earliest(&mut self, until: f64) -> Option<Place> {
        let known = &mut self.keys[..self.count.min(MOST)];
        let mut first = 0;
        let mut least = *known.first()?;
        for (at, key) in known.iter().enumerate() {
            if *key < least {
                (first, least) = (at, *key);
            }
        }
        if f64::from(f32::from_bits((least >> 32) as u32)) > until {
            self.count = 0;
            return None;
        }
        known[first] = *known.last()?;
        self.count -= 1;
        Some(Place(least as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_come_in_order_of_entry_up_to_until() {
        let mut candidates = Candidates::NONE;
        candidates.push(
            3,
            0b0101_1111,
            &[0.5, 0.0, 1e-30, 0.75, 0.25, 0.0, 0.3, 0.0],
        );
        candidates.push(9, 0b1000_0000, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.4]);
        let places = std::iter::from_fn(|| candidates.earliest(0.5));
        let places: Vec<_> = places.map(|place| (place.bundle(), place.lane())).collect();
        assert_eq!(places, [(3, 1), (3, 2), (3, 4), (3, 6), (9, 7), (3, 0)]);
        assert_eq!(candidates.earliest(1.0), None);
    }
}
