//! The way of a box over the squares of the baseplate, in the direction in which it goes.

use super::area::{Area, PITCH_MM, cell_of};
use super::cover::{Cover, above};
use super::grid::Grid;
use super::pool::Chain;
use super::silhouettes::{Bundle, LANES};
use super::sweep::{SLOWEST_MM, Sweep};

/// Who is shown what a box may meet.
pub(crate) trait Visit {
    /// Whether it matters when a piece is met.
    fn in_order(&self) -> bool;

    /// Bit k of `lanes`: the box may meet lane k, in order not before `entry[k]` of the way. A piece may
    /// be shown more than once. True: nothing else matters.
    fn bundle(&mut self, bundle: &Bundle, lanes: u32, entry: &[f32; LANES]) -> bool;

    /// Whatever is not shown yet is met later on the way, or as late as what was shown since the last
    /// pause. Answers with the fraction of the way that still matters; below 0: nothing does.
    fn pause(&mut self) -> f64;
}

/// A box under way.
pub(super) struct Walk<'a, V> {
    grid: &'a Grid,
    sweep: &'a Sweep,
    /// Layers that the box passes.
    layers: u64,
    /// Of the box on what is left of its way.
    cover: Cover,
    /// The fraction of the way that matters.
    until: f64,
    is_slanted: bool,
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
            until: 1.0,
            is_slanted: sweep.is_slanted(),
            visit,
        }
    }

    /// The open cell, then the squares.
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
        let [wide, high] = [0, 1].map(|axis: usize| area.high[axis] - area.low[axis]);
        let [x, y] = [self.sweep.run[0].abs(), self.sweep.run[1].abs()];
        if wide <= 1 && high <= 1 || x.max(y) < SLOWEST_MM {
            self.every_square(&area);
        } else if x >= y {
            self.along::<0>(&area);
        } else {
            self.along::<1>(&area);
        }
    }

    /// True when the rest does not matter.
    fn bundles(&mut self, chain: Chain<'_>) -> bool {
        let (sweep, until) = (self.sweep, above(self.until));
        // What only shares the box around the way is met by no time at all.
        let timed = self.is_slanted || self.visit.in_order();
        for bundle in chain {
            let (lanes, entry) = if timed {
                let crossing = bundle.boxes.crossing(&sweep.start, &sweep.pace, until);
                (crossing.lanes, crossing.entry)
            } else {
                (bundle.boxes.meeting(&self.cover), [0.0; LANES])
            };
            if lanes != 0 && self.visit.bundle(bundle, lanes, &entry) {
                return true;
            }
        }
        false
    }

    fn shorten(&mut self, until: f64) {
        if until < self.until {
            self.until = until;
            self.cover = self.sweep.cover(until);
        }
    }

    #[inline]
    fn every_square(&mut self, area: &Area) {
        for row in area.low[1]..=area.high[1] {
            let first = self.grid.place(area.low[0], row);
            if !self
                .grid
                .has_something(first, 1, area.high[0] - area.low[0], self.layers)
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

    /// Band by band across the axis of the longer way, in its direction: of each band only the
    /// squares that the box passes while it is over the band.
    fn along<const AXIS: usize>(&mut self, area: &Area) {
        let across = 1 - AXIS;
        let forward = self.sweep.run[AXIS] > 0.0;
        let pace = 1.0 / self.sweep.run[AXIS];
        let until = self.visit.pause();
        self.shorten(until);
        for step in 0..=area.high[AXIS] - area.low[AXIS] {
            let band = if forward {
                area.low[AXIS] + step
            } else {
                area.high[AXIS] - step
            };
            let edge = f64::from(band) * PITCH_MM;
            let (first, last) = self.sweep.during(AXIS, pace, edge, edge + PITCH_MM);
            if first > self.until {
                return;
            }
            let (low, high) = self
                .sweep
                .between(across, first.max(0.0), last.min(self.until));
            let from = cell_of(low).max(area.low[across]);
            let to = cell_of(high).min(area.high[across]);
            let first = if AXIS == 0 {
                self.grid.place(band, from)
            } else {
                self.grid.place(from, band)
            };
            let stride = self.grid.stride(across);
            if !self
                .grid
                .has_something(first, stride, to - from, self.layers)
            {
                continue;
            }
            let mut shown = false;
            for square in 0..=to - from {
                let place = first + stride * square as usize;
                if let Some(chain) = self.grid.in_layers(place, self.layers) {
                    shown = true;
                    if self.bundles(chain) {
                        return;
                    }
                }
            }
            if shown {
                let until = self.visit.pause();
                self.shorten(until);
            }
        }
    }
}
