//! Layers: the checking space cut along z at the real bottoms and tops of what stands in it.
//!
//! A layer is `{h1, h2, V, B}`: it begins at the lowest bottom and ends at the highest top of its
//! members. An element belongs to exactly one layer, so nothing is copied; layers may overlap in
//! height. `V`, the grid information, is kept for all layers together as one word per cell of the
//! [`Grid`](super::grid::Grid) (bit k: layer k has something here), `B`, the silhouettes, as the boxes of the pieces.

/// Layers fit the bits of one word.
pub(crate) const MOST_LAYERS: usize = 64;

/// A piece joins a layer that grows by no more than this part of the height of the piece.
const TOLERATED_GROWTH: f64 = 0.25;

/// Height range of one layer, mm, and how many pieces it holds.
#[derive(Debug, Clone, Copy)]
struct Layer {
    h1: f64,
    h2: f64,
    members: u32,
}

const EMPTY: Layer = Layer {
    h1: f64::INFINITY,
    h2: f64::NEG_INFINITY,
    members: 0,
};

/// All layers; those without members take no part.
#[derive(Debug, Clone, Default)]
pub(crate) struct Layers {
    layers: Vec<Layer>,
}

impl Layers {
    /// Takes a piece between two heights in and says which layer it now belongs to.
    pub(crate) fn join(&mut self, h1: f64, h2: f64) -> u8 {
        let chosen = self.chosen(h1, h2);
        let layer = &mut self.layers[chosen];
        layer.h1 = layer.h1.min(h1);
        layer.h2 = layer.h2.max(h2);
        layer.members += 1;
        chosen as u8
    }

    /// Lets a piece go. The heights of the layer stay (a superset is safe) until it is empty.
    pub(crate) fn leave(&mut self, layer: u8) {
        let layer = &mut self.layers[layer as usize];
        layer.members -= 1;
        if layer.members == 0 {
            *layer = EMPTY;
        }
    }

    /// One bit for each layer that reaches into the heights `low..=high`.
    pub(crate) fn meeting(&self, low: f64, high: f64) -> u64 {
        let bit = |word: u64, (index, layer): (usize, &Layer)| {
            word | (u64::from(layer.h1 <= high && layer.h2 >= low) << index)
        };
        self.layers.iter().enumerate().fold(0, bit)
    }

    /// Lowest bottom and highest top: the height of the checking space.
    pub(crate) fn heights(&self) -> Option<(f64, f64)> {
        let used = self.layers.iter().filter(|layer| layer.members > 0);
        used.fold(None, |range, layer| {
            let (low, high) = range.unwrap_or((layer.h1, layer.h2));
            Some((layer.h1.min(low), layer.h2.max(high)))
        })
    }

    fn chosen(&mut self, h1: f64, h2: f64) -> usize {
        let growth = |layer: &Layer| (layer.h1 - h1).max(0.0) + (h2 - layer.h2).max(0.0);
        let used = self
            .layers
            .iter()
            .enumerate()
            .filter(|(_, layer)| layer.members > 0);
        // Of the layers that need not grow the tightest is best: waste counts like growth.
        let cost = |layer: &Layer| {
            let waste = (h1 - layer.h1).max(0.0) + (layer.h2 - h2).max(0.0);
            growth(layer).max(waste)
        };
        let best = used.min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b)));
        if let Some((index, layer)) = best
            && cost(layer) <= TOLERATED_GROWTH * (h2 - h1)
        {
            return index;
        }
        if let Some(index) = self.layers.iter().position(|layer| layer.members == 0) {
            return index;
        }
        if self.layers.len() < MOST_LAYERS {
            self.layers.push(EMPTY);
            return self.layers.len() - 1;
        }
        best.map_or(0, |(index, _)| index)
    }
}
