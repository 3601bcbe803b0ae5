//! Triangles from STL (binary or text) and OBJ, told apart by the extension.
//!
//! What is damaged or can be read in two ways is refused: a mesh that lost a triangle may be open, and an open one
//! makes a false *clear* of whatever is inside. Every complaint tells the line, what was found and what was expected.
//! The readers are our own: stl_io hands out f32, with which a text STL of more digits would be off by 4e-6 mm at
//! 100 mm where 1e-6 mm is promised, and which faces of an OBJ may be cut into a fan would be asked here anyway.

use super::field::{Field, SceneError};
use super::{obj, stl};
use crate::Mesh;

/// Gives the bytes of a mesh file named in a scene, or why it cannot be read.
pub type MeshFiles<'a> = dyn FnMut(&str) -> Result<Vec<u8>, MeshFault> + 'a;

/// Why a mesh file is refused. Lines and triangles count from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// The file cannot be had, for this reason.
    #[error("{0}")]
    File(String),
    /// A line of a text holds what it must not.
    #[error("line {line}: found {found}, expected {expected}")]
    Line {
        /// Which.
        line: usize,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A face of more than three corners has no triangles of its own.
    #[error("line {line}: a face that is not flat and convex; cut it into triangles")]
    Face {
        /// Where.
        line: usize,
    },
    /// A corner of a binary STL is no place.
    #[error("triangle {triangle}: found {found}, expected a finite number")]
    Triangle {
        /// Which.
        triangle: usize,
        /// Its first wrong number.
        found: f64,
    },
    /// An STL that begins like no text has not the length of a binary one.
    #[error("{text}; a binary STL of {count} triangles has {expected} bytes, not {found}")]
    Length {
        /// Why it is no text.
        text: Box<Self>,
        /// Triangles of its head.
        count: u32,
        /// Bytes of so many.
        expected: u64,
        /// Its bytes.
        found: usize,
    },
    /// An STL that begins like no text is shorter than the head of a binary one.
    #[error("{text}; a binary STL has {head} bytes or more, not {found}")]
    Short {
        /// Why it is no text.
        text: Box<Self>,
        /// Bytes of a head.
        head: usize,
        /// Its bytes.
        found: usize,
    },
}

/// Letters of a word that a complaint repeats; one of a damaged file may be as long as the file.
const REPEATED: usize = 40;

pub(super) fn load(field: &Field, scale: f64, files: &mut MeshFiles) -> Result<Mesh, SceneError> {
    let name = field.text()?;
    let lower = name.to_ascii_lowercase();
    let parse = if lower.ends_with(".stl") {
        stl::mesh
    } else if lower.ends_with(".obj") {
        obj::mesh
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

/// The text of a file with LF behind its lines, whether it came with LF, CR or both. Bytes that are no UTF-8 (Latin-1
/// in names and comments) are replaced, so that no word or number can hold them; a zero byte is in no text, but in a
/// block that a disk or a transfer lost.
pub(super) fn text(bytes: &[u8]) -> Result<String, MeshFault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = String::from_utf8_lossy(bytes)
        .replace("\r\n", "\n")
        .replace('\r', "\n");
    match text.split('\n').position(|line| line.contains('\0')) {
        Some(above) => complaint(above + 1, "a zero byte", "text"),
        None => Ok(text),
    }
}

/// Of a word, when it is one and finite.
pub(super) fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Lines count from 1.
pub(super) fn complaint<T>(line: usize, found: &str, expected: &str) -> Result<T, MeshFault> {
    Err(MeshFault::Line {
        line,
        found: found.to_owned(),
        expected: expected.to_owned(),
    })
}

/// A word of the file in a complaint.
pub(super) fn quoted(word: &str) -> String {
    format!("{:?}", word.chars().take(REPEATED).collect::<String>())
}
