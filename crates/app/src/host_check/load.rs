//! Makes the load of the test: two busy threads per CPU, and one that writes and syncs a file without pause, all at
//! normal priority.

use anyhow::Context;
use std::fs::File;
use std::io::{self, Seek, Write};
use std::num::NonZero;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, JoinHandle};

/// Busy threads per CPU.
const BUSY_PER_CPU: usize = 2;
/// Bytes between two syncs: the size of a commit of the history.
const BLOCK: usize = 64 * 1024;
/// Steps that a busy thread takes between two checks of the stop flag.
const STEPS: u32 = 10_000;

/// Creates a file without a name in `folder`; the system removes the file however the program ends.
///
/// # Errors
/// Fails when the folder does not exist or refuses a new file; the error names the folder.
pub(super) fn scratch_file(folder: &Path) -> anyhow::Result<File> {
    let place = || {
        format!(
            "{}: expected a folder for a temporary file",
            folder.display()
        )
    };
    tempfile::tempfile_in(folder).with_context(place)
}

/// A running load. Dropping the value ends the threads.
pub(super) struct Load {
    stop: Arc<AtomicBool>,
    busy: Vec<JoinHandle<()>>,
    writer: Option<JoinHandle<io::Result<()>>>,
}

impl Load {
    /// Starts the load; the writer overwrites `file`.
    ///
    /// # Errors
    /// Fails when the system refuses a thread.
    pub fn start(file: File) -> anyhow::Result<Self> {
        let mut load = Self {
            stop: Arc::new(AtomicBool::new(false)),
            busy: Vec::new(),
            writer: None,
        };
        let stop = &load.stop;
        let cpus = std::thread::available_parallelism().map_or(1, NonZero::get);
        for _ in 0..BUSY_PER_CPU * cpus {
            let stop = Arc::clone(stop);
            let busy = Builder::new()
                .name("load".into())
                .spawn(move || busy(&stop));
            load.busy.push(busy.context("starting a busy thread")?);
        }
        let stop = Arc::clone(stop);
        let writer = Builder::new().name("load".into());
        let writer = writer.spawn(move || write(file, &stop));
        load.writer = Some(writer.context("starting the writing thread")?);
        Ok(load)
    }

    /// Ends the load.
    ///
    /// # Errors
    /// Fails when the file was not written: the phase then had no load on the disk.
    pub fn end(mut self) -> anyhow::Result<()> {
        self.stop.store(true, Ordering::Release);
        let written = self.writer.take().map(JoinHandle::join);
        written
            .and_then(Result::ok)
            .unwrap_or(Ok(()))
            .context("writing the temporary file of the load")
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        for thread in self.busy.drain(..) {
            let _ = thread.join();
        }
        let _ = self.writer.take().map(JoinHandle::join);
    }
}

fn busy(stop: &AtomicBool) {
    let mut sum = 0u32;
    while !stop.load(Ordering::Acquire) {
        sum = (0..STEPS).fold(sum, |sum, step| std::hint::black_box(sum ^ step));
    }
}

/// Overwrites the same block of the file, so that the disk does not fill.
fn write(mut file: File, stop: &AtomicBool) -> io::Result<()> {
    let block = vec![0x55; BLOCK];
    while !stop.load(Ordering::Acquire) {
        file.rewind()?;
        file.write_all(&block)?;
        file.sync_data()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_load_leaves_no_file_behind() {
        let folder = tempfile::tempdir().unwrap();
        let load = Load::start(scratch_file(folder.path()).unwrap()).unwrap();
        let files = || std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(files(), 0, "a name that a killed program leaves");
        load.end().unwrap();
        assert_eq!(files(), 0);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let error = scratch_file(Path::new("/no/such/folder")).unwrap_err();
        assert!(error.to_string().contains("/no/such/folder"), "{error:#}");
    }
}
