//! Finds the triangles of a mesh that enclose a space.
//!
//! Mesh files are untidy. Surfaces occur twice or inside each other; stray triangles lie beside surfaces, and walls
//! inside them; an edge may lack a corner that the triangle on its other side has. A body inside such a mesh touches no
//! triangle, so this module must find the enclosed spaces all the same:
//! 1. Merge corners nearer to each other than [`WELD_MM`]. Triangles that become a segment or a point enclose nothing.
//! 2. Count a triangle that occurs several times once. A triangle that occurs in both orientations within a connected
//!    part is a wall between two spaces; leave it out, unless every triangle of the part occurs in both.
//! 3. Cut a free edge (an edge of only one triangle) at those corners of other free edges that lie on it.
//! 4. Remove triangles with a free edge until none has one; the rest is closed.
//! 5. Group the triangles that are connected by edges into surfaces.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::shape::Mesh;
use super::vector::{Vec3, add, dot, length, scale, sub};

/// Corners nearer to each other than this are merged, mm. Merging may block a move too early by as much; programs that
/// write one corner twice differ by less, because they only round it.
const WELD_MM: f64 = 1e-6;
/// Maximum number of rounds of cutting; each round cuts every free edge at most once.
const MOST_CUTS: usize = 16;
/// A mesh with more free edges than this counts as open on purpose.
const MOST_FREE: usize = 2_000;

/// Indices of the three vertices of a triangle.
pub(crate) type Corners = [usize; 3];

/// A surface that encloses a space.
pub(crate) struct Surface {
    pub(crate) triangles: Vec<Corners>,
    /// True when each edge belongs to an even number of triangles: a path that crosses the surface once then changes
    /// sides.
    pub(crate) is_even: bool,
    /// True when along each edge as many triangles run one way as the other: the surface then has an inside and an
    /// outside.
    pub(crate) is_oriented: bool,
}

/// Returns the parts of a mesh, each as its triangles. A part is connected by corners; merged corners have the same
/// index.
pub(crate) fn parts(mesh: &Mesh) -> Vec<BTreeSet<Corners>> {
    let welded = weld(&mesh.vertices);
    let named = |corners: &Corners| lowest_first(corners.map(|vertex| welded[vertex]));
    connected_by_corners(&mesh.triangles.iter().map(named).collect())
}

/// Returns the closed surfaces of a part.
pub(crate) fn closed_surfaces(vertices: &[Vec3], part: &BTreeSet<Corners>) -> Vec<Surface> {
    let proper = part
        .iter()
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .copied();
    let proper: BTreeSet<Corners> = proper.collect();
    surfaces(&closed(vertices, &proper))
}

/// Returns the triangles of a part that remain after cutting and removing open ones. Leaves walls out when the other
/// triangles are closed without them and the walls enclose no space of their own.
fn closed(vertices: &[Vec3], part: &BTreeSet<Corners>) -> Vec<Corners> {
    let has_reverse = |corners: &Corners| part.contains(&reversed(*corners));
    let (paired, alone): (Vec<Corners>, Vec<Corners>) = part.iter().partition(|it| has_reverse(it));
    let walls: Vec<Corners> = paired
        .into_iter()
        .filter(|it| *it < reversed(*it))
        .collect();
    if !walls.is_empty() && without_free_triangles(walls.clone()).is_empty() {
        let around = cut_free_edges(vertices, alone.clone());
        if !around.is_empty() && free_edges(&around).is_empty() {
            return around;
        }
    }
    without_free_triangles(cut_free_edges(vertices, [alone, walls].concat()))
}

/// Returns, for each vertex, the index of the first vertex nearer to it than [`WELD_MM`], which may be its own.
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

/// Rotates the indices so that the lowest comes first, which makes triangles with equal corners and orientation equal.
fn lowest_first([a, b, c]: Corners) -> Corners {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

fn connected_by_corners(triangles: &BTreeSet<Corners>) -> Vec<BTreeSet<Corners>> {
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

/// Returns the same triangle with the opposite orientation.
fn reversed([a, b, c]: Corners) -> Corners {
    lowest_first([a, c, b])
}

/// Returns the directed edges in their order around the triangle.
fn sides([a, b, c]: Corners) -> [(usize, usize); 3] {
    [(a, b), (b, c), (c, a)]
}

/// Returns the undirected edges of a triangle; each begins at its lower index.
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

/// Cuts triangles with a free edge at those corners of other free edges that lie on it.
fn cut_free_edges(vertices: &[Vec3], mut triangles: Vec<Corners>) -> Vec<Corners> {
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

/// Returns true when a vertex lies strictly between two others and within [`WELD_MM`] of the line through them.
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

/// Removes triangles with a free edge until none has one.
fn without_free_triangles(mut triangles: Vec<Corners>) -> Vec<Corners> {
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

/// Splits triangles into surfaces; each is connected by edges.
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
