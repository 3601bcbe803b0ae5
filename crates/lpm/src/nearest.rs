//! Least distance over a path: examines every pair whose boxes come close enough, nearest pairs first.

use super::mover::{Group, MOST_OF_A_GROUP};
use super::passage::{Passage, Pending, once_in_order};
use super::space::{Bundle, Cover, LANES, Onset, Sweep, Visit};
use super::straight;
use super::turning::Turning;

/// Least distance, mm, with the stationary piece and the fraction of the path at which it occurs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    pub(crate) distance_mm: f64,
    /// Number of the stationary piece.
    pub(crate) element: u32,
    /// Fraction of the path.
    pub(crate) t: f64,
}

/// Collects the pairs of boxes within range.
struct Near<'a> {
    passage: &'a Passage<'a>,
    group: &'a Group,
    /// Boxes around the pieces of the group over their whole path.
    covers: [Cover; MOST_OF_A_GROUP],
    range_mm: f64,
    pending: &'a mut Vec<Pending>,
}

impl Visit for Near<'_> {
    fn in_order(&self) -> bool {
        false
    }

    fn bundle(&mut self, bundle: &Bundle, lanes: u32, _: Option<&Onset>) -> bool {
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            let element = bundle.piece(lane);
            let stationary = self.passage.element(element);
            if !self.passage.counts(stationary) {
                continue;
            }
            for (place, own) in self.covers[..self.group.count].iter().enumerate() {
                let order = own.distance(&stationary.cover());
                if order <= self.range_mm {
                    self.pending.push(Pending {
                        order,
                        element,
                        local: (self.group.first + place) as u32,
                    });
                }
            }
        }
        false
    }

    fn pause(&mut self) -> f64 {
        1.0
    }
}

impl Passage<'_> {
    /// Returns the least distance over the path; `None` when it exceeds `range_mm`.
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

    /// Returns the pairs whose boxes come within `range_mm` of each other, each with the distance of its boxes.
    fn within(&self, range_mm: f64) -> Vec<Pending> {
        let mut pending = Vec::new();
        let run = self.path.displacement;
        for group in &self.body.groups {
            let own = group.boxes(&self.whereabouts(0.0));
            let swept = [0, 1, 2, 3].map(|place: usize| own.cover(place).swept(run));
            let mut near = Near {
                passage: self,
                group,
                covers: swept,
                range_mm,
                pending: &mut pending,
            };
            let sweep = Sweep::new(group.hull(&self.whereabouts(range_mm)), run);
            self.model.space.walk(&sweep, 1.0, &mut near);
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
