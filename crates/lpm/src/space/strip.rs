//! The squares that a moving box passes, band by band. A band is a row or column across the path; in each band the box
//! passes the squares between two lines.
//!
//! Both lines are tracked in units of 2^-32 squares. The width includes a reserve for the rounding to units, at most
//! one per band, so that the strip contains every square that the box passes. The strip ignores where within a band the
//! box starts and ends: too many squares are safe.

use super::area::{Area, PITCH_MM};
use super::sweep::{SLACK_MM, Sweep};

/// Number of units on the side of a square, a power of two.
const UNIT: f64 = (1u64 << UNIT_BITS) as f64;
const UNIT_BITS: u32 = 32;

/// Number of squares that replaces infinity: no grid, and no line within a grid, reaches as far.
const BEYOND: f64 = (1 << 28) as f64;

/// The bands of an area, in the order of the path. The box moves farther across the bands than along them.
pub(super) struct Strip {
    /// Number of the next band, counted from 0.
    pub(super) step: i32,
    band: i32,
    /// Step to the next band: 1 or -1.
    towards: i32,
    /// Number of the last band.
    last: i32,
    /// Position of the lower line over the next band, from the first row or column of the area, in units.
    low: i64,
    /// Position of the upper line over the next band, from the first row or column of the area, in units.
    high: i64,
    /// Advance of both lines per band, in units.
    slope: i64,
    /// Last row or column of the area.
    width: i32,
    /// Length of the path until the box reaches the first band, in bands.
    ahead: f64,
    /// Length of the whole path, in bands.
    run: f64,
    /// Length of the path while the box is over a band, in bands.
    over: f64,
}

impl Strip {
    #[inline]
    pub(super) fn new<const AXIS: usize>(sweep: &Sweep, area: &Area) -> Strip {
        let across = 1 - AXIS;
        let is_forward = sweep.run[AXIS] > 0.0;
        let (towards, band) = if is_forward {
            (1, area.low[AXIS])
        } else {
            (-1, area.high[AXIS])
        };
        // The box lies over the first band while its displacement is between `first` and `end`, in either direction.
        let edge = f64::from(band) * PITCH_MM;
        let first = edge - f64::from(sweep.start.high[AXIS]) - SLACK_MM;
        let end = edge + PITCH_MM - f64::from(sweep.start.low[AXIS]) + SLACK_MM;
        let slope = sweep.run[across] / sweep.run[AXIS];
        let (least, most) = if slope >= 0.0 {
            (first, end)
        } else {
            (end, first)
        };
        let last = area.high[AXIS] - area.low[AXIS];
        let spare = i64::from(last) + 2;
        let units = |mm: f64| {
            let squares = mm * (1.0 / PITCH_MM) - f64::from(area.low[across]);
            squares.clamp(-BEYOND, BEYOND) * UNIT
        };
        let low = f64::from(sweep.start.low[across]) - SLACK_MM + slope * least;
        let high = f64::from(sweep.start.high[across]) + SLACK_MM + slope * most;
        // A box of infinite size, which covers every square, gives NaN.
        let low = if low.is_nan() { -BEYOND } else { low };
        let high = if high.is_nan() { BEYOND } else { high };
        let direction = f64::from(towards);
        Strip {
            step: 0,
            band,
            towards,
            last,
            low: units(low) as i64 - spare,
            high: units(high) as i64 + spare,
            slope: (slope * direction * UNIT) as i64,
            width: area.high[across] - area.low[across],
            ahead: direction * if is_forward { first } else { end } * (1.0 / PITCH_MM),
            run: sweep.run[AXIS].abs() * (1.0 / PITCH_MM),
            over: (end - first) * (1.0 / PITCH_MM),
        }
    }

    /// Returns the fractions of the path between which the box is over the band `step`, at most `until`.
    #[inline]
    pub(super) fn over(&self, step: i32, until: f64) -> (f64, f64) {
        let enter = self.ahead + f64::from(step);
        // Minimum and maximum ignore NaN, which means the whole path.
        let leave = ((enter + self.over) / self.run).min(until);
        ((enter / self.run).max(0.0), leave)
    }

