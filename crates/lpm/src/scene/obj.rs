//! Reads OBJ: vertices and faces, statement by statement.
//!
//! A statement is one line; a backslash at its end continues it on the next line. A comment always ends with its line.
//! The reader skips points, lines, normals, names and other statements without a surface, and refuses every other
//! keyword, which may be a surface (`curv`, `surf`) or a damaged face (`F`): a lost face would leave the mesh open.
//! The reader does not detect a file that was cut off between two faces, because the format has no end mark.

use super::face;
use super::mesh_file::{MeshFault, complaint, number, quoted, text};
use crate::Mesh;

/// Keywords of statements without a surface, which the reader skips.
const PASSED_OVER: [&str; 19] = [
    "vt",
    "vn",
    "vp",
    "p",
    "l",
    "o",
    "g",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "lod",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
];

pub(super) fn mesh(bytes: &[u8]) -> Result<Mesh, MeshFault> {
    let text = text(bytes)?;
    let mut lines = (1..).zip(text.lines());
    let mut mesh = Mesh {
        vertices: Vec::new(),
        triangles: Vec::new(),
    };
    while let Some(statement) = Statement::next(&mut lines)? {
        let line = statement.line;
        match statement.words.split_first() {
            None => {}
            Some((&"v", members)) => mesh.vertices.push(vertex(line, members)?),
            Some((&"f", corners)) => add_face(line, corners, &mut mesh)?,
            Some((word, _)) if PASSED_OVER.contains(word) => statement.check_end()?,
            Some((word, _)) => {
                return complaint(
                    line,
                    &quoted(word),
                    "\"v\", \"f\" or a word without a surface",
                );
            }
        }
    }
    Ok(mesh)
}

/// A line, joined with the lines that continue it, without comments.
struct Statement<'a> {
    /// Number of its first line, from 1.
    line: usize,
    words: Vec<&'a str>,
    is_continued: bool,
}

impl<'a> Statement<'a> {
    fn next(
        lines: &mut impl Iterator<Item = (usize, &'a str)>,
    ) -> Result<Option<Statement<'a>>, MeshFault> {
        let Some((line, mut rest)) = lines.next() else {
            return Ok(None);
        };
        let mut statement = Statement {
            line,
            words: Vec::new(),
            is_continued: false,
        };
        while let Some(part) = rest.trim_ascii_end().strip_suffix('\\')
            && !part.contains('#')
        {
            let Some((below, next)) = lines.next() else {
                return complaint(line, "the end of the file", "what the backslash announces");
            };
            if part.ends_with(is_no_blank) && next.starts_with(is_no_blank) {
                return complaint(below - 1, "one word or two", "a blank before the backslash");
            }
            statement.words.extend(part.split_ascii_whitespace());
            statement.is_continued = true;
            rest = next;
        }
        let told = rest.split_once('#').map_or(rest, |(told, _)| told);
        statement.words.extend(told.split_ascii_whitespace());
        Ok(Some(statement))
    }

    /// Fails when a skipped statement with a continuation contains the keyword `v` or `f`: the backslash may only be
    /// the end of a name, and the next statement would be lost.
    fn check_end(&self) -> Result<(), MeshFault> {
        let taken = self.words.iter().find(|word| ["v", "f"].contains(word));
        match taken {
            Some(word) if self.is_continued => {
                let found = format!("{} behind a backslash", quoted(word));
                complaint(self.line, &found, "it on its own line")
            }
            Some(_) | None => Ok(()),
        }
    }
}

fn is_no_blank(letter: char) -> bool {
    !letter.is_ascii_whitespace()
}

/// Reads a vertex: three coordinates, optionally followed by a weight, a colour or both.
fn vertex(line: usize, members: &[&str]) -> Result<[f64; 3], MeshFault> {
    let mut numbers = Vec::new();
    for word in members {
        match number(word) {
            Some(number) => numbers.push(number),
            None => return complaint(line, &quoted(word), "a finite number"),
        }
    }
    match numbers[..] {
        [x, y, z] | [x, y, z, _] | [x, y, z, _, _, _] | [x, y, z, _, _, _, _] => Ok([x, y, z]),
        _ => complaint(
            line,
            &format!("a vertex of {} numbers", numbers.len()),
            "3, 4 with a weight, 6 with a colour or 7 with both",
        ),
    }
}

fn add_face(line: usize, words: &[&str], mesh: &mut Mesh) -> Result<(), MeshFault> {
    let count = mesh.vertices.len();
    let mut face = Vec::new();
    for word in words {
        match corner(word, count) {
            Some(index) => face.push(index),
            None => {
                let expected =
                    format!("one of the {count} vertices above as 7, 7/1, 7/1/2, 7//2 or -1");
                return complaint(line, &quoted(word), &expected);
            }
        }
    }
    if face.len() < 3 {
        let found = format!("a face of {} corners", face.len());
        return complaint(line, &found, "3 or more");
    }
    let corners: Vec<[f64; 3]> = face.iter().map(|index| mesh.vertices[*index]).collect();
    if face.len() > 3 && !face::is_flat_and_convex(&corners) {
        return Err(MeshFault::Face { line });
    }
    let fan = face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]);
    mesh.triangles.extend(fan);
    Ok(())
}

/// Reads a corner of a face: `7`, `7/1`, `7/1/2`, `7//2`, or `-1`, which counts back from the last vertex.
fn corner(word: &str, vertices: usize) -> Option<usize> {
    let parts: Vec<&str> = word.split('/').collect();
    let (vertex, others) = match parts[..] {
        [vertex] => (vertex, &[][..]),
        [vertex, _] => (vertex, &parts[1..]),
        [vertex, "", _] => (vertex, &parts[2..]),
        [vertex, _, _] => (vertex, &parts[1..]),
        _ => return None,
    };
    let reference = |part: &str| part.parse().ok().filter(|number: &i64| *number != 0);
    if !others.iter().all(|part| reference(part).is_some()) {
        return None;
    }
    let number = reference(vertex)?;
    let index = if number < 0 {
        i64::try_from(vertices).ok()? + number
    } else {
        number - 1
    };
    usize::try_from(index)
        .ok()
        .filter(|index| *index < vertices)
}
