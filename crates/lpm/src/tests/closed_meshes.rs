//! Tests: points inside a mesh, however untidy its file is.
use super::*;

/// A mesh: corners, and triangles that face outward.
#[derive(Clone, Default)]
struct Soup {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
}

impl Soup {
    fn cuboid(low: [f64; 3], high: [f64; 3]) -> Soup {
        let corner = |at: usize| [0, 1, 2].map(|axis| [low, high][at >> axis & 1][axis]);
        let sides = [
            [0, 2, 3, 1],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [4, 5, 7, 6],
        ];
        let halves = sides
            .into_iter()
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Soup {
            vertices: (0..8).map(corner).collect(),
            triangles: halves.collect(),
        }
    }

    fn cube(half: f64) -> Soup {
        Soup::cuboid([-half; 3], [half; 3])
    }

    /// Combines two meshes into one.
    fn with(mut self, other: Soup) -> Soup {
        let first = self.vertices.len();
        self.vertices.extend(other.vertices);
        let shifted = other
            .triangles
            .into_iter()
            .map(|it| it.map(|vertex| vertex + first));
        self.triangles.extend(shifted);
        self
    }

    fn and(mut self, triangle: [usize; 3]) -> Soup {
        self.triangles.push(triangle);
        self
    }

    fn turned_over(mut self) -> Soup {
        self.triangles.iter_mut().for_each(|it| it.swap(1, 2));
        self
    }

    /// Gives every triangle three corners of its own, as in STL.
    fn loose(self) -> Soup {
        let corners = self.triangles.iter().flatten();
        Soup {
            vertices: corners.map(|vertex| self.vertices[*vertex]).collect(),
            triangles: (0..self.triangles.len())
                .map(|at| [3 * at, 3 * at + 1, 3 * at + 2])
                .collect(),
        }
    }

    fn shape(self) -> Shape {
        Shape::Mesh(Mesh {
            vertices: self.vertices,
            triangles: self.triangles,
        })
    }
}

/// Returns true when the mesh encloses a grain of 1 mm at this place; asserts the same answer with the mesh as mover.
fn is_inside(soup: &Soup, at: [f64; 3]) -> bool {
    let grain = Shape::Block { half: [0.5; 3] };
    let mesh = soup.clone().shape();
    let stays = |pose: Pose| way(pose, pose);
    let met = standing(&mesh, Pose::IDENTITY)
        .any_hit(&grain, &stays(Pose::at(at)))
        .is_some();
    let back = at.map(|member| -member);
    let meets = standing(&grain, Pose::IDENTITY)
        .any_hit(&mesh, &stays(Pose::at(back)))
        .is_some();
    assert_eq!(met, meets, "{at:?}");
    let turning = way(Pose::at(at), Pose::yawed(at, 0.3));
    let turned = standing(&mesh, Pose::IDENTITY)
        .any_hit(&grain, &turning)
        .is_some();
    assert_eq!(met, turned, "{at:?}");
    met
}

const MIDDLE: [f64; 3] = [0.0; 3];

#[test]
fn the_inside_of_two_intersecting_surfaces_is_solid() {
    let both = Soup::cube(10.0).with(Soup::cuboid([0.0, -8.0, -8.0], [20.0, 8.0, 8.0]));
    for x in [-5.0, 5.0, 15.0] {
        assert!(is_inside(&both, [x, 0.3, 0.2]), "{x}");
    }
    assert!(!is_inside(&both, [-15.0, 0.0, 0.0]));
    assert!(!is_inside(&both, [15.0, 9.2, 0.0]));
}

#[test]
fn a_repeated_surface_is_solid() {
    let cube = Soup::cube(10.0);
    let (first, again) = (cube.triangles[0], cube.clone());
    assert!(is_inside(&again.and(first), MIDDLE));
    assert!(is_inside(&cube.clone().with(cube.clone()), MIDDLE));
    assert!(is_inside(
        &cube.clone().with(cube.clone().turned_over()),
        MIDDLE
    ));
    // One part has triangles in both orientations, the other in one.
    let other = Soup::cuboid([30.0; 3], [40.0; 3]);
    let both = cube.clone().with(cube.clone().turned_over()).with(other);
    assert!(is_inside(&both, MIDDLE) && is_inside(&both, [35.0; 3]));
    // The same two parts, with a corner in common.
    let mut hinged = both;
    let first = hinged.vertices[7];
    hinged.vertices[16..]
        .iter_mut()
        .for_each(|it| *it = it.map(|member| member - 20.0));
    assert_eq!(hinged.vertices[16], first);
    assert!(is_inside(&hinged, MIDDLE) && is_inside(&hinged, [15.0; 3]));
    assert!(is_inside(&cube.turned_over(), MIDDLE));
}

