//! What stands around a box at rest.

use super::area::Area;
use super::cover::Cover;
use super::grid::Grid;
use super::silhouettes::{Bundle, NONE};

/// A few cells that have something to show, noted without a branch.
struct Heads {
    heads: [u32; 8],
    count: usize,
}

impl Heads {
    const NONE: Heads = Heads {
        heads: [NONE; 8],
        count: 0,
    };

    #[inline]
    fn is_full(&self) -> bool {
        self.count == self.heads.len()
    }

    /// Notes a cell if one of its layers is wanted, where there is room.
    #[inline]
    fn push(&mut self, head: u32, wanted: u64) {
        self.heads[self.count % 8] = head;
        self.count += usize::from(wanted != 0);
    }
}

impl Grid {
    /// Shows the bundles in some of these layers that have pieces which may meet a box, until one is
    /// answered with true.
    #[inline]
    pub(crate) fn around(
        &self,
        cover: &Cover,
        layers: u64,
        mut show: impl FnMut(&Bundle, u32) -> bool,
    ) {
        let mut heads = Heads::NONE;
        heads.push(self.open_head, self.open_layers & layers);
        let Some(area) = self.common(&Area::of(cover)) else {
            self.shown(&mut heads, cover, &mut show);
            return;
        };
        let first = self.place(area.low[0], area.low[1]);
        let [wide, deep] = [0, 1].map(|axis: usize| (area.high[axis] - area.low[axis]) as usize);
        if wide <= 1 && deep <= 1 {
            // Most boxes lie over four squares at most: without a branch between them.
            for (across, along) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let place = first + across * wide + along * deep * self.columns;
                let is_new = across <= wide && along <= deep;
                let wanted = self.layers[place] & layers;
                heads.push(self.heads[place], if is_new { wanted } else { 0 });
            }
        } else {
            for row in 0..=deep {
                for column in 0..=wide {
                    if heads.is_full() && self.shown(&mut heads, cover, &mut show) {
                        return;
                    }
                    let place = first + row * self.columns + column;
                    heads.push(self.heads[place], self.layers[place] & layers);
                }
            }
        }
        self.shown(&mut heads, cover, &mut show);
    }

    fn shown(
        &self,
        heads: &mut Heads,
        cover: &Cover,
        show: &mut impl FnMut(&Bundle, u32) -> bool,
    ) -> bool {
        let noted = std::mem::replace(&mut heads.count, 0);
        heads.heads[..noted].iter().any(|head| {
            self.pool.chain(*head).any(|(_, bundle)| {
                let lanes = bundle.boxes.meeting(cover);
                lanes != 0 && show(bundle, lanes)
            })
        })
    }
}
