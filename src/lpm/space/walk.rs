//! The way of a box over the squares of the baseplate, in the direction in which it goes.

use super::area::{Area, PITCH_MM};
use super::cover::{Cover, above};
use super::grid::Grid;
use super::pool::Chain;
use super::silhouettes::{Bundle, LANES};
use super::sweep::{SLACK_MM, SLOWEST_MM, Sweep};

/// Who is shown what a box may meet.
pub(crate) trait Visit {
    /// Whether it matters when a piece is met.
    fn in_order(&self) -> bool;

    /// Bit k of `lanes`: the box may meet lane k of the bundle of this number, in order not before
    /// `entry[k]` of the way. A piece may be shown more than once. True: nothing else matters.
    fn bundle(&mut self, shown: (u32, &Bundle), lanes: u32, entry: &[f32; LANES]) -> bool;

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
    /// Along which the way is longest.
    axis: usize,
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
            axis: sweep.axis(),
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

    /// True when the rest does not matter.
    fn bundles(&mut self, chain: Chain<'_>) -> bool {
        let (sweep, until) = (self.sweep, above(self.until));
        let in_order = self.visit.in_order();
        for (number, bundle) in chain {
            // What only shares the box around a slanted way may be met by no time at all.
            let (lanes, entry) = if self.is_slanted {
                bundle.crossing(sweep, until)
            } else {
                let lanes = bundle.meeting(&self.cover);
                let entry = if in_order && lanes != 0 {
                    bundle.entry(sweep, self.axis)
                } else {
                    [0.0; LANES]
                };
                (lanes, entry)
            };
            if lanes != 0 && self.visit.bundle((number, bundle), lanes, &entry) {
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
        let strip = Strip::new::<AXIS>(self.sweep, area.low[across]);
        let width = area.high[across] - area.low[across];
        let stride = self.grid.stride(across);
        let until = self.visit.pause();
        self.shorten(until);
        for step in 0..=area.high[AXIS] - area.low[AXIS] {
            let band = if strip.forward {
                area.low[AXIS] + step
            } else {
                area.high[AXIS] - step
            };
            if strip.is_after(band, self.until) {
                return;
            }
            let (from, to) = strip.over(band, width);
            let first = if AXIS == 0 {
                self.grid.place(band, area.low[1] + from)
            } else {
                self.grid.place(area.low[0] + from, band)
            };
            let steps = to - from;
            if !self.grid.has_something(first, stride, steps, self.layers) {
                continue;
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
        }
    }
}

/// What a box passes of each band: between two lines, in squares across the bands.
struct Strip {
    forward: bool,
    /// Across per band, and where both lines would be over band 0.
    slope: f64,
    low: f64,
    high: f64,
    /// Way along the bands until the box comes over band 0, in its direction; and the whole way, mm.
    ahead: f64,
    run: f64,
}

impl Strip {
    /// `origin` is the row or column that counts as 0 across.
    #[inline]
    fn new<const AXIS: usize>(sweep: &Sweep, origin: i32) -> Strip {
        let across = 1 - AXIS;
        let start = |bounds: &[f32; 3], axis: usize| f64::from(bounds[axis]);
        let run = sweep.run[AXIS];
        let slope = sweep.run[across] / run;
        // The way of the box over band 0 begins and ends here, whichever way it goes.
        let first = -start(&sweep.start.high, AXIS) - SLACK_MM;
        let last = PITCH_MM - start(&sweep.start.low, AXIS) + SLACK_MM;
        let (lowest, highest) = if slope >= 0.0 {
            (first, last)
        } else {
            (last, first)
        };
        let squares = |mm: f64| mm * (1.0 / PITCH_MM) - f64::from(origin);
        Strip {
            forward: run > 0.0,
            slope,
            low: squares(start(&sweep.start.low, across) - SLACK_MM + slope * lowest),
            high: squares(start(&sweep.start.high, across) + SLACK_MM + slope * highest),
            ahead: if run > 0.0 { first } else { last },
            run,
        }
    }

    /// First and last square that the box may pass over a band, of `0..=width`. Where it stands at the
    /// ends of its way does not count: a superset is safe.
    #[inline]
    fn over(&self, band: i32, width: i32) -> (i32, i32) {
        let shift = self.slope * f64::from(band);
        // A cast cuts towards 0, which is downward for all that counts. What is no number, of a box
        // without end, is every square.
        let from = ((self.low + shift) as i32).clamp(0, width);
        let to = (self.high + shift).min(f64::from(width)) as i32;
        (from, to.max(0))
    }

    /// Whether the box comes over a band only after the fraction `until` of its way.
    #[inline]
    fn is_after(&self, band: i32, until: f64) -> bool {
        let way = self.ahead + f64::from(band) * PITCH_MM;
        if self.forward {
            way > self.run * until
        } else {
            way < self.run * until
        }
    }
}
