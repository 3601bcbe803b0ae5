//! The model of the standing elements, and the three questions asked of it.

use super::answer::{Answer, Clearance, Contact, ElementKey, Move};
use super::mover::{Mover, Moving};
use super::path::Path;
use super::piece::{Piece, pieces_of};
use super::pose::{Frame, Pose};
use super::shape::{Flaw, Shape};
use super::solid::Interior;
use super::space::{Candidate, Space};
use super::straight::{self, Hit};
use super::turning::Turning;
use std::borrow::Cow;

/// The standing elements. Elements are put in and taken out one by one; nothing is rebuilt.
#[derive(Debug, Clone, Default)]
pub struct Model {
    slots: Vec<Slot>,
    free: Vec<u32>,
    space: Space,
    /// By the numbers of the space.
    pieces: Vec<Piece>,
    /// Slots of elements with a closed mesh: those can hold a body without touching it.
    hollow: Vec<u32>,
}

#[derive(Debug, Clone, Default)]
struct Slot {
    generation: u32,
    element: Option<Element>,
}

#[derive(Debug, Clone)]
struct Element {
    id: String,
    numbers: Vec<u32>,
    interior: Interior,
}

impl Model {
    /// An empty checking space.
    pub fn new() -> Model {
        Model::default()
    }

    /// Adds one element; `id` is for people and need not be unique.
    ///
    /// # Errors
    /// [`Flaw`] of the shape or the pose; the model stays as it was.
    pub fn insert(&mut self, id: &str, shape: &Shape, pose: &Pose) -> Result<ElementKey, Flaw> {
        shape.check()?;
        pose.check()?;
        let frame = Frame::of(pose.rotation);
        let slot = self.free.pop().unwrap_or(self.slots.len() as u32);
        if slot as usize == self.slots.len() {
            self.slots.push(Slot::default());
        }
        let local = pieces_of(shape);
        let placed = local
            .iter()
            .map(|piece| piece.placed(&frame, pose.position));
        let numbers = placed.map(|piece| self.stand(piece, slot)).collect();
        let interior = Interior::of(shape).placed(&frame, pose.position);
        if !interior.solids.is_empty() {
            self.hollow.push(slot);
        }
        let place = &mut self.slots[slot as usize];
        place.element = Some(Element {
            id: id.to_owned(),
            numbers,
            interior,
        });
        Ok(ElementKey {
            slot,
            generation: place.generation,
        })
    }

    fn stand(&mut self, piece: Piece, slot: u32) -> u32 {
        let (low, high) = piece.bounds();
        let number = self.space.insert(low, high, slot);
        if number as usize == self.pieces.len() {
            self.pieces.push(piece);
        } else {
            self.pieces[number as usize] = piece;
        }
        number
    }

    /// Takes an element out; false when it is not there (any more).
    pub fn remove(&mut self, key: ElementKey) -> bool {
        let Some(slot) = self.slots.get_mut(key.slot as usize) else {
            return false;
        };
        if slot.generation != key.generation {
            return false;
        }
        let Some(element) = slot.element.take() else {
            return false;
        };
        slot.generation += 1;
        element
            .numbers
            .iter()
            .for_each(|number| self.space.remove(*number));
        self.hollow.retain(|known| *known != key.slot);
        self.free.push(key.slot);
        true
    }

    /// Name of an element; `"(undecidable)"` for [`ElementKey::UNDECIDABLE`], `"(removed)"` for one that is gone.
    pub fn id(&self, key: ElementKey) -> &str {
        if key == ElementKey::UNDECIDABLE {
            return "(undecidable)";
        }
        let slot = self
            .slots
            .get(key.slot as usize)
            .filter(|slot| slot.generation == key.generation);
        slot.and_then(|slot| slot.element.as_ref())
            .map_or("(removed)", |element| &element.id)
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.slots.len() - self.free.len()
    }

