//! The assembly: its elements at their places, the space Omega around them, and the collision model of the elements.

use crate::direction::Direction;
use crate::error::PlanError;
use crate::extent::Extent;
use crate::thinned::thinned;
use lpm::{ElementKey, LARGEST_COORDINATE_MM, Model, Move, Mover, Pose, Shape};
use std::collections::HashMap;

/// A body of the assembly.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Name, unique in the assembly.
    pub id: String,
    /// Shape of the body.
    pub shape: Shape,
    /// Place of the body in the assembly.
    pub pose: Pose,
}

/// Tolerances of contacts and mates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Depth by which two elements may press into each other and still slide, mm: above 0, at most 1. Everything that
    /// presses deeper blocks. A body thinner than the depth keeps a core of 2e-3 mm, or its own thickness where that is
    /// less.
    pub contact_mm: f64,
    /// Gap up to which two elements count as mated, mm: 0 to 10.
    pub mate_mm: f64,
}

impl Default for Tolerance {
    /// Contact 1e-4 mm: above the 1e-6 mm by which the collision core may block early, below what a hand notices. Mates
    /// 2e-3 mm: a close running fit.
    fn default() -> Tolerance {
        Tolerance {
            contact_mm: 1e-4,
            mate_mm: 2e-3,
        }
    }
}

/// A pair of elements that run in each other by construction, so that their bodies overlap in the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guided {
    /// Number of one element.
    pub a: usize,
    /// Number of the other element.
    pub b: usize,
    /// Axis along which the elements come apart, 0 to 2; across the axis they block each other. `None`: the two never
    /// block each other.
    pub axis: Option<usize>,
}

/// Elements at their places, checked, with a collision model.
#[derive(Debug, Clone)]
pub struct Assembly {
    elements: Vec<Element>,
    extents: Vec<Extent>,
    omega: Extent,
    tolerance: Tolerance,
    guided: Vec<Guided>,
    numbers: HashMap<String, usize>,
    /// Subtracted from every position, mm, so that ways out of Omega stay within the range of the collision core.
    origin: [f64; 3],
    movers: Vec<Mover>,
    model: Model,
    keys: Vec<ElementKey>,
}

impl Assembly {
    /// Checks the elements and builds the model. Without `omega`, the box around all elements is Omega.
    ///
    /// # Errors
    /// Fails when the tolerance is out of range, an id is repeated, a body is flawed, an element reaches out of
    /// `omega`, Omega is so large that an element outside would exceed the coordinates of the collision core, or two
    /// elements that are not `guided` overlap deeper than the contact depth.
    pub fn new(
        elements: Vec<Element>,
        omega: Option<Extent>,
        tolerance: Tolerance,
        guided: Vec<Guided>,
    ) -> Result<Assembly, PlanError> {
        check_tolerance(tolerance)?;
        let numbers = numbered(&elements)?;
        for element in &elements {
            let checked = element.shape.check().and_then(|()| element.pose.check());
            checked.map_err(|flaw| PlanError::Flawed {
                id: element.id.clone(),
                flaw,
            })?;
        }
        let extents: Vec<Extent> = elements
            .iter()
            .map(|it| Extent::of(&it.shape, &it.pose))
            .collect();
        let around = extents.iter().fold(Extent::NOTHING, Extent::joined);
        if let Some(omega) = &omega {
            let outside = extents
                .iter()
                .position(|it| !omega.holds(it, tolerance.contact_mm));
            if let Some(outside) = outside {
                return Err(PlanError::OutsideOmega {
                    id: elements[outside].id.clone(),
                    found: extents[outside],
                    omega: *omega,
                });
            }
        }
        let omega = omega.unwrap_or(around);
        let origin = origin_of(&omega)?;
        let (movers, model) = modelled(&elements, tolerance.contact_mm / 2.0, origin)?;
        let keys = model.keys().collect();
        let assembly = Assembly {
            elements,
            extents,
            omega,
            tolerance,
            guided,
            numbers,
            origin,
            movers,
            model,
            keys,
        };
        assembly.check_apart()?;
        Ok(assembly)
    }

    /// Returns the elements; tables and steps name an element by its index in this slice.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Returns the number of elements.
    pub fn len(&self) -> usize {
        self.elements.len()
    }

