//! The model of the standing elements: who stands where. What is asked of it: [`question`](super::question).

use super::answer::ElementKey;
use super::name::Name;
use super::piece::{Piece, each_piece};
use super::pose::{Frame, Pose};
use super::shape::{Flaw, Shape};
use super::solid::Interior;
use super::space::Space;

/// The standing elements. Elements are put in and taken out one by one; nothing is rebuilt.
#[derive(Debug, Clone, Default)]
pub struct Model {
    slots: Vec<Slot>,
    free: Vec<u32>,
    pub(crate) space: Space,
    /// By the numbers that the space knows.
    pub(crate) pieces: Vec<Standing>,
    free_pieces: Vec<u32>,
    /// Slots of elements with a closed mesh: those can hold a body without touching it.
    pub(crate) hollow: Vec<u32>,
}

/// A piece where it stands.
#[derive(Debug, Clone)]
pub(crate) struct Standing {
    pub(crate) piece: Piece,
    /// Slot of its element.
    pub(crate) owner: u32,
    /// Another piece of the same element, or [`NONE`].
    sibling: u32,
    /// What [`Space::insert`] said.
    gridded: bool,
}

/// No piece.
const NONE: u32 = u32::MAX;

#[derive(Debug, Clone, Default)]
struct Slot {
    generation: u32,
    element: Option<Element>,
}

#[derive(Debug, Clone)]
struct Element {
    id: Name,
    /// First of its pieces.
    first: u32,
    /// Of elements with a mesh.
    interior: Option<Box<Interior>>,
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
        let mut first = NONE;
        each_piece(shape, |piece| {
            first = self.stand(piece.placed(&frame, pose.position), slot, first);
        });
        let interior = Interior::of(shape).map(|interior| interior.placed(&frame, pose.position));
        if interior
            .as_ref()
            .is_some_and(|interior| !interior.solids.is_empty())
        {
            self.hollow.push(slot);
        }
        let element = Element {
            id: Name::of(id),
            first,
            interior: interior.map(Box::new),
        };
        if slot as usize == self.slots.len() {
            self.slots.push(Slot::default());
        }
        self.slots[slot as usize].element = Some(element);
        Ok(self.key(slot))
    }

    fn stand(&mut self, piece: Piece, owner: u32, sibling: u32) -> u32 {
        let number = self.free_pieces.pop().unwrap_or(self.pieces.len() as u32);
        let gridded = self.space.insert(number, piece.bounds());
        let standing = Standing {
            piece,
            owner,
            sibling,
            gridded,
        };
        if number as usize == self.pieces.len() {
            self.pieces.push(standing);
        } else {
            self.pieces[number as usize] = standing;
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
        let mut number = element.first;
        while let Some(standing) = self.pieces.get(number as usize) {
            self.space
                .remove(number, standing.piece.bounds(), standing.gridded);
            self.free_pieces.push(number);
            number = standing.sibling;
        }
        if element.interior.is_some() {
            self.hollow.retain(|known| *known != key.slot);
        }
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
            .map_or("(removed)", |element| element.id.as_str())
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
        self.standing_slots().map(|slot| self.key(slot))
    }

    /// Heap that the model occupies, bytes; closed meshes, which are kept apart, not counted.
    pub fn heap_bytes(&self) -> usize {
        let numbers = self.free.capacity() + self.free_pieces.capacity() + self.hollow.capacity();
        self.slots.capacity() * size_of::<Slot>()
            + self.pieces.capacity() * size_of::<Standing>()
            + numbers * size_of::<u32>()
            + self.space.heap_bytes()
    }

    pub(crate) fn standing_slots(&self) -> impl Iterator<Item = u32> + '_ {
        let standing = |slot: &u32| self.slots[*slot as usize].element.is_some();
        (0..self.slots.len() as u32).filter(standing)
    }

    pub(crate) fn key(&self, slot: u32) -> ElementKey {
        ElementKey {
            slot,
            generation: self.slots[slot as usize].generation,
        }
    }

    /// A point of the element in a slot, or of `other`, that lies inside the other one although no
    /// surfaces need to meet.
    pub(crate) fn shared_point(&self, slot: u32, other: &Interior) -> Option<[f64; 3]> {
        let element = self.slots[slot as usize].element.as_ref()?;
        match &element.interior {
            Some(interior) => interior.shared_with(other),
            None => Interior::around(self.centres(element)).shared_with(other),
        }
    }

    fn centres(&self, element: &Element) -> Vec<[f64; 3]> {
        let piece = |number: u32| self.pieces.get(number as usize);
        let chain = std::iter::successors(piece(element.first), |standing| piece(standing.sibling));
        chain.map(|standing| standing.piece.centre).collect()
    }
}
