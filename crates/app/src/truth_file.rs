//! The file of true values of a simulated rig (`--truth`).

use anyhow::Context;
use rigsim::SharedRig;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// File with one JSON object per part: each write appends its parts in the order of `seq`, the last one also the parts
/// that never landed. After each write the file holds whole lines only.
pub struct TruthFile<'a> {
    path: &'a Path,
    file: File,
    /// `seq` of the parts in the file.
    written: BTreeSet<u64>,
}

impl<'a> TruthFile<'a> {
    /// Creates an empty file; replaces an existing one.
    ///
    /// # Errors
    /// Fails when the file cannot be created.
    pub fn create(path: &'a Path) -> anyhow::Result<Self> {
        let file = File::create(path).with_context(|| format!("--truth {}", path.display()))?;
        Ok(Self {
            path,
            file,
            written: BTreeSet::new(),
        })
    }

    /// Adds the parts that have landed since the last call.
    ///
    /// # Errors
    /// Fails when the file cannot be written.
    pub fn write_landed(&mut self, rig: &SharedRig) -> anyhow::Result<()> {
        self.write(rig, |part| !part["landed_in"].is_null())
    }

    /// Adds all parts that are not in the file yet, also those still inside the rig.
    ///
    /// # Errors
    /// Fails when the file cannot be written.
    pub fn write_rest(&mut self, rig: &SharedRig) -> anyhow::Result<()> {
        self.write(rig, |_| true)
    }

    fn write(&mut self, rig: &SharedRig, wanted: impl Fn(&Value) -> bool) -> anyhow::Result<()> {
        let mut rows = String::new();
        for part in rig.truth().into_iter().filter(wanted) {
            let seq = part["seq"].as_u64();
            if seq.is_some_and(|seq| self.written.insert(seq)) {
                rows.push_str(&format!("{part}\n"));
            }
        }
        self.file
            .write_all(rows.as_bytes())
            .with_context(|| format!("--truth {}", self.path.display()))
    }
}
