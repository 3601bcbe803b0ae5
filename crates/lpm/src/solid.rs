//! Closed meshes are solid: tests whether a point lies inside.
//!
//! Triangles show where surfaces meet. Only a body wholly inside a closed mesh (or around it) meets none of them, and
//! it stays inside as long as no surfaces meet; so it is enough to test one point of each connected part at the start
//! of a move.
//!
//! The test counts how often a ray crosses each closed surface of the mesh ([`closed_surfaces`]). A point inside a
//! surface is inside the mesh, except in a hole: a surface within another one and of opposite orientation. For a
//! surface with walls inside it the number of crossings decides nothing; there a point counts as outside only if some
//! ray crosses nothing. A ray that passes an edge or a corner within rounding is replaced by one in another direction;
//! when every direction fails, the point counts as inside.

use std::collections::BTreeSet;

use super::closed::{Corners, Surface, closed_surfaces};
use super::pose::Frame;
use super::vector::{Vec3, add, cross, dot, reach, sub};

/// Directions of rays, chosen so that they are unlikely to lie in a symmetry of any machine part.
const RAYS: [Vec3; 6] = [
    [0.842_713, 0.311_907, 0.438_851],
    [-0.237_119, 0.915_203, 0.325_741],
    [0.171_803, -0.402_917, 0.898_963],
    [-0.693_401, -0.541_177, -0.475_583],
    [0.519_683, 0.108_359, -0.847_433],
    [-0.078_511, 0.337_639, -0.938_001],
];

/// Relative rounding of one signed volume, which takes five products and sums of differences.
const VOLUME_NOISE: f64 = 32.0 * f64::EPSILON;

/// Closed surfaces of one mesh, in the frame of its body or at their place.
#[derive(Debug, Clone)]
pub(crate) struct Solid {
    shells: Vec<Shell>,
}

/// One closed surface.
#[derive(Debug, Clone)]
struct Shell {
    triangles: Vec<[Vec3; 3]>,
    low: Vec3,
    high: Vec3,
    /// True when a path that crosses the shell once changes sides ([`Surface::is_even`]).
    is_even: bool,
    is_oriented: bool,
    is_hole: bool,
}

impl Solid {
    /// Builds the solid; `None` when no surface is closed.
    pub(crate) fn of(vertices: &[Vec3], parts: &[BTreeSet<Corners>]) -> Option<Solid> {
        let corner = |vertex: usize| vertices[vertex];
        let shell = |surface: Surface| Shell {
            is_even: surface.is_even,
            is_oriented: surface.is_oriented,
            ..Shell::of(
                surface
                    .triangles
                    .into_iter()
                    .map(|corners| corners.map(corner))
                    .collect(),
            )
        };
        let surfaces = parts
            .iter()
            .flat_map(|part| closed_surfaces(vertices, part));
        let shells = surfaces.map(shell);
        let mut sized: Vec<(f64, Shell)> = shells.map(|shell| (shell.volume(), shell)).collect();
        // Sorted so that a shell comes after those that surround it: the larger first.
        sized.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        for inner in 1..sized.len() {
            let (larger, rest) = sized.split_at_mut(inner);
            let (volume, shell) = &mut rest[0];
            let around = larger
                .iter()
                .rev()
                .find(|it| it.0 * *volume < 0.0 && it.1.surrounds(shell));
            let is_plain = |shell: &Shell| shell.is_even && shell.is_oriented;
            shell.is_hole =
                is_plain(shell) && around.is_some_and(|(_, it)| is_plain(it) && !it.is_hole);
        }
        let shells: Vec<Shell> = sized.into_iter().map(|(_, shell)| shell).collect();
        (!shells.is_empty()).then_some(Solid { shells })
    }

