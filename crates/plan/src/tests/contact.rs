//! Parts in exact contact slide along their plane; what presses deeper than the contact depth blocks.
use super::*;

/// Depths by which parts press into each other and must still slide, mm.
const SLIDING_MM: [f64; 5] = [0.0, 1e-12, 1e-9, 1e-7, 1e-6];

/// Places to which the same scene is moved, mm.
const PLACES_MM: [[f64; 3]; 4] = [
    [0.0; 3],
    [1234.567, -890.123, 45.678],
    [-999_900.3, 999_876.1, 0.7],
    [999_900.1, 999_900.1, 999_900.1],
];

fn moved(mut elements: Vec<Element>, by: [f64; 3]) -> Vec<Element> {
    for element in &mut elements {
        let at = element.pose.position;
        element.pose.position = [0, 1, 2].map(|axis| at[axis] + by[axis]);
    }
    elements
}

fn row(assembly: &Assembly, number: usize) -> [Vec<u32>; 6] {
    let table = Interference::swept(assembly).unwrap();
    Direction::ALL.map(|direction| table.blockers(number, direction).to_vec())
}

#[test]
fn blocks_in_contact_slide_along_their_plane() {
    for place in PLACES_MM {
        for pressed_mm in SLIDING_MM {
            for tilt in [0.0, 1e-9 / 30.0] {
                let plate = between("plate", [-30.0, -30.0, 0.0], [30.0, 30.0, 10.0]);
                let mut rider = between("rider", [-5.0, -5.0, 10.0], [5.0, 5.0, 20.0]);
                rider.pose.position[2] -= pressed_mm;
                rider.pose.rotation = [1.0, 0.5 * tilt, 0.5 * tilt, 0.0];
                let assembly = assembled(moved(vec![plate, rider], place));
                let found = row(&assembly, 1);
                let wanted = [vec![], vec![], vec![], vec![], vec![], vec![0]];
                assert_eq!(found, wanted, "{place:?} {pressed_mm} {tilt}");
            }
        }
    }
}

#[test]
fn a_part_between_two_walls_slides_both_ways() {
    for place in PLACES_MM {
        for pressed_mm in SLIDING_MM {
            let walls = [
                between("left", [-10.0, -9.0, 0.0], [-4.0 + pressed_mm, 9.0, 8.0]),
                between("right", [4.0 - pressed_mm, -9.0, 0.0], [10.0, 9.0, 8.0]),
                between("part", [-4.0, -2.0, 0.0], [4.0, 2.0, 8.0]),
            ];
            let assembly = assembled(moved(walls.to_vec(), place));
            let found = row(&assembly, 2);
            let wanted = [vec![1], vec![0], vec![], vec![], vec![], vec![]];
            assert_eq!(found, wanted, "{place:?} {pressed_mm}");
        }
    }
}

#[test]
fn shafts_leave_holes_of_any_fit_along_the_axis() {
    for place in PLACES_MM {
        for clearance_mm in [1e-3, 1e-6, 1e-9, 0.0] {
            // The shaft lies 1e-9 mm beside the axis, and then tilted by as much over its length.
            for (askew_mm, tilt) in [(0.0, 0.0), (1e-9, 0.0), (0.0, 1e-9 / 30.0)] {
                let shaft = Shape::Cylinder {
                    radius: 5.0 - clearance_mm,
                    height: 30.0,
                };
                let mut shaft = element("shaft", shaft, [askew_mm, -askew_mm, 5.0]);
                shaft.pose.rotation = [1.0, 0.5 * tilt, -0.5 * tilt, 0.0];
                let parts = vec![holed("plate", 20.0, 5.0, 0.0, 10.0), shaft];
                let assembly = assembled(moved(parts, place));
                let found = row(&assembly, 1);
                let wanted = [vec![0], vec![0], vec![0], vec![0], vec![], vec![]];
                assert_eq!(found, wanted, "{place:?} {clearance_mm} {askew_mm} {tilt}");
                let local = Interference::local(&assembly).unwrap();
                let found = mates(&assembly, &local).unwrap();
                assert_eq!(priority(&found), [Direction::PlusZ, Direction::MinusZ]);
            }
        }
    }
}

/// A closed prism over a polygon in x and z, from y = -4 to 4.
fn prism(corners: &[[f64; 2]]) -> Shape {
    let count = corners.len();
    let side = |y: f64| corners.iter().map(move |[x, z]| [*x, y, *z]);
    let mut triangles = Vec::new();
    for at in 0..count {
        let next = (at + 1) % count;
        triangles.push([at, next, count + at]);
        triangles.push([next, count + next, count + at]);
        if at > 0 && next > 0 {
            triangles.push([0, next, at]);
            triangles.push([count, count + at, count + next]);
        }
    }
    Shape::Mesh(Mesh {
        vertices: side(-4.0).chain(side(4.0)).collect(),
        triangles,
    })
}

#[test]
fn bevels_in_contact_block_only_towards_each_other() {
    for place in PLACES_MM {
        let lower = prism(&[[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]]);
        let upper = prism(&[[10.0, 10.0], [0.0, 10.0], [10.0, 0.0]]);
        let parts = vec![
            element("lower", lower, [0.0; 3]),
            element("upper", upper, [0.0; 3]),
        ];
        let assembly = assembled(moved(parts, place));
        let found = row(&assembly, 1);
        let wanted = [vec![], vec![0], vec![], vec![], vec![], vec![0]];
        assert_eq!(found, wanted, "{place:?}");
        // The boxes of both bevels are the same cube, so box extrusion blocks all six directions.
        let boxes = Interference::extruded(&assembly);
        let is_blocked = |it: &Direction| boxes.blockers(1, *it) == [0];
        assert!(Direction::ALL.iter().all(is_blocked));
    }
}

#[test]
fn a_plane_mate_of_bevels_has_their_normal() {
    let lower = prism(&[[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]]);
    let upper = prism(&[[10.0, 10.0], [0.0, 10.0], [10.0, 0.0]]);
    let parts = vec![
        element("lower", lower, [0.0; 3]),
        element("upper", upper, [0.0; 3]),
    ];
    let assembly = assembled(parts);
    let local = Interference::local(&assembly).unwrap();
    let found = mates(&assembly, &local).unwrap();
    let is_diagonal = |mate: &Mate| match mate.kind {
        Kind::Plane { normal: [x, y, z] } => {
            let wanted = 0.5_f64.sqrt();
            (x - wanted).abs() < 1e-6 && y.abs() < 1e-6 && (z - wanted).abs() < 1e-6
        }
        Kind::Align { .. } | Kind::Axis { .. } => false,
    };
    assert_eq!(
        found.iter().filter(|it| is_diagonal(it)).count(),
        1,
        "{found:?}"
    );
}

#[test]
fn an_overlap_beyond_the_depth_is_named() {
    let depth_mm = Tolerance::default().contact_mm;
    for (pressed_mm, is_refused) in [(0.5 * depth_mm, false), (1.5 * depth_mm, true)] {
        let elements = vec![
            between(
                "plate",
                [-30.0, -30.0, 0.0],
                [30.0, 30.0, 10.0 + pressed_mm],
            ),
            between("rider", [-5.0, -5.0, 10.0], [5.0, 5.0, 20.0]),
        ];
        let made = Assembly::new(elements, None, Tolerance::default(), Vec::new());
        assert_eq!(made.is_err(), is_refused, "{pressed_mm}");
    }
}
