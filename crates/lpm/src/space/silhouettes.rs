//! Silhouettes (`B` in the paper): the extents of each piece in x, y and z, compared eight at a time.

use super::codes::{Extent, Onset, Scale};
use super::cover::Cover;
use super::eight::Eight;
use super::layers::Reach;

/// Number of pieces in one bundle; the place of a piece in its bundle is a lane.
pub(crate) const LANES: usize = 8;

/// Number that means no bundle and no piece.
pub(super) const NONE: u32 = u32::MAX;

/// One silhouette of a bundle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lane {
    pub(super) piece: u32,
    pub(super) extent: Extent,
}

/// Eight silhouettes with their pieces, in two cache lines.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Bundle {
    /// Codes of each axis; lanes that are not in use have the heights of [`Extent::NOWHERE`].
    low: [[i16; LANES]; 3],
    high: [[i16; LANES]; 3],
    pieces: [u32; LANES],
}

/// Limits for the codes of height, lane by lane: they leave a lane as it is, or empty its range of heights.
struct Limits {
    low: [i16; LANES],
    high: [i16; LANES],
}

const ALL: Limits = Limits {
    low: [i16::MIN; LANES],
    high: [i16::MAX; LANES],
};

/// For each lane, the limits that empty this lane and leave all others as they are.
static WITHOUT: [Limits; LANES] = {
    let mut without = [const { ALL }; LANES];
    let mut lane = 0;
    while lane < LANES {
        without[lane].low[lane] = i16::MAX;
        without[lane].high[lane] = i16::MIN;
        lane += 1;
    }
    without
};

/// The box that a question compares with bundles: each of its codes, eight times.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    low: [Eight; 3],
    high: [Eight; 3],
}

impl Asked {
    #[inline(always)]
    pub(super) fn of(extent: &Extent) -> Asked {
        let three = |[x, y, z, _]: [i16; 4]| [Eight::all(x), Eight::all(y), Eight::all(z)];
        Asked {
            low: three(extent.low),
            high: three(extent.high),
        }
    }

    /// Returns the codes of a box.
    #[inline(always)]
    pub(super) fn about(scale: &Scale, cover: &Cover) -> Asked {
        Asked::of(&scale.extent(cover))
    }
}

impl Bundle {
    /// A bundle without pieces.
    pub(super) const EMPTY: Bundle = Bundle {
        low: [[i16::MAX; LANES]; 3],
        high: [[i16::MIN; LANES]; 3],
        pieces: [NONE; LANES],
    };

    #[inline]
    pub(super) fn set(&mut self, at: usize, lane: &Lane) {
        for axis in 0..3 {
            self.low[axis][at] = lane.extent.low[axis];
            self.high[axis][at] = lane.extent.high[axis];
        }
        self.pieces[at] = lane.piece;
    }

    /// Returns the silhouette of a lane.
    #[inline]
    pub(super) fn lane(&self, at: usize) -> Lane {
        let member = |[x, y, z]: &[[i16; LANES]; 3]| [x[at], y[at], z[at], 0];
        Lane {
            piece: self.pieces[at],
            extent: Extent {
                low: member(&self.low),
                high: member(&self.high),
            },
        }
    }

    /// Frees a lane. Its codes along x and y may stay, because no box meets its heights.
    #[inline]
    pub(super) fn clear(&mut self, at: usize) {
        (self.low[2][at], self.high[2][at]) = (Extent::NOWHERE.low[2], Extent::NOWHERE.high[2]);
        self.pieces[at] = NONE;
    }

    /// Returns the lane of a piece.
    #[inline]
    pub(super) fn lane_of(&self, piece: u32) -> Option<usize> {
        let word = (0..LANES).fold(0, |word, lane| {
            word | u32::from(self.pieces[lane] == piece) << lane
        });
        (word != 0).then(|| word.trailing_zeros() as usize % LANES)
    }

    /// Returns the codes of the heights between which a lane lies.
    #[inline]
    pub(super) fn heights(&self, at: usize) -> [i16; 2] {
        [self.low[2][at], self.high[2][at]]
    }

    /// Returns the word of all layers in which this bundle has pieces, without the lane `gone`.
    ///
    /// Call this before removing the lane: a read of eight numbers at once stalls the processor right after they were
    /// written one by one.
    #[inline]
    pub(super) fn word_without(&self, gone: Option<usize>) -> u64 {
        let gone = gone.map_or(&ALL, |lane| &WITHOUT[lane % LANES]);
        let low = Eight::of(&self.low[2]).larger(Eight::of(&gone.low));
        let high = Eight::of(&self.high[2]).smaller(Eight::of(&gone.high));
        Reach::between(low.least(), high.greatest()).word()
    }

    /// Returns a mask in which bit k is set when the silhouette of lane k may share a point with a box.
    #[inline(always)]
    pub(super) fn meeting(&self, asked: &Asked) -> u32 {
        let apart = |axis: usize| {
            let beyond = Eight::of(&self.low[axis]).above(asked.high[axis]);
            beyond.or(asked.low[axis].above(Eight::of(&self.high[axis])))
        };
        let apart = apart(0).or(apart(1)).or(apart(2));
        apart.negative() ^ ((1 << LANES) - 1)
    }

    /// Returns the fraction of the path before which the moving box does not meet the piece of a lane.
    #[inline(always)]
    pub(crate) fn entry(&self, lane: usize, onset: &Onset) -> f32 {
        onset.entry(&self.lane(lane).extent)
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
            let mut bundle = Bundle::EMPTY;
            let gone = dice.pick(9) as usize;
            let gone = (gone < LANES).then_some(gone);
            let mut heights = (i16::MAX, i16::MIN);
            for at in 0..dice.pick(9) as usize {
                let mut extent = Extent::NOWHERE;
                let low = dice.pick(40_000) as i32 - 20_000;
                extent.low[2] = low as i16;
                extent.high[2] = (low + dice.pick(9_000) as i32) as i16;
                let piece = at as u32;
                bundle.set(at, &Lane { piece, extent });
                if Some(at) != gone {
                    let (low, high) = (extent.low[2], extent.high[2]);
                    heights = (heights.0.min(low), heights.1.max(high));
                }
                let word = Reach::between(heights.0, heights.1).word();
                assert_eq!(bundle.word_without(gone), word);
            }
            (0..LANES).for_each(|at| bundle.clear(at));
            assert_eq!(bundle.word_without(None), 0);
        }
    }
}
