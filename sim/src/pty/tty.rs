//! One pseudo-terminal in raw mode, for clients that set no terminal options.

use std::fs::File;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStringExt;
use std::path::PathBuf;

use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

/// Master and slave; the open slave keeps the terminal alive between clients.
pub(crate) struct Tty {
    pub(crate) master: File,
    pub(crate) slave: OwnedFd,
    pub(crate) path: PathBuf,
}

impl Tty {
    /// Opens the terminal; `baud` is the initial rate.
    pub(crate) fn open(baud: u32) -> io::Result<Self> {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        let name = ptsname(&master, Vec::new())?;
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let slave = rustix::fs::open(name.as_c_str(), flags, Mode::empty())?;
        let mut mode = tcgetattr(&slave)?;
        mode.make_raw();
        mode.set_speed(baud)?;
        tcsetattr(&slave, OptionalActions::Now, &mode)?;
        let path = PathBuf::from(std::ffi::OsString::from_vec(name.into_bytes()));
        Ok(Self {
            master: File::from(master),
            slave,
            path,
        })
    }
}
