//! Where clients find the port of a line; the terminal behind it changes when the port is lost.

use std::io;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rustix::termios::{QueueSelector, ioctl_tiocnxcl, tcflush, tcgetattr};

/// Path, links and the slave that is kept open.
#[derive(Default)]
pub(super) struct Socket(Mutex<Behind>);

#[derive(Default)]
struct Behind {
    path: PathBuf,
    slave: Option<OwnedFd>,
    links: Vec<PathBuf>,
}

impl Socket {
    fn behind(&self) -> MutexGuard<'_, Behind> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn path(&self) -> PathBuf {
        self.behind().path.clone()
    }

    /// A terminal is there; the links point at it.
    pub(super) fn plug(&self, path: &Path, slave: OwnedFd) -> io::Result<()> {
        let mut behind = self.behind();
        path.clone_into(&mut behind.path);
        behind.slave = Some(slave);
        behind.links.iter().try_for_each(|link| point(link, path))
    }

    /// The terminal is gone, and so are the links until it is back.
    pub(super) fn unplug(&self) {
        let mut behind = self.behind();
        behind.slave = None;
        behind.links.iter().for_each(|link| remove(link));
    }

    /// Makes a link, and makes it again whenever the port comes back.
    pub(super) fn link(&self, link: PathBuf) -> io::Result<()> {
        let mut behind = self.behind();
        point(&link, &behind.path)?;
        behind.links.push(link);
        Ok(())
    }

    /// Removes the links for good.
    pub(super) fn unlink(&self) {
        self.behind().links.drain(..).for_each(|link| remove(&link));
    }

    /// A client that was killed has left the terminal exclusive; as long as this slave is open, nobody else would end
    /// that.
    pub(super) fn share(&self) {
        if let Some(slave) = &self.behind().slave {
            let _ = ioctl_tiocnxcl(slave);
        }
    }

    /// The rate that the client has set at its end.
    pub(super) fn baud(&self) -> Option<u32> {
        let behind = self.behind();
        let mode = tcgetattr(behind.slave.as_ref()?).ok()?;
        Some(mode.output_speed())
    }

    /// Wakes the reader by a character, which is no request.
    pub(super) fn wake_reader(&self) {
        if let Some(slave) = &self.behind().slave {
            let _ = rustix::io::write(slave, b"\r");
        }
    }

    /// Frees a writer whose host does not read.
    pub(super) fn free_writer(&self) {
        if let Some(slave) = &self.behind().slave {
            let _ = tcflush(slave, QueueSelector::IFlush);
        }
    }
}

/// An older link is replaced, any other file is not.
fn point(link: &Path, path: &Path) -> io::Result<()> {
    if link.is_symlink() {
        remove(link);
    }
    std::os::unix::fs::symlink(path, link)
}

/// A link that somebody removed already is as good as removed.
fn remove(link: &Path) {
    let _ = std::fs::remove_file(link);
}
