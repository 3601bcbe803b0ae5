//! Boxes in codes of 16 bits: places and heights in whole steps, so that one instruction compares eight of them.
//!
//! A place becomes a code by one function that never decreases, for stationary pieces and for the mover alike. So two
//! boxes that overlap have overlapping codes; the reverse need not hold, because a code covers a whole step.
//! Places beyond the first and the last code get that code, which is as safe.

use super::area::{Area, PITCH_MM};
use super::cover::{Cover, larger};
use super::four::Four;
use super::layers::Reach;
use super::sweep::{Pace, Sweep};

/// First and last code of a place.
const FIRST: i16 = -i16::MAX;
const LAST: i16 = i16::MAX - 1;

/// Binary logarithm of the greatest number of codes along a side of a square: steps of 1/32 mm.
const FINEST: i32 = 11;
/// Number of codes in a millimetre of height.
const HEIGHT_PER_MM: f32 = 32.0;
/// Height of code 0, mm; codes reach from about -570 to 1470 mm.
const MIDDLE_MM: f32 = 448.0;

/// Codes of a box along x, y and z; the fourth members mean nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Extent {
    pub(super) low: [i16; 4],
    pub(super) high: [i16; 4],
}

impl Extent {
    /// Meets no box on any path, because its codes lie beyond those of every place.
    pub(super) const NOWHERE: Extent = Extent {
        low: [i16::MAX; 4],
        high: [i16::MIN; 4],
    };

    /// Returns the layers into which the box reaches; no scale changes them.
    #[inline(always)]
    pub(super) fn reach(&self) -> Reach {
        Reach::between(self.low[2], self.high[2])
    }
}

/// How places in a grid become codes; the fourth members are 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Place in the middle of all codes, mm.
    middle: [f32; 4],
    /// Number of codes in a millimetre, a power of two.
    per_mm: [f32; 4],
}

impl Scale {
    /// Returns the finest scale with a code for every place in an area.
    pub(super) fn over(area: &Area) -> Scale {
        let edge = |axis: usize| i64::from(area.high[axis]) - i64::from(area.low[axis]) + 1;
        let squares = edge(0).max(edge(1));
        let has_room = |power: &i32| squares << power < 1 << 16;
        let power = (0..=FINEST).rev().find(has_room).unwrap_or(0);
        let per_mm = (1 << power) as f32 / PITCH_MM as f32;
        let middle =
            |axis: usize| (0.5 * PITCH_MM * f64::from(area.low[axis] + area.high[axis] + 1)) as f32;
        Scale {
            middle: [middle(0), middle(1), MIDDLE_MM, 0.0],
            per_mm: [per_mm, per_mm, HEIGHT_PER_MM, 0.0],
        }
    }

    /// Returns the codes of a box. A bound that is not a number counts as infinite.
    #[inline(always)]
    pub(super) fn extent(&self, cover: &Cover) -> Extent {
        let [low, high] = [&cover.low, &cover.high].map(|bound| {
            let moved = Four::of(bound).minus(Four::of(&self.middle));
            moved.times(Four::of(&self.per_mm))
        });
        let [a, b, c, d, e, f, g, h] = lower_codes(low).nearest_codes(upper_codes(high));
        Extent {
            low: [a, b, c, d],
            high: [e, f, g, h],
        }
    }

    /// Returns codes of this scale for a piece that has `extent` in the scale `old`, at most two steps too wide.
    pub(super) fn converted(&self, old: &Scale, extent: &Extent) -> Extent {
        let mut converted = *extent;
        for axis in 0..2 {
            let code = |code: i16, wider: f64| {
                let steps = (f64::from(code) + wider) / f64::from(old.per_mm[axis]);
                let place = steps + f64::from(old.middle[axis]) - f64::from(self.middle[axis]);
                place * f64::from(self.per_mm[axis]) + wider
            };
            // The first and the last code cover everything beyond and stay unchanged, as do the codes of a free lane.
            let (low, high) = (extent.low[axis], extent.high[axis]);
            if (FIRST + 1..=LAST).contains(&low) {
                let low = code(low, -1.0).floor();
                converted.low[axis] = low.clamp(FIRST.into(), LAST.into()) as i16;
            }
            if (FIRST..LAST).contains(&high) {
                let high = code(high, 1.0).ceil();
                converted.high[axis] = high.clamp(FIRST.into(), LAST.into()) as i16;
            }
        }
        converted
    }

