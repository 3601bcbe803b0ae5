//! Path and links of a line's port; they outlast the terminal, which is a new one after each loss of the port.

use std::io;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rustix::termios::{QueueSelector, ioctl_tiocnxcl, tcflush, tcgetattr};

/// Path, links, and the slave descriptor that stays open; shared between threads.
#[derive(Default)]
pub(super) struct Socket(Mutex<PortState>);

#[derive(Default)]
struct PortState {
    path: PathBuf,
    slave: Option<OwnedFd>,
    links: Vec<PathBuf>,
}

impl Socket {
    fn state(&self) -> MutexGuard<'_, PortState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn path(&self) -> PathBuf {
        self.state().path.clone()
    }

    /// Installs a new terminal and points the links at it.
    pub(super) fn plug(&self, path: &Path, slave: OwnedFd) -> io::Result<()> {
        let mut state = self.state();
        path.clone_into(&mut state.path);
        state.slave = Some(slave);
        state.links.iter().try_for_each(|link| point(link, path))
    }

    /// Removes the terminal and its links.
    pub(super) fn unplug(&self) {
        let mut state = self.state();
        state.slave = None;
        state.links.iter().for_each(|link| remove(link));
    }

    /// Makes a link, and restores it whenever the port comes back.
    pub(super) fn link(&self, link: PathBuf) -> io::Result<()> {
        let mut state = self.state();
        point(&link, &state.path)?;
        state.links.push(link);
        Ok(())
    }

    /// Removes the links for good.
    pub(super) fn unlink(&self) {
        self.state().links.drain(..).for_each(|link| remove(&link));
    }

    /// Ends exclusive mode: a killed client leaves the terminal in that mode, and the open slave descriptor preserves
    /// it.
    pub(super) fn share(&self) {
        if let Some(slave) = &self.state().slave {
            let _ = ioctl_tiocnxcl(slave);
        }
    }

    /// Returns the baud rate that the client has set.
    pub(super) fn baud(&self) -> Option<u32> {
        let state = self.state();
        let mode = tcgetattr(state.slave.as_ref()?).ok()?;
        Some(mode.output_speed())
    }

    /// Wakes the reader with one character; it forms no request.
    pub(super) fn wake_reader(&self) {
        if let Some(slave) = &self.state().slave {
            let _ = rustix::io::write(slave, b"\r");
        }
    }

    /// Unblocks a write that waits because the host does not read.
    pub(super) fn unblock_writer(&self) {
        if let Some(slave) = &self.state().slave {
            let _ = tcflush(slave, QueueSelector::IFlush);
        }
    }
}

/// Makes a symbolic link; replaces an older link, never another kind of file.
fn point(link: &Path, path: &Path) -> io::Result<()> {
    if link.is_symlink() {
        remove(link);
    }
    std::os::unix::fs::symlink(path, link)
}

/// Removes a link; ignores a link that is already gone.
fn remove(link: &Path) {
    let _ = std::fs::remove_file(link);
}
