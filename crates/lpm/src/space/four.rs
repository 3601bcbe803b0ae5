//! Four numbers in single precision, processed by one instruction.

#[cfg(not(target_arch = "x86_64"))]
use one_by_one as machine;
#[cfg(target_arch = "x86_64")]
use sse as machine;

/// Four numbers in single precision.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Four(machine::Numbers);

impl Four {
    #[inline(always)]
    pub(crate) fn of(numbers: &[f32; 4]) -> Four {
        Four(machine::of(numbers))
    }

    #[inline(always)]
    pub(crate) fn all(number: f32) -> Four {
        Four::of(&[number; 4])
    }

    /// Rounds three numbers to nearest; the fourth is 0.
    #[inline(always)]
    pub(crate) fn rounded(three: &[f64; 3]) -> Four {
        Four(machine::rounded(three))
    }

    #[inline(always)]
    pub(crate) fn numbers(self) -> [f32; 4] {
        machine::numbers(self.0)
    }

    #[inline(always)]
    pub(crate) fn plus(self, other: Four) -> Four {
        Four(machine::plus(self.0, other.0))
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Four) -> Four {
        Four(machine::minus(self.0, other.0))
    }

    #[inline(always)]
    pub(crate) fn times(self, other: Four) -> Four {
        Four(machine::times(self.0, other.0))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Four {
        Four(machine::abs(self.0))
    }

    /// Returns the smaller number of each pair; that of `other` when one of them is NaN.
    #[inline(always)]
    pub(crate) fn smaller(self, other: Four) -> Four {
        Four(machine::smaller(self.0, other.0))
    }

    /// Returns the larger number of each pair; that of `other` when one of them is NaN.
    #[inline(always)]
    pub(crate) fn larger(self, other: Four) -> Four {
        Four(machine::larger(self.0, other.0))
    }

    /// Limits each number to the range from `low` to `high`, with `low` at most `high`; NaN becomes one of the two.
    #[inline(always)]
    pub(crate) fn within(self, low: Four, high: Four) -> Four {
        self.larger(low).smaller(high)
    }

    /// Returns the first two numbers of `self`, then the first two of `other`.
    #[inline(always)]
    pub(crate) fn first_two(self, other: Four) -> Four {
        Four(machine::first_two(self.0, other.0))
    }

    /// Returns the nearest whole numbers, ties to even; each number must be at most 2^23.
    #[inline(always)]
    pub(crate) fn nearest(self) -> [i32; 4] {
        machine::nearest(self.0)
    }

    /// Returns [`Four::nearest`] of `self`, then of `other`; each number must be in the range of an i16.
    #[inline(always)]
    pub(crate) fn nearest_codes(self, other: Four) -> [i16; 8] {
        machine::nearest_codes(self.0, other.0)
    }

    /// Returns a mask in which bit k is set when number k is at most that of `other`; never set for NaN.
    #[inline(always)]
    pub(crate) fn at_most(self, other: Four) -> u32 {
        machine::bits(machine::at_most(self.0, other.0))
    }

    /// Returns a mask in which bit k is set when, in all six pairs, number k of the first is at most that of the
    /// second.
    #[inline(always)]
    pub(crate) fn all_at_most(pairs: [(Four, Four); 6]) -> u32 {
        let [a, b, c, d, e, f] = pairs.map(|(a, b)| machine::at_most(a.0, b.0));
        let (ab, cd, ef) = (
            machine::both(a, b),
            machine::both(c, d),
            machine::both(e, f),
        );
        machine::bits(machine::both(machine::both(ab, cd), ef))
    }
}

/// Implementation with SSE2, which every x86-64 processor has.
#[cfg(target_arch = "x86_64")]
mod sse {
    use std::arch::x86_64::*;

    pub(super) type Numbers = __m128;

    /// Defines safe functions for instructions that only use registers.
    macro_rules! instructions {
        ($($name:ident($($from:ident),+) = $intrinsic:ident;)+) => {$(
            #[inline(always)]
            pub(super) fn $name($($from: Numbers),+) -> Numbers {
                // SAFETY: SSE2 is part of every x86-64; the instruction needs nothing else.
                unsafe { $intrinsic($($from),+) }
            }
        )+};
    }

