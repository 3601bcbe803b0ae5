//! Layers: the checking space cut along z; each layer knows the actual lowest and highest height of its pieces.
//!
//! A layer is `{h1, h2, V, B}`: an interval of height of 8 mm (a third of the lowest elements of a fixture,
//! so that a gripper which passes over them shares no layer with them), the lowest bottom of a piece that lies in it
//! (`h1`) and the highest top (`h2`). A piece belongs to every layer into which it reaches, but no layer has a copy of
//! it. `V` of a layer is one bit in the word of each cell of the [`Grid`](super::grid::Grid) (bit k: the cell has a
//! piece in layer k). The silhouettes `B` are stored per cell, for all layers together
//! ([`Bundle`](super::silhouettes::Bundle)).
//!
//! The checking space Omega reaches from the lowest `h1` to the highest `h2` and changes with them.

use super::codes::heights;
use super::cover::{Cover, larger, smaller};

/// Number of layers: one for each bit of a word.
const LAYERS: usize = 64;

/// Greatest number of layers strictly between the lowest and the highest layer of a usual piece; few pieces have more.
const SHORT: usize = 8;

/// For each number of passed layers up to [`SHORT`]: all bits of the counts of these layers, no bit of the others.
static PASSED: [[u32; SHORT]; SHORT + 1] = {
    let mut masks = [[0; SHORT]; SHORT + 1];
    let mut between = 0;
    while between <= SHORT {
        let mut at = 0;
        while at < between {
            masks[between][at] = u32::MAX;
            at += 1;
        }
        between += 1;
    }
    masks
};

/// Binary logarithm of the number of codes of height in a layer.
const CODES: u32 = 8;
/// Number of layers below code 0 of the height. A piece below -64 mm belongs to the lowest layer, a piece above 440 mm
/// to the highest one.
const MIDDLE: i16 = 64;

/// The lowest and the highest layer into which a piece reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Reach {
    pub(crate) low: u8,
    pub(crate) high: u8,
}

impl Reach {
    /// Returns the layers between the heights of bottom and top, mm.
    #[inline(always)]
    pub(crate) fn of(bottom_mm: f32, top_mm: f32) -> Reach {
        let (low, high) = heights(bottom_mm, top_mm);
        Reach::between(low, high)
    }

    /// Returns the layers between two codes of height. Codes keep the order of heights, so that two overlapping ranges
    /// of heights always share a layer.
    #[inline(always)]
    pub(super) fn between(low: i16, high: i16) -> Reach {
        let layer = |code: i16| ((code >> CODES) + MIDDLE).clamp(0, LAYERS as i16 - 1) as u8;
        Reach {
            low: layer(low),
            high: layer(high),
        }
    }

    /// Returns the lowest and the highest layer. The modulus changes no valid layer and saves a bounds check.
    #[inline(always)]
    fn ends(self) -> [usize; 2] {
        [self.low, self.high].map(|layer| usize::from(layer) % LAYERS)
    }

    /// Returns a word with one bit set for each layer in reach.
    #[inline(always)]
    pub(crate) fn word(self) -> u64 {
        // The modulus keeps the shift below the number of bits in the word.
        let last = LAYERS as u32 - 1;
        u64::MAX.wrapping_shl(u32::from(self.low))
            & u64::MAX.wrapping_shr(last.wrapping_sub(u32::from(self.high)))
    }
}

/// Counts and heights of all layers, and Omega.
#[derive(Debug, Clone)]
pub(crate) struct Layers {
    /// Number of pieces that pass through each layer.
    passing: [u32; LAYERS + SHORT],
    /// Number of pieces whose bottom lies in each layer.
    beginning: [u32; LAYERS],
    /// Number of pieces whose top lies in each layer.
    ending: [u32; LAYERS],
    /// Lowest bottom of the pieces that begin in each layer, mm.
    h1: [f32; LAYERS],
    /// Highest top of the pieces that end in each layer, mm.
    h2: [f32; LAYERS],
    /// Bottom and top of Omega, mm.
    bottom: f32,
    top: f32,
}

impl Default for Layers {
    fn default() -> Layers {
        Layers {
            passing: [0; LAYERS + SHORT],
            beginning: [0; LAYERS],
            ending: [0; LAYERS],
            h1: [f32::INFINITY; LAYERS],
            h2: [f32::NEG_INFINITY; LAYERS],
            bottom: f32::INFINITY,
            top: f32::NEG_INFINITY,
        }
    }
}