    /// Returns the number of the last band that the box reaches up to the fraction `until` of its path.
    #[inline]
    pub(super) fn last(&self, until: f64) -> i32 {
        let bands = self.run * until - self.ahead;
        // NaN means all bands.
        if bands < f64::from(self.last) {
            // The cast truncates towards 0, which rounds non-negative numbers down; only these matter.
            if bands < 0.0 { -1 } else { bands as i32 }
        } else {
            self.last
        }
    }

    /// Returns the next band, with the first and the last square in it that the box may pass; the last comes before the
    /// first when there is none.
    #[inline(always)]
    pub(super) fn next(&mut self) -> (i32, i32, i32) {
        let square = |units: i64| (units >> UNIT_BITS) as i32;
        let passed = (
            self.band,
            square(self.low).max(0),
            square(self.high).min(self.width),
        );
        self.step += 1;
        self.band += self.towards;
        (self.low, self.high) = (self.low + self.slope, self.high + self.slope);
        passed
    }
}

#[cfg(test)]
mod tests {
    use super::super::cover::Cover;
    use super::*;
    use crate::distance::tests::Dice;

    /// Returns, for each band, its number and the first and last square in it.
    fn bands<const AXIS: usize>(sweep: &Sweep, area: &Area, until: f64) -> Vec<(i32, i32, i32)> {
        let mut strip = Strip::new::<AXIS>(sweep, area);
        let last = strip.last(until);
        let mut bands = Vec::new();
        while strip.step <= last {
            bands.push(strip.next());
        }
        bands
    }

    #[test]
    fn the_strip_contains_every_passed_square() {
        let mut dice = Dice::new(23);
        let (mut passed, mut spared) = (0, 0);
        for _ in 0..400 {
            let [x, y, z] = dice.vector().map(|member| 40.0 * member.abs());
            let mut at = dice.vector().map(|member| 500.0 * member);
            if dice.pick(2) == 0 {
                // Places beside a grid line, on either side.
                let line = PITCH_MM * dice.pick(3) as f64 - PITCH_MM;
                (at[0], at[1]) = (
                    line - x + 3e-6 * dice.signed(),
                    line - y + 3e-6 * dice.signed(),
                );
            }
            let start = Cover::of((at, [at[0] + x, at[1] + y, at[2] + z]));
            let long = (500.0 + 1500.0 * dice.signed().abs()).copysign(dice.signed());
            let sweep = Sweep::new(start, [long, 0.9 * long.abs() * dice.signed(), 3.0]);
            let area = Area::of(&Cover::of(([-900.0; 3], [900.0; 3])));
            let until = dice.signed().abs();
            let bands = bands::<0>(&sweep, &area, until);
            for moment in 0..200 {
                let t = until * f64::from(moment) / 199.0;
                let moved = |bound: [f32; 4]| {
                    [0, 1, 2].map(|axis: usize| f64::from(bound[axis]) + t * sweep.run[axis])
                };
                let over = Area::of(&Cover::of((moved(start.low), moved(start.high))));
                for column in over.low[0].max(area.low[0])..=over.high[0].min(area.high[0]) {
                    for row in over.low[1].max(area.low[1])..=over.high[1].min(area.high[1]) {
                        let square = row - area.low[1];
                        let known = bands.iter().any(|(band, from, to)| {
                            *band == column && (from..=to).contains(&&square)
                        });
                        assert!(known, "{sweep:?} {t} {column} {row}");
                        passed += 1;
                    }
                }
            }
            let width = area.high[1] - area.low[1] + 1;
            let shown: i32 = bands
                .iter()
                .map(|(_, from, to)| (to - from + 1).max(0))
                .sum();
            spared += width * bands.len() as i32 - shown;
        }
        assert!(passed > 100_000 && spared > 10_000, "{passed} {spared}");
    }

    #[test]
    fn a_box_without_end_passes_every_square() {
        let endless = Cover {
            low: [f32::NEG_INFINITY; 4],
            high: [f32::INFINITY; 4],
        };
        let area = Area::of(&Cover::of(([-900.0; 3], [900.0; 3])));
        for run in [[300.0, 0.0, 0.0], [-300.0, 20.0, 0.0], [300.0, -20.0, 0.0]] {
            let bands = bands::<0>(&Sweep::new(endless, run), &area, 0.5);
            let width = area.high[1] - area.low[1];
            assert_eq!(bands.len() as i32, area.high[0] - area.low[0] + 1);
            assert!(bands.iter().all(|(_, from, to)| (*from, *to) == (0, width)));
        }
    }
}
