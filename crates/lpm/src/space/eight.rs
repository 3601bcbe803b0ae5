//! Eight whole numbers of 16 bits, processed by one instruction.

#[cfg(not(target_arch = "x86_64"))]
use one_by_one as machine;
#[cfg(target_arch = "x86_64")]
use sse as machine;

/// Eight whole numbers of 16 bits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Eight(machine::Numbers);

impl Eight {
    #[inline(always)]
    pub(super) fn of(numbers: &[i16; 8]) -> Eight {
        Eight(machine::of(numbers))
    }

    #[inline(always)]
    pub(super) fn all(number: i16) -> Eight {
        Eight(machine::all(number))
    }

    /// Returns -1 where the number exceeds that of `other`, else 0.
    #[inline(always)]
    pub(super) fn above(self, other: Eight) -> Eight {
        Eight(machine::above(self.0, other.0))
    }

    /// Returns the bits of either.
    #[inline(always)]
    pub(super) fn or(self, other: Eight) -> Eight {
        Eight(machine::or(self.0, other.0))
    }

    /// Returns a mask in which bit k is set when number k is negative.
    #[inline(always)]
    pub(super) fn negative(self) -> u32 {
        machine::negative(self.0)
    }

    /// Returns the smaller number of each pair.
    #[inline(always)]
    pub(super) fn smaller(self, other: Eight) -> Eight {
        Eight(machine::smaller(self.0, other.0))
    }

    /// Returns the larger number of each pair.
    #[inline(always)]
    pub(super) fn larger(self, other: Eight) -> Eight {
        Eight(machine::larger(self.0, other.0))
    }

    /// Returns the least number.
    #[inline(always)]
    pub(super) fn least(self) -> i16 {
        machine::least(self.0)
    }

    /// Returns the greatest number.
    #[inline(always)]
    pub(super) fn greatest(self) -> i16 {
        machine::greatest(self.0)
    }
}

/// Implementation with SSE2, which every x86-64 processor has.
#[cfg(target_arch = "x86_64")]
mod sse {
    use std::arch::x86_64::*;

    pub(super) type Numbers = __m128i;

    #[inline(always)]
    pub(super) fn of(numbers: &[i16; 8]) -> Numbers {
        // SAFETY: SSE2 is part of every x86-64; the array holds eight numbers, and the load needs no alignment.
        unsafe { _mm_loadu_si128(numbers.as_ptr().cast()) }
    }

    #[inline(always)]
    pub(super) fn all(number: i16) -> Numbers {
        // SAFETY: as above; uses registers only.
        unsafe { _mm_set1_epi16(number) }
    }

    #[inline(always)]
    pub(super) fn above(a: Numbers, b: Numbers) -> Numbers {
        // SAFETY: as above; uses registers only.
        unsafe { _mm_cmpgt_epi16(a, b) }
    }

    #[inline(always)]
    pub(super) fn or(a: Numbers, b: Numbers) -> Numbers {
        // SAFETY: as above; uses registers only.
        unsafe { _mm_or_si128(a, b) }
    }

    #[inline(always)]
    pub(super) fn smaller(a: Numbers, b: Numbers) -> Numbers {
        // SAFETY: as above; uses registers only.
        unsafe { _mm_min_epi16(a, b) }
    }

    #[inline(always)]
    pub(super) fn larger(a: Numbers, b: Numbers) -> Numbers {
        // SAFETY: as above; uses registers only.
        unsafe { _mm_max_epi16(a, b) }
    }

    #[inline(always)]
    pub(super) fn negative(a: Numbers) -> u32 {
        // SAFETY: as above; uses registers only. Packing keeps the sign of each number.
        unsafe { _mm_movemask_epi8(_mm_packs_epi16(a, _mm_setzero_si128())) as u32 }
    }

    #[inline(always)]
    pub(super) fn least(a: Numbers) -> i16 {
        // SAFETY: as above; uses registers only. Each step compares one half of the numbers with the other.
        unsafe {
            let a = _mm_min_epi16(a, _mm_shuffle_epi32::<0b1110>(a));
            let a = _mm_min_epi16(a, _mm_shuffle_epi32::<0b0001>(a));
            let a = _mm_min_epi16(a, _mm_shufflelo_epi16::<0b0001>(a));
            _mm_cvtsi128_si32(a) as i16
        }
    }

