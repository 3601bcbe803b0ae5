//! Files of one configuration: a directory, or files in memory that begin as those compiled into the program.
//!
//! Everything that reads or revises a configuration does it through [`Folder`]. A file has the name that it has in
//! `config/`, such as `recipes/jzc-22f-012.toml`.

use super::built_in::{BUILT_IN, FIRST_RIG, RIGS, files_of};
use super::check::File;
use super::error::ConfigError;
use std::collections::BTreeMap;
use std::io::{Error, ErrorKind, Write};
use std::iter;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// Files of one configuration. Clones share the files.
#[derive(Debug, Clone)]
pub enum Folder {
    /// Directory on disk.
    Directory(PathBuf),
    /// Files in memory: a revision of a recipe lasts until the program ends.
    Memory(Memory),
}

/// Files in memory, by name. Clones share the files.
#[derive(Debug, Clone)]
pub struct Memory {
    files: Arc<Mutex<BTreeMap<String, Kept>>>,
    /// Lock held while a revision changes files.
    changing: Arc<Mutex<()>>,
}

#[derive(Debug)]
struct Kept {
    text: String,
    /// Time at which a revision saved the file; `None` for a file that was compiled in.
    saved_at: Option<SystemTime>,
}

impl From<&Path> for Folder {
    fn from(dir: &Path) -> Self {
        Self::Directory(dir.to_owned())
    }
}

impl Folder {
    /// Returns the files of `config/` that this program was built with.
    pub fn built_in() -> Self {
        Self::in_memory(BUILT_IN)
    }

    /// Returns the files of a rig that this program was built with; `None` for a name that no rig has.
    pub fn built_in_rig(name: &str) -> Option<Self> {
        files_of(name).map(Self::in_memory)
    }

