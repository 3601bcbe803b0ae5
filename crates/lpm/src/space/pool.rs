//! Bundles of all cells in one block of memory, so that inserting and removing pieces seldom allocates.

use super::codes::{Extent, Scale};
use super::silhouettes::{Bundle, LANES, Lane};

/// A cell: its word (bit k: the cell has pieces in layer k), and its newest bundle, the only one that may be partly
/// filled.
pub(super) struct Cell<'a> {
    pub(super) layers: &'a mut u64,
    pub(super) head: &'a mut u32,
}

/// Place of a bundle in its cell.
#[derive(Debug, Clone, Copy)]
struct Link {
    /// Next bundle of the same cell, which is always full; `u32::MAX` after the last one.
    next: u32,
    /// Number of lanes in use, the first ones.
    count: u32,
}

impl Link {
    /// Returns the newest lane; in an empty bundle, one that is not in use.
    #[inline]
    fn last(self) -> usize {
        (self.count as usize).wrapping_sub(1) % LANES
    }
}

/// All bundles, those in use and spare ones. The links are stored apart: a question that visits a cell knows the next
/// bundle before the memory delivers the first one.
#[derive(Debug, Clone, Default)]
pub(super) struct Pool {
    bundles: Vec<Bundle>,
    links: Vec<Link>,
    spare: Vec<u32>,
}

impl Pool {
    /// Adds a silhouette, with its layers, to a cell.
    #[inline]
    pub(super) fn put(&mut self, cell: Cell<'_>, lane: &Lane, word: u64) {
        let has_room = |link: &Link| (link.count as usize) < LANES;
        if !self.links.get(*cell.head as usize).is_some_and(has_room) {
            *cell.head = self.fresh(*cell.head);
        }
        let head = *cell.head as usize;
        let link = &mut self.links[head];
        self.bundles[head].set(link.count as usize % LANES, lane);
        link.count += 1;
        *cell.layers |= word;
    }

    /// Returns the number of an empty bundle, linked before the bundle `next`.
    fn fresh(&mut self, next: u32) -> u32 {
        let link = Link { next, count: 0 };
        match self.spare.pop() {
            Some(spare) => {
                self.links[spare as usize] = link;
                spare
            }
            None => {
                self.bundles.push(Bundle::EMPTY);
                self.links.push(link);
                (self.bundles.len() - 1) as u32
            }
        }
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
        for (head, count) in heads.iter_mut().zip(counts) {
            let fresh = self.links.len() as u32;
            let mut left = std::mem::replace(count, fresh * LANES as u32);
            while left > 0 {
                let next = std::mem::replace(head, self.links.len() as u32);
                let count = left.min(LANES as u32);
                self.links.push(Link { next, count });
                left -= count;
            }
        }
    }

    /// Writes a silhouette into a lane of the reserved bundles; lanes are counted across all bundles.
    #[inline]
    pub(super) fn put_reserved(&mut self, at: u32, lane: &Lane) {
        self.bundles[at as usize / LANES].set(at as usize % LANES, lane);
    }

    /// Removes a silhouette from a cell, and fills the gap with the last one of the newest bundle. Returns `None` when
    /// the cell does not have it.
    #[inline(always)]
    pub(super) fn take(&mut self, cell: Cell<'_>, piece: u32) -> Option<Extent> {
        let (at, lane) = self.whereabouts(*cell.head, piece)?;
        let Lane { extent, .. } = self.bundles[at].lane(lane);
        *cell.layers = self.word_without(*cell.head, (at, lane));
        let head = *cell.head as usize;
        let link = self.links[head];
        if (at, lane) != (head, link.last()) {
            let moved = self.bundles[head].lane(link.last());
            self.bundles[at].set(lane, &moved);
        }
        self.bundles[head].clear(link.last());
        self.links[head].count = link.count - 1;
        if link.count == 1 {
            self.spare.push(*cell.head);
            *cell.head = link.next;
        }
        Some(extent)
    }

    /// Returns the word of the cell whose newest bundle is `head`, without a lane of one of its bundles.
    #[inline]
    fn word_without(&self, head: u32, (gone, lane): (usize, usize)) -> u64 {
        let (mut word, mut at) = (0, head as usize);
        while let (Some(bundle), Some(link)) = (self.bundles.get(at), self.links.get(at)) {
            word |= bundle.word_without((at == gone).then_some(lane));
            at = link.next as usize;
        }
        word
    }

    /// Returns the bundle and the lane of a piece in the cell whose newest bundle is `head`.
    #[inline]
    fn whereabouts(&self, head: u32, piece: u32) -> Option<(usize, usize)> {
        let mut at = head as usize;
        while let Some(link) = self.links.get(at) {
            if let Some(lane) = self.bundles[at].lane_of(piece, link.last()) {
                return Some((at, lane));
            }
            at = link.next as usize;
        }
        None
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
            + self.links.capacity() * size_of::<Link>()
            + self.spare.capacity() * size_of::<u32>()
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
        self.next = self.pool.links[at].next;
        Some(bundle)
    }
}
