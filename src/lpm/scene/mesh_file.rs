//! Triangles from STL (binary or text) and OBJ, told apart by the extension.

use super::field::{Field, SceneError};
use crate::lpm::Mesh;

/// Gives the bytes of a mesh file named in a scene, or why it cannot be read.
pub type MeshFiles<'a> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'a;

/// Bytes of the head of a binary STL: 80 of text and a count.
const STL_HEAD: usize = 84;
/// Bytes of one triangle: normal, three corners as f32, and two of attributes.
const STL_TRIANGLE: usize = 50;

pub(super) fn load(field: &Field, scale: f64, files: &mut MeshFiles) -> Result<Mesh, SceneError> {
    let name = field.text()?;
    let lower = name.to_ascii_lowercase();
    let parse = if lower.ends_with(".stl") {
        stl
    } else if lower.ends_with(".obj") {
        obj
    } else {
        return field.refuse("a file that ends in .stl or .obj");
    };
    let mesh = files(name).and_then(|bytes| parse(&bytes));
    match mesh {
        Ok(mut mesh) => {
            for member in mesh.vertices.iter_mut().flatten() {
                *member *= scale;
            }
            Ok(mesh)
        }
        Err(cause) => field.refuse(format!("a readable mesh file ({cause})")),
    }
}

fn stl(bytes: &[u8]) -> Result<Mesh, String> {
    let count = bytes
        .get(80..STL_HEAD)
        .and_then(|field| field.try_into().ok())
        .map(u32::from_le_bytes);
    match count {
        Some(count) if bytes.len() == STL_HEAD + STL_TRIANGLE * count as usize => {
            Ok(stl_binary(bytes))
        }
        Some(_) | None => stl_text(bytes),
    }
}

fn stl_binary(bytes: &[u8]) -> Mesh {
    let corner = |at: &[u8]| {
        let mut point = [0.0; 3];
        for (member, four) in point.iter_mut().zip(at.chunks_exact(4)) {
            *member = f64::from(f32::from_le_bytes([four[0], four[1], four[2], four[3]]));
        }
        point
    };
    let triangles = bytes[STL_HEAD..].chunks_exact(STL_TRIANGLE);
    in_threes(
        triangles
            .flat_map(|triangle| triangle[12..48].chunks_exact(12).map(corner))
            .collect(),
    )
}

fn stl_text(bytes: &[u8]) -> Result<Mesh, String> {
    let text =
        std::str::from_utf8(bytes).map_err(|_| "neither a binary nor a text STL".to_owned())?;
    if !text.trim_start().starts_with("solid") {
        return Err("a text STL begins with \"solid\"".to_owned());
    }
    let mut corners = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        if words.next() == Some("vertex") {
            corners.push(point(words, number)?);
        }
    }
    if corners.len() % 3 != 0 {
        return Err(format!(
            "{} vertex lines, not a multiple of three",
            corners.len()
        ));
    }
    Ok(in_threes(corners))
}

fn in_threes(vertices: Vec<[f64; 3]>) -> Mesh {
    let triangles = (0..vertices.len() / 3).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]);
    Mesh {
        triangles: triangles.collect(),
        vertices,
    }
}

fn obj(bytes: &[u8]) -> Result<Mesh, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "an OBJ is a text file".to_owned())?;
    let mut mesh = Mesh {
        vertices: Vec::new(),
        triangles: Vec::new(),
    };
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => mesh.vertices.push(point(words, number)?),
            Some("f") => {
                let face = words
                    .map(|word| obj_index(word, mesh.vertices.len()))
                    .collect::<Option<Vec<usize>>>()
                    .filter(|face| face.len() >= 3)
                    .ok_or_else(|| format!("line {}: no face over known vertices", number + 1))?;
                // A planar polygon as a fan over its first corner.
                mesh.triangles.extend(
                    face.windows(2)
                        .skip(1)
                        .map(|pair| [face[0], pair[0], pair[1]]),
                );
            }
            Some(_) | None => {}
        }
    }
    Ok(mesh)
}

/// `7`, `7/1/2` or, counted back from the last vertex, `-1`.
fn obj_index(word: &str, vertices: usize) -> Option<usize> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let index = if number < 0 {
        vertices as i64 + number
    } else {
        number - 1
    };
    usize::try_from(index)
        .ok()
        .filter(|index| *index < vertices)
}

fn point<'a>(words: impl Iterator<Item = &'a str>, line: usize) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = words.take(3).filter_map(|word| word.parse().ok()).collect();
    let wrong = || format!("line {}: a vertex needs three finite numbers", line + 1);
    let point: [f64; 3] = numbers.try_into().map_err(|_| wrong())?;
    if point.iter().all(|member| member.is_finite()) {
        Ok(point)
    } else {
        Err(wrong())
    }
}