    /// Returns true when the assembly has no elements.
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }

    /// Returns the id of an element.
    pub fn id(&self, number: usize) -> &str {
        &self.elements[number].id
    }

    /// Returns the number of the element with this id.
    ///
    /// # Errors
    /// Fails when no element has this id; the error then names `demand`, the demand with the id.
    pub fn number(&self, id: &str, demand: &'static str) -> Result<usize, PlanError> {
        self.numbers
            .get(id)
            .copied()
            .ok_or_else(|| PlanError::UnknownId {
                demand,
                found: id.to_owned(),
            })
    }

    /// Returns the space around the assembly; an element is out when its box has left it.
    pub fn omega(&self) -> &Extent {
        &self.omega
    }

    /// Returns the tolerances with which the assembly was built.
    pub fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    /// Returns the pairs that run in each other.
    pub fn guided(&self) -> &[Guided] {
        &self.guided
    }

    /// Returns the box around an element, mm.
    pub fn extent(&self, number: usize) -> &Extent {
        &self.extents[number]
    }

    /// Returns the distance that brings a box out of Omega in a direction, mm.
    pub fn distance_out_mm(&self, extent: &Extent, direction: Direction) -> f64 {
        let axis = direction.axis();
        let distance = if direction.sign() > 0.0 {
            self.omega.high[axis] - extent.low[axis]
        } else {
            extent.high[axis] - self.omega.low[axis]
        };
        distance.max(0.0)
    }

    /// Returns the collision model of all elements, half of the contact depth taken off each.
    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the origin of the model in the frame of the assembly, mm.
    pub(crate) fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns the key of an element in [`Assembly::model`].
    pub(crate) fn key(&self, number: usize) -> ElementKey {
        self.keys[number]
    }

    /// Returns an element as a mover, half of the contact depth taken off.
    pub(crate) fn mover(&self, number: usize) -> &Mover {
        &self.movers[number]
    }

    /// Returns the pose of an element in the frame of the model, shifted by a displacement, mm.
    pub(crate) fn pose(&self, number: usize, by: [f64; 3]) -> Pose {
        let pose = self.elements[number].pose;
        let at = [0, 1, 2].map(|axis| pose.position[axis] - self.origin[axis] + by[axis]);
        pose.moved_to(at)
    }

    /// Returns the elements that an element meets on a straight way that begins at `from` (a displacement from its
    /// place, mm), in the order of their numbers. Leaves out the elements with which it is guided.
    ///
    /// # Errors
    /// Fails when the collision core cannot decide the move.
    pub(crate) fn met(
        &self,
        number: usize,
        from: [f64; 3],
        way: [f64; 3],
    ) -> Result<Vec<u32>, PlanError> {
        let mut met = Vec::new();
        self.add_met((number, from, way), &mut Vec::new(), &mut met)?;
        Ok(met)
    }

    /// Adds the result of [`Assembly::met`] to `met`. `hits` is memory that many questions share.
    ///
    /// # Errors
    /// Fails when the collision core cannot decide the move.
    pub(crate) fn add_met(
        &self,
        (number, from, way): (usize, [f64; 3], [f64; 3]),
        hits: &mut Vec<ElementKey>,
        met: &mut Vec<u32>,
    ) -> Result<(), PlanError> {
        let to = [0, 1, 2].map(|axis| from[axis] + way[axis]);
        let way = Move {
            from: self.pose(number, from),
            to: self.pose(number, to),
            margin_mm: 0.0,
            ignore: &[self.keys[number]],
        };
        self.model.list_hits(self.mover(number), &way, hits);
        // Nothing is ever removed from the model, so the place of an element is its number.
        if hits.last().is_some_and(|hit| hit.place() >= self.len()) {
            return Err(PlanError::Undecidable {
                id: self.id(number).to_owned(),
            });
        }
        let counts = |other: &usize| !self.is_guided(number, *other);
        let others = hits.iter().map(|hit| hit.place()).filter(counts);
        met.extend(others.map(|it| it as u32));
        Ok(())
    }

    /// Returns the elements that block an element in a direction because they guide it along another axis.
    pub(crate) fn guiding(&self, number: usize, direction: Direction) -> Vec<u32> {
        let across = self
            .guided
            .iter()
            .filter(|it| it.axis.is_some_and(|axis| axis != direction.axis()));
        let partner = across.filter_map(|it| match (it.a == number, it.b == number) {
            (true, _) => Some(it.b as u32),
            (_, true) => Some(it.a as u32),
            (false, false) => None,
        });
        partner.collect()
    }

    /// Returns true when the two elements run in each other.
    pub(crate) fn is_guided(&self, a: usize, b: usize) -> bool {
        let is_pair = |it: &Guided| (it.a, it.b) == (a, b) || (it.a, it.b) == (b, a);
        self.guided.iter().any(is_pair)
    }

    fn check_apart(&self) -> Result<(), PlanError> {
        for number in 0..self.len() {
            if let Some(other) = self.met(number, [0.0; 3], [0.0; 3])?.first() {
                return Err(PlanError::Overlap {
                    a: self.id(number).to_owned(),
                    b: self.id(*other as usize).to_owned(),
                    allowed_mm: self.tolerance.contact_mm,
                });
            }
        }
        Ok(())
    }
}

