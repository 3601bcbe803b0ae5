//! Finds the stationary pieces around a box at rest.

use super::area::Area;
use super::cover::Cover;
use super::grid::Grid;
use super::silhouettes::{Bundle, NONE};

/// Iterates over the bundles around a box, in some layers, each with the lanes that the box meets. Visits the open cell
/// first, then the squares in blocks of two by two.
pub(crate) struct Around<'a> {
    grid: &'a Grid,
    cover: &'a Cover,
    layers: u64,
    /// Next bundle of the current square.
    next: u32,
    /// First square of the current block; the next field is the mask of its squares still to visit (bit 0: the first,
    /// bit 1: the next column, bit 2: the next row).
    first: usize,
    left: u32,
    /// Number of blocks visited so far; `None` when there is only one block.
    blocks: Option<i32>,
}

impl<'a> Around<'a> {
    #[inline(always)]
    pub(super) fn new(grid: &'a Grid, cover: &'a Cover, layers: u64) -> Around<'a> {
        let is_open = grid.open_layers & layers != 0;
        let mut around = Around {
            grid,
            cover,
            layers,
            next: if is_open { grid.open_head } else { NONE },
            first: 0,
            left: 0,
            blocks: None,
        };
        let area = Area::among(cover, &grid.ends);
        if area.is_few() {
            around.squares(&area);
        } else {
            around.blocks = Some(0);
        }
        around
    }

    /// Starts a block of at most two by two squares.
    #[inline(always)]
    fn squares(&mut self, block: &Area) {
        self.first = self.grid.place(block.low[0], block.low[1]);
        // Reads the words of all four squares without a branch between them.
        let wanted = |at: u32| u32::from(self.grid.word(self.place(at)) & self.layers != 0) << at;
        let word = wanted(0) | wanted(1) | wanted(2) | wanted(3);
        self.left = word & block.different();
    }

    /// Returns the cell number of square `at` of the block, 0 to 3, row by row.
    #[inline(always)]
    fn place(&self, at: u32) -> usize {
        let row = if at < 2 { 0 } else { self.grid.columns };
        self.first + row + at as usize % 2
    }

    /// Advances to the next block of an area larger than two by two squares.
    #[cold]
    fn block(&mut self, blocks: i32) {
        let area = Area::among(self.cover, &self.grid.ends);
        let wide = (area.high[0] - area.low[0]) / 2 + 1;
        let low = [
            area.low[0] + 2 * (blocks % wide),
            area.low[1] + 2 * (blocks / wide),
        ];
        let high = [0, 1].map(|axis: usize| (low[axis] + 1).min(area.high[axis]));
        if low[1] > area.high[1] {
            self.blocks = None;
        } else {
            self.blocks = Some(blocks + 1);
            self.squares(&Area { low, high });
        }
    }
}

impl<'a> Iterator for Around<'a> {
    type Item = (&'a Bundle, u32);

    #[inline(always)]
    fn next(&mut self) -> Option<(&'a Bundle, u32)> {
        loop {
            while let Some(bundle) = self.grid.pool.bundles.get(self.next as usize) {
                self.next = bundle.next;
                let lanes = bundle.meeting(self.cover);
                if lanes != 0 {
                    return Some((bundle, lanes));
                }
            }
            while self.left == 0 {
                self.block(self.blocks?);
            }
            self.next = self.grid.heads[self.place(self.left.trailing_zeros())];
            self.left &= self.left - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Entering, Filling, Space};
    use super::*;
    use crate::distance::tests::Dice;

    fn drawn(dice: &mut Dice, reach: f64, size: f64) -> Cover {
        let at = dice.vector().map(|member| reach * member);
        let half = dice.vector().map(|member| size * member.abs());
        let side = |sign: f64| [0, 1, 2].map(|axis: usize| at[axis] + sign * half[axis]);
        Cover::of((side(-1.0), side(1.0)))
    }

    fn shown(space: &Space, cover: &Cover) -> Vec<u32> {
        let mut pieces: Vec<u32> = Vec::new();
        for (bundle, lanes) in space.around(cover).into_iter().flatten() {
            let met = (0..8).filter(|lane| lanes >> lane & 1 == 1);
            pieces.extend(met.map(|lane| bundle.piece(lane)));
        }
        pieces.sort_unstable();
        pieces.dedup();
        pieces
    }

    #[test]
    fn every_piece_that_meets_a_box_is_visited() {
        let mut dice = Dice::new(19);
        let mut large = 0;
        for round in 0..40 {
            let covers: Vec<Cover> = (0..60)
                .map(|number| {
                    // One piece in twenty is too large for the squares.
                    let size = if number % 20 == 0 { 700.0 } else { 40.0 };
                    drawn(&mut dice, 300.0, size)
                })
                .collect();
            let mut filling = Filling::of(covers.len());
            let mut one_by_one = Space::default();
            for (number, cover) in covers.iter().enumerate() {
                filling.enter(number as u32, cover);
                one_by_one.enter(number as u32, cover);
            }
            let filled = filling.space();
            for _ in 0..40 {
                let size = [10.0, 60.0, 400.0][dice.pick(3) as usize];
                let asked = drawn(&mut dice, 500.0, size);
                large += u32::from(!Area::of(&asked).is_few());
                let meets = |number: &u32| covers[*number as usize].distance(&asked) == 0.0;
                let wanted: Vec<u32> = (0..60).filter(meets).collect();
                assert_eq!(shown(&filled, &asked), wanted, "{round}: {asked:?}");
                assert_eq!(shown(&one_by_one, &asked), wanted, "{round}: {asked:?}");
            }
        }
        assert!(large > 300, "only {large}");
    }

    #[test]
    fn an_empty_space_has_no_pieces_around_a_box() {
        let cover = Cover::of(([-1e3; 3], [1e3; 3]));
        assert!(shown(&Space::default(), &cover).is_empty());
        let mut plate_alone = Space::default();
        plate_alone.enter(0, &Cover::of(([-5e3, -5e3, -20.0], [5e3, 5e3, 0.0])));
        assert_eq!(shown(&plate_alone, &cover), [0]);
    }
}
