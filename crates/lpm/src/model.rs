//! The model of the stationary elements: inserts, removes and names them. The questions are in
//! [`question`](super::question).

use super::answer::ElementKey;
use super::interior::Interior;
use super::name::{Name, Names};
use super::pose::{Frame, Pose};
use super::prism::Checked;
use super::shape::{Flaw, Shape};
use super::space::{Filling, Space};
use super::stationary::{NONE, Pieces};

/// The stationary elements. Inserting or removing one element rebuilds nothing.
#[derive(Debug, Clone, Default)]
pub struct Model {
    slots: Vec<Slot>,
    free: Vec<u32>,
    names: Names,
    pub(crate) space: Space,
    pub(crate) pieces: Pieces,
    /// Slots of elements with a closed mesh; only these can enclose a body without touching it.
    pub(crate) hollow: Vec<u32>,
}

/// Slot of an element, present or removed.
#[derive(Debug, Clone)]
struct Slot {
    generation: u32,
    /// Number of the first piece of the element; [`NONE`] for a free slot.
    first: u32,
    id: Name,
    /// Enclosed spaces of an element with a mesh.
    interior: Option<Box<Interior>>,
}

impl Slot {
    fn is_taken(&self) -> bool {
        self.first != NONE
    }
}

impl Model {
    /// Returns a model without elements.
    pub fn new() -> Model {
        Model::default()
    }

    /// Adds one element. Only messages use `id`; it need not be unique.
    ///
    /// # Errors
    /// Fails with the [`Flaw`] of the shape or the pose; the model stays unchanged.
    pub fn insert(&mut self, id: &str, shape: &Shape, pose: &Pose) -> Result<ElementKey, Flaw> {
        let checked = Checked::of(shape)?;
        pose.check()?;
        let slot = self.free.pop().unwrap_or(self.slots.len() as u32);
        let left = self.slots.get(slot as usize);
        let key = ElementKey {
            slot,
            generation: left.map_or(0, |left| left.generation),
        };
        let first = self.pieces.insert(&mut self.space, &checked, pose, key);
        let taken = self.taken(id, &checked, pose, key, first);
        match self.slots.get_mut(slot as usize) {
            Some(left) => *left = taken,
            None => self.slots.push(taken),
        }
        Ok(key)
    }

    /// Builds a model of many elements at once: faster than one [`Model::insert`] per element, with the same result.
    /// [`Model::keys`] are in the order of the elements.
    ///
    /// # Errors
    /// Fails with the index and the [`Flaw`] of the first flawed element.
    pub fn of<'a>(
        elements: impl Iterator<Item = (&'a str, &'a Shape, &'a Pose)>,
    ) -> Result<Model, (usize, Flaw)> {
        let mut model = Model::new();
        model.slots.reserve(elements.size_hint().0);
        model.pieces.reserve(elements.size_hint().0);
        let mut filling = Filling::of(elements.size_hint().0);
        for (number, (id, shape, pose)) in elements.enumerate() {
            let flawed = |flaw| (number, flaw);
            let checked = Checked::of(shape).map_err(flawed)?;
            pose.check().map_err(flawed)?;
            let key = ElementKey {
                slot: number as u32,
                generation: 0,
            };
            let first = model.pieces.insert(&mut filling, &checked, pose, key);
            let taken = model.taken(id, &checked, pose, key, first);
            model.slots.push(taken);
        }
        model.space = filling.space();
        Ok(model)
    }

    /// Makes the slot of an element whose pieces are already in the model; stores its name and its enclosed spaces.
    #[inline(always)]
    fn taken(
        &mut self,
        id: &str,
        checked: &Checked<'_>,
        pose: &Pose,
        key: ElementKey,
        first: u32,
    ) -> Slot {
        let interior = match checked.single {
            Some(_) => None,
            None => self.interior(checked.shape, pose, key.slot),
        };
        Slot {
            generation: key.generation,
            first,
            id: self.names.keep(id),
            interior,
        }
    }

