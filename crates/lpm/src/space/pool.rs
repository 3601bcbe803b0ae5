//! Bundles of all cells in one block of memory, so that inserting and removing pieces seldom allocates.

use super::codes::Scale;
use super::silhouettes::{Bundle, LANES, Lane, NONE};

/// A cell: its word (bit k: the cell has pieces in layer k), and its newest bundle, the only one that may be partly
/// filled.
pub(super) struct Cell<'a> {
    pub(super) layers: &'a mut u64,
    pub(super) head: &'a mut u32,
}

/// How far a bundle is filled.
#[derive(Debug, Clone, Copy)]
struct Fill {
    /// For each lane in use, the word that its cell had before this lane was filled: the cell gets it back when its
    /// newest silhouette leaves.
    before: [u64; LANES],
    /// Number of lanes in use, the first ones.
    count: u32,
    /// Number of lanes, the first ones, for which `before` is not known.
    unknown: u32,
}

impl Fill {
    /// Makes a bundle in which `count` lanes are in use, or will be.
    fn reserved(count: u32) -> Fill {
        Fill {
            before: [0; LANES],
            count,
            unknown: count,
        }
    }

    /// Returns the newest lane; in an empty bundle, one that is not in use.
    #[inline]
    fn last(&self) -> usize {
        (self.count as usize).wrapping_sub(1) % LANES
    }
}

/// All bundles, those in use and spare ones. The links are stored apart: a question that visits a cell knows the next
/// bundle before the memory delivers the first one.
#[derive(Debug, Clone, Default)]
pub(super) struct Pool {
    bundles: Vec<Bundle>,
    /// For each bundle, the next older one of the same cell, which is always full; [`NONE`] after the oldest one.
    links: Vec<u32>,
    fills: Vec<Fill>,
    spare: Vec<u32>,
}

impl Pool {
    /// Adds a silhouette, with its layers, to a cell.
    #[inline(always)]
    pub(super) fn put(&mut self, cell: Cell<'_>, lane: &Lane, word: u64) {
        let head = *cell.head as usize;
        match (self.fills.get_mut(head), self.bundles.get_mut(head)) {
            (Some(fill), Some(bundle)) if (fill.count as usize) < LANES => {
                let at = fill.count as usize % LANES;
                fill.before[at] = *cell.layers;
                fill.count += 1;
                bundle.set(at, lane);
            }
            _ => *cell.head = self.fresh(*cell.head, *cell.layers, lane),
        }
        *cell.layers |= word;
    }

    /// Returns the number of a bundle with one silhouette, linked before the bundle `next` of a cell with the word
    /// `layers`.
    #[inline(never)]
    fn fresh(&mut self, next: u32, layers: u64, lane: &Lane) -> u32 {
        let number = self.spare.pop().unwrap_or_else(|| {
            self.bundles.push(Bundle::EMPTY);
            self.links.push(NONE);
            self.fills.push(Fill::reserved(0));
            (self.bundles.len() - 1) as u32
        });
        let at = number as usize;
        self.links[at] = next;
        self.bundles[at].set(0, lane);
        let fill = &mut self.fills[at];
        (fill.before[0], fill.count, fill.unknown) = (layers, 1, 0);
        number
    }

    /// Reserves bundles for several new cells, with `counts` silhouettes each, in order. Writes the newest bundle of
    /// each cell into `heads`, and replaces each count by the lane of the cell's first silhouette, for
    /// [`Pool::put_reserved`].
    pub(super) fn reserve(&mut self, heads: &mut [u32], counts: &mut [u32]) {
        let bundles = counts.iter().map(|count| count.div_ceil(LANES as u32));
        let whole = bundles.sum::<u32>() as usize;
        // One more bundle for the open cell.
        self.bundles.reserve_exact(whole + 1);
        self.bundles.resize(whole, Bundle::EMPTY);
        self.links.reserve_exact(whole + 1);
        self.fills.reserve_exact(whole + 1);
        for (head, count) in heads.iter_mut().zip(counts) {
            let fresh = self.links.len() as u32;
            let mut left = std::mem::replace(count, fresh * LANES as u32);
            while left > 0 {
                let next = std::mem::replace(head, self.links.len() as u32);
                let count = left.min(LANES as u32);
                self.links.push(next);
                self.fills.push(Fill::reserved(count));
                left -= count;
            }
        }
    }

