//! What stands around a box at rest.

use super::area::Area;
use super::cover::Cover;
use super::grid::Grid;
use super::silhouettes::{Bundle, NONE};

impl Grid {
    /// Shows the bundles in some of these layers that have pieces which may meet a box, until one is
    /// answered with true.
    #[inline(always)]
    pub(crate) fn around(
        &self,
        cover: &Cover,
        layers: u64,
        mut show: impl FnMut(&Bundle, u32) -> bool,
    ) {
        let mut next = if self.open_layers & layers != 0 {
            self.open_head
        } else {
            NONE
        };
        let (places, mut left) = match self.common(&Area::of(cover)) {
            None => ([0; 4], 0),
            Some(area) => match self.few(&area) {
                None => return self.around_many(&area, cover, layers, &mut show),
                // Their words are read without a branch between them.
                Some((places, different)) => {
                    let wanted = |at: usize| u32::from(self.layers[places[at]] & layers != 0) << at;
                    let word = wanted(0) | wanted(1) | wanted(2) | wanted(3);
                    (places, word & different)
                }
            },
        };
        // One loop over all bundles of all cells: what is done with one stands in the program once.
        loop {
            let Some(bundle) = self.pool.bundles.get(next as usize) else {
                if left == 0 {
                    return;
                }
                next = self.heads[places[left.trailing_zeros() as usize % 4]];
                left &= left - 1;
                continue;
            };
            next = bundle.next;
            let lanes = bundle.meeting(cover);
            if lanes != 0 && show(bundle, lanes) {
                return;
            }
        }
    }

    #[cold]
    fn around_many(
        &self,
        area: &Area,
        cover: &Cover,
        layers: u64,
        show: &mut dyn FnMut(&Bundle, u32) -> bool,
    ) {
        let open = self.open_in_layers(layers).into_iter();
        let rows = (area.low[1]..=area.high[1]).map(|row| self.place(area.low[0], row));
        let wide = (area.high[0] - area.low[0]) as usize;
        let squares = rows.flat_map(|first| first..=first + wide);
        let chains = open.chain(squares.filter_map(|place| self.in_layers(place, layers)));
        for (_, bundle) in chains.flatten() {
            let lanes = bundle.meeting(cover);
            if lanes != 0 && show(bundle, lanes) {
                return;
            }
        }
    }
}
