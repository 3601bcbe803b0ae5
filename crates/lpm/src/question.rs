//! The four questions to the model: is there any hit, where is the first contact, which elements are hit at all, how
//! large is the clearance.

use super::answer::{Answer, Clearance, Contact, ElementKey, Move};
use super::contact::{Findings, Wanted};
use super::model::Model;
use super::mover::{Mover, Moving};
use super::passage::Passage;
use super::path::Path;
use super::prism::Prism;
use super::rest::Question;
use super::straight::Hit;
use super::touch::touch;
use super::vector::Vec3;

impl Model {
    /// Returns when and where the mover first comes within the margin of an element.
    pub fn first_contact(&self, mover: &impl Moving, way: &Move) -> Answer {
        let answer = mover.with_mover(|body| self.ask::<FirstContact>(body, way));
        answer.unwrap_or(UNDECIDABLE)
    }

    /// Returns an element of which the mover comes within the margin during the move; `None` is proof that there is
    /// none.
    pub fn any_hit(&self, mover: &impl Moving, way: &Move) -> Option<ElementKey> {
        let answer = mover.with_mover(|body| self.ask::<AnyHit>(body, way));
        answer.unwrap_or(Some(ElementKey::UNDECIDABLE))
    }

    /// Returns every element of which the mover comes within the margin during the move, in the order of their keys and
    /// each once. An element that is missing is proven to stay farther away.
    ///
    /// For a move that cannot be decided, the only entry is [`ElementKey::UNDECIDABLE`].
    pub fn every_hit(&self, mover: &impl Moving, way: &Move) -> Vec<ElementKey> {
        let mut hits = Vec::new();
        self.list_hits(mover, way, &mut hits);
        hits
    }

    /// Replaces the content of `hits` by the answer of [`Model::every_hit`], so that many questions can share its
    /// memory.
    pub fn list_hits(&self, mover: &impl Moving, way: &Move, hits: &mut Vec<ElementKey>) {
        let mut listed = std::mem::take(hits);
        listed.clear();
        let answer = mover.with_mover(|body| self.all_on_the_way(body, way, listed));
        *hits = answer
            .flatten()
            .unwrap_or_else(|| vec![ElementKey::UNDECIDABLE]);
    }

    fn all_on_the_way(
        &self,
        body: &Mover,
        way: &Move,
        listed: Vec<ElementKey>,
    ) -> Option<Vec<ElementKey>> {
        let path = Path::of(way);
        let path = path.as_ref()?;
        let passage = Passage::new(self, body, path, way);
        let mut found = Findings::into(Wanted::Every, listed);
        passage.contact(&mut found);
        let mut hits = found.met;
        if self.may_enclose(body) {
            let enclosed = self.holding(body, way);
            hits.extend(enclosed.map(|(piece, _)| self.owner(piece)));
        }
        hits.sort_unstable();
        hits.dedup();
        Some(hits)
    }

