//! Configuration files of a rig: where they are, and how one is read.

use std::collections::BTreeMap;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use crate::config::ConfigError;

/// Configuration files of a rig.
#[derive(Debug, Clone)]
pub enum Files {
    /// Those of a directory.
    Directory(PathBuf),
    /// Texts by name, for example `recipes/jzc-22f-012.toml`.
    Texts(BTreeMap<String, String>),
}

impl Default for Files {
    fn default() -> Self {
        Self::Texts(BTreeMap::new())
    }
}

impl From<&Path> for Files {
    fn from(dir: &Path) -> Self {
        Self::Directory(dir.to_owned())
    }
}

impl Files {
    /// Returns the path of a file as messages show it.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        match self {
            Self::Directory(dir) => dir.join(name),
            Self::Texts(_) => name.into(),
        }
    }

    pub(crate) fn read(&self, name: &str) -> Result<TextFile, ConfigError> {
        let path = self.path(name);
        match self {
            Self::Directory(_) => TextFile::read(&path),
            Self::Texts(texts) => match texts.get(name).cloned() {
                Some(text) => Ok(TextFile { path, text }),
                None => Err(ConfigError::Read {
                    path,
                    source: Error::from(ErrorKind::NotFound),
                }),
            },
        }
    }

    /// Reads a recipe as the keys of `T`; ignores its other keys.
    pub(crate) fn recipe<T: DeserializeOwned>(&self, name: &str) -> Result<T, ConfigError> {
        self.read(&format!("recipes/{name}.toml"))?.parse()
    }
}

/// A file that was read.
#[derive(Debug)]
pub(crate) struct TextFile {
    pub path: PathBuf,
    pub text: String,
}

impl TextFile {
    pub fn read(path: &Path) -> Result<Self, ConfigError> {
        let path = path.to_path_buf();
        match std::fs::read_to_string(&path) {
            Ok(text) => Ok(Self { path, text }),
            Err(source) => Err(ConfigError::Read { path, source }),
        }
    }

    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, ConfigError> {
        toml::from_str(&self.text).map_err(|error| self.refuse(&error))
    }

    /// Builds the error for invalid TOML, with its line.
    pub fn refuse(&self, error: &toml::de::Error) -> ConfigError {
        let before = |span: std::ops::Range<usize>| &self.text.as_bytes()[..span.start];
        let line = error.span().map_or(0, |span| {
            before(span).iter().filter(|&&byte| byte == b'\n').count() + 1
        });
        ConfigError::Content {
            path: self.path.clone(),
            line,
            message: error.message().lines().collect::<Vec<_>>().join(" "),
        }
    }
}
