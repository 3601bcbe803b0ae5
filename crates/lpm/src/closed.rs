//! Which triangles of a mesh close a space.
//!
//! Files are not tidy: surfaces come twice, lie within each other, have a stray triangle beside them, a wall in the
//! middle, a corner that is not written down by the neighbour on the other side of an edge. A body inside such a mesh
//! touches nothing, so whatever is closed has to be found in spite of all that:
//! 1. Corners nearer than [`WELD_MM`] are one. What is shrunk to a segment or a point closes nothing.
//! 2. A triangle that comes again is one. Of what hangs together one that comes again turned over is a wall between two
//!    spaces and is left out, unless everything comes twice.
//! 3. An edge that is free although corners of other free edges lie on it is cut there.
//! 4. Triangles with a free edge are taken away until there are none: what is left is closed.
//! 5. What hangs together by edges is a surface of its own.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::shape::Mesh;
use super::vector::{Vec3, add, dot, length, scale, sub};

/// Corners nearer to each other than this are one when it is asked what is closed, mm: what may be blocked, and more
/// than programs lose that write one corner twice.
const WELD_MM: f64 = 1e-6;
/// Rounds of cutting free edges: each cuts every free edge once.
const MOST_CUTS: usize = 16;
/// With more free edges than this a mesh is meant to be open.
const MOST_FREE: usize = 2_000;

/// Numbers of three vertices.
pub(crate) type Corners = [usize; 3];

/// What closes a space.
pub(crate) struct Surface {
    pub(crate) triangles: Vec<Corners>,
    /// Each edge is shared by an even number of triangles: who crosses the surface once has changed sides.
    pub(crate) is_even: bool,
    /// Along each edge as many triangles run one way as the other: it has an inside and an outside.
    pub(crate) is_oriented: bool,
}

/// What hangs together by corners, each part by its triangles; corners that are one have the same number.
pub(crate) fn parts(mesh: &Mesh) -> Vec<BTreeSet<Corners>> {
    let welded = weld(&mesh.vertices);
    let named = |corners: &Corners| turned(corners.map(|vertex| welded[vertex]));
    touching(&mesh.triangles.iter().map(named).collect())
}

/// The closed surfaces of a part.
pub(crate) fn closed_surfaces(vertices: &[Vec3], part: &BTreeSet<Corners>) -> Vec<Surface> {
    let proper = part
        .iter()
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .copied();
    let proper: BTreeSet<Corners> = proper.collect();
    surfaces(&closed(vertices, &proper))
}

/// What is left of a part without all that is open. Walls are left out where what they divide is closed without them;
/// not, where they close a space of their own.
fn closed(vertices: &[Vec3], part: &BTreeSet<Corners>) -> Vec<Corners> {
    let has_twin = |corners: &Corners| part.contains(&twin(*corners));
    let (twins, alone): (Vec<Corners>, Vec<Corners>) = part.iter().partition(|it| has_twin(it));
    let walls: Vec<Corners> = twins.into_iter().filter(|it| *it < twin(*it)).collect();
    if !walls.is_empty() && peeled(walls.clone()).is_empty() {
        let around = joined(vertices, alone.clone());
        if !around.is_empty() && free_edges(&around).is_empty() {
            return around;
        }
    }
    peeled(joined(vertices, [alone, walls].concat()))
}

/// For each vertex the first one that is nearer to it than [`WELD_MM`].
fn weld(vertices: &[Vec3]) -> Vec<usize> {
    let mut exact = HashMap::new();
    let mut near: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut welded = Vec::with_capacity(vertices.len());
    for (index, vertex) in vertices.iter().enumerate() {
        let key = vertex.map(|member| (member + 0.0).to_bits());
        let first = *exact.entry(key).or_insert_with(|| {
            let cell = vertex.map(|member| (member / WELD_MM).floor() as i64);
            let around = (0..27).map(|at| [at / 9 - 1, at / 3 % 3 - 1, at % 3 - 1]);
            let cells = around.map(|by: [i64; 3]| [0, 1, 2].map(|axis| cell[axis] + by[axis]));
            let mut known = cells.filter_map(|cell| near.get(&cell)).flatten();
            let found = known.find(|other| length(sub(vertices[**other], *vertex)) < WELD_MM);
            let found = found.copied();
            found.unwrap_or_else(|| {
                near.entry(cell).or_default().push(index);
                index
            })
        });
        welded.push(first);
    }
    welded
}

