//! Silhouettes (`B` in the paper): the extents of each piece in x, y and z, compared eight at a time.

use super::Seat;
use super::boxes::Boxes;
use super::cover::Cover;
use super::layers::Reach;
use super::sweep::Sweep;

/// Number of pieces in one bundle; the place of a piece in it is a lane.
pub(crate) const LANES: usize = 8;

/// Number that stands for no bundle and for no piece.
pub(super) const NONE: u32 = u32::MAX;

/// One silhouette of a bundle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lane {
    pub(super) piece: u32,
    pub(super) reach: Reach,
    pub(super) cover: Cover,
}

impl Lane {
    #[inline]
    pub(super) fn of(piece: u32, cover: &Cover, seat: &Seat) -> Lane {
        Lane {
            piece,
            reach: seat.reach,
            cover: *cover,
        }
    }
}

/// Eight silhouettes with their pieces. Lanes from `count` on are not in use.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Bundle {
    boxes: Boxes<LANES>,
    pieces: [u32; LANES],
    /// Number of the lowest layer of each piece; the next field has the highest.
    lowest: [u8; LANES],
    highest: [u8; LANES],
    count: u32,
    /// Next bundle of the same cell, which is always full; [`NONE`] after the last one.
    pub(super) next: u32,
}

impl Bundle {
    /// Returns an empty bundle, linked before the bundle `next` of its cell.
    #[inline]
    pub(super) fn before(next: u32) -> Bundle {
        Bundle {
            boxes: Boxes::NOWHERE,
            pieces: [NONE; LANES],
            lowest: [Reach::NONE.low; LANES],
            highest: [Reach::NONE.high; LANES],
            count: 0,
            next,
        }
    }

    #[inline]
    pub(super) fn is_full(&self) -> bool {
        self.count as usize == LANES
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    #[inline]
    pub(super) fn push(&mut self, lane: &Lane) {
        self.count += 1;
        self.set(self.last(), lane);
    }

    /// Marks `count` lanes as in use; [`Bundle::set`] fills them later.
    #[inline]
    pub(super) fn expect(&mut self, count: u32) {
        self.count = count;
    }

    #[inline]
    pub(super) fn set(&mut self, at: usize, lane: &Lane) {
        self.boxes.set(at, &lane.cover);
        self.pieces[at] = lane.piece;
        (self.lowest[at], self.highest[at]) = (lane.reach.low, lane.reach.high);
    }

    /// Returns the silhouette of a lane.
    #[inline]
    pub(super) fn lane(&self, at: usize) -> Lane {
        Lane {
            piece: self.pieces[at],
            reach: Reach {
                low: self.lowest[at],
                high: self.highest[at],
            },
            cover: self.cover(at),
        }
    }

    /// Removes the last lane.
    #[inline]
    pub(super) fn pop(&mut self) {
        let last = self.last();
        self.pieces[last] = NONE;
        (self.lowest[last], self.highest[last]) = (Reach::NONE.low, Reach::NONE.high);
        self.count = self.count.saturating_sub(1);
    }

    /// Returns the newest lane; in an empty bundle, one that is not in use.
    #[inline]
    pub(super) fn last(&self) -> usize {
        (self.count as usize).wrapping_sub(1) % LANES
    }

    /// Returns the lane of a piece. Searches from the newest lane, because parts that pass through a fixture leave it
    /// before its own elements do.
    #[inline]
    pub(super) fn lane_of(&self, piece: u32) -> Option<usize> {
        let last = self.last();
        if self.pieces[last] == piece {
            return Some(last);
        }
        let word = (0..LANES).fold(0, |word, lane| {
            word | u32::from(self.pieces[lane] == piece) << lane
        });
        (word != 0).then(|| word.trailing_zeros() as usize % LANES)
    }

    /// Returns the word of all layers in which this bundle has pieces, without the lane `gone`.
    ///
    /// Call this before removing the lane: a read of eight bytes at once stalls the processor right after they were
    /// written one by one.
    #[inline]
    pub(super) fn word_without(&self, gone: Option<usize>) -> u64 {
        let gone = gone.map_or(0, |lane| 0xff << (8 * lane));
        let lowest = u64::from_le_bytes(self.lowest) | gone;
        let highest = u64::from_le_bytes(self.highest) & !gone;
        let reach = Reach {
            low: lowest
                .to_le_bytes()
                .into_iter()
                .fold(Reach::NONE.low, u8::min),
            high: highest
                .to_le_bytes()
                .into_iter()
                .fold(Reach::NONE.high, u8::max),
        };
        reach.word()
    }

    /// Returns a mask of the lanes in use (bit k: lane k).
    #[inline]
    fn used(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// Returns a mask in which bit k is set when the silhouette of lane k shares a point with `cover`.
    #[inline]
    pub(super) fn meeting(&self, cover: &Cover) -> u32 {
        self.boxes.meeting(cover) & self.used()
    }

    /// Returns a mask of the silhouettes that a moving box meets up to the fraction `until` of its path, and for each
    /// of them the fraction before which the box does not meet it.
    #[inline(always)]
    pub(super) fn crossing(&self, sweep: &Sweep, until: f32) -> (u32, [f32; LANES]) {
        let crossing = self.boxes.crossing(&sweep.start, &sweep.pace, until);
        (crossing.lanes & self.used(), crossing.entry)
    }

    /// Returns, for each silhouette, the fraction of the path before which the moving box does not meet it along one
    /// axis.
    #[inline]
    pub(super) fn entry(&self, sweep: &Sweep, axis: usize) -> [f32; LANES] {
        self.boxes.entry(&sweep.start, &sweep.pace, axis)
    }

    /// Returns the box around the piece of a lane.
    #[inline]
    pub(crate) fn cover(&self, lane: usize) -> Cover {
        self.boxes.cover(lane)
    }

    #[inline]
    pub(crate) fn piece(&self, lane: usize) -> u32 {
        self.pieces[lane]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::tests::Dice;

    #[test]
    fn the_layer_word_spans_all_remaining_lanes() {
        let mut dice = Dice::new(17);
        for _ in 0..2_000 {
            let mut bundle = Bundle::before(NONE);
            let mut reaches = Vec::new();
            for piece in 0..dice.pick(9) as u32 {
                let low = dice.pick(64) as u8;
                let high = low + dice.pick(64 - u64::from(low)) as u8;
                let reach = Reach { low, high };
                let cover = Cover {
                    low: [0.0; 4],
                    high: [0.0; 4],
                };
                bundle.push(&Lane {
                    piece,
                    reach,
                    cover,
                });
                reaches.push(reach);
            }
            let gone = dice.pick(9) as usize;
            let gone = (gone < reaches.len()).then_some(gone);
            let stay = |at: &usize| Some(*at) != gone;
            let stay: Vec<Reach> = (0..reaches.len())
                .filter(stay)
                .map(|at| reaches[at])
                .collect();
            let low = stay.iter().map(|reach| reach.low).min();
            let high = stay.iter().map(|reach| reach.high).max();
            let word = low
                .zip(high)
                .map_or(0, |(low, high)| Reach { low, high }.word());
            assert_eq!(
                bundle.word_without(gone),
                word,
                "{reaches:?} without {gone:?}"
            );
        }
    }
}
