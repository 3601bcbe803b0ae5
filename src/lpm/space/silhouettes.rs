//! Silhouettes, `B` of the paper: what each piece covers of x, y and z, eight pieces at a time.

use super::boxes::Boxes;
use super::cover::Cover;
use super::layers::Reach;

/// Pieces of one bundle.
pub(crate) const LANES: usize = 8;

/// No bundle, no piece.
pub(super) const NONE: u32 = u32::MAX;

/// Eight silhouettes and whose they are. Lanes from `count` on meet nothing.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Bundle {
    pub(crate) boxes: Boxes<LANES>,
    pieces: [u32; LANES],
    reaches: [Reach; LANES],
    count: u32,
    /// Next bundle of the same cell; always a full one.
    pub(super) next: u32,
}

impl Bundle {
    /// An empty bundle, and the bundle that follows it in its cell.
    #[inline]
    pub(super) fn before(next: u32) -> Bundle {
        Bundle {
            boxes: Boxes::NOWHERE,
            pieces: [NONE; LANES],
            reaches: [Reach::NONE; LANES],
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
    pub(super) fn push(&mut self, piece: u32, reach: Reach, cover: &Cover) {
        let lane = self.count as usize % LANES;
        self.count += 1;
        self.boxes.set(lane, cover);
        self.pieces[lane] = piece;
        self.reaches[lane] = reach;
    }

    /// The last of `self` takes the place of `lane`, which may be its own.
    #[inline]
    pub(super) fn close(&mut self, lane: usize) {
        let last = self.last();
        let cover = self.boxes.cover(last);
        self.boxes.set(lane, &cover);
        self.pieces[lane] = self.pieces[last];
        self.reaches[lane] = self.reaches[last];
        self.forget_last();
    }

    /// The last of `newest` takes the place of `lane`.
    pub(super) fn refill(&mut self, lane: usize, newest: &mut Bundle) {
        let last = newest.last();
        self.boxes.set(lane, &newest.boxes.cover(last));
        self.pieces[lane] = newest.pieces[last];
        self.reaches[lane] = newest.reaches[last];
        newest.forget_last();
    }

    #[inline]
    fn last(&self) -> usize {
        (self.count as usize).saturating_sub(1) % LANES
    }

    #[inline]
    fn forget_last(&mut self) {
        let last = self.last();
        for axis in 0..3 {
            self.boxes.low[axis][last] = f32::INFINITY;
            self.boxes.high[axis][last] = f32::INFINITY;
        }
        self.pieces[last] = NONE;
        self.reaches[last] = Reach::NONE;
        self.count -= 1;
    }

    #[inline]
    pub(super) fn lane_of(&self, piece: u32) -> Option<usize> {
        let lanes = 0..LANES;
        let word = lanes.fold(0, |word, lane| {
            word | u32::from(self.pieces[lane] == piece) << lane
        });
        (word != 0).then(|| word.trailing_zeros() as usize % LANES)
    }

    /// Word of the layers of this bundle.
    #[inline]
    pub(super) fn word(&self) -> u64 {
        let reaches = self.reaches.iter();
        reaches.fold(0, |word, reach| word | reach.word())
    }

    #[inline]
    pub(crate) fn piece(&self, lane: usize) -> u32 {
        self.pieces[lane]
    }
}
