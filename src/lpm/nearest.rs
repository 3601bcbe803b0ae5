//! The least distance over a way: every pair whose boxes come near enough, the nearest boxes first.

use super::parts::Parts;
use super::passage::{Passage, Pending, once_in_order};
use super::space::LANES;
use super::straight;
use super::turning::Turning;

/// The least distance, mm, from which piece, and when.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    pub(crate) distance_mm: f64,
    /// Number of the standing piece.
    pub(crate) element: u32,
    /// Fraction of the way.
    pub(crate) t: f64,
}

impl Passage<'_> {
    /// Least distance up to `range_mm` over the way; `None` when it is larger.
    pub(crate) fn least(&self, range_mm: f64) -> Option<Nearest> {
        let mut pending = self.within(range_mm);
        once_in_order(&mut pending);
        let mut least: Option<Nearest> = None;
        for pair in pending {
            let cutoff = least.map_or(range_mm, |known| known.distance_mm);
            if pair.order > cutoff || least.is_some_and(|known| known.distance_mm <= 0.0) {
                break;
            }
            if let Some((t, distance_mm)) = self.pair_least(&pair, cutoff)
                && least.is_none_or(|known| distance_mm < known.distance_mm)
            {
                let element = pair.element;
                least = Some(Nearest {
                    distance_mm,
                    element,
                    t,
                });
            }
        }
        least
    }

    /// Pairs whose boxes come within `range_mm` of each other, with the distance of the boxes.
    fn within(&self, range_mm: f64) -> Vec<Pending> {
        let mut pending = Vec::new();
        for group in &self.body.groups {
            let mut parts = Parts::UNPLACED;
            let sweep = group.sweep(self.path, range_mm);
            self.model.space.walk(&sweep, |bundle, lanes| {
                for part in parts.placed(self, group, 0.0, 1.0) {
                    for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
                        let number = bundle.piece(lane);
                        let order = part.cover.distance(&bundle.cover(lane));
                        if order <= range_mm && self.counts(self.element(number)) {
                            pending.push(Pending {
                                order,
                                element: number,
                                local: part.local,
                            });
                        }
                    }
                }
                1.0
            });
        }
        pending
    }

    fn pair_least(&self, pair: &Pending, cutoff: f64) -> Option<(f64, f64)> {
        let element = &self.piece(pair.element);
        let local = self.local(pair.local);
        match &self.path.turn {
            None => {
                let at_start = self.path.piece_at(local, 0.0);
                straight::least(element, &at_start, self.path.displacement, cutoff)
            }
            Some(turn) => Turning {
                element,
                local,
                path: self.path,
                turn,
            }
            .least(cutoff),
        }
    }
}
