//! Tests: triangles of every kind, closed meshes, turning moves.
use super::*;

#[test]
fn triangle_corner_order_changes_no_answer() {
    let orders = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    let mesh = |vertices: [[f64; 3]; 3], order| {
        Shape::Mesh(Mesh {
            vertices: vertices.to_vec(),
            triangles: vec![order],
        })
    };
    let flat = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]];
    let touching = [[2.0, 2.0, 0.0], [2.0, 2.0, 5.0], [3.0, 2.5, 5.0]];
    let apart = touching.map(|corner| [corner[0], corner[1], corner[2] + 1e-5]);
    for first in orders {
        for second in orders {
            let model = standing(&mesh(flat, first), Pose::IDENTITY);
            let still = straight([0.0; 3], [0.0; 3]);
            assert!(stop(&model, &mesh(touching, second), &still).is_some());
            assert!(stop(&model, &mesh(apart, second), &still).is_none());
        }
    }
}

#[test]
fn slivers_segments_and_points_are_legal_triangles() {
    let thin = |third: [f64; 3]| {
        Shape::Mesh(Mesh {
            vertices: vec![[0.0; 3], [100.0, 0.0, 0.0], third],
            triangles: vec![[0, 1, 2]],
        })
    };
    for third in [
        [50.0, 1e-9, 0.0],
        [50.0, 0.0, 0.0],
        [100.0, 0.0, 0.0],
        [100.0, 0.0, 1e-300],
    ] {
        let model = standing(&thin(third), Pose::IDENTITY);
        let down = |to: f64| straight([70.0, 0.0, 60.0], [70.0, 0.0, to]);
        let t = stop(&model, &block(5.0, 5.0, 5.0), &down(0.0)).unwrap();
        assert!((t - 55.0 / 60.0).abs() < 1e-9, "{t}");
        assert_eq!(stop(&model, &block(5.0, 5.0, 5.0), &down(5.000_001)), None);
    }
    let point = Shape::Mesh(Mesh {
        vertices: vec![[1.0, 2.0, 3.0]],
        triangles: vec![[0, 0, 0]],
    });
    let model = standing(&point, Pose::IDENTITY);
    assert!(
        stop(
            &model,
            &cylinder(1.0, 2.0),
            &straight([1.0, 2.0, 9.0], [1.0, 2.0, 4.0])
        )
        .is_some()
    );
}

/// Returns a box as a mesh; without the lid the box is open.
fn box_mesh(half: f64, lid: bool) -> Shape {
    let corner =
        |index: usize| [0, 1, 2].map(|axis| if index >> axis & 1 == 1 { half } else { -half });
    let mut faces = vec![
        [0, 1, 3, 2],
        [0, 1, 5, 4],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 3, 7, 5],
    ];
    if lid {
        faces.push([4, 5, 7, 6]);
    }
    let triangles = faces
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    Shape::Mesh(Mesh {
        vertices: (0..8).map(corner).collect(),
        triangles: triangles.collect(),
    })
}

#[test]
fn a_closed_mesh_is_solid_an_open_one_hollow() {
    let inside = straight([0.5, 0.2, 0.1], [1.0, 1.0, 1.0]);
    let mover = block(1.0, 1.0, 1.0);
    assert_eq!(
        stop(
            &standing(&box_mesh(20.0, true), Pose::IDENTITY),
            &mover,
            &inside
        ),
        Some(0.0)
    );
    let open = standing(&box_mesh(20.0, false), Pose::IDENTITY);
    assert_eq!(stop(&open, &mover, &inside), None);
    assert!((least(&open, &mover, &inside) - 18.0).abs() < 1e-9);
    // Now the mover surrounds the element.
    let pin = standing(&cylinder(1.0, 2.0), Pose::IDENTITY);
    assert_eq!(stop(&pin, &box_mesh(20.0, true), &inside), Some(0.0));
    assert_eq!(stop(&pin, &box_mesh(20.0, false), &inside), None);
}

#[test]
fn a_turning_bar_stops_at_the_computed_angle() {
    // A bar of 200 x 10 about z, a pin of radius 4 at 80 mm and 60 degrees.
    let (distance, angle) = (80.0, 60f64.to_radians());
    let model = standing(
        &cylinder(4.0, 50.0),
        Pose::at([distance * angle.cos(), distance * angle.sin(), 0.0]),
    );
    let quarter = way(Pose::IDENTITY, Pose::yawed([0.0; 3], 90f64.to_radians()));
    let t = stop(&model, &block(100.0, 5.0, 5.0), &quarter).unwrap();
    let truth = (angle - (9.0_f64 / distance).asin()) / 90f64.to_radians();
    assert!(t <= truth && truth - t < 1e-6, "{t} {truth}");
}

#[test]
fn half_a_turn_hits_a_pin_between_its_ends() {
    // Start and end look alike; the bar meets the pin only in between.
    let model = standing(&cylinder(4.0, 50.0), Pose::at([0.0, 90.0, 0.0]));
    let turn = way(Pose::IDENTITY, Pose::yawed([0.0; 3], 179f64.to_radians()));
    assert!(stop(&model, &block(100.0, 5.0, 5.0), &turn).is_some());
    let shorter = block(80.0, 5.0, 5.0);
    assert_eq!(stop(&model, &shorter, &turn), None);
    let truth = 90.0 - 4.0 - 80f64.hypot(5.0);
    let found = least(&model, &shorter, &turn);
    let flat = 6.0; // the end face passes the pin squarely, its corners swing nearer
    assert!(
        found <= flat && (found - truth).abs() < 1e-3,
        "{found} {truth}"
    );
}
