//! Silhouettes, `B` of the paper: what each piece covers of x, y and z, eight pieces at a time.

use super::Seat;
use super::boxes::Boxes;
use super::cover::Cover;

/// Pieces of one bundle.
pub(crate) const LANES: usize = 8;

/// No bundle, no piece.
pub(super) const NONE: u32 = u32::MAX;

/// One silhouette of a bundle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lane {
    pub(super) piece: u32,
    /// Its layers, bit k: layer k.
    pub(super) word: u64,
    pub(super) cover: Cover,
}

impl Lane {
    #[inline]
    pub(super) fn of(piece: u32, cover: &Cover, seat: &Seat) -> Lane {
        Lane {
            piece,
            word: seat.reach.word(),
            cover: *cover,
        }
    }

    /// Meets nothing.
    const EMPTY: Lane = Lane {
        piece: NONE,
        word: 0,
        cover: Cover {
            low: [f32::INFINITY; 3],
            high: [f32::INFINITY; 3],
        },
    };
}

/// Eight silhouettes and whose they are. Lanes from `count` on meet nothing.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Bundle {
    pub(crate) boxes: Boxes<LANES>,
    pieces: [u32; LANES],
    /// The layers of each piece, bit k: layer k.
    words: [u64; LANES],
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
            words: [0; LANES],
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

    /// Counts lanes that will be [`Bundle::set`].
    #[inline]
    pub(super) fn expect(&mut self, count: u32) {
        self.count = count;
    }

    #[inline]
    pub(super) fn set(&mut self, at: usize, lane: &Lane) {
        self.boxes.set(at, &lane.cover);
        self.pieces[at] = lane.piece;
        self.words[at] = lane.word;
    }

    /// Takes the last lane out; of an empty bundle, nothing that anybody knows.
    #[inline]
    pub(super) fn pop(&mut self) -> Lane {
        let last = self.last();
        let lane = Lane {
            piece: self.pieces[last],
            word: self.words[last],
            cover: self.boxes.cover(last),
        };
        self.set(last, &Lane::EMPTY);
        self.count = self.count.saturating_sub(1);
        lane
    }

    #[inline]
    fn last(&self) -> usize {
        (self.count as usize).wrapping_sub(1) % LANES
    }

    /// Where a piece is; first of all where the newest is, which is the first to go where parts pass and a
    /// fixture stays.
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

    /// Word of the layers of this bundle.
    #[inline]
    pub(super) fn word(&self) -> u64 {
        self.words.iter().fold(0, |whole, word| whole | word)
    }

    #[inline]
    pub(crate) fn piece(&self, lane: usize) -> u32 {
        self.pieces[lane]
    }
}