    #[inline(always)]
    pub(super) fn greatest(a: Numbers) -> i16 {
        // SAFETY: as for `least`.
        unsafe {
            let a = _mm_max_epi16(a, _mm_shuffle_epi32::<0b1110>(a));
            let a = _mm_max_epi16(a, _mm_shuffle_epi32::<0b0001>(a));
            let a = _mm_max_epi16(a, _mm_shufflelo_epi16::<0b0001>(a));
            _mm_cvtsi128_si32(a) as i16
        }
    }
}

/// Implementation for other processors: the functions of `sse`, one number after the other.
#[cfg(any(test, not(target_arch = "x86_64")))]
mod one_by_one {
    pub(super) type Numbers = [i16; 8];

    pub(super) fn of(numbers: &[i16; 8]) -> Numbers {
        *numbers
    }

    pub(super) fn all(number: i16) -> Numbers {
        [number; 8]
    }

    pub(super) fn above(a: Numbers, b: Numbers) -> Numbers {
        std::array::from_fn(|at| -i16::from(a[at] > b[at]))
    }

    pub(super) fn or(a: Numbers, b: Numbers) -> Numbers {
        std::array::from_fn(|at| a[at] | b[at])
    }

    pub(super) fn smaller(a: Numbers, b: Numbers) -> Numbers {
        std::array::from_fn(|at| a[at].min(b[at]))
    }

    pub(super) fn larger(a: Numbers, b: Numbers) -> Numbers {
        std::array::from_fn(|at| a[at].max(b[at]))
    }

    pub(super) fn negative(a: Numbers) -> u32 {
        (0..8).fold(0, |bits, at| bits | u32::from(a[at] < 0) << at)
    }

    pub(super) fn least(a: Numbers) -> i16 {
        a.into_iter().fold(i16::MAX, i16::min)
    }

    pub(super) fn greatest(a: Numbers) -> i16 {
        a.into_iter().fold(i16::MIN, i16::max)
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::{one_by_one, sse};
    use crate::distance::tests::Dice;

    #[test]
    fn eight_at_a_time_equals_one_by_one() {
        let mut dice = Dice::new(31);
        let mut above = 0;
        for _ in 0..4_000 {
            let mut drawn = || {
                [0; 8].map(|_: i16| match dice.pick(4) {
                    0 => i16::MIN,
                    1 => i16::MAX,
                    2 => dice.pick(5) as i16 - 2,
                    _ => (40_000.0 * dice.signed()) as i16,
                })
            };
            let (a, b) = (drawn(), drawn());
            let (fast_a, fast_b) = (sse::of(&a), sse::of(&b));
            assert_eq!(sse::least(fast_a), one_by_one::least(a), "{a:?}");
            assert_eq!(sse::greatest(fast_a), one_by_one::greatest(a), "{a:?}");
            let (fast, slow) = (sse::smaller(fast_a, fast_b), one_by_one::smaller(a, b));
            assert_eq!(
                sse::greatest(fast),
                one_by_one::greatest(slow),
                "{a:?} {b:?}"
            );
            let (fast, slow) = (sse::larger(fast_a, fast_b), one_by_one::larger(a, b));
            assert_eq!(sse::least(fast), one_by_one::least(slow), "{a:?} {b:?}");
            let fast = sse::above(fast_a, fast_b);
            let slow = one_by_one::above(a, b);
            let bits = sse::negative(fast);
            assert_eq!(bits, one_by_one::negative(slow), "{a:?} {b:?}");
            above += bits.count_ones();
            let (fast, slow) = (sse::or(fast_a, fast_b), one_by_one::or(a, b));
            assert_eq!(
                sse::negative(fast),
                one_by_one::negative(slow),
                "{a:?} {b:?}"
            );
            let (fast, slow) = (sse::above(sse::all(a[0]), fast_b), one_by_one::all(a[0]));
            let slow = one_by_one::above(slow, one_by_one::of(&b));
            assert_eq!(
                sse::negative(fast),
                one_by_one::negative(slow),
                "{a:?} {b:?}"
            );
        }
        assert!(above > 10_000, "only {above}");
    }
}