/// The triangle from its lowest corner on: the same for all that look the same from the same side.
fn turned([a, b, c]: Corners) -> Corners {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

fn touching(triangles: &BTreeSet<Corners>) -> Vec<BTreeSet<Corners>> {
    let mut around: BTreeMap<usize, Vec<Corners>> = BTreeMap::new();
    for corners in triangles {
        for vertex in corners {
            around.entry(*vertex).or_default().push(*corners);
        }
    }
    let mut parts: Vec<BTreeSet<Corners>> = Vec::new();
    while let Some((_, first)) = around.pop_first() {
        let (mut part, mut left) = (BTreeSet::new(), first);
        while let Some(corners) = left.pop() {
            if part.insert(corners) {
                let beside = corners.iter().filter_map(|vertex| around.remove(vertex));
                left.extend(beside.flatten());
            }
        }
        parts.push(part);
    }
    parts
}

/// The same seen from the other side.
fn twin([a, b, c]: Corners) -> Corners {
    turned([a, c, b])
}

/// The way round a triangle.
fn sides([a, b, c]: Corners) -> [(usize, usize); 3] {
    [(a, b), (b, c), (c, a)]
}

/// The edges of a triangle, each from its lower corner.
fn edges(corners: Corners) -> [(usize, usize); 3] {
    sides(corners).map(|(p, q)| (p.min(q), p.max(q)))
}

fn uses(triangles: &[Corners]) -> BTreeMap<(usize, usize), usize> {
    let mut uses = BTreeMap::new();
    for edge in triangles.iter().copied().flat_map(edges) {
        *uses.entry(edge).or_default() += 1;
    }
    uses
}

fn free_edges(triangles: &[Corners]) -> BTreeSet<(usize, usize)> {
    let free = uses(triangles).into_iter().filter(|(_, count)| *count == 1);
    free.map(|(edge, _)| edge).collect()
}

/// Cuts triangles whose free edge has corners of other free edges on it.
fn joined(vertices: &[Vec3], mut triangles: Vec<Corners>) -> Vec<Corners> {
    for _ in 0..MOST_CUTS {
        let free = free_edges(&triangles);
        if free.is_empty() || free.len() > MOST_FREE {
            break;
        }
        let ends: BTreeSet<usize> = free.iter().flat_map(|(p, q)| [*p, *q]).collect();
        let before = triangles.len();
        for at in 0..before {
            let [a, b, c] = triangles[at];
            let sides = [[a, b, c], [b, c, a], [c, a, b]];
            let mut free_sides = sides
                .into_iter()
                .filter(|[p, q, _]| free.contains(&(*p.min(q), *p.max(q))));
            let cut = free_sides.find_map(|[p, q, other]| {
                let end = ends.iter().find(|end| lies_on(vertices, **end, (p, q)))?;
                Some(([p, *end, other], [*end, q, other]))
            });
            if let Some((first, second)) = cut {
                triangles[at] = first;
                triangles.push(second);
            }
        }
        if triangles.len() == before {
            break;
        }
    }
    triangles
}

/// Whether a vertex lies between two others, and is neither.
fn lies_on(vertices: &[Vec3], vertex: usize, (p, q): (usize, usize)) -> bool {
    if vertex == p || vertex == q {
        return false;
    }
    let (from, to, at) = (vertices[p], vertices[q], vertices[vertex]);
    let way = sub(to, from);
    let part = dot(sub(at, from), way) / dot(way, way);
    let foot = add(from, scale(way, part));
    part > 0.0 && part < 1.0 && length(sub(at, foot)) < WELD_MM
}

/// Without those that have a free edge, until nobody has.
fn peeled(mut triangles: Vec<Corners>) -> Vec<Corners> {
    let mut uses = uses(&triangles);
    loop {
        let before = triangles.len();
        triangles.retain(|corners| {
            let is_open = edges(*corners).iter().any(|edge| uses[edge] == 1);
            if is_open {
                for edge in edges(*corners) {
                    *uses.entry(edge).or_default() -= 1;
                }
            }
            !is_open
        });
        if triangles.len() == before {
            return triangles;
        }
    }
}

/// What hangs together by edges.
fn surfaces(triangles: &[Corners]) -> Vec<Surface> {
    let mut beside: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    let mut forward: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for (index, corners) in triangles.iter().enumerate() {
        for (p, q) in sides(*corners) {
            *forward.entry((p, q)).or_default() += 1;
            beside.entry((p.min(q), p.max(q))).or_default().push(index);
        }
    }
    let mut known = vec![false; triangles.len()];
    let mut surfaces = Vec::new();
    for first in 0..triangles.len() {
        let mut left = vec![first];
        let mut surface = Surface {
            triangles: Vec::new(),
            is_even: true,
            is_oriented: true,
        };
        while let Some(index) = left.pop() {
            if std::mem::replace(&mut known[index], true) {
                continue;
            }
            surface.triangles.push(triangles[index]);
            for (p, q) in edges(triangles[index]) {
                let sharing = &beside[&(p, q)];
                surface.is_even &= sharing.len().is_multiple_of(2);
                surface.is_oriented &= forward.get(&(p, q)) == forward.get(&(q, p));
                left.extend(sharing);
            }
        }
        if !surface.triangles.is_empty() {
            surfaces.push(surface);
        }
    }
    surfaces
}
