//! Layers: the checking space cut along z at the real bottoms and tops of what stands in it.
//!
//! A layer is `{h1, h2, V, B}`. It holds the pieces whose bottom lies in one step of [`STEP_MM`],
//! begins at the lowest real bottom (`h1`) and ends at the highest real top (`h2`) of its members.
//! A piece belongs to exactly one layer, so nothing is copied; layers may overlap in height. `V`, the
//! grid information, is kept for all layers together as one word per cell of the
//! [`Grid`](super::grid::Grid) (bit k: layer k has something here), `B`, the silhouettes, as the
//! bundles of the cell ([`Bundle`](super::silhouettes::Bundle)).
//!
//! The checking space Omega reaches from the lowest `h1` to the highest `h2` and follows them.

/// Layers fit the bits of one word.
const LAYERS: usize = 64;

/// Height of a step of bottoms, mm: elements of one level of a fixture share a layer, those of the
/// next level do not.
const STEP_MM: f32 = 8.0;

/// Steps below the top of the baseplate; lower bottoms belong to the lowest layer, those above all
/// steps (440 mm) to the highest.
const STEPS_BELOW: f32 = 8.0;

/// The layer of a bottom, and the step of any height. Monotone, which is all that safety needs.
fn step(height_mm: f32) -> usize {
    // A cast from float to integer saturates, NaN is 0.
    (height_mm / STEP_MM + STEPS_BELOW).clamp(0.0, (LAYERS - 1) as f32) as usize
}

/// All layers, and Omega.
#[derive(Debug, Clone)]
pub(crate) struct Layers {
    /// Real bottom and top of each layer, mm.
    h1: [f32; LAYERS],
    h2: [f32; LAYERS],
    members: [u32; LAYERS],
    /// Of each step: the layers that begin below it and reach it.
    reaching: [u64; LAYERS],
    /// Bottom and top of Omega, mm.
    bottom: f32,
    top: f32,
}

impl Default for Layers {
    fn default() -> Layers {
        Layers {
            h1: [f32::INFINITY; LAYERS],
            h2: [f32::NEG_INFINITY; LAYERS],
            members: [0; LAYERS],
            reaching: [0; LAYERS],
            bottom: f32::INFINITY,
            top: f32::NEG_INFINITY,
        }
    }
}

impl Layers {
    /// Layer of a piece with this bottom, mm.
    pub(crate) fn of(bottom_mm: f32) -> u8 {
        step(bottom_mm) as u8
    }

    /// Takes a piece between two heights (mm) in and says which layer it now belongs to.
    pub(crate) fn join(&mut self, h1: f32, h2: f32) -> u8 {
        let layer = step(h1);
        self.members[layer] += 1;
        self.h1[layer] = self.h1[layer].min(h1);
        if h2 > self.h2[layer] {
            self.h2[layer] = h2;
            let (above, last) = (layer + 1, step(h2));
            if above <= last {
                self.reaching[above..=last]
                    .iter_mut()
                    .for_each(|word| *word |= 1 << layer);
            }
        }
        self.bottom = self.bottom.min(h1);
        self.top = self.top.max(h2);
        layer as u8
    }

    /// Lets a piece go. The heights of a layer stay (a superset is safe) until it is empty.
    pub(crate) fn leave(&mut self, layer: u8) {
        let layer = layer as usize;
        self.members[layer] -= 1;
        if self.members[layer] > 0 {
            return;
        }
        let (h1, h2) = (self.h1[layer], self.h2[layer]);
        self.h1[layer] = f32::INFINITY;
        self.h2[layer] = f32::NEG_INFINITY;
        self.reaching[layer..=step(h2)]
            .iter_mut()
            .for_each(|word| *word &= !(1 << layer));
        if h1 <= self.bottom || h2 >= self.top {
            self.bottom = self.h1.iter().copied().fold(f32::INFINITY, f32::min);
            self.top = self.h2.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        }
    }

    /// One bit for each layer that may reach into the heights `low..=high` (mm); none outside Omega.
    #[inline]
    pub(crate) fn meeting(&self, low: f32, high: f32) -> u64 {
        if high < self.bottom || low > self.top {
            return 0;
        }
        let (first, last) = (step(low), step(high));
        let beginning = u64::MAX << first & u64::MAX >> (LAYERS - 1 - last);
        beginning | self.reaching[first]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lpm::distance::tests::Dice;

    #[test]
    fn no_layer_that_reaches_into_the_asked_heights_is_left_out() {
        let mut dice = Dice(3);
        let mut layers = Layers::default();
        let mut standing: Vec<(f32, f32, u8)> = Vec::new();
        for round in 0..3_000 {
            let bottom = (300.0 * dice.signed() + 150.0) as f32;
            let top = bottom + (60.0 * dice.signed().abs()) as f32;
            standing.push((bottom, top, layers.join(bottom, top)));
            if round % 3 > 0 {
                let (.., gone) = standing.swap_remove(round % standing.len());
                layers.leave(gone);
            }
            let low = (400.0 * dice.signed()) as f32;
            let high = low + (30.0 * dice.signed().abs()) as f32;
            let word = layers.meeting(low, high);
            for (bottom, top, layer) in &standing {
                let meets = *bottom <= high && *top >= low;
                assert!(
                    !meets || word >> layer & 1 == 1,
                    "{bottom} {top} {low} {high}"
                );
            }
        }
    }

    #[test]
    fn the_top_of_omega_follows_the_elements() {
        let mut layers = Layers::default();
        assert_eq!(layers.meeting(-1e6, 1e6), 0);
        let plate = layers.join(-20.0, 0.0);
        let tower = layers.join(0.0, 180.0);
        assert_eq!((layers.bottom, layers.top), (-20.0, 180.0));
        layers.leave(tower);
        assert_eq!((layers.bottom, layers.top), (-20.0, 0.0));
        assert_eq!(layers.meeting(0.1, 300.0), 0);
        layers.leave(plate);
        assert_eq!(layers.meeting(-1e6, 1e6), 0);
    }
}
