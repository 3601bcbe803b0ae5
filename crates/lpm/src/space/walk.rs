//! Walks over the squares of the baseplate along the path of a box, in the direction of motion.

use super::area::Area;
use super::codes::Onset;
use super::cover::Cover;
use super::grid::Grid;
use super::pool::Chain;
use super::silhouettes::{Asked, Bundle};
use super::strip::Strip;
use super::sweep::{SLOWEST_MM, Sweep};

/// Receives the pieces that a moving box may meet.
pub(crate) trait Visit {
    /// Returns true when the visitor needs the pieces in the order in which they are met.
    fn in_order(&self) -> bool;

    /// Receives a bundle. The box may meet lane k if bit k of `lanes` is set. The same piece may come more than once.
    /// `onset` is given with [`Visit::in_order`]. Returns true to end the walk.
    fn bundle(&mut self, bundle: &Bundle, lanes: u32, onset: Option<&Onset>) -> bool;

    /// The walk calls this between groups of pieces: the box meets no later piece earlier than those of the group.
    /// Returns the fraction of the path up to which pieces still matter; below 0 to end the walk.
    fn pause(&mut self) -> f64;
}

/// A walk in progress.
pub(super) struct Walk<'a, V> {
    grid: &'a Grid,
    sweep: &'a Sweep,
    /// Layers into which the box reaches.
    layers: u64,
    /// Box around the path that remains.
    cover: Cover,
    /// Codes of `cover`.
    asked: Asked,
    onset: Option<Onset>,
    /// Fraction of the path up to which pieces still matter.
    until: f64,
    visit: &'a mut V,
}

impl<'a, V: Visit> Walk<'a, V> {
    #[inline]
    pub(super) fn new(
        grid: &'a Grid,
        sweep: &'a Sweep,
        layers: u64,
        cover: Cover,
        visit: &'a mut V,
    ) -> Walk<'a, V> {
        Walk {
            grid,
            sweep,
            layers,
            cover,
            asked: Asked::about(&grid.scale, &cover),
            onset: visit.in_order().then(|| grid.scale.onset(sweep)),
            until: 1.0,
            visit,
        }
    }

    /// Visits the open cell, then the squares.
    #[inline]
    pub(super) fn whole(&mut self) {
        if let Some(chain) = self.grid.open_in_layers(self.layers)
            && self.bundles(chain)
        {
            return;
        }
        let Some(area) = self.grid.common(&Area::of(&self.cover)) else {
            self.visit.pause();
            return;
        };
        let (wide, high) = (area.high[0] - area.low[0], area.high[1] - area.low[1]);
        let [x, y] = [self.sweep.run[0].abs(), self.sweep.run[1].abs()];
        if wide <= 1 && high <= 1 || x.max(y) < SLOWEST_MM {
            self.every_square(&area);
        } else if x >= y {
            self.along::<0>(&area);
        } else {
            self.along::<1>(&area);
        }
    }

    /// Visits the bundles of one cell; returns true to end the walk.
    #[inline]
    fn bundles(&mut self, chain: Chain<'_>) -> bool {
        for bundle in chain {
            let lanes = bundle.meeting(&self.asked);
            if lanes != 0 && self.visit.bundle(bundle, lanes, self.onset.as_ref()) {
                return true;
            }
        }
        false
    }

    fn shorten(&mut self, until: f64) {
        if until < self.until {
            self.until = until;
            self.cover = self.sweep.cover(until);
            self.asked = Asked::about(&self.grid.scale, &self.cover);
        }
    }

    #[inline]
    fn every_square(&mut self, area: &Area) {
        for row in area.low[1]..=area.high[1] {
            let first = self.grid.place(area.low[0], row);
            if !self
                .grid
                .may_have_piece(first, 1, area.high[0] - area.low[0], self.layers)
            {
                continue;
            }
            for place in first..=first + (area.high[0] - area.low[0]) as usize {
                if let Some(chain) = self.grid.in_layers(place, self.layers)
                    && self.bundles(chain)
                {
                    return;
                }
            }
        }
        self.visit.pause();
    }

    /// Visits the squares band by band; the bands lie across the axis along which the box moves farthest. In each band
    /// visits only the squares that the box passes while it is over this band.
    fn along<const AXIS: usize>(&mut self, area: &Area) {
        let mut strip = Strip::new::<AXIS>(self.sweep, area);
        let is_slanted = self.sweep.is_slanted();
        let stride = self.grid.stride(1 - AXIS);
        let until = self.visit.pause();
        self.shorten(until);
        let mut last = strip.last(self.until);
        while strip.step <= last {
            let step = strip.step;
            let (band, from, to) = strip.next();
            let first = if AXIS == 0 {
                self.grid.place(band, area.low[1] + from)
            } else {
                self.grid.place(area.low[0] + from, band)
            };
            let steps = to - from;
            if !self.grid.may_have_piece(first, stride, steps, self.layers) {
                continue;
            }
            if is_slanted {
                // The box around a slanted path is much larger than the path, that around its part in a band is not.
                let (enter, leave) = strip.over(step, self.until);
                let cover = self.sweep.between(enter, leave);
                self.asked = Asked::about(&self.grid.scale, &cover);
            }
            for square in 0..=steps as usize {
                if let Some(chain) = self.grid.in_layers(first + stride * square, self.layers)
                    && self.bundles(chain)
                {
                    return;
                }
            }
            let until = self.visit.pause();
            self.shorten(until);
            last = strip.last(self.until);
        }
    }
}
