//! Tests: one body as a mesh file in three formats, and the errors for damaged files.
use super::*;
use crate::scene::{Format, Scene, read_scene};

mod accepted;
mod faces;
mod refused;

/// Returns the triangles of a box with half extents 3, 4, 5; without the lid the box is open.
fn box_triangles(lid: bool) -> Vec<[[f64; 3]; 3]> {
    let corner = |index: usize| {
        [0, 1, 2]
            .map(|axis| [3.0, 4.0, 5.0][axis] * if index >> axis & 1 == 1 { 1.0 } else { -1.0 })
    };
    let mut faces = vec![
        [0, 2, 3, 1],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    if lid {
        faces.push([4, 5, 7, 6]);
    }
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    faces
        .into_iter()
        .flat_map(halves)
        .map(|it| it.map(corner))
        .collect()
}

fn stl_text(triangles: &[[[f64; 3]; 3]]) -> Vec<u8> {
    let mut text = "solid box\n".to_owned();
    for corners in triangles {
        text.push_str("facet normal 0 0 0\n outer loop\n");
        for [x, y, z] in corners {
            text.push_str(&format!("  vertex {x:e} {y} {z}\n"));
        }
        text.push_str(" endloop\nendfacet\n");
    }
    text.push_str("endsolid box\n");
    text.into_bytes()
}

fn stl_binary(triangles: &[[[f64; 3]; 3]]) -> Vec<u8> {
    // Some programs write a header of a binary file that begins like a text file.
    let mut bytes = b"solid in name only".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        for member in corners.iter().flatten() {
            bytes.extend((*member as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn obj(triangles: &[[[f64; 3]; 3]]) -> Vec<u8> {
    let mut text = "# box\no box\n".to_owned();
    for (number, corners) in triangles.iter().enumerate() {
        for [x, y, z] in corners {
            text.push_str(&format!("v {x} {y} {z}\n"));
        }
        text.push_str(&match number % 2 {
            0 => format!(
                "f {} {} {}\n",
                3 * number + 1,
                3 * number + 2,
                3 * number + 3
            ),
            _ => "f -3//1 -2//1 -1//1\n".to_owned(),
        });
    }
    text.into_bytes()
}

fn read(name: &str, bytes: &[u8], scale: f64) -> Result<Scene, String> {
    let text =
        format!(r#"{{"elements":[{{"id":"m","kind":"mesh","file":"{name}","scale":{scale:?}}}]}}"#);
    let mut files = |_: &str| Ok(bytes.to_vec());
    read_scene(&text, Format::Json, &mut files).map_err(|error| error.to_string())
}

fn model(name: &str, bytes: &[u8]) -> Model {
    standing(
        &read(name, bytes, 1.0).unwrap().elements[0].shape,
        Pose::IDENTITY,
    )
}

#[test]
fn stl_text_stl_binary_and_obj_agree() {
    let triangles = box_triangles(true);
    let files = [
        ("a.stl", stl_text(&triangles)),
        ("a.STL", stl_binary(&triangles)),
        ("a.obj", obj(&triangles)),
    ];
    let solid = standing(&block(3.0, 4.0, 5.0), Pose::IDENTITY);
    for (name, bytes) in files {
        let model = model(name, &bytes);
        for x in [-9.0, 0.5, 1.0, 4.999, 5.0, 5.001] {
            let down = straight([x, 0.3, 40.0], [x, 0.3, -40.0]);
            let (found, truth) = (
                stop(&model, &cylinder(2.0, 6.0), &down),
                stop(&solid, &cylinder(2.0, 6.0), &down),
            );
            assert_eq!(found.is_some(), truth.is_some(), "{name} {x}");
            assert!(
                (found.unwrap_or(0.0) - truth.unwrap_or(0.0)).abs() < 1e-9,
                "{name} {x}"
            );
        }
    }
}

#[test]
fn only_a_closed_mesh_file_is_solid() {
    let inside = straight([0.0; 3], [0.1, 0.0, 0.0]);
    let grain = block(0.5, 0.5, 0.5);
    for (lid, is_blocked) in [(true, true), (false, false)] {
        let triangles = box_triangles(lid);
        for (name, bytes) in [
            ("a.stl", stl_text(&triangles)),
            ("b.stl", stl_binary(&triangles)),
            ("a.obj", obj(&triangles)),
        ] {
            assert_eq!(
                stop(&model(name, &bytes), &grain, &inside).is_some(),
                is_blocked,
                "{name} lid {lid}"
            );
        }
    }
}

#[test]
fn the_winding_of_a_file_does_not_matter() {
    let mut triangles = box_triangles(true);
    for (number, corners) in triangles.iter_mut().enumerate() {
        if number % 3 == 0 {
            corners.swap(0, 1);
        }
    }
    let inside = straight([0.0; 3], [0.1, 0.0, 0.0]);
    assert_eq!(
        stop(
            &model("a.stl", &stl_text(&triangles)),
            &block(0.5, 0.5, 0.5),
            &inside
        ),
        Some(0.0)
    );
}

#[test]
fn degenerate_triangles_of_a_file_still_block() {
    let needle = [[[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [0.0, 0.0, 4.0]]];
    let point = [[[0.0, 0.0, 5.0]; 3]];
    for (name, bytes) in [
        ("a.stl", stl_text(&needle)),
        ("b.stl", stl_binary(&needle)),
        ("a.obj", obj(&needle)),
        ("c.stl", stl_binary(&point)),
    ] {
        let model = model(name, &bytes);
        let pass = |y: f64| straight([-20.0, y, 5.0], [20.0, y, 5.0]);
        let t = stop(&model, &block(1.0, 1.0, 1.0), &pass(1.0)).unwrap();
        assert!((t - 19.0 / 40.0).abs() < 1e-9, "{name}: {t}");
        assert_eq!(
            stop(&model, &block(1.0, 1.0, 1.0), &pass(1.000_001)),
            None,
            "{name}"
        );
    }
}

#[test]
fn a_file_is_scaled() {
    let Shape::Mesh(mesh) = &read("a.obj", &obj(&box_triangles(true)), 25.4)
        .unwrap()
        .elements[0]
        .shape
    else {
        panic!("no mesh")
    };
    let highest = mesh.vertices.iter().map(|it| it[2]).fold(0.0, f64::max);
    assert_eq!(highest, 5.0 * 25.4);
}

#[test]
fn a_broken_file_is_refused_at_its_field() {
    let whole = stl_binary(&box_triangles(true));
    let broken: [(&str, &[u8]); 8] = [
        ("a.stl", &whole[..whole.len() - 1]),
        ("a.stl", b""),
        ("a.stl", b"solid x\nfacet\nvertex 0 0\n"),
        (
            "a.stl",
            b"solid x\nvertex 0 0 0\nvertex 0 0 1\nendsolid x\n",
        ),
        (
            "a.stl",
            b"solid x\nvertex 0 0 nan\nvertex 0 0 1\nvertex 1 0 1\nendsolid x\n",
        ),
        ("a.obj", b"v 0 0 0\nf 1 2 3\n"),
        ("a.obj", b"v 0 0 zero\n"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n"),
    ];
    for (name, bytes) in broken {
        let said = read(name, bytes, 1.0).unwrap_err();
        assert!(
            said.starts_with("elements[0]"),
            "{name} {}: {said}",
            String::from_utf8_lossy(bytes)
        );
    }
}
