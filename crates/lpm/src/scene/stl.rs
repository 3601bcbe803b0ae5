//! Reads STL: triangles, each with corners of its own.
//!
//! A file whose length fits the count in its header is binary, whatever the header begins with. Any other file is text:
//!
//! ```text
//! file  = solid { solid }
//! solid = "solid" [name] { facet } "endsolid" [name]
//! facet = "facet" "normal" number*3 "outer" "loop" ("vertex" number*3)*3 "endloop" "endfacet"
//! ```
//!
//! in upper or lower case, with blanks and line ends between words; a name extends to the end of its line. The file
//! must contain nothing else. The reader does not detect a file that was cut off between two of its solids.

use super::mesh_file::{MeshFault, complaint, number, quoted, text};
use crate::Mesh;

/// Length of the header of a binary file, bytes: 80 of text, and 4 for the number of triangles.
const HEAD: usize = 84;
/// Length of one triangle in a binary file, bytes: normal and three corners as f32, and two of attributes.
const TRIANGLE: usize = 50;

pub(super) fn mesh(bytes: &[u8]) -> Result<Mesh, MeshFault> {
    let count = bytes
        .get(HEAD - 4..HEAD)
        .and_then(|field| field.try_into().ok())
        .map(u32::from_le_bytes);
    let corners = if count.map(length) == Some(bytes.len() as u64) {
        binary(&bytes[HEAD..])?
    } else {
        let text = text(bytes).and_then(|text| {
            Words::of(&text).take(&["solid"])?;
            Ok(text)
        });
        solids(&text.map_err(|why| no_stl(why, bytes.len(), count))?)?
    };
    Ok(in_threes(corners))
}

/// Returns the length of a binary file of `count` triangles, bytes.
fn length(count: u32) -> u64 {
    HEAD as u64 + TRIANGLE as u64 * u64::from(count)
}

/// Returns the error for a file that is neither text, for the reason `why`, nor binary.
fn no_stl(why: MeshFault, found: usize, count: Option<u32>) -> MeshFault {
    let text = Box::new(why);
    match count {
        Some(count) => MeshFault::Length {
            text,
            count,
            expected: length(count),
            found,
        },
        None => MeshFault::Short {
            text,
            head: HEAD,
            found,
        },
    }
}

fn in_threes(vertices: Vec<[f64; 3]>) -> Mesh {
    let triangles = (0..vertices.len() / 3).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]);
    Mesh {
        triangles: triangles.collect(),
        vertices,
    }
}

fn binary(triangles: &[u8]) -> Result<Vec<[f64; 3]>, MeshFault> {
    let mut corners = Vec::new();
    for (index, triangle) in triangles.chunks_exact(TRIANGLE).enumerate() {
        for corner in triangle[12..48].chunks_exact(12) {
            let mut point = [0.0; 3];
            for (member, four) in point.iter_mut().zip(corner.chunks_exact(4)) {
                *member = f64::from(f32::from_le_bytes([four[0], four[1], four[2], four[3]]));
            }
            if let Some(wrong) = point.iter().find(|member| !member.is_finite()) {
                return Err(MeshFault::Triangle {
                    triangle: index + 1,
                    found: *wrong,
                });
            }
            corners.push(point);
        }
    }
    Ok(corners)
}

/// Reads the corners of all solids in a text.
fn solids(text: &str) -> Result<Vec<[f64; 3]>, MeshFault> {
    let mut words = Words::of(text);
    let mut corners = Vec::new();
    words.take(&["solid"])?;
    loop {
        words.name()?;
        while words.take(&["facet", "endsolid"])? == "facet" {
            facet(&mut words, &mut corners)?;
        }
        words.name()?;
        if words.are_over() {
            return Ok(corners);
        }
        words.take(&["solid"])?;
    }
}

/// Reads the rest of a facet, after the word `facet`.
fn facet(words: &mut Words, corners: &mut Vec<[f64; 3]>) -> Result<(), MeshFault> {
    words.take(&["normal"])?;
    words.point()?;
    words.take(&["outer"])?;
    words.take(&["loop"])?;
    for _ in 0..3 {
        words.take(&["vertex"])?;
        corners.push(words.point()?);
    }
    words.take(&["endloop"])?;
    words.take(&["endfacet"])?;
    Ok(())
}

/// Words of a text, with the line number of the next one.
struct Words<'a> {
    lines: std::str::Lines<'a>,
    words: std::iter::Peekable<std::str::SplitAsciiWhitespace<'a>>,
    line: usize,
}

impl<'a> Words<'a> {
    fn of(text: &'a str) -> Words<'a> {
        let mut lines = text.lines();
        let words = lines.next().unwrap_or("").split_ascii_whitespace();
        Words {
            lines,
            words: words.peekable(),
            line: 1,
        }
    }

    /// Advances to the line of the next word; returns true when there is no further word.
    fn are_over(&mut self) -> bool {
        while self.words.peek().is_none() {
            let Some(line) = self.lines.next() else {
                return true;
            };
            self.words = line.split_ascii_whitespace().peekable();
            self.line += 1;
        }
        false
    }

    fn next(&mut self) -> Option<&'a str> {
        if self.are_over() {
            None
        } else {
            self.words.next()
        }
    }

    /// Reads the next word, which must be one of `expected`.
    fn take(&mut self, expected: &[&'static str]) -> Result<&'static str, MeshFault> {
        let found = self.next();
        let is_found = |it: &&&str| found.is_some_and(|word| word.eq_ignore_ascii_case(it));
        match expected.iter().find(is_found) {
            Some(word) => Ok(word),
            None => self.refuse(found, &format!("\"{}\"", expected.join("\" or \""))),
        }
    }

    fn point(&mut self) -> Result<[f64; 3], MeshFault> {
        let mut point = [0.0; 3];
        for member in &mut point {
            let found = self.next();
            *member = match found.and_then(number) {
                Some(number) => number,
                None => return self.refuse(found, "a finite number"),
            };
        }
        Ok(point)
    }

    /// Skips a name, up to the end of its line; fails when it contains a facet, which shows that a line end was lost.
    fn name(&mut self) -> Result<(), MeshFault> {
        let name: Vec<&str> = self.words.by_ref().collect();
        let hides = |pair: &[&str]| {
            pair[0].eq_ignore_ascii_case("facet") && pair[1].eq_ignore_ascii_case("normal")
        };
        if name.windows(2).any(hides) {
            return complaint(
                self.line,
                "\"facet normal\" in a name",
                "it on its own line",
            );
        }
        Ok(())
    }

    fn refuse<T>(&self, found: Option<&str>, expected: &str) -> Result<T, MeshFault> {
        let found = found.map_or("the end of the file".to_owned(), quoted);
        complaint(self.line, &found, expected)
    }
}
