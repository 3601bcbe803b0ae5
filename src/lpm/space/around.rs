//! What stands around a box at rest.

use super::area::Area;
use super::cover::Cover;
use super::grid::Grid;
use super::silhouettes::Bundle;

/// Of two by two squares those that differ, by columns and rows less one: bit 0 the first, bit 1 the next
/// column, bit 2 the next row.
const DIFFERENT: [[u32; 2]; 2] = [[0b0001, 0b0011], [0b0101, 0b1111]];

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
        if self.open_layers & layers != 0 && self.shown(self.open_head, cover, &mut show) {
            return;
        }
        let Some(area) = self.common(&Area::of(cover)) else {
            return;
        };
        let first = self.place(area.low[0], area.low[1]);
        let [wide, deep] = [0, 1].map(|axis: usize| (area.high[axis] - area.low[axis]) as usize);
        if wide > 1 || deep > 1 {
            let rows = (0..=deep).map(|row| first + row * self.columns);
            for place in rows.flat_map(|row| row..=row + wide) {
                if self.layers[place] & layers != 0
                    && self.shown(self.heads[place], cover, &mut show)
                {
                    return;
                }
            }
            return;
        }
        // Most boxes lie over four squares at most: their words are read without a branch between them.
        let next = first + deep * self.columns;
        let places = [first, first + wide, next, next + wide];
        let wanted = |square: usize| u32::from(self.layers[places[square]] & layers != 0) << square;
        let mut left = (wanted(0) | wanted(1) | wanted(2) | wanted(3)) & DIFFERENT[deep][wide];
        while left != 0 {
            let square = left.trailing_zeros() as usize % 4;
            left &= left - 1;
            if self.shown(self.heads[places[square]], cover, &mut show) {
                return;
            }
        }
    }

    /// The bundles of one cell; true when one was answered with true.
    #[inline]
    fn shown(&self, head: u32, cover: &Cover, show: &mut impl FnMut(&Bundle, u32) -> bool) -> bool {
        self.pool.chain(head).any(|(_, bundle)| {
            let lanes = bundle.boxes.meeting(cover);
            lanes != 0 && show(bundle, lanes)
        })
    }
}
