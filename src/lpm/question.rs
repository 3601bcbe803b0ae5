//! The three questions asked of the model: any hit (the gate), first contact, clearance.

use super::answer::{Answer, Clearance, Contact, ElementKey, Move};
use super::contact::{Found, Wanted};
use super::model::Model;
use super::mover::{Mover, Moving};
use super::passage::Passage;
use super::path::Path;
use super::straight::Hit;

impl Model {
    /// When and where the mover first comes within the margin of an element.
    pub fn first_contact(&self, mover: &impl Moving, way: &Move) -> Answer {
        let answer = asked(mover, way, |body, path| {
            if let Some((slot, hit)) = self.enclosed(body, path, way) {
                return blocked(self.key(slot), &hit);
            }
            let passage = Passage::new(self, body, path, way);
            match passage.contact(Wanted::First) {
                None => Answer::Clear,
                Some(found) => blocked(self.owner(&found), &found.hit(&passage)),
            }
        });
        answer.unwrap_or_else(undecidable)
    }

    /// Some element within the margin at some time of the move; `None` is proof that there is none.
    pub fn any_hit(&self, mover: &impl Moving, way: &Move) -> Option<ElementKey> {
        let answer = asked(mover, way, |body, path| {
            if let Some((slot, _)) = self.enclosed(body, path, way) {
                return Some(self.key(slot));
            }
            let found = Passage::new(self, body, path, way).contact(Wanted::Any)?;
            Some(self.owner(&found))
        });
        answer.unwrap_or(Some(ElementKey::UNDECIDABLE))
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
        let answer = asked(mover, way, |body, path| {
            if let Some((slot, _)) = self.enclosed(body, path, way) {
                return Some(nothing(self.key(slot)));
            }
            let nearest = Passage::new(self, body, path, way).least(range_mm)?;
            Some(Clearance {
                distance_mm: nearest.distance_mm,
                nearest: self.pieces.at(nearest.element).owner,
                t: nearest.t,
            })
        });
        answer.unwrap_or(Some(nothing(ElementKey::UNDECIDABLE)))
    }

    fn owner(&self, found: &Found) -> ElementKey {
        self.pieces.at(found.element).owner
    }

    /// An element that holds the mover, or is held by it, without touching.
    #[inline]
    fn enclosed(&self, body: &Mover, path: &Path, way: &Move) -> Option<(u32, Hit)> {
        if self.hollow.is_empty() && !body.is_hollow() {
            return None;
        }
        self.holding(body, path, way)
    }

    #[cold]
    fn holding(&self, body: &Mover, path: &Path, way: &Move) -> Option<(u32, Hit)> {
        let inside = body.interior_at_start(path);
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
            Some((slot, Hit::inside(point)))
        };
        counted.filter_map(shared).next()
    }
}

/// `None` when the move or the mover is not valid.
#[inline(always)]
fn asked<A>(mover: &impl Moving, way: &Move, ask: impl FnOnce(&Mover, &Path) -> A) -> Option<A> {
    if !(way.margin_mm >= 0.0 && way.margin_mm <= f64::MAX) {
        return None;
    }
    let path = Path::between(&way.from, &way.to)?;
    mover.asked(|body| ask(body, &path))
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