    fn interior(&mut self, shape: &Shape, pose: &Pose, slot: u32) -> Option<Box<Interior>> {
        let interior = Interior::of(shape)?.placed(&Frame::of(pose.rotation), pose.position);
        if !interior.solids.is_empty() {
            self.hollow.push(slot);
        }
        Some(Box::new(interior))
    }

    /// Removes an element; returns false when it is absent.
    pub fn remove(&mut self, key: ElementKey) -> bool {
        let Some(slot) = self.slots.get_mut(key.slot as usize) else {
            return false;
        };
        if slot.generation != key.generation || !slot.is_taken() {
            return false;
        }
        slot.generation += 1;
        self.names.release(&slot.id);
        let mut piece = std::mem::replace(&mut slot.first, NONE);
        if slot.interior.take().is_some() {
            self.hollow.retain(|known| *known != key.slot);
        }
        while piece != NONE {
            let (cover, next) = self.pieces.remove(piece);
            self.space.remove(piece, &cover);
            piece = next;
        }
        self.free.push(key.slot);
        if self.names.is_mostly_gaps() {
            self.rewrite_names();
        }
        true
    }

    fn rewrite_names(&mut self) {
        let mut fresh = Names::default();
        for slot in self.slots.iter_mut().filter(|slot| slot.is_taken()) {
            slot.id = fresh.keep(self.names.text(&slot.id));
        }
        self.names = fresh;
    }

    /// Returns the name of an element; `"(undecidable)"` for [`ElementKey::UNDECIDABLE`], `"(removed)"` for a
    /// removed element.
    pub fn id(&self, key: ElementKey) -> &str {
        if key == ElementKey::UNDECIDABLE {
            return "(undecidable)";
        }
        let slot = self.slots.get(key.slot as usize);
        slot.filter(|slot| slot.generation == key.generation && slot.is_taken())
            .map_or("(removed)", |slot| self.names.text(&slot.id))
    }

    /// Returns the number of elements.
    pub fn len(&self) -> usize {
        self.slots.len() - self.free.len()
    }

    /// Returns true when the model has no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Iterates over the elements in the order of their slots.
    pub fn keys(&self) -> impl Iterator<Item = ElementKey> + '_ {
        self.taken_slots().map(|slot| self.key(slot))
    }

    /// Returns the heap in use, bytes, without that of closed meshes.
    pub fn heap_bytes(&self) -> usize {
        let numbers = self.free.capacity() + self.hollow.capacity();
        self.slots.capacity() * size_of::<Slot>()
            + self.pieces.heap_bytes()
            + numbers * size_of::<u32>()
            + self.names.heap_bytes()
            + self.space.heap_bytes()
    }

    pub(crate) fn taken_slots(&self) -> impl Iterator<Item = u32> + '_ {
        let is_taken = |slot: &u32| self.slots[*slot as usize].is_taken();
        (0..self.slots.len() as u32).filter(is_taken)
    }

    pub(crate) fn key(&self, slot: u32) -> ElementKey {
        ElementKey {
            slot,
            generation: self.slots[slot as usize].generation,
        }
    }

    /// Returns the first piece of the element in a slot; [`NONE`] for a free slot.
    pub(crate) fn first_piece(&self, slot: u32) -> u32 {
        self.slots[slot as usize].first
    }

    /// Returns a point of one body, the element in a slot or `other`, that lies inside the other body, even if their
    /// surfaces do not touch; `None` without such a point.
    pub(crate) fn shared_point(&self, slot: u32, other: &Interior) -> Option<[f64; 3]> {
        let slot = &self.slots[slot as usize];
        match &slot.interior {
            Some(interior) => interior.shared_with(other),
            None => Interior::around(self.centres(slot)).shared_with(other),
        }
    }

    fn centres(&self, slot: &Slot) -> Vec<[f64; 3]> {
        let known = |number: u32| (number != NONE).then_some(number);
        let chain = std::iter::successors(known(slot.first), |number| {
            known(self.pieces.at(*number).sibling)
        });
        chain
            .map(|number| self.pieces.piece(number).centre)
            .collect()
    }
}