    /// Writes a silhouette into a lane of the reserved bundles; lanes are counted across all bundles.
    #[inline]
    pub(super) fn put_reserved(&mut self, at: u32, lane: &Lane) {
        self.bundles[at as usize / LANES].set(at as usize % LANES, lane);
    }

    /// Removes a silhouette from a cell, and fills the gap with the newest one. Returns the codes of its heights;
    /// `None` when the cell does not have it.
    #[inline(always)]
    pub(super) fn take(&mut self, cell: Cell<'_>, piece: u32) -> Option<[i16; 2]> {
        let head = *cell.head as usize;
        let (fill, bundle) = (self.fills.get_mut(head)?, self.bundles.get_mut(head)?);
        let last = fill.last();
        // Parts that pass through a fixture leave it before its own elements do.
        if bundle.piece(last) != piece || last < fill.unknown as usize {
            return self.take_older(cell, piece);
        }
        let heights = bundle.heights(last);
        bundle.clear(last);
        *cell.layers = fill.before[last];
        fill.count -= 1;
        if fill.count == 0 {
            self.spare.push(*cell.head);
            *cell.head = self.links[head];
        }
        Some(heights)
    }

    /// Removes any silhouette from a cell, as [`Pool::take`] does, and computes the word of the cell.
    #[inline(never)]
    fn take_older(&mut self, cell: Cell<'_>, piece: u32) -> Option<[i16; 2]> {
        let head = *cell.head as usize;
        let (at, lane) = self.whereabouts(head, piece)?;
        let heights = self.bundles[at].heights(lane);
        *cell.layers = self.word_without(head, (at, lane));
        let last = self.fills[head].last();
        if (at, lane) != (head, last) {
            let newest = self.bundles[head].lane(last);
            self.bundles[at].set(lane, &newest);
        }
        self.bundles[head].clear(last);
        self.fills[head].count -= 1;
        self.forget(head, at);
        if self.fills[head].count == 0 {
            self.spare.push(*cell.head);
            *cell.head = self.links[head];
        }
        Some(heights)
    }

    /// Returns the bundle and the lane of a piece in the cell whose newest bundle is `head`.
    #[inline]
    fn whereabouts(&self, head: usize, piece: u32) -> Option<(usize, usize)> {
        let mut at = head;
        while let Some(bundle) = self.bundles.get(at) {
            if let Some(lane) = bundle.lane_of(piece) {
                return Some((at, lane));
            }
            at = self.links[at] as usize;
        }
        None
    }

    /// Returns the word of the cell whose newest bundle is `head`, without a lane of one of its bundles.
    #[inline]
    fn word_without(&self, head: usize, (gone, lane): (usize, usize)) -> u64 {
        let (mut word, mut at) = (0, head);
        while let Some(bundle) = self.bundles.get(at) {
            word |= bundle.word_without((at == gone).then_some(lane));
            at = self.links[at] as usize;
        }
        word
    }

    /// Marks [`Fill::before`] as unknown in the bundle `last` of a cell, and in those newer than it up to `head`.
    #[inline]
    fn forget(&mut self, head: usize, last: usize) {
        let mut at = head;
        self.fills[at].unknown = self.fills[at].count;
        while at != last {
            at = self.links[at] as usize;
            self.fills[at].unknown = self.fills[at].count;
        }
    }

    /// Converts the silhouettes of all bundles to another scale.
    pub(super) fn convert(&mut self, old: &Scale, new: &Scale) {
        for bundle in &mut self.bundles {
            for at in 0..LANES {
                let Lane { piece, extent } = bundle.lane(at);
                let extent = new.converted(old, &extent);
                bundle.set(at, &Lane { piece, extent });
            }
        }
    }

    /// Returns the bundles of a cell whose newest bundle is `head`.
    #[inline]
    pub(super) fn chain(&self, head: u32) -> Chain<'_> {
        Chain {
            pool: self,
            next: head,
        }
    }

    /// Returns the heap in use, bytes.
    pub(super) fn heap_bytes(&self) -> usize {
        self.bundles.capacity() * size_of::<Bundle>()
            + self.fills.capacity() * size_of::<Fill>()
            + (self.links.capacity() + self.spare.capacity()) * size_of::<u32>()
    }
}