    /// Returns how the codes of pieces give the fractions of a path at which a moving box reaches them.
    #[inline]
    pub(super) fn onset(&self, sweep: &Sweep) -> Onset {
        let axis = |axis: usize| {
            let pace = sweep.pace.0[axis];
            let is_backward = pace < 0.0;
            // Half a step is lost in the code; half a step more covers rounding.
            let (bound, step, beyond) = if is_backward {
                (sweep.start.low[axis], -1.0, LAST)
            } else {
                (sweep.start.high[axis], 1.0, FIRST)
            };
            let is_moving = Pace::is_moving(pace);
            let pace = if is_moving {
                pace / self.per_mm[axis]
            } else {
                0.0
            };
            Axis {
                is_backward,
                beyond,
                lead: (bound - self.middle[axis]) * self.per_mm[axis] + step,
                pace,
            }
        };
        Onset {
            axes: [axis(0), axis(1), axis(2)],
        }
    }
}

/// Returns the codes of two heights, mm.
#[inline(always)]
pub(super) fn heights(bottom_mm: f32, top_mm: f32) -> (i16, i16) {
    let scaled = |mm: f32| Four::all((mm - MIDDLE_MM) * HEIGHT_PER_MM);
    let (low, high) = (lower_codes(scaled(bottom_mm)), upper_codes(scaled(top_mm)));
    let [low, .., high] = low.nearest_codes(high);
    (low, high)
}

/// Limits lower bounds in steps to those that have a code.
#[inline(always)]
fn lower_codes(steps: Four) -> Four {
    let within = steps.larger(Four::all(FIRST.into()));
    within.smaller(Four::all(LAST.into()))
}

/// Limits upper bounds in steps to those that have a code.
#[inline(always)]
fn upper_codes(steps: Four) -> Four {
    let within = steps.smaller(Four::all(LAST.into()));
    within.larger(Four::all(FIRST.into()))
}

/// How the codes of pieces give the fractions of a path at which a moving box reaches them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Onset {
    axes: [Axis; 3],
}

/// An axis of an [`Onset`].
#[derive(Debug, Clone, Copy)]
struct Axis {
    /// Whether the box moves towards smaller codes, and reaches high codes first.
    is_backward: bool,
    /// Code that covers everything beyond it on the side from which the box comes.
    beyond: i16,
    /// Bound of the box that comes first, in steps.
    lead: f32,
    /// Fraction of the path per step; 0 for an axis at rest.
    pace: f32,
}

/// Factor that decreases a fraction of the path by more than its roundings.
const EARLIER: f32 = 1.0 - 8.0 * f32::EPSILON;

