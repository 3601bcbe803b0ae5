//! Tests: faces of more than three corners, and which of them can be cut into triangles.
use super::accepted::shape;
use super::refused::refusal;
use super::*;

/// Writes an OBJ file of one face; corners have six digits.
fn face(corners: &[[f64; 3]]) -> Vec<u8> {
    let mut text = String::new();
    for [x, y, z] in corners {
        text.push_str(&format!("v {x:.5e} {y:.5e} {z:.5e}\n"));
    }
    let words: Vec<String> = (1..=corners.len()).map(|it| it.to_string()).collect();
    text.push_str(&format!("f {}\n", words.join(" ")));
    text.into_bytes()
}

#[test]
fn a_convex_face_of_any_orientation_becomes_a_fan() {
    for turn in [0.0_f64, 0.1, 0.7, 1.3] {
        for count in [4, 5, 6, 60, 400] {
            let corner = |index: usize| {
                let angle = index as f64 / count as f64 * std::f64::consts::TAU;
                let (x, y) = (30.0 * angle.cos(), 10.0 * angle.sin());
                [x + 20.0, y * turn.cos(), y * turn.sin() - x * turn]
            };
            let mut corners: Vec<[f64; 3]> = (0..count).map(corner).collect();
            for _ in 0..2 {
                let Shape::Mesh(mesh) = shape("a.obj", &face(&corners)) else {
                    panic!("no mesh")
                };
                let last = [0, count - 2, count - 1];
                assert_eq!(
                    (mesh.triangles.len(), mesh.triangles.last()),
                    (count - 2, Some(&last))
                );
                corners.reverse();
            }
        }
    }
}

#[test]
fn a_degenerate_face_is_legal() {
    let (a, b, c, m) = ([0.0; 3], [8.0, 0.0, 6.0], [0.0, 5.0, 1.0], [4.0, 0.0, 3.0]);
    for corners in [
        &[a, a, b, c][..],
        &[a, b, c, c],
        &[a, m, b, c],
        &[m, b, c, a],
        &[a, b, m, a],
        &[a, b, a, b],
        &[b, b, b, b, b],
    ] {
        shape("a.obj", &face(corners));
    }
}

/// Writes one OBJ file of the face for each first corner and each direction around it.
fn faces(corners: &[[f64; 3]]) -> Vec<Vec<u8>> {
    let mut text = String::new();
    for [x, y, z] in corners {
        text.push_str(&format!("v {x} {y} {z}\n"));
    }
    let mut round: Vec<usize> = (1..=corners.len()).collect();
    let mut files = Vec::new();
    for _ in 0..2 {
        for _ in 0..corners.len() {
            round.rotate_left(1);
            let words: Vec<String> = round.iter().map(usize::to_string).collect();
            files.push(format!("{text}f {}\n", words.join(" ")).into_bytes());
        }
        round.reverse();
    }
    files
}

/// Places the corners in a plane oblique to all axes.
fn leaning(flat: &[[f64; 2]], height: f64) -> Vec<[f64; 3]> {
    let place = |[x, y]: &[f64; 2]| [100.0 + 0.6 * x, *y, 0.8 * x + 0.3 * y];
    let mut corners: Vec<[f64; 3]> = flat.iter().map(place).collect();
    corners[1][2] += height;
    corners
}

#[test]
fn a_bent_or_concave_face_is_refused() {
    let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
    let star = [0.0, 2.0, 4.0, 1.0, 3.0].map(|it| {
        let angle = it * std::f64::consts::TAU / 5.0;
        [10.0 * f64::cos(angle), 10.0 * f64::sin(angle)]
    });
    let angle = [
        [0.0, 0.0],
        [10.0, 0.0],
        [10.0, 4.0],
        [4.0, 4.0],
        [4.0, 10.0],
        [0.0, 10.0],
    ];
    for (what, corners) in [
        (
            "an arrow",
            leaning(&[[0.0, 0.0], [10.0, 4.0], [0.0, 8.0], [4.0, 4.0]], 0.0),
        ),
        (
            "a dent",
            leaning(
                &[
                    [0.0, 0.0],
                    [5.0, 0.01],
                    [10.0, 0.0],
                    [10.0, 10.0],
                    [0.0, 10.0],
                ],
                0.0,
            ),
        ),
        ("an angle", leaning(&angle, 0.0)),
        (
            "a tie",
            leaning(&[[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.0, 10.0]], 0.0),
        ),
        ("a star", leaning(&star, 0.0)),
        (
            "twice round",
            leaning(&[&square[..], &square].concat(), 0.0),
        ),
        (
            "out and back",
            leaning(&[[0.0, 0.0], [10.0, 0.0], [0.0, 0.0], [0.0, 10.0]], 0.0),
        ),
        ("a saddle", leaning(&square, 0.01)),
        (
            "out of all measure",
            leaning(&square.map(|it| it.map(|member| member * 1e200)), 0.0),
        ),
    ] {
        for file in faces(&corners) {
            let said = refusal("a.obj", &file);
            let expected = format!(
                "line {}: a face that is not flat and convex; cut it into triangles",
                corners.len() + 1
            );
            assert!(said.contains(&expected), "{what}: {said}");
        }
    }
    for file in faces(&leaning(&square, 0.0005)) {
        assert!(read("a.obj", &file, 1.0).is_ok());
    }
}
