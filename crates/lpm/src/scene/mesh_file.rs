//! Reads triangles from STL (binary or text) and OBJ; the extension selects the format.
//!
//! Damaged or ambiguous files are refused: a mesh that lost a triangle may be open, and an open mesh gives a false
//! *clear* for a body inside it. Every error names the line, the value found and the value expected. The readers are
//! part of this crate for two reasons: stl_io returns f32, which puts a text STL of more digits off by 4e-6 mm at 100
//! mm where 1e-6 mm is promised; and the check of which OBJ faces may be cut into a fan is needed here anyway.

use super::field::{Field, SceneError};
use super::{obj, stl};
use crate::Mesh;

/// Callback that returns the bytes of a mesh file named in a scene, or the reason why it cannot.
pub type MeshFiles<'a> = dyn FnMut(&str) -> Result<Vec<u8>, MeshFault> + 'a;

/// Why a mesh file is refused. Lines and triangles count from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// The callback could not read the file, for this reason.
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
    /// A face of more than three corners is not flat and convex, so its triangles are ambiguous.
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
        /// Its first non-finite number.
        found: f64,
    },
    /// An STL is not valid text, and its length does not match the triangle count of a binary file.
    #[error("{text}; a binary STL of {count} triangles has {expected} bytes, not {found}")]
    Length {
        /// Error of reading the file as text.
        text: Box<Self>,
        /// Triangle count in the header.
        count: u32,
        /// Length of a binary file with that count, bytes.
        expected: u64,
        /// Length of the file, bytes.
        found: usize,
    },
    /// An STL is not valid text, and is shorter than the header of a binary file.
    #[error("{text}; a binary STL has {head} bytes or more, not {found}")]
    Short {
        /// Error of reading the file as text.
        text: Box<Self>,
        /// Length of the header, bytes.
        head: usize,
        /// Length of the file, bytes.
        found: usize,
    },
}

/// Most characters of a word that a message repeats; a word of a damaged file may be as long as the file.
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

/// Converts a file to text with LF line ends, from LF, CR or both. Replaces bytes that are not UTF-8 (Latin-1 in
/// names and comments), so that no keyword or number can contain them. Refuses a zero byte: no text has one, but a
/// block lost by a disk or a transfer does.
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

/// Parses a finite number.
pub(super) fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Returns a line error; lines count from 1.
pub(super) fn complaint<T>(line: usize, found: &str, expected: &str) -> Result<T, MeshFault> {
    Err(MeshFault::Line {
        line,
        found: found.to_owned(),
        expected: expected.to_owned(),
    })
}

/// Quotes a word of the file, shortened, for a message.
pub(super) fn quoted(word: &str) -> String {
    format!("{:?}", word.chars().take(REPEATED).collect::<String>())
}
