//! A body at rest: the question of the paper, which checks poses.
//!
//! Nothing moves, so there is neither a way nor an order: the boxes of pieces are compared, then
//! heights and footprints. Two upright pieces are clear when a height or a footprint lies apart by more than
//! the slack of [`meeting`](super::meeting), for the reason that stands there. Where something is tilted, holds
//! space or has to keep a margin nothing is said here: those are questions about a way, of no length.

use super::answer::Move;
use super::distance::Gap;
use super::meeting::slack;
use super::model::Model;
use super::mover::{Group, Mover, Orientation, Whereabouts};
use super::piece::NOISE;
use super::pose::Yaw;
use super::prism::Prism;
use super::space::LANES;
use super::standing::Stands;
use super::touch::{lie_apart, touch};
use super::vector::{Vec3, add, reach, sub};

/// What closed forms say about a body at rest.
pub(crate) enum Rested<A> {
    /// Proven: nothing is met.
    Clear,
    /// This piece, by its number, may be met; and what was to be told of it.
    Met(u32, A),
    /// Nothing that stands here.
    Unsaid,
}

/// What is wanted of a contact.
pub(crate) trait Telling {
    type Told;
    /// Of an element and a piece of the mover whose centre lies `apart` from it.
    fn tell(element: &Prism, mover: &Prism, apart: Vec3) -> Self::Told;
}

/// That it is.
pub(crate) struct Whether;

impl Telling for Whether {
    type Told = ();
    #[inline(always)]
    fn tell(_: &Prism, _: &Prism, _: Vec3) {}
}

/// Where it is.
pub(crate) struct Where;

impl Telling for Where {
    type Told = Gap;
    #[inline(always)]
    fn tell(element: &Prism, mover: &Prism, apart: Vec3) -> Gap {
        touch(element, mover, apart)
    }
}

impl Model {
    /// A contact of a body that stays where it is.
    #[inline(always)]
    pub(crate) fn at_rest<T: Telling>(&self, body: &Mover, way: &Move) -> Rested<T::Told> {
        let is_plain = self.hollow.is_empty() & !body.is_hollow() & (way.margin_mm == 0.0);
        if !(is_plain && way.goes_nowhere() && way.from.is_sound()) {
            return Rested::Unsaid;
        }
        let rest = Rest {
            model: self,
            body,
            way,
        };
        match way.from.rotation {
            [_, 0.0, 0.0, 0.0] => rest.unturned::<T>(),
            [w, 0.0, 0.0, z] => rest.yawed::<T>(Yaw::of(w, z)),
            _ => Rested::Unsaid,
        }
    }
}

/// A body where its way begins.
struct Rest<'a> {
    model: &'a Model,
    body: &'a Mover,
    way: &'a Move<'a>,
}

impl Rest<'_> {
    /// (Apart from the other one, so that it carries no yaw.)
    #[inline(never)]
    fn unturned<T: Telling>(&self) -> Rested<T::Told> {
        self.among::<T>(None)
    }

    #[inline(never)]
    fn yawed<T: Telling>(&self, yaw: Yaw) -> Rested<T::Told> {
        self.among::<T>(Some(yaw))
    }

    #[inline(always)]
    fn among<T: Telling>(&self, yaw: Option<Yaw>) -> Rested<T::Told> {
        let at = Whereabouts {
            origin: self.way.from.position,
            orientation: yaw.map_or(Orientation::Unturned, Orientation::Yawed),
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
                if placed.is_none() {
                    placed = Some(group.boxes(&at));
                }
                let Some(boxes) = &placed else { continue };
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize % LANES;
                    lanes &= lanes - 1;
                    let places = boxes.meeting(&bundle.cover(lane)) & group.used();
                    if places == 0 {
                        continue;
                    }
                    let number = bundle.piece(lane);
                    match self.judged::<T>(number, (group, places), yaw) {
                        Rested::Clear => {}
                        Rested::Unsaid => is_said = false,
                        met @ Rested::Met(..) => return met,
                    }
                }
            }
        }
        if is_said {
            Rested::Clear
        } else {
            Rested::Unsaid
        }
    }

    /// Some pieces of a group and a standing piece whose boxes they meet.
    #[inline(always)]
    fn judged<T: Telling>(
        &self,
        number: u32,
        (group, mut places): (&Group, u32),
        yaw: Option<Yaw>,
    ) -> Rested<T::Told> {
        let element = self.model.pieces.at(number);
        if !self.way.ignore.is_empty() && self.way.ignore.contains(&element.owner) {
            return Rested::Clear;
        }
        while places != 0 {
            let local = group.first + places.trailing_zeros() as usize;
            places &= places - 1;
            let (Stands::Upright(standing), Some(own)) = (&element.form, &self.body.prisms[local])
            else {
                return Rested::Unsaid;
            };
            let told = match yaw {
                None => self.told::<T>(standing, own),
                Some(yaw) => self.told::<T>(standing, &own.yawed(yaw)),
            };
            if let Some(told) = told {
                return Rested::Met(number, told);
            }
        }
        Rested::Clear
    }

    /// `None` is proof that two upright pieces share no point; that of the mover is turned, but not at its
    /// place yet.
    #[inline(always)]
    fn told<T: Telling>(&self, element: &Prism, mover: &Prism) -> Option<T::Told> {
        let origin = self.way.from.position;
        let apart = sub(add(mover.centre, origin), element.centre);
        let placed = NOISE * (reach(origin) + reach(mover.centre));
        let grown = placed + slack(element, mover, apart);
        let above = apart[2].abs() - element.half[2] - mover.half[2];
        let is_apart = (above > grown) | lie_apart(element, mover, apart, grown);
        (!is_apart).then(|| T::tell(element, mover, apart))
    }
}
