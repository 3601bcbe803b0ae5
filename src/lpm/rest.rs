//! A body at rest: the question of the paper, which checks poses.
//!
//! Nothing moves, so there is neither a way nor an order: the boxes of pieces are compared, then
//! heights and footprints. Two upright pieces are clear when a height or a footprint lies apart by more than
//! the slack of [`meeting`](super::meeting), for the reason that stands there. What is tilted, and what has to
//! keep a margin, goes on the list of searches.

use super::contact::{Findings, Found};
use super::meeting::slack;
use super::mover::{Group, MOST_OF_A_GROUP};
use super::passage::{Passage, Pending};
use super::piece::NOISE;
use super::prism::Prism;
use super::space::{Boxes, Cover};
use super::standing::Stands;
use super::touch::lie_apart;
use super::vector::{add, reach, sub};

impl Passage<'_> {
    /// A contact within the margin where the body stands.
    #[inline(always)]
    pub(crate) fn rest(&self, found: &mut Findings) {
        let space = &self.model.space;
        for group in &self.body.groups {
            let mut boxes = None;
            let hull = group.hull(self.path, self.way.margin_mm);
            space.around(&hull, |bundle, mut lanes| {
                let boxes = boxes.get_or_insert_with(|| group.boxes(self.path, self.way.margin_mm));
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let cover = bundle.cover(lane);
                    self.standing(bundle.piece(lane), &cover, (group, boxes), found);
                    if found.best.is_some() {
                        return true;
                    }
                }
                false
            });
            if found.best.is_some() {
                return;
            }
        }
        self.searches(found);
    }

    /// Which pieces of a group share a point with a standing one?
    #[inline]
    fn standing(
        &self,
        number: u32,
        cover: &Cover,
        (group, boxes): (&Group, &Boxes<MOST_OF_A_GROUP>),
        found: &mut Findings,
    ) {
        let mut places = boxes.meeting(cover) & group.used();
        if places == 0 {
            return;
        }
        let element = self.element(number);
        if !self.counts(element) {
            return;
        }
        while places != 0 {
            let local = (group.first + places.trailing_zeros() as usize) as u32;
            places &= places - 1;
            match (&element.form, &self.body.prisms[local as usize]) {
                (Stands::Upright(standing), Some(own)) if self.level => {
                    let may_share = if self.path.is_unturned() {
                        self.may_share(standing, own)
                    } else {
                        self.may_share(standing, &own.turned(self.path.start()))
                    };
                    if !may_share {
                        continue;
                    }
                    if self.way.margin_mm == 0.0 {
                        found.best = Some(Found::at_start(number, local));
                        return;
                    }
                }
                _ => {}
            }
            found.pending.push(Pending {
                order: 0.0,
                element: number,
                local,
            });
        }
    }

    /// False is proof that two upright pieces are farther apart than the margin; that of the mover is
    /// turned, but not at its place yet.
    #[inline(always)]
    fn may_share(&self, element: &Prism, mover: &Prism) -> bool {
        let origin = self.path.from;
        let apart = sub(add(mover.centre, origin), element.centre);
        let placed = NOISE * (reach(origin) + reach(mover.centre));
        let grown = self.way.margin_mm + placed + slack(element, mover, apart);
        let above = apart[2].abs() - element.half[2] - mover.half[2];
        !((above > grown) | lie_apart(element, mover, apart, grown))
    }
}