    /// True without elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Every element in the order of its slot.
    pub fn keys(&self) -> impl Iterator<Item = ElementKey> + '_ {
        let standing = |slot: &u32| self.slots[*slot as usize].element.is_some();
        (0..self.slots.len() as u32)
            .filter(standing)
            .map(|slot| self.key(slot))
    }

    fn key(&self, slot: u32) -> ElementKey {
        ElementKey {
            slot,
            generation: self.slots[slot as usize].generation,
        }
    }

    /// When and where the mover first comes within the margin of an element.
    pub fn first_contact(&self, mover: &impl Moving, way: &Move) -> Answer {
        let Some((body, path)) = readied(mover, way) else {
            return undecidable();
        };
        if let Some((slot, hit)) = self.enclosed(&body, &path, way) {
            return blocked(self.key(slot), &hit);
        }
        let mut earliest: Option<(u32, Hit)> = None;
        self.each_pair(&body, &path, way, way.margin_mm, |pair, entry| {
            let until = earliest.as_ref().map_or(1.0, |(_, hit)| hit.t);
            if entry > until {
                return Next::Piece;
            }
            if let Some(hit) = pair.first_within(way.margin_mm, until)
                && earliest.as_ref().is_none_or(|(_, known)| hit.t < known.t)
            {
                earliest = Some((pair.owner, hit));
            }
            Next::Pair
        });
        earliest.map_or(Answer::Clear, |(slot, hit)| blocked(self.key(slot), &hit))
    }

    /// Some element within the margin at some time of the move; `None` is proof that there is none.
    pub fn any_hit(&self, mover: &impl Moving, way: &Move) -> Option<ElementKey> {
        let Some((body, path)) = readied(mover, way) else {
            return Some(ElementKey::UNDECIDABLE);
        };
        let mut found = self.enclosed(&body, &path, way).map(|(slot, _)| slot);
        if found.is_none() {
            self.each_pair(&body, &path, way, way.margin_mm, |pair, _| {
                if pair.first_within(way.margin_mm, 1.0).is_some() {
                    found = Some(pair.owner);
                    return Next::Done;
                }
                Next::Pair
            });
        }
        found.map(|slot| self.key(slot))
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
        let judged = readied(mover, way).filter(|_| range_mm >= 0.0 && range_mm.is_finite());
        let Some((body, path)) = judged else {
            return Some(nothing(ElementKey::UNDECIDABLE));
        };
        if let Some((slot, _)) = self.enclosed(&body, &path, way) {
            return Some(nothing(self.key(slot)));
        }
        let mut least: Option<Clearance> = None;
        self.each_pair(&body, &path, way, range_mm, |pair, _| {
            let cutoff = least.map_or(range_mm, |known| known.distance_mm);
            if let Some((t, distance_mm)) = pair.least(cutoff)
                && least.is_none_or(|known| distance_mm < known.distance_mm)
            {
                least = Some(Clearance {
                    distance_mm,
                    nearest: self.key(pair.owner),
                    t,
                });
            }
            if least.is_some_and(|known| known.distance_mm <= 0.0) {
                Next::Done
            } else {
                Next::Pair
            }
        });
        least
    }

    /// An element that holds the mover, or is held by it, without touching.
    fn enclosed(&self, body: &Mover, path: &Path, way: &Move) -> Option<(u32, Hit)> {
        if self.hollow.is_empty() && !body.is_hollow() {
            return None;
        }
        let inside = body.interior_at_start(&Frame::of(way.from.rotation), path);
        let all: Vec<u32> = (0..self.slots.len() as u32).collect();
        let asked = if body.is_hollow() { &all } else { &self.hollow };
        let shared = |slot: &u32| {
            let element = self.slots[*slot as usize].element.as_ref()?;
            let point = element.interior.shared_with(&inside)?;
            Some((*slot, Hit::inside(point)))
        };
        let counted = asked
            .iter()
            .filter(|slot| !way.ignore.contains(&self.key(**slot)));
        counted.filter_map(shared).next()
    }

    /// Offers every pair of pieces that may come within `reach_mm`, earliest first for each piece of the mover.
    fn each_pair(
        &self,
        body: &Mover,
        path: &Path,
        way: &Move,
        reach_mm: f64,
        mut offer: impl FnMut(&Pair, f64) -> Next,
    ) {
        let mut candidates = Vec::new();
        for local in &body.pieces {
            let at_start = path.piece_at(local, 0.0);
            self.space
                .candidates(&path.swept(local, &at_start, reach_mm), &mut candidates);
            for Candidate {
                entry,
                owner,
                piece,
            } in candidates.drain(..)
            {
                if !way.ignore.is_empty() && way.ignore.contains(&self.key(owner)) {
                    continue;
                }
                let element = &self.pieces[piece as usize];
                match offer(
                    &Pair {
                        element,
                        local,
                        at_start: &at_start,
                        path,
                        owner,
                    },
                    entry,
                ) {
                    Next::Pair => {}
                    Next::Piece => break,
                    Next::Done => return,
                }
            }
        }
    }
}

/// What to look at after a pair.
enum Next {
    Pair,
    /// The next piece of the mover: the rest of this one cannot matter.
    Piece,
    Done,
}

/// A piece of an element and a piece of the mover.
struct Pair<'a> {
    element: &'a Piece,
    local: &'a Piece,
    at_start: &'a Piece,
    path: &'a Path,
    owner: u32,
}

impl Pair<'_> {
    fn first_within(&self, margin: f64, until: f64) -> Option<Hit> {
        let Pair {
            element,
            local,
            at_start,
            path,
            ..
        } = *self;
        match &path.turn {
            None => straight::first_within(element, at_start, path.displacement, margin, until),
            Some(turn) => Turning {
                element,
                local,
                path,
                turn,
            }
            .first_within(margin, until),
        }
    }

    fn least(&self, cutoff: f64) -> Option<(f64, f64)> {
        let Pair {
            element,
            local,
            at_start,
            path,
            ..
        } = *self;
        match &path.turn {
            None => straight::least(element, at_start, path.displacement, cutoff),
            Some(turn) => Turning {
                element,
                local,
                path,
                turn,
            }
            .least(cutoff),
        }
    }
}

/// `None` when the move or the mover is not valid.
fn readied<'a>(mover: &'a impl Moving, way: &Move) -> Option<(Cow<'a, Mover>, Path)> {
    let margin_valid = way.margin_mm >= 0.0 && way.margin_mm.is_finite();
    let path = Path::between(&way.from, &way.to).filter(|_| margin_valid)?;
    Some((mover.mover()?, path))
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

fn blocked(blocker: ElementKey, hit: &Hit) -> Answer {
    Answer::Blocked(Contact {
        t_stop: (hit.t * (1.0 - 4.0 * f64::EPSILON)).clamp(0.0, 1.0),
        blocker,
        at: hit.gap.on_element,
        normal: hit.gap.normal,
        distance_mm: hit.gap.lower.max(0.0),
    })
}