impl Onset {
    /// Returns the fraction of the path before which the box does not meet a piece with this extent. Selects by
    /// arithmetic, because branches here are unpredictable.
    #[inline(always)]
    pub(super) fn entry(&self, Extent { low, high }: &Extent) -> f32 {
        let reached = |axis: usize| {
            let it = &self.axes[axis];
            let code = if it.is_backward {
                high[axis]
            } else {
                low[axis]
            };
            let reached = (f32::from(code) - it.lead) * it.pace;
            if code == it.beyond { 0.0 } else { reached }
        };
        let latest = larger(larger(reached(0), reached(1)), reached(2));
        larger(latest, 0.0) * EARLIER
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::tests::Dice;

    fn overlap(a: &Extent, b: &Extent) -> bool {
        (0..3).all(|axis| a.low[axis] <= b.high[axis] && b.low[axis] <= a.high[axis])
    }

    fn area(dice: &mut Dice) -> Area {
        let mut side = || {
            let longest = [20, 300][dice.pick(2) as usize];
            let low = dice.pick(4_000) as i32 - 2_000;
            (low, low + 1 + dice.pick(longest) as i32)
        };
        let (x, y) = (side(), side());
        Area {
            low: [x.0, y.0],
            high: [x.1, y.1],
        }
    }

    /// Draws a box of whole millimetres near an area.
    fn drawn(dice: &mut Dice, area: &Area) -> Cover {
        let mut cover = Cover {
            low: [0.0; 4],
            high: [0.0; 4],
        };
        for axis in 0..3 {
            let corner = if axis < 2 { 64 * area.low[axis] } else { 0 };
            let low = corner + dice.pick(150) as i32 - 50;
            cover.low[axis] = low as f32;
            cover.high[axis] = (low + dice.pick(90) as i32) as f32;
        }
        cover
    }

    #[test]
    fn boxes_that_overlap_have_overlapping_codes() {
        let mut dice = Dice::new(41);
        let (mut met, mut apart) = (0, 0);
        for _ in 0..20_000 {
            let area = area(&mut dice);
            let (a, b) = (drawn(&mut dice, &area), drawn(&mut dice, &area));
            let old = Scale::over(&area);
            let grown = Area {
                low: area.low.map(|low| low - dice.pick(90) as i32),
                high: area.high.map(|high| high + dice.pick(90) as i32),
            };
            let new = Scale::over(&grown);
            let is_met = overlap(&old.extent(&a), &old.extent(&b));
            if a.distance(&b) == 0.0 {
                assert!(is_met, "{a:?} {b:?} {old:?}");
                let converted = new.converted(&old, &old.extent(&a));
                assert!(
                    overlap(&converted, &new.extent(&b)),
                    "{a:?} {b:?} {old:?} {new:?}"
                );
                met += 1;
            } else {
                apart += u32::from(!is_met);
            }
        }
        assert!(met > 1_000 && apart > 5_000, "{met} {apart}");
    }

    #[test]
    fn a_box_without_end_or_number_meets_everything_but_free_lanes() {
        let area = Area {
            low: [0; 2],
            high: [9; 2],
        };
        let scale = Scale::over(&area);
        let piece = drawn(&mut Dice::new(5), &area);
        for end in [f32::INFINITY, 1e6, f32::NAN] {
            let whole = scale.extent(&Cover {
                low: [-end; 4],
                high: [end; 4],
            });
            assert!(overlap(&whole, &scale.extent(&piece)), "{end}");
            assert!(!overlap(&whole, &Extent::NOWHERE), "{end}");
            assert_eq!(scale.converted(&Scale::over(&Area::NOWHERE), &whole), whole);
        }
        let free = scale.converted(&Scale::over(&Area::NOWHERE), &Extent::NOWHERE);
        assert_eq!(free, Extent::NOWHERE);
    }

    #[test]
    fn an_entry_comes_no_later_than_the_boxes_meet() {
        let mut dice = Dice::new(43);
        let (mut met, mut late) = (0, 0);
        for _ in 0..20_000 {
            let area = area(&mut dice);
            let (piece, start) = (drawn(&mut dice, &area), drawn(&mut dice, &area));
            let run = [0; 3].map(|_| f64::from(8 * (dice.pick(41) as i32 - 20)));
            let moved = |t: f64| {
                let shift = |bound: [f32; 4]| {
                    let place = |axis: usize| (f64::from(bound[axis]) + t * run[axis]) as f32;
                    [place(0), place(1), place(2), 0.0]
                };
                Cover {
                    low: shift(start.low),
                    high: shift(start.high),
                }
            };
            let mut eighths = (0..=8).map(|eighth| f64::from(eighth) / 8.0);
            let Some(first) = eighths.find(|t| moved(*t).distance(&piece) == 0.0) else {
                continue;
            };
            let scale = Scale::over(&area);
            let extent = scale.extent(&piece);
            let entry = scale.onset(&Sweep::new(start, run)).entry(&extent);
            assert!(
                f64::from(entry) <= first,
                "{entry} {first} {piece:?} {start:?} {run:?}"
            );
            met += 1;
            late += u32::from(entry > 0.0);
        }
        assert!(met > 1_000 && late > 300, "{met} {late}");
    }
}
