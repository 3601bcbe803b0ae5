//! A body at rest: checks a pose, as in the paper.
//!
//! Nothing moves, so there is no path and no order in time: the check compares boxes of pieces first, then heights and
//! footprints. Two upright pieces are clear when their heights or their footprints are farther apart than the slack of
//! [`meeting`](super::meeting), which gives the argument. Tilted bodies, bodies that enclose a space, and moves with a
//! margin go to the check of a path of length zero.

use super::answer::{ElementKey, Move};
use super::meeting::slack;
use super::model::Model;
use super::mover::{Group, Mover, Orientation, Whereabouts};
use super::piece::NOISE;
use super::pose::{RoughYaw, Yaw};
use super::prism::Prism;
use super::shape::is_turn;
use super::space::LANES;
use super::stationary::{Stationary, Stored};
use super::touch::lie_apart;
use super::vector::{Vec3, add, reach, sub};

/// A question with a shortcut for a body at rest. Each implementation builds its answer directly as the return value:
/// extracting it from another value would cost a slow copy.
pub(crate) trait Question {
    type Answer;
    /// Answer when the body meets nothing.
    const CLEAR: Self::Answer;
    /// Returns the answer when the body may meet an element; `apart` runs from the centre of `element` to that of
    /// `mover`.
    fn met(owner: ElementKey, element: &Prism, mover: &Prism, apart: Vec3) -> Self::Answer;
    /// Returns the general answer, for any body and any path.
    fn on_the_way(model: &Model, body: &Mover, way: &Move) -> Self::Answer;
}

impl Model {
    /// Answers at once when the body stays in place and closed forms suffice; else checks the path.
    #[inline(always)]
    pub(crate) fn ask<Q: Question>(&self, body: &Mover, way: &Move) -> Q::Answer {
        let rest = Rest {
            model: self,
            body,
            way,
        };
        let is_plain = self.hollow.is_empty() & !body.is_hollow() & (way.margin_mm == 0.0);
        if is_plain && way.is_at_rest() && way.from.is_placed() {
            match way.from.rotation {
                [w, 0.0, 0.0, 0.0] if is_turn(w * w) => return rest.among::<Q>(None),
                [w, 0.0, 0.0, z] if is_turn(w * w + z * z) => {
                    return rest.among::<Q>(Some((w, z)));
                }
                _ => {}
            }
        }
        Q::on_the_way(self, body, way)
    }
}

/// Verdict of the shortcut on one stationary piece.
enum Judged<A> {
    Clear,
    Met(A),
    /// The piece is not upright, so the shortcut cannot decide.
    NotUpright,
}

/// A body at the start of its path.
struct Rest<'a> {
    model: &'a Model,
    body: &'a Mover,
    way: &'a Move<'a>,
}

impl Rest<'_> {
    /// Answers for a body turned by the quaternion `[w, 0, 0, z]`, or not turned (`None`). The compiler makes a version
    /// for each case, so that an unturned body costs no rotation.
    #[inline(always)]
    fn among<Q: Question>(&self, turn: Option<(f64, f64)>) -> Q::Answer {
        let yaw = turn.map(|(w, z)| Yaw::of(w, z));
        let at = Whereabouts {
            origin: self.way.from.position,
            orientation: turn.map_or(Orientation::Unturned, |(w, z)| {
                Orientation::Yawed(RoughYaw::of(w, z))
            }),
            run: [0.0; 3],
            margin_mm: 0.0,
        };
        let mut is_said = true;
        for group in &self.body.groups {
            let hull = group.hull(&at);
            let Some(around) = self.model.space.around(&hull) else {
                continue;
            };
            let mut placed = None;
            for (bundle, mut lanes) in around {
                let boxes = match &placed {
                    Some(boxes) => boxes,
                    None => &*placed.insert(group.boxes(&at)),
                };
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize % LANES;
                    lanes &= lanes - 1;
                    let element = self.model.pieces.at(bundle.piece(lane));
                    let places = boxes.meeting(&element.cover()) & group.used();
                    if places == 0 {
                        continue;
                    }
                    match self.judged::<Q>(element, (group, places), yaw) {
                        Judged::Clear => {}
                        Judged::NotUpright => is_said = false,
                        Judged::Met(answer) => return answer,
                    }
                }
            }
        }
        if is_said {
            Q::CLEAR
        } else {
            Q::on_the_way(self.model, self.body, self.way)
        }
    }

    /// Compares a stationary piece with those pieces of a group that `places` marks because their boxes meet its box.
    #[inline(always)]
    fn judged<Q: Question>(
        &self,
        element: &Stationary,
        (group, mut places): (&Group, u32),
        yaw: Option<Yaw>,
    ) -> Judged<Q::Answer> {
        if !self.way.ignore.is_empty() && self.way.ignore.contains(&element.owner) {
            return Judged::Clear;
        }
        while places != 0 {
            let local = group.first + places.trailing_zeros() as usize;
            places &= places - 1;
            let (Stored::Upright(fixed), Some(own)) = (&element.form, &self.body.prisms[local])
            else {
                return Judged::NotUpright;
            };
            let turned;
            let own = match yaw {
                None => own,
                Some(yaw) => {
                    turned = own.yawed(yaw);
                    &turned
                }
            };
            if let Some(apart) = self.sharing(fixed, own) {
                return Judged::Met(Q::met(element.owner, fixed, own, apart));
            }
        }
        Judged::Clear
    }

    /// Returns the vector between the centres of two upright pieces when they may share a point; `None` is proof that
    /// they do not. `mover` is already turned, but not yet at its place.
    #[inline(always)]
    fn sharing(&self, element: &Prism, mover: &Prism) -> Option<Vec3> {
        let origin = self.way.from.position;
        let apart = sub(add(mover.centre, origin), element.centre);
        let placed = NOISE * (reach(origin) + reach(mover.centre));
        let grown = placed + slack(element, mover, apart);
        let above = apart[2].abs() - element.half[2] - mover.half[2];
        let is_apart = (above > grown) | lie_apart(element, mover, apart, grown);
        (!is_apart).then_some(apart)
    }
}
