//! Pairs without a closed form: each is searched once, in the order in which the boxes of the pairs meet.

use super::contact::{Findings, Found};
use super::passage::{Passage, Pending, once_in_order};
use super::straight;
use super::turning::Turning;

impl Passage<'_> {
    /// Searches the pairs that wait in `found`.
    pub(crate) fn searches(&self, found: &mut Findings) {
        if found.pending.is_empty() {
            return;
        }
        let mut pending = std::mem::take(&mut found.pending);
        once_in_order(&mut pending);
        for pair in pending {
            if pair.order > found.until() {
                return;
            }
            let searched = self.searched(&pair, found.until());
            found.offer(searched, self.element(pair.element).owner);
        }
    }

    fn searched(&self, pair: &Pending, until: f64) -> Option<Found> {
        let path = self.path;
        let element = &self.piece(pair.element);
        let local = self.local(pair.local);
        let margin = self.way.margin_mm;
        let hit = match &path.turn {
            None => {
                let at_start = path.piece_at(local, 0.0);
                straight::first_within(element, &at_start, path.displacement, margin, 0.0, until)
            }
            Some(turn) => Turning {
                element,
                local,
                path,
                turn,
            }
            .first_within(margin, until),
        }?;
        Some(Found::searched(pair.element, hit))
    }
}