    instructions! {
        plus(a, b) = _mm_add_ps;
        minus(a, b) = _mm_sub_ps;
        times(a, b) = _mm_mul_ps;
        smaller(a, b) = _mm_min_ps;
        larger(a, b) = _mm_max_ps;
        first_two(a, b) = _mm_movelh_ps;
        at_most(a, b) = _mm_cmple_ps;
        both(a, b) = _mm_and_ps;
    }

    #[inline(always)]
    pub(super) fn of(numbers: &[f32; 4]) -> Numbers {
        // SAFETY: as above; the array holds four numbers, and the load needs no alignment.
        unsafe { _mm_loadu_ps(numbers.as_ptr()) }
    }

    #[inline(always)]
    pub(super) fn numbers(a: Numbers) -> [f32; 4] {
        let mut numbers = [0.0; 4];
        // SAFETY: as above; four numbers may be written.
        unsafe { _mm_storeu_ps(numbers.as_mut_ptr(), a) };
        numbers
    }

    #[inline(always)]
    pub(super) fn rounded(three: &[f64; 3]) -> Numbers {
        // SAFETY: as above; reads two numbers and then one, all within the array.
        unsafe {
            let (xy, z) = (_mm_loadu_pd(three.as_ptr()), _mm_load_sd(&three[2]));
            _mm_movelh_ps(_mm_cvtpd_ps(xy), _mm_cvtpd_ps(z))
        }
    }

    #[inline(always)]
    pub(super) fn abs(a: Numbers) -> Numbers {
        // SAFETY: as above.
        unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), a) }
    }

    #[inline(always)]
    pub(super) fn nearest(a: Numbers) -> [i32; 4] {
        let mut whole = [0; 4];
        // SAFETY: as above; four numbers may be written.
        unsafe { _mm_storeu_si128(whole.as_mut_ptr().cast(), _mm_cvtps_epi32(a)) };
        whole
    }

    #[inline(always)]
    pub(super) fn nearest_codes(a: Numbers, b: Numbers) -> [i16; 8] {
        let mut codes = [0; 8];
        // SAFETY: as above; eight numbers may be written.
        unsafe {
            let packed = _mm_packs_epi32(_mm_cvtps_epi32(a), _mm_cvtps_epi32(b));
            _mm_storeu_si128(codes.as_mut_ptr().cast(), packed);
        }
        codes
    }

    #[inline(always)]
    pub(super) fn bits(a: Numbers) -> u32 {
        // SAFETY: as above.
        unsafe { _mm_movemask_ps(a) as u32 }
    }
}

/// Implementation for other processors: the functions of `sse`, one number after the other.
#[cfg(any(test, not(target_arch = "x86_64")))]
mod one_by_one {
    pub(super) type Numbers = [f32; 4];

    /// Defines a function that applies `made` to each of the four positions.
    macro_rules! each {
        ($($name:ident($($from:ident),+) = $made:expr;)+) => {$(
            pub(super) fn $name($($from: Numbers),+) -> Numbers {
                std::array::from_fn(|at| {
                    $(let $from = $from[at];)+
                    $made
                })
            }
        )+};
    }

    each! {
        plus(a, b) = a + b;
        minus(a, b) = a - b;
        times(a, b) = a * b;
        smaller(a, b) = if a < b { a } else { b };
        larger(a, b) = if a > b { a } else { b };
        abs(a) = a.abs();
        at_most(a, b) = f32::from_bits(if a <= b { u32::MAX } else { 0 });
        both(a, b) = f32::from_bits(a.to_bits() & b.to_bits());
    }

    pub(super) fn of(numbers: &[f32; 4]) -> Numbers {
        *numbers
    }

    pub(super) fn numbers(a: Numbers) -> [f32; 4] {
        a
    }

    pub(super) fn rounded([x, y, z]: &[f64; 3]) -> Numbers {
        [*x as f32, *y as f32, *z as f32, 0.0]
    }

