//! A value with its path in the file, which every error message names.

use super::node::{Node, Unreadable};

/// Error in a scene file or a move file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The text is not valid TOML or JSON.
    #[error("{place}not readable: {cause}")]
    Syntax {
        /// Empty for a scene file; `line N: ` for a line of a move file.
        place: String,
        /// Message of the TOML or JSON parser.
        cause: Unreadable,
    },
    /// A field holds a value that is not allowed.
    #[error("{path}: found {found}, expected {expected}")]
    Field {
        /// Path of the field, such as `elements[0].half[1]`; in move files preceded by `line 3: `.
        path: String,
        /// Value found.
        found: String,
        /// Value expected.
        expected: String,
    },
}

/// A value, and its path in the file.
#[derive(Debug, Clone)]
pub(super) struct Field<'a> {
    pub(super) node: &'a Node,
    pub(super) path: String,
}

impl<'a> Field<'a> {
    pub(super) fn refuse<T>(&self, expected: impl Into<String>) -> Result<T, SceneError> {
        let path = match self.path.as_str() {
            "" => "the whole file".to_owned(),
            line if line.ends_with(": ") => format!("{line}the whole line"),
            path => path.to_owned(),
        };
        refuse(path, self.node.to_string(), expected)
    }

    /// Reads a table; fails on a key that is not in `known`.
    pub(super) fn table(&self, known: &[&str]) -> Result<Table<'a>, SceneError> {
        let Node::Table(members) = self.node else {
            return self.refuse("a table");
        };
        for (key, _) in members {
            if !known.contains(&key.as_str()) {
                let expected = format!("one of the keys {}", known.join(", "));
                return refuse(self.below(key), "an unknown key".into(), expected);
            }
        }
        Ok(Table {
            members,
            field: self.clone(),
        })
    }

    pub(super) fn list(&self) -> Result<Vec<Field<'a>>, SceneError> {
        let Node::List(members) = self.node else {
            return self.refuse("a list");
        };
        let member = |(index, node)| Field {
            node,
            path: format!("{}[{index}]", self.path),
        };
        Ok(members.iter().enumerate().map(member).collect())
    }

    pub(super) fn number(&self) -> Result<f64, SceneError> {
        match self.node {
            Node::Number(number) if number.is_finite() => Ok(*number),
            Node::Null
            | Node::Flag(_)
            | Node::Number(_)
            | Node::Text(_)
            | Node::List(_)
            | Node::Table(_) => self.refuse("a finite number"),
        }
    }

    pub(super) fn text(&self) -> Result<&'a str, SceneError> {
        match self.node {
            Node::Text(text) if !text.is_empty() => Ok(text),
            Node::Null
            | Node::Flag(_)
            | Node::Number(_)
            | Node::Text(_)
            | Node::List(_)
            | Node::Table(_) => self.refuse("a non-empty text"),
        }
    }

    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], SceneError> {
        let members = self.list()?;
        if members.len() != N {
            return self.refuse(format!("a list of {N} numbers"));
        }
        let mut numbers = [0.0; N];
        for (number, member) in numbers.iter_mut().zip(&members) {
            *number = member.number()?;
        }
        Ok(numbers)
    }

    pub(super) fn below(&self, key: &str) -> String {
        match self.path.as_str() {
            "" => key.to_owned(),
            path if path.ends_with(": ") => format!("{path}{key}"),
            path => format!("{path}.{key}"),
        }
    }
}

/// A table whose keys are all known.
pub(super) struct Table<'a> {
    members: &'a [(String, Node)],
    field: Field<'a>,
}

impl<'a> Table<'a> {
    pub(super) fn optional(&self, key: &str) -> Option<Field<'a>> {
        let found = self.members.iter().find(|(known, _)| known == key);
        found.map(|(_, node)| Field {
            node,
            path: self.field.below(key),
        })
    }

    pub(super) fn required(&self, key: &str, expected: &str) -> Result<Field<'a>, SceneError> {
        match self.optional(key) {
            Some(field) => Ok(field),
            None => refuse(self.field.below(key), "nothing".into(), expected),
        }
    }
}

/// Describes an expected name: `the id of a mover of the scene (gripper, jaw)`, listing at most twelve names.
pub(super) fn expected_id(one: &str, many: &str, ids: &[&str]) -> String {
    if ids.is_empty() {
        return format!("the id of {one}; the scene has no {many}");
    }
    let more = if ids.len() > 12 { ", ..." } else { "" };
    let first = ids[..ids.len().min(12)].join(", ");
    format!("the id of {one} ({first}{more})")
}

pub(super) fn refuse<T>(
    path: String,
    found: String,
    expected: impl Into<String>,
) -> Result<T, SceneError> {
    Err(SceneError::Field {
        path,
        found,
        expected: expected.into(),
    })
}
