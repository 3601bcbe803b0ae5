//! The three questions asked of the model: any hit (the gate), first contact, clearance.

use super::answer::{Answer, Clearance, Contact, ElementKey, Move};
use super::contact::Wanted;
use super::model::Model;
use super::mover::{Mover, Moving};
use super::passage::Passage;
use super::path::Path;
use super::rest::{Rested, Where, Whether};
use super::straight::Hit;

impl Model {
    /// When and where the mover first comes within the margin of an element.
    pub fn first_contact(&self, mover: &impl Moving, way: &Move) -> Answer {
        let answer = mover.asked(|body| match self.at_rest::<Where>(body, way) {
            Rested::Clear => Some(Answer::Clear),
            Rested::Met(piece, gap) => Some(self.blocked(piece, &Hit { t: 0.0, gap })),
            Rested::Unsaid => self.first_on_the_way(body, way),
        });
        answer.flatten().unwrap_or_else(undecidable)
    }

    fn first_on_the_way(&self, body: &Mover, way: &Move) -> Option<Answer> {
        let path = Path::of(way);
        let path = path.as_ref()?;
        if let Some((piece, hit)) = self.enclosed(body, way) {
            return Some(self.blocked(piece, &hit));
        }
        let passage = Passage::new(self, body, path, way);
        Some(match passage.contact(Wanted::First) {
            None => Answer::Clear,
            Some(found) => self.blocked(found.element, &found.hit(&passage)),
        })
    }

    /// Some element within the margin at some time of the move; `None` is proof that there is none.
    pub fn any_hit(&self, mover: &impl Moving, way: &Move) -> Option<ElementKey> {
        let answer = mover.asked(|body| match self.at_rest::<Whether>(body, way) {
            Rested::Clear => Some(None),
            Rested::Met(piece, ()) => Some(Some(self.owner(piece))),
            Rested::Unsaid => self.any_on_the_way(body, way),
        });
        answer.flatten().unwrap_or(Some(ElementKey::UNDECIDABLE))
    }

    fn any_on_the_way(&self, body: &Mover, way: &Move) -> Option<Option<ElementKey>> {
        let path = Path::of(way);
        let path = path.as_ref()?;
        let piece = match self.enclosed(body, way) {
            Some((piece, _)) => Some(piece),
            None => {
                let passage = Passage::new(self, body, path, way);
                passage.contact(Wanted::Any).map(|found| found.element)
            }
        };
        Some(piece.map(|piece| self.owner(piece)))
    }

    /// Least distance over the move up to `range_mm`; `None` when it is larger.
    ///
    /// A move or a range that cannot be judged has distance 0 from [`ElementKey::UNDECIDABLE`].
    pub fn clearance(&self, mover: &impl Moving, way: &Move, range_mm: f64) -> Option<Clearance> {
        let nothing = |nearest| Clearance {
            distance_mm: 0.0,
            nearest,
            t: 0.0,
        };
        if !(range_mm >= 0.0 && range_mm.is_finite()) {
            return Some(nothing(ElementKey::UNDECIDABLE));
        }
        let least = mover.asked(|body| self.least_on_the_way(body, way, range_mm));
        least
            .flatten()
            .unwrap_or(Some(nothing(ElementKey::UNDECIDABLE)))
    }

    fn least_on_the_way(
        &self,
        body: &Mover,
        way: &Move,
        range_mm: f64,
    ) -> Option<Option<Clearance>> {
        let path = Path::of(way);
        let path = path.as_ref()?;
        let (piece, distance_mm, t) = match self.enclosed(body, way) {
            Some((piece, _)) => (piece, 0.0, 0.0),
            None => match Passage::new(self, body, path, way).least(range_mm) {
                Some(nearest) => (nearest.element, nearest.distance_mm, nearest.t),
                None => return Some(None),
            },
        };
        Some(Some(Clearance {
            distance_mm,
            nearest: self.owner(piece),
            t,
        }))
    }

    /// The element of a piece.
    #[inline]
    fn owner(&self, piece: u32) -> ElementKey {
        self.pieces.at(piece).owner
    }

    #[inline]
    fn blocked(&self, piece: u32, hit: &Hit) -> Answer {
        Answer::Blocked(Contact {
            t_stop: (hit.t * (1.0 - 4.0 * f64::EPSILON)).clamp(0.0, 1.0),
            blocker: self.owner(piece),
            at: hit.gap.on_element,
            normal: hit.gap.normal,
            distance_mm: hit.gap.lower.max(0.0),
        })
    }

    /// A piece of an element that holds the mover, or is held by it, without touching.
    #[inline]
    fn enclosed(&self, body: &Mover, way: &Move) -> Option<(u32, Hit)> {
        if self.hollow.is_empty() && !body.is_hollow() {
            return None;
        }
        self.holding(body, way)
    }

    #[cold]
    fn holding(&self, body: &Mover, way: &Move) -> Option<(u32, Hit)> {
        let inside = body.interior_at(&way.from);
        let asked: Vec<u32> = if body.is_hollow() {
            self.standing_slots().collect()
        } else {
            self.hollow.clone()
        };
        let counted = asked
            .into_iter()
            .filter(|slot| !way.ignore.contains(&self.key(*slot)));
        let shared = |slot: u32| {
            let point = self.shared_point(slot, &inside)?;
            Some((self.a_piece(slot), Hit::inside(point)))
        };
        counted.filter_map(shared).next()
    }
}

fn undecidable() -> Answer {
    Answer::Blocked(Contact {
        t_stop: 0.0,
        blocker: ElementKey::UNDECIDABLE,
        at: [0.0; 3],
        normal: [0.0, 0.0, 1.0],
        distance_mm: 0.0,
    })
}