    pub(super) fn first_two(a: Numbers, b: Numbers) -> Numbers {
        [a[0], a[1], b[0], b[1]]
    }

    pub(super) fn nearest(a: Numbers) -> [i32; 4] {
        a.map(|number| number.round_ties_even() as i32)
    }

    pub(super) fn nearest_codes([a, b, c, d]: Numbers, [e, f, g, h]: Numbers) -> [i16; 8] {
        [a, b, c, d, e, f, g, h].map(|number| number.round_ties_even() as i16)
    }

    pub(super) fn bits(a: Numbers) -> u32 {
        (0..4).fold(0, |bits, at| bits | a[at].to_bits() >> 31 << at)
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::{one_by_one, sse};
    use crate::distance::tests::Dice;

    fn drawn(dice: &mut Dice) -> [f32; 4] {
        [0; 4].map(|_| match dice.pick(8) {
            0 => f32::NAN,
            1 => f32::INFINITY,
            2 => (dice.signed() * 4.0).round() as f32,
            _ => (dice.signed() * 2f64.powi(dice.pick(40) as i32 - 20)) as f32,
        })
    }

    fn same(a: [f32; 4], b: [f32; 4]) -> bool {
        a.iter()
            .zip(b)
            .all(|(a, b)| *a == b || a.is_nan() && b.is_nan())
    }

    #[test]
    fn four_at_a_time_equals_one_by_one() {
        let mut dice = Dice::new(8);
        for _ in 0..4_000 {
            let (a, b) = (drawn(&mut dice), drawn(&mut dice));
            let (fast_a, fast_b) = (sse::of(&a), sse::of(&b));
            let (a, b) = (one_by_one::of(&a), one_by_one::of(&b));
            let made = [
                (sse::plus(fast_a, fast_b), one_by_one::plus(a, b)),
                (sse::minus(fast_a, fast_b), one_by_one::minus(a, b)),
                (sse::times(fast_a, fast_b), one_by_one::times(a, b)),
                (sse::smaller(fast_a, fast_b), one_by_one::smaller(a, b)),
                (sse::larger(fast_a, fast_b), one_by_one::larger(a, b)),
                (sse::first_two(fast_a, fast_b), one_by_one::first_two(a, b)),
                (sse::abs(fast_a), one_by_one::abs(a)),
            ];
            for (at, (fast, slow)) in made.into_iter().enumerate() {
                let slow = one_by_one::numbers(slow);
                assert!(same(sse::numbers(fast), slow), "{at}: {a:?} {b:?}");
            }
            let three = [0, 1, 2].map(|at: usize| f64::from(a[at]) * 1.000_000_1);
            assert!(same(
                sse::numbers(sse::rounded(&three)),
                one_by_one::rounded(&three)
            ));
            let (fast, slow) = (sse::at_most(fast_a, fast_b), one_by_one::at_most(a, b));
            assert_eq!(sse::bits(fast), one_by_one::bits(slow), "{a:?} {b:?}");
            let either = (sse::at_most(fast_b, fast_a), one_by_one::at_most(b, a));
            let both = (sse::both(fast, either.0), one_by_one::both(slow, either.1));
            assert_eq!(sse::bits(both.0), one_by_one::bits(both.1), "{a:?} {b:?}");
        }
    }

    #[test]
    fn rounding_gives_the_nearest_whole_number() {
        let mut dice = Dice::new(12);
        for exponent in -30..22 {
            for _ in 0..100 {
                let x = (dice.signed() * 2f64.powi(exponent)) as f32;
                let half = x.round() + 0.5;
                let four = [x, half, half.next_down(), half.next_up()];
                assert_eq!(
                    sse::nearest(sse::of(&four)),
                    one_by_one::nearest(four),
                    "{x:e}"
                );
                let codes = [four, four.map(|x| -x)].map(|four| four.map(|x| x % 32_000.0));
                let [low, high] = codes.map(|four| sse::of(&four));
                assert_eq!(
                    sse::nearest_codes(low, high),
                    one_by_one::nearest_codes(codes[0], codes[1]),
                    "{x:e}"
                );
            }
        }
    }
}