/// The bundles of one cell, newest first.
#[derive(Clone)]
pub(super) struct Chain<'a> {
    pool: &'a Pool,
    next: u32,
}

impl<'a> Iterator for Chain<'a> {
    type Item = &'a Bundle;

    #[inline(always)]
    fn next(&mut self) -> Option<&'a Bundle> {
        let at = self.next as usize;
        let bundle = self.pool.bundles.get(at)?;
        self.next = self.pool.links[at];
        Some(bundle)
    }
}

#[cfg(test)]
mod tests {
    use super::super::codes::Extent;
    use super::super::layers::Reach;
    use super::*;
    use crate::distance::tests::Dice;

    fn drawn(dice: &mut Dice, piece: u32) -> Lane {
        let low = dice.pick(16_000) as i16 - 17_000;
        let high = low + dice.pick(2_000) as i16;
        let extent = Extent {
            low: [0, 0, low, 0],
            high: [0, 0, high, 0],
        };
        Lane { piece, extent }
    }

    fn word(lane: &Lane) -> u64 {
        let [low, high] = [lane.extent.low[2], lane.extent.high[2]];
        Reach::between(low, high).word()
    }

    fn pieces(pool: &Pool, head: u32) -> Vec<u32> {
        let lanes = |bundle: &Bundle| [0, 1, 2, 3, 4, 5, 6, 7].map(|lane| bundle.piece(lane));
        let mut pieces: Vec<u32> = pool.chain(head).flat_map(lanes).collect();
        pieces.retain(|piece| *piece != NONE);
        pieces.sort_unstable();
        pieces
    }

    /// Returns the word of all layers from the lowest to the highest one of these silhouettes.
    fn span(lanes: &[Lane]) -> u64 {
        let (low, high) = lanes
            .iter()
            .fold((i16::MAX, i16::MIN), |(low, high), lane| {
                let Extent {
                    low: [_, _, bottom, _],
                    high: [_, _, top, _],
                } = lane.extent;
                (low.min(bottom), high.max(top))
            });
        Reach::between(low, high).word()
    }

    #[test]
    fn a_cell_has_the_layers_of_its_pieces_whichever_leave() {
        let mut dice = Dice::new(47);
        for reserved in 0..30 {
            let mut standing: Vec<Lane> = (0..reserved).map(|at| drawn(&mut dice, at)).collect();
            let (mut pool, mut heads, mut counts) = (Pool::default(), [NONE], [reserved]);
            pool.reserve(&mut heads, &mut counts);
            for (lane, at) in standing.iter().zip(counts[0]..) {
                pool.put_reserved(at, lane);
            }
            let [head] = &mut heads;
            let layers = &mut standing.iter().fold(0, |whole, lane| whole | word(lane));
            for piece in reserved..reserved + 200 {
                let lane = drawn(&mut dice, piece);
                pool.put(Cell { layers, head }, &lane, word(&lane));
                standing.push(lane);
                let many = dice.pick(2) == 0;
                while many && !standing.is_empty() && dice.pick(3) > 0 {
                    // The newest piece leaves more often than any other.
                    let last = standing.len() - 1;
                    let any = [last, dice.pick(last as u64 + 1) as usize][dice.pick(2) as usize];
                    let gone = standing.remove(any);
                    let heights = [gone.extent.low[2], gone.extent.high[2]];
                    assert_eq!(pool.take(Cell { layers, head }, gone.piece), Some(heights));
                    assert_eq!(pool.take(Cell { layers, head }, gone.piece), None);
                }
                let needed = standing.iter().fold(0, |whole, lane| whole | word(lane));
                assert_eq!(*layers & needed, needed, "{reserved} {piece}");
                assert_eq!(*layers & !span(&standing), 0, "{reserved} {piece}");
                let mut numbers: Vec<u32> = standing.iter().map(|lane| lane.piece).collect();
                numbers.sort_unstable();
                assert_eq!(pieces(&pool, *head), numbers);
            }
        }
    }
}