    /// Yields the names of the rigs that this program was built with: first that of `config/`, then those of
    /// `config/rigs/`.
    pub fn built_in_rigs() -> impl Iterator<Item = &'static str> {
        iter::once(FIRST_RIG).chain(RIGS.iter().map(|(name, _)| *name))
    }

    fn in_memory(files: &[(&str, &str)]) -> Self {
        let kept = |(name, text): &(&str, &str)| {
            let (text, saved_at) = ((*text).to_owned(), None);
            ((*name).to_owned(), Kept { text, saved_at })
        };
        Self::Memory(Memory {
            files: Arc::new(Mutex::new(files.iter().map(kept).collect())),
            changing: Arc::default(),
        })
    }

    /// Returns the path of the folder as messages show it.
    pub fn root(&self) -> &Path {
        match self {
            Self::Directory(dir) => dir,
            Self::Memory(_) => Path::new("built-in"),
        }
    }

    /// Returns the path of a file as messages show it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.root().join(name)
    }

    /// Checks that a directory exists.
    ///
    /// # Errors
    /// Fails when the directory does not exist; the message names the command that writes a configuration.
    pub fn check_exists(&self) -> Result<(), ConfigError> {
        match self {
            Self::Directory(dir) if !dir.exists() => {
                Err(ConfigError::NoFolder { dir: dir.clone() })
            }
            Self::Directory(_) | Self::Memory(_) => Ok(()),
        }
    }

    /// Reads and parses a file. When the file cannot be read, the message states `expected`, the content that the file
    /// should have.
    pub(super) fn file(&self, name: &str, expected: &'static str) -> Result<File, ConfigError> {
        self.check_exists()?;
        let file = self.path(name);
        match self.read(name) {
            Ok(text) => File::parse(file, text),
            Err(source) => Err(ConfigError::Unreadable {
                file,
                expected,
                source,
            }),
        }
    }

    pub(super) fn has(&self, name: &str) -> bool {
        match self {
            Self::Directory(dir) => dir.join(name).exists(),
            Self::Memory(memory) => memory.files().contains_key(name),
        }
    }

    pub(super) fn read(&self, name: &str) -> std::io::Result<String> {
        match self {
            Self::Directory(dir) => std::fs::read_to_string(dir.join(name)),
            Self::Memory(memory) => match memory.files().get(name) {
                Some(kept) => Ok(kept.text.clone()),
                None => Err(Error::from(ErrorKind::NotFound)),
            },
        }
    }

    /// Returns media type and bytes of a PNG, JPEG or SVG file directly in `pictures`; `None` when there is no such
    /// file, and for files in memory.
    pub fn picture(&self, name: &str) -> Option<(&'static str, Vec<u8>)> {
        let Self::Directory(dir) = self else {
            return None;
        };
        let media = match Path::new(name).extension()?.to_str()? {
            "png" => "image/png",
            "jpg" | "jpeg" => "image/jpeg",
            "svg" => "image/svg+xml",
            _other => return None,
        };
        if Path::new(name).file_name()? != name {
            return None;
        }
        let bytes = std::fs::read(dir.join("pictures").join(name)).ok()?;
        Some((media, bytes))
    }

    /// Returns the names of the TOML files directly in the folder `below`, without their extension, sorted; none when
    /// the folder cannot be read.
    pub(super) fn stems(&self, below: &str) -> Vec<String> {
        let names: Vec<String> = match self {
            Self::Directory(dir) => {
                let entries = std::fs::read_dir(dir.join(below)).into_iter().flatten();
                let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
                names.collect()
            }
            Self::Memory(memory) => {
                let files = memory.files();
                let names = files.keys().filter_map(|it| it.strip_prefix(below));
                let names = names.filter_map(|it| it.strip_prefix('/'));
                let own = names.filter(|it| !it.contains('/'));
                own.map(str::to_owned).collect()
            }
        };
        let stem = |name: &String| name.strip_suffix(".toml").map(str::to_owned);
        let mut stems: Vec<String> = names.iter().filter_map(stem).collect();
        stems.sort();
        stems
    }

    /// Replaces a file atomically: after a crash it holds either `text` or its old content.
    pub(super) fn replace(&self, name: &str, text: &str) -> std::io::Result<()> {
        match self {
            Self::Directory(dir) => replace_file(&dir.join(name), text),
            Self::Memory(memory) => {
                let (text, saved_at) = (text.to_owned(), Some(SystemTime::now()));
                let kept = Kept { text, saved_at };
                memory.files().insert(name.to_owned(), kept);
                Ok(())
            }
        }
    }

    /// Returns the time at which a file was written, microseconds since 1970 UTC; `None` when it is not known.
    pub(super) fn saved_at_us(&self, name: &str) -> Option<i64> {
        let saved_at = match self {
            Self::Directory(dir) => std::fs::metadata(dir.join(name))
                .and_then(|it| it.modified())
                .ok(),
            Self::Memory(memory) => memory.files().get(name).and_then(|it| it.saved_at),
        };
        let since = saved_at?.duration_since(UNIX_EPOCH).ok()?;
        i64::try_from(since.as_micros()).ok()
    }

    /// Runs `change` while no other change runs in this program nor, for a directory, in another program.
    pub(super) fn alone<T>(&self, change: impl FnOnce() -> T) -> std::io::Result<T> {
        match self {
            Self::Directory(dir) => {
                let recipes = std::fs::File::open(dir.join("recipes"))?;
                recipes.lock()?;
                Ok(change())
            }
            Self::Memory(memory) => {
                let _alone = memory.changing.lock();
                Ok(change())
            }
        }
    }
}

impl Memory {
    /// Returns the text of every file, by name.
    pub fn texts(&self) -> BTreeMap<String, String> {
        let files = self.files();
        let texts = files.iter();
        texts
            .map(|(name, it)| (name.clone(), it.text.clone()))
            .collect()
    }

    /// Locks the files. A poisoned lock does no harm, because a change is a single insertion.
    fn files(&self) -> MutexGuard<'_, BTreeMap<String, Kept>> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Replaces a file: writes the text beside it and renames.
fn replace_file(path: &Path, text: &str) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let beside = path.with_extension("toml.new");
    let mut file = std::fs::File::create(&beside)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()?;
    std::fs::rename(&beside, path)?;
    std::fs::File::open(folder)?.sync_all()
}