fn check_tolerance(tolerance: Tolerance) -> Result<(), PlanError> {
    let checks = [
        (
            "contact_mm",
            tolerance.contact_mm,
            tolerance.contact_mm > 0.0 && tolerance.contact_mm <= 1.0,
            "above 0 and at most 1 mm",
        ),
        (
            "mate_mm",
            tolerance.mate_mm,
            (0.0..=10.0).contains(&tolerance.mate_mm),
            "0 to 10 mm",
        ),
    ];
    for (key, found, is_sound, expected) in checks {
        if !is_sound {
            return Err(PlanError::Tolerance {
                key,
                found,
                expected,
            });
        }
    }
    Ok(())
}

fn numbered(elements: &[Element]) -> Result<HashMap<String, usize>, PlanError> {
    let mut numbers = HashMap::new();
    for (number, element) in elements.iter().enumerate() {
        if numbers.insert(element.id.clone(), number).is_some() {
            return Err(PlanError::RepeatedId {
                found: element.id.clone(),
            });
        }
    }
    Ok(numbers)
}

/// Returns the origin of the model: 0 where Omega allows it, else the middle of Omega.
fn origin_of(omega: &Extent) -> Result<[f64; 3], PlanError> {
    let size = |axis: usize| (omega.high[axis] - omega.low[axis]).max(0.0);
    let farthest = |axis: usize| omega.low[axis].abs().max(omega.high[axis].abs()) + size(axis);
    if (0..3).all(|axis| farthest(axis) <= LARGEST_COORDINATE_MM) || omega.low[0] > omega.high[0] {
        return Ok([0.0; 3]);
    }
    for axis in 0..3 {
        // An element may start at one end of Omega and leave beyond the other one.
        if 1.5 * size(axis) > LARGEST_COORDINATE_MM {
            return Err(PlanError::OmegaTooLarge {
                found_mm: size(axis),
                most_mm: LARGEST_COORDINATE_MM / 1.5,
            });
        }
    }
    Ok(omega.middle().map(f64::round))
}

/// Builds the movers and the model of the elements with a depth taken off their faces.
pub(crate) fn modelled(
    elements: &[Element],
    depth_mm: f64,
    origin: [f64; 3],
) -> Result<(Vec<Mover>, Model), PlanError> {
    let thin: Vec<(Shape, Pose)> = elements
        .iter()
        .map(|it| {
            let at = [0, 1, 2].map(|axis| it.pose.position[axis] - origin[axis]);
            (thinned(&it.shape, depth_mm), it.pose.moved_to(at))
        })
        .collect();
    let flawed = |number: usize, flaw| PlanError::Flawed {
        id: elements[number].id.clone(),
        flaw,
    };
    let movers = thin
        .iter()
        .enumerate()
        .map(|(number, (shape, _))| Mover::new(shape).map_err(|flaw| flawed(number, flaw)));
    let movers = movers.collect::<Result<_, _>>()?;
    let named = elements
        .iter()
        .zip(&thin)
        .map(|(it, (shape, pose))| (it.id.as_str(), shape, pose));
    let model = Model::of(named).map_err(|(number, flaw)| flawed(number, flaw))?;
    Ok((movers, model))
}
