//! Bundles of all cells in one block of memory, so that inserting and removing pieces seldom allocates.

use super::silhouettes::{Bundle, LANES, Lane, NONE};

/// A cell: its word (bit k: the cell has pieces in layer k), and its newest bundle, the only one that may be partly
/// filled.
pub(super) struct Cell<'a> {
    pub(super) layers: &'a mut u64,
    pub(super) head: &'a mut u32,
}

/// All bundles, those in use and spare ones.
#[derive(Debug, Clone, Default)]
pub(super) struct Pool {
    pub(super) bundles: Vec<Bundle>,
    spare: Vec<u32>,
}

impl Pool {
    /// Adds a silhouette to a cell.
    #[inline]
    pub(super) fn put(&mut self, cell: Cell<'_>, lane: &Lane) {
        match self.bundles.get_mut(*cell.head as usize) {
            Some(head) if !head.is_full() => head.push(lane),
            Some(_) | None => {
                *cell.head = self.fresh(*cell.head);
                self.bundles[*cell.head as usize].push(lane);
            }
        }
        *cell.layers |= lane.reach.word();
    }

    /// Returns the number of an empty bundle, linked before the bundle `next`.
    fn fresh(&mut self, next: u32) -> u32 {
        match self.spare.pop() {
            Some(spare) => {
                self.bundles[spare as usize].next = next;
                spare
            }
            None => {
                self.bundles.push(Bundle::before(next));
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
        self.bundles.resize(whole, Bundle::before(NONE));
        let mut fresh = 0..whole as u32;
        for (head, count) in heads.iter_mut().zip(counts) {
            let lane = fresh.start * LANES as u32;
            let mut left = std::mem::replace(count, lane);
            while left > 0
                && let Some(newest) = fresh.next()
            {
                let bundle = &mut self.bundles[newest as usize];
                bundle.next = std::mem::replace(head, newest);
                bundle.expect(left.min(LANES as u32));
                left = left.saturating_sub(LANES as u32);
            }
        }
    }

    /// Writes a silhouette into a lane of the reserved bundles; lanes are counted across all bundles.
    #[inline]
    pub(super) fn put_reserved(&mut self, at: u32, lane: &Lane) {
        self.bundles[at as usize / LANES].set(at as usize % LANES, lane);
    }

    /// Removes a silhouette from a cell, and fills the gap with the last one of the newest bundle. Returns false when
    /// the cell does not have it.
    #[inline(always)]
    pub(super) fn take(&mut self, cell: Cell<'_>, piece: u32) -> bool {
        let Some((at, lane)) = self.whereabouts(*cell.head, piece) else {
            return false;
        };
        *cell.layers = self.chain(*cell.head).fold(0, |word, (number, bundle)| {
            word | bundle.word_without((number == at).then_some(lane))
        });
        let newest = &self.bundles[*cell.head as usize];
        let last = newest.last();
        if (at, lane) != (*cell.head, last) {
            let moved = newest.lane(last);
            self.bundles[at as usize].set(lane, &moved);
        }
        let newest = &mut self.bundles[*cell.head as usize];
        newest.pop();
        let (is_empty, next) = (newest.is_empty(), newest.next);
        if is_empty {
            self.spare.push(*cell.head);
            *cell.head = next;
        }
        true
    }

    #[inline]
    fn whereabouts(&self, head: u32, piece: u32) -> Option<(u32, usize)> {
        let mut chain = self.chain(head);
        chain.find_map(|(at, bundle)| Some((at, bundle.lane_of(piece)?)))
    }

    /// Returns a bundle by its number.
    #[inline]
    pub(super) fn bundle(&self, number: u32) -> &Bundle {
        &self.bundles[number as usize]
    }

    /// Returns the bundles of a cell whose newest bundle is `head`.
    #[inline]
    pub(super) fn chain(&self, head: u32) -> Chain<'_> {
        Chain {
            bundles: &self.bundles,
            next: head,
        }
    }

    /// Returns the heap in use, bytes.
    pub(super) fn heap_bytes(&self) -> usize {
        self.bundles.capacity() * size_of::<Bundle>() + self.spare.capacity() * size_of::<u32>()
    }
}

/// The bundles of one cell with their numbers, newest first.
pub(crate) struct Chain<'a> {
    bundles: &'a [Bundle],
    next: u32,
}

impl<'a> Iterator for Chain<'a> {
    type Item = (u32, &'a Bundle);

    #[inline]
    fn next(&mut self) -> Option<(u32, &'a Bundle)> {
        let number = self.next;
        let bundle = self.bundles.get(number as usize)?;
        self.next = bundle.next;
        Some((number, bundle))
    }
}