    /// Returns the least distance over the move; `None` when it exceeds `range_mm`.
    ///
    /// For an undecidable move or range, the distance is 0 and the element is [`ElementKey::UNDECIDABLE`].
    pub fn clearance(&self, mover: &impl Moving, way: &Move, range_mm: f64) -> Option<Clearance> {
        let nothing = |nearest| Clearance {
            distance_mm: 0.0,
            nearest,
            t: 0.0,
        };
        if !(range_mm >= 0.0 && range_mm.is_finite()) {
            return Some(nothing(ElementKey::UNDECIDABLE));
        }
        let least = mover.with_mover(|body| self.least_on_the_way(body, way, range_mm));
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

    /// Returns the element to which a piece belongs.
    #[inline]
    fn owner(&self, piece: u32) -> ElementKey {
        self.pieces.at(piece).owner
    }

    /// Returns a piece of an element that encloses the mover, or that the mover encloses; their surfaces need not
    /// touch.
    #[inline]
    fn enclosed(&self, body: &Mover, way: &Move) -> Option<(u32, Hit)> {
        if !self.may_enclose(body) {
            return None;
        }
        self.holding(body, way).next()
    }

    /// Returns true when the mover or an element encloses a space in which the other one can lie.
    #[inline]
    fn may_enclose(&self, body: &Mover) -> bool {
        !self.hollow.is_empty() || body.is_hollow()
    }

    /// Yields the elements that enclose the mover at the start, or lie inside it, each by one of its pieces.
    #[cold]
    fn holding(&self, body: &Mover, way: &Move) -> impl Iterator<Item = (u32, Hit)> {
        let inside = body.interior_at(&way.from);
        let candidates: Vec<u32> = if body.is_hollow() {
            self.taken_slots().collect()
        } else {
            self.hollow.clone()
        };
        let counted = candidates
            .into_iter()
            .filter(|slot| !way.ignore.contains(&self.key(*slot)));
        let shared = move |slot: u32| {
            let point = self.shared_point(slot, &inside)?;
            Some((self.first_piece(slot), Hit::inside(point)))
        };
        counted.filter_map(shared)
    }
}

/// First question: is there any contact, and with which element?
struct AnyHit;

impl Question for AnyHit {
    type Answer = Option<ElementKey>;
    const CLEAR: Option<ElementKey> = None;

    #[inline(always)]
    fn met(owner: ElementKey, _: &Prism, _: &Prism, _: Vec3) -> Option<ElementKey> {
        Some(owner)
    }

    #[inline(never)]
    fn on_the_way(model: &Model, body: &Mover, way: &Move) -> Option<ElementKey> {
        let path = Path::of(way);
        let Some(path) = &path else {
            return Some(ElementKey::UNDECIDABLE);
        };
        let piece = match model.enclosed(body, way) {
            Some((piece, _)) => piece,
            None => {
                let passage = Passage::new(model, body, path, way);
                let mut found = Findings::wanted(Wanted::Any);
                passage.contact(&mut found);
                found.best.as_ref()?.element
            }
        };
        Some(model.owner(piece))
    }
}

/// Second question: with which element is the first contact, when and where?
struct FirstContact;

impl Question for FirstContact {
    type Answer = Answer;
    const CLEAR: Answer = Answer::Clear;

    #[inline(always)]
    fn met(owner: ElementKey, element: &Prism, mover: &Prism, apart: Vec3) -> Answer {
        let gap = touch(element, mover, apart);
        blocked(owner, &Hit { t: 0.0, gap })
    }

    #[inline(never)]
    fn on_the_way(model: &Model, body: &Mover, way: &Move) -> Answer {
        let path = Path::of(way);
        let Some(path) = &path else {
            return UNDECIDABLE;
        };
        if let Some((piece, hit)) = model.enclosed(body, way) {
            return blocked(model.owner(piece), &hit);
        }
        let passage = Passage::new(model, body, path, way);
        let mut found = Findings::wanted(Wanted::First);
        passage.contact(&mut found);
        match &found.best {
            None => Answer::Clear,
            Some(found) => blocked(model.owner(found.element), &found.hit(&passage)),
        }
    }
}

/// Answer to a move that cannot be decided.
const UNDECIDABLE: Answer = Answer::Blocked(Contact {
    t_stop: 0.0,
    blocker: ElementKey::UNDECIDABLE,
    at: [0.0; 3],
    normal: [0.0, 0.0, 1.0],
    distance_mm: 0.0,
});

#[inline]
fn blocked(blocker: ElementKey, hit: &Hit) -> Answer {
    Answer::Blocked(Contact {
        t_stop: (hit.t * (1.0 - 4.0 * f64::EPSILON)).clamp(0.0, 1.0),
        blocker,
        at: hit.gap.on_element,
        normal: hit.gap.normal,
        distance_mm: hit.gap.lower.max(0.0),
    })
}