#[test]
fn a_stray_triangle_leaves_the_mesh_closed() {
    let stray = |low: f64| Soup {
        vertices: vec![[low; 3], [low + 1.0, low, low], [low, low + 1.0, low + 0.5]],
        triangles: vec![[0, 1, 2]],
    };
    for low in [30.0, 6.0] {
        assert!(
            is_inside(&Soup::cube(10.0).with(stray(low)), MIDDLE),
            "{low}"
        );
    }
    // A triangle that shares an edge with the mesh, outside and inside.
    for tip in [[-30.0, 0.0, -10.0], [-5.0, 0.0, -5.0]] {
        let mut flap = Soup::cube(10.0).and([0, 2, 8]);
        flap.vertices.push(tip);
        assert!(is_inside(&flap, MIDDLE), "{tip:?}");
    }
}

#[test]
fn spaces_behind_an_inner_wall_are_inside() {
    // A wall across the middle that shares its corners with the sides.
    let wall = Soup {
        vertices: vec![
            [0.0, -10.0, -10.0],
            [0.0, 10.0, -10.0],
            [0.0, 10.0, 10.0],
            [0.0, -10.0, 10.0],
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let left = Soup::cuboid([-10.0; 3], [0.0, 10.0, 10.0]);
    let right = Soup::cuboid([0.0, -10.0, -10.0], [10.0; 3]);
    let (both, meeting) = (left.with(right), Soup::cube(10.0).with(wall));
    for x in [-5.0, 5.0] {
        assert!(is_inside(&both, [x, 0.3, 0.2]));
        assert!(is_inside(&meeting, [x, 0.3, 0.2]));
    }
    assert!(!is_inside(&both, [11.0, 0.0, 0.0]));
}

#[test]
fn a_surface_with_mismatched_corners_is_closed() {
    let mut cracked = Soup::cube(10.0).loose();
    cracked.vertices[0][0] += 1e-9;
    assert!(is_inside(&cracked, MIDDLE));
    // The first edge has a further corner on it for only one of its two triangles.
    let mut cut = Soup::cube(10.0);
    let at = cut
        .triangles
        .iter()
        .position(|it| it.contains(&0) && it.contains(&1));
    let corners = cut.triangles.remove(at.unwrap());
    let place = corners
        .iter()
        .position(|vertex| *vertex == 0 || *vertex == 1)
        .unwrap();
    let [p, q, other] = [0, 1, 2].map(|by| corners[(place + by) % 3]);
    let (p, q, other) = if q > 1 { (other, p, q) } else { (p, q, other) };
    cut.vertices.push([0.0, -10.0, -10.0]);
    let cut = cut.and([p, 8, other]).and([8, q, other]);
    assert!(is_inside(&cut, MIDDLE));
    assert!(!is_inside(&cut, [0.0, 0.0, 11.0]));
}

#[test]
fn an_inner_surface_of_opposite_orientation_is_a_hole() {
    let hollow = Soup::cube(10.0).with(Soup::cube(5.0).turned_over());
    for soup in [hollow.clone(), hollow.clone().turned_over()] {
        assert!(!is_inside(&soup, MIDDLE));
        assert!(is_inside(&soup, [7.5, 0.3, 0.2]));
    }
    let island = hollow.with(Soup::cube(2.0));
    assert!(is_inside(&island, MIDDLE));
    assert!(!is_inside(&island, [3.5, 0.3, 0.2]));
    // An inner cube of the same orientation is no hole, but another part in the same place.
    assert!(is_inside(&Soup::cube(10.0).with(Soup::cube(5.0)), MIDDLE));
}

#[test]
fn an_open_mesh_is_its_triangles() {
    for missing in 0..12 {
        let mut open = Soup::cube(10.0);
        open.triangles.remove(missing);
        assert!(!is_inside(&open, MIDDLE), "without {missing}");
        assert!(!is_inside(&open.loose(), MIDDLE), "without {missing}");
    }
    let sheet = Soup {
        vertices: vec![[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 1]],
    };
    assert!(!is_inside(&sheet, [0.0, 0.0, 1.0]));
}
