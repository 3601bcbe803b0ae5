//! Reads triangles from STL (binary or text) and OBJ; the extension selects the format.
//!
//! The readers refuse damaged or ambiguous files: a mesh that lost a triangle may be open, and an open mesh gives a
//! false *clear* for a body inside it. Every error names the line, the value found and the value expected. The readers
//! are part of this crate for two reasons. The library stl_io returns f32, which shifts a corner at 100 mm in a text
//! STL with many digits by 4e-6 mm, while this crate promises 1e-6 mm. And the check which OBJ faces may be cut into
//! triangles is needed here anyway.

use super::field::{Field, SceneError};
use super::{obj, stl};
use crate::Mesh;

/// Function that returns the bytes of a mesh file that a scene names, or the reason why it cannot.
pub type MeshFiles<'a> = dyn FnMut(&str) -> Result<Vec<u8>, MeshFault> + 'a;

/// Reason why a mesh file is refused. Lines and triangles count from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// The caller's function could not read the file, for this reason.
    #[error("{0}")]
    File(String),
    /// A line of a text file holds something that is not allowed.
    #[error("line {line}: found {found}, expected {expected}")]
    Line {
        /// Line number.
        line: usize,
        /// Text found.
        found: String,
        /// Text expected.
        expected: String,
    },
    /// A face of more than three corners is not flat and convex, so it can be cut into triangles in different ways.
    #[error("line {line}: a face that is not flat and convex; cut it into triangles")]
    Face {
        /// Line number.
        line: usize,
    },
    /// A corner of a binary STL is not finite.
    #[error("triangle {triangle}: found {found}, expected a finite number")]
    Triangle {
        /// Number of the triangle.
        triangle: usize,
        /// First number of the triangle that is not finite.
        found: f64,
    },
    /// An STL file is not valid text, and its length does not fit the triangle count of a binary file.
    #[error("{text}; a binary STL of {count} triangles has {expected} bytes, not {found}")]
    Length {
        /// Error of the attempt to read the file as text.
        text: Box<Self>,
        /// Number of triangles that the header states.
        count: u32,
        /// Length of a binary file with this number of triangles, bytes.
        expected: u64,
        /// Length of the file, bytes.
        found: usize,
    },
    /// An STL file is not valid text, and is shorter than the header of a binary file.
    #[error("{text}; a binary STL has {head} bytes or more, not {found}")]
    Short {
        /// Error of the attempt to read the file as text.
        text: Box<Self>,
        /// Length of the header of a binary file, bytes.
        head: usize,
        /// Length of the file, bytes.
        found: usize,
    },
}

/// Greatest number of characters of a word that a message repeats; a word in a damaged file may be as long as the file.
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

/// Converts a file to text whose lines end with LF; in the file they may end with LF, CR or both. Replaces bytes that
/// are not UTF-8 (Latin-1 in names and comments), so that no keyword or number can contain them. Fails on a zero byte:
/// no text has one, but a block of zeros shows a damaged disk or transfer.
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

/// Parses a number; returns `None` unless it is finite.
pub(super) fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Returns the error for a line, which counts from 1.
pub(super) fn complaint<T>(line: usize, found: &str, expected: &str) -> Result<T, MeshFault> {
    Err(MeshFault::Line {
        line,
        found: found.to_owned(),
        expected: expected.to_owned(),
    })
}

/// Returns a word of the file in quotes, shortened, for a message.
pub(super) fn quoted(word: &str) -> String {
    format!("{:?}", word.chars().take(REPEATED).collect::<String>())
}