impl Layers {
    /// Builds the layers of many pieces at once.
    pub(super) fn of(reaches: &[Reach], covers: &[Cover]) -> Layers {
        let mut layers = Layers::default();
        // Counts the pieces that begin and end in the same layer.
        let mut within = [0u32; LAYERS];
        for (reach, cover) in reaches.iter().zip(covers) {
            layers.enclose(*reach, cover.low[2], cover.high[2]);
            if reach.low == reach.high {
                within[usize::from(reach.low) % LAYERS] += 1;
            }
        }
        layers.bottom = layers.h1.into_iter().fold(f32::INFINITY, smaller);
        layers.top = layers.h2.into_iter().fold(f32::NEG_INFINITY, larger);
        // A piece passes a layer when it begins below the layer and ends above it. The count leaves out pieces within
        // one layer, so that none ends before it begins.
        let (mut begun, mut ended) = (0, 0);
        for (layer, within) in within.into_iter().enumerate() {
            ended += layers.ending[layer] - within;
            layers.passing[layer] = begun - ended;
            begun += layers.beginning[layer] - within;
        }
        layers
    }

    /// Adds a piece that extends between two heights, mm.
    #[inline]
    pub(crate) fn join(&mut self, reach: Reach, bottom_mm: f32, top_mm: f32) {
        self.enclose(reach, bottom_mm, top_mm);
        self.bottom = smaller(self.bottom, bottom_mm);
        self.top = larger(self.top, top_mm);
        self.pass(reach, 1);
    }

    /// Enters where a piece begins and ends.
    #[inline]
    fn enclose(&mut self, reach: Reach, bottom_mm: f32, top_mm: f32) {
        let [low, high] = reach.ends();
        self.beginning[low] += 1;
        self.ending[high] += 1;
        self.h1[low] = smaller(self.h1[low], bottom_mm);
        self.h2[high] = larger(self.h2[high], top_mm);
    }

    /// Counts a piece in the layers that it passes: adds `more` to each of their counts; `u32::MAX` subtracts 1.
    #[inline]
    fn pass(&mut self, reach: Reach, more: u32) {
        let first = usize::from(reach.low) + 1;
        let between = usize::from(reach.high).saturating_sub(first);
        let passed = &mut self.passing[first..];
        match (passed.first_chunk_mut::<SHORT>(), PASSED.get(between)) {
            // The number of layers is unpredictable, so the loop always writes `SHORT` counts; most of them do not
            // change.
            (Some(few), Some(masks)) => {
                for (count, mask) in few.iter_mut().zip(masks) {
                    *count = count.wrapping_add(more & mask);
                }
            }
            (Some(_), None) | (None, _) => {
                let long = passed.iter_mut().take(between);
                long.for_each(|count| *count = count.wrapping_add(more));
            }
        }
    }

    /// Removes a piece. `h1` and `h2` of a layer stay until no piece begins or ends there; too wide an interval is
    /// safe.
    pub(crate) fn remove(&mut self, reach: Reach) {
        let [low, high] = reach.ends();
        self.pass(reach, u32::MAX);
        self.beginning[low] -= 1;
        self.ending[high] -= 1;
        if self.beginning[low] == 0 {
            let h1 = std::mem::replace(&mut self.h1[low], f32::INFINITY);
            if h1 <= self.bottom {
                self.bottom = self.h1.iter().copied().fold(f32::INFINITY, f32::min);
            }
        }
        if self.ending[high] == 0 {
            let h2 = std::mem::replace(&mut self.h2[high], f32::NEG_INFINITY);
            if h2 >= self.top {
                self.top = self.h2.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            }
        }
    }

    /// Returns a word with one bit set for each layer between the heights `low` and `high` (mm); 0 outside Omega.
    #[inline]
    pub(crate) fn between(&self, low: f32, high: f32) -> u64 {
        if self.misses(low, high) {
            return 0;
        }
        Reach::of(low, high).word()
    }

    /// Returns true when the heights `low` to `high` (mm) are outside Omega.
    #[inline]
    pub(super) fn misses(&self, low: f32, high: f32) -> bool {
        (high < self.bottom) | (low > self.top)
    }