    pub(crate) fn placed(&self, frame: &Frame, position: Vec3) -> Solid {
        let place = |corner: Vec3| add(frame.apply(corner), position);
        let shell = |shell: &Shell| {
            let triangles = shell.triangles.iter().map(|corners| corners.map(place));
            Shell {
                is_even: shell.is_even,
                is_oriented: shell.is_oriented,
                is_hole: shell.is_hole,
                ..Shell::of(triangles.collect())
            }
        };
        Solid {
            shells: self.shells.iter().map(shell).collect(),
        }
    }

    /// Returns true when `point` lies inside the solid, or so near to its surface that rounding leaves doubt.
    pub(crate) fn holds(&self, point: Vec3) -> bool {
        let (mut around, mut holes) = (0, 0);
        for shell in &self.shells {
            if shell.is_hole {
                holes += u32::from(shell.surely_holds(point));
            } else {
                around += u32::from(shell.may_hold(point));
            }
        }
        around > holes
    }
}

impl Shell {
    fn of(triangles: Vec<[Vec3; 3]>) -> Shell {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for corner in triangles.iter().flatten() {
            for axis in 0..3 {
                low[axis] = low[axis].min(corner[axis]);
                high[axis] = high[axis].max(corner[axis]);
            }
        }
        Shell {
            triangles,
            low,
            high,
            is_even: true,
            is_oriented: true,
            is_hole: false,
        }
    }

    /// Returns six times the volume; negative when the triangles face inward.
    fn volume(&self) -> f64 {
        let origin = self.low;
        let cone = |corners: &[Vec3; 3]| {
            let [a, b, c] = corners.map(|corner| sub(corner, origin));
            dot(cross(a, b), c)
        };
        self.triangles.iter().map(cone).sum()
    }

    /// Returns true when the other shell lies entirely inside this one.
    fn surrounds(&self, other: &Shell) -> bool {
        let mut corners = other.triangles.iter().flatten();
        corners.all(|corner| self.surely_holds(*corner))
    }

    fn may_hold(&self, point: Vec3) -> bool {
        self.is_around(point) && self.is_inside(point).unwrap_or(true)
    }

    fn surely_holds(&self, point: Vec3) -> bool {
        self.is_around(point) && self.is_inside(point).unwrap_or(false)
    }

    fn is_around(&self, point: Vec3) -> bool {
        (0..3).all(|axis| point[axis] >= self.low[axis] && point[axis] <= self.high[axis])
    }

    /// Returns whether `point` is inside the shell; `None` when no ray gives a decision.
    fn is_inside(&self, point: Vec3) -> Option<bool> {
        let mut crossings = RAYS.iter().filter_map(|ray| self.crossings(point, *ray));
        let first = crossings.next()?;
        if self.is_even {
            return Some(first % 2 == 1);
        }
        Some(first > 0 && crossings.all(|count| count > 0))
    }

    fn crossings(&self, point: Vec3, ray: Vec3) -> Option<usize> {
        let mut count = 0;
        for corners in &self.triangles {
            count += usize::from(crosses(corners.map(|corner| sub(corner, point)), ray)?);
        }
        Some(count)
    }
}

/// Returns whether the ray from the origin crosses the triangle; `None` when it passes an edge within rounding.
fn crosses([a, b, c]: [Vec3; 3], ray: Vec3) -> Option<bool> {
    let size = reach(a).max(reach(b)).max(reach(c));
    let noise = VOLUME_NOISE * size * size;
    let sides = [
        dot(cross(a, b), ray),
        dot(cross(b, c), ray),
        dot(cross(c, a), ray),
    ];
    let left = sides.iter().any(|side| *side > noise);
    let right = sides.iter().any(|side| *side < -noise);
    if left && right {
        return Some(false);
    }
    if sides.iter().any(|side| side.abs() <= noise) {
        return None;
    }
    // When all signs are equal, the line crosses the triangle; the ray does when the plane of the triangle lies ahead.
    let volume = dot(cross(a, b), c);
    let ahead = volume * (sides[0] + sides[1] + sides[2]);
    if volume.abs() <= noise * size {
        None
    } else {
        Some(ahead > 0.0)
    }
}
