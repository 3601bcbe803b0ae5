//! Finds the stationary pieces around a box at rest.

use super::area::Area;
use super::cover::Cover;
use super::grid::Grid;
use super::pool::Chain;
use super::silhouettes::{Asked, Bundle, NONE};

/// Iterates over the bundles around a box, each with the lanes that the box may meet. Visits the open cell first, then
/// the squares in blocks of two by two.
pub(crate) struct Around<'a> {
    grid: &'a Grid,
    asked: Asked,
    layers: u64,
    /// Squares that the box covers.
    area: Area,
    /// Bundles of the current square.
    chain: Chain<'a>,
    /// First square of the current block.
    first: usize,
    /// Mask of the squares of the current block still to visit. Bit 0: the first square, bit 1: the next column, bit 2:
    /// the next row, bit 3: the next column in the next row.
    left: u32,
    /// Number of blocks visited so far; `None` when there is only one block.
    blocks: Option<i32>,
}

impl<'a> Around<'a> {
    #[inline(always)]
    pub(super) fn new(grid: &'a Grid, cover: &Cover) -> Around<'a> {
        let extent = grid.scale.extent(cover);
        let layers = extent.reach().word();
        let is_open = grid.open_layers & layers != 0;
        let head = if is_open { grid.open_head } else { NONE };
        let area = Area::among(cover, &grid.ends);
        let (first, left, blocks) = if area.is_few() {
            let (first, left) = wanted(grid, layers, &area);
            (first, left, None)
        } else {
            (0, 0, Some(0))
        };
        Around {
            grid,
            asked: Asked::of(&extent),
            layers,
            area,
            chain: grid.pool.chain(head),
            first,
            left,
            blocks,
        }
    }
}

/// Returns the first cell of a block of at most two by two squares, and the mask of its squares with pieces in these
/// layers.
#[inline(always)]
fn wanted(grid: &Grid, layers: u64, block: &Area) -> (usize, u32) {
    let first = grid.place(block.low[0], block.low[1]);
    let words = grid.words(first);
    let bit = |at: usize| u32::from(words[at] & layers != 0) << at;
    let mask = bit(0) | bit(1) | bit(2) | bit(3);
    (first, mask & block.different())
}

/// Returns the block with a number in an area larger than two by two squares; `None` after the last one.
#[cold]
#[inline(never)]
fn block(area: Area, number: i32) -> Option<Area> {
    let wide = (area.high[0] - area.low[0]) / 2 + 1;
    let low = [
        area.low[0] + 2 * (number % wide),
        area.low[1] + 2 * (number / wide),
    ];
    let high = [0, 1].map(|axis: usize| (low[axis] + 1).min(area.high[axis]));
    (low[1] <= area.high[1]).then_some(Area { low, high })
}

impl<'a> Iterator for Around<'a> {
    type Item = (&'a Bundle, u32);

    #[inline(always)]
    fn next(&mut self) -> Option<(&'a Bundle, u32)> {
        loop {
            for bundle in &mut self.chain {
                let lanes = bundle.meeting(&self.asked);
                if lanes != 0 {
                    return Some((bundle, lanes));
                }
            }
            while self.left == 0 {
                let number = self.blocks?;
                let block = block(self.area, number)?;
                self.blocks = Some(number + 1);
                (self.first, self.left) = wanted(self.grid, self.layers, &block);
            }
            let at = self.left.trailing_zeros() as usize;
            let row = if at < 2 { 0 } else { self.grid.columns };
            let head = self.grid.heads[self.first + row + at % 2];
            self.chain = self.grid.pool.chain(head);
            self.left &= self.left - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Entering, Filling, Space};
    use super::*;
    use crate::distance::tests::Dice;

    /// Two steps of the codes in these spaces, mm.
    const STEPS_MM: f64 = 0.3;

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
                let near = |number: &u32| covers[*number as usize].distance(&asked) < STEPS_MM;
                for shown in [shown(&filled, &asked), shown(&one_by_one, &asked)] {
                    let has = |number: &u32| shown.contains(number);
                    assert!(wanted.iter().all(has), "{round}: {asked:?}");
                    assert!(shown.iter().all(near), "{round}: {asked:?}");
                }
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