    /// Returns [`Layers::between`], without its lowest and highest layer where the pieces of that layer do not reach
    /// into these heights. For paths over many squares this is worth its cost.
    #[inline]
    pub(crate) fn meeting(&self, low: f32, high: f32) -> u64 {
        let reach = Reach::of(low, high);
        let outermost = self.void(reach.low, low, high) | self.void(reach.high, low, high);
        self.between(low, high) & !outermost
    }

    /// Returns the bit of a layer if `low..=high` lies strictly between the tops of its lower pieces and the bottoms of
    /// its upper ones; otherwise 0.
    #[inline]
    fn void(&self, layer: u8, low: f32, high: f32) -> u64 {
        let layer = usize::from(layer) % LAYERS;
        let is_void = (self.passing[layer] == 0) & (self.h2[layer] < low) & (self.h1[layer] > high);
        u64::from(is_void) << layer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::tests::Dice;

    fn joined(layers: &mut Layers, bottom: f32, top: f32) -> Reach {
        let reach = Reach::of(bottom, top);
        layers.join(reach, bottom, top);
        reach
    }

    #[test]
    fn every_layer_within_the_given_heights_is_returned() {
        let mut dice = Dice::new(3);
        let mut layers = Layers::default();
        let mut standing: Vec<(f32, f32, Reach)> = Vec::new();
        for round in 0..3_000 {
            let bottom = (300.0 * dice.signed() + 150.0) as f32;
            let top = bottom + (60.0 * dice.signed().abs()) as f32;
            standing.push((bottom, top, joined(&mut layers, bottom, top)));
            if round % 3 > 0 {
                let (.., gone) = standing.swap_remove(round % standing.len());
                layers.remove(gone);
            }
            let low = (400.0 * dice.signed()) as f32;
            let high = low + (30.0 * dice.signed().abs()) as f32;
            let word = layers.meeting(low, high);
            for (bottom, top, reach) in &standing {
                let meets = *bottom <= high && *top >= low;
                assert!(
                    !meets || word & reach.word() != 0,
                    "{bottom} {top} {low} {high}"
                );
            }
        }
    }

    #[test]
    fn layers_built_at_once_equal_layers_built_singly() {
        let mut dice = Dice::new(29);
        for count in [0, 1, 7, 400] {
            let covers: Vec<Cover> = (0..count)
                .map(|_| {
                    let bottom = 300.0 * dice.signed() + 150.0;
                    // Many pieces end in the layer in which they begin.
                    let tall = [3.0, 60.0, 700.0][dice.pick(3) as usize] * dice.signed().abs();
                    Cover::of(([0.0, 0.0, bottom], [1.0, 1.0, bottom + tall]))
                })
                .collect();
            let mut single = Layers::default();
            let join = |cover: &Cover| joined(&mut single, cover.low[2], cover.high[2]);
            let reaches: Vec<Reach> = covers.iter().map(join).collect();
            let at_once = Layers::of(&reaches, &covers);
            assert_eq!(format!("{at_once:?}"), format!("{single:?}"), "{count}");
        }
    }

    #[test]
    fn the_top_of_omega_follows_the_elements() {
        let mut layers = Layers::default();
        assert_eq!(layers.meeting(-1e6, 1e6), 0);
        let plate = joined(&mut layers, -20.0, 0.0);
        let tower = joined(&mut layers, 0.0, 180.0);
        assert_eq!((layers.bottom, layers.top), (-20.0, 180.0));
        layers.remove(tower);
        assert_eq!((layers.bottom, layers.top), (-20.0, 0.0));
        assert_eq!(layers.meeting(0.1, 300.0), 0);
        layers.remove(plate);
        assert_eq!(layers.meeting(-1e6, 1e6), 0);
    }

    #[test]
    fn a_box_between_actual_layer_ends_shares_none() {
        let mut layers = Layers::default();
        joined(&mut layers, -20.0, 2.0);
        joined(&mut layers, 5.0, 40.0);
        assert_eq!(layers.meeting(3.0, 4.0), 0);
        assert_eq!(layers.meeting(2.0, 4.0).count_ones(), 1);
        assert_eq!(layers.meeting(3.0, 5.0).count_ones(), 1);
        assert_eq!(layers.meeting(40.5, 200.0), layers.meeting(48.0, 200.0));
    }
}
