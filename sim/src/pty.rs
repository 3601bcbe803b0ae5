//! Lines as pseudo-terminals in real time.
//!
//! The slave is put into raw mode before anybody opens it, and one slave descriptor stays open, so
//! that clients may open and close the port per request. Two threads serve a line: one reads the
//! master and stamps what comes, the other keeps absolute deadlines, so that late wake-ups never
//! add up. A pseudo-terminal has no baud rate: the time of every character is added here. Each
//! reply is one write. While nobody talks the rig still goes on every [`IDLE`], so that watchdogs
//! expire in time.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::ffi::OsStringExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};

use crate::line::{self, Arrival};
use crate::rig::Reply;
use crate::{SharedRig, SimError};

/// Longest pause of a line's thread.
const IDLE: Duration = Duration::from_millis(50);

/// A sleeping thread wakes some 60 us late; it is woken so much earlier and yields until the deadline.
const EARLY: Duration = Duration::from_micros(120);

/// Bytes as they came, with the instant at which they were read.
type Piece = (Instant, Vec<u8>);

/// The pseudo-terminals of a rig; dropping it stops them.
pub struct Ptys {
    ports: Vec<Port>,
    links: std::sync::Mutex<Vec<PathBuf>>,
    stop: Arc<AtomicBool>,
}

struct Port {
    line: String,
    path: PathBuf,
    /// Kept open: clients come and go.
    slave: OwnedFd,
    threads: Vec<JoinHandle<()>>,
}

/// Opens a pseudo-terminal per line and starts to answer. Rig time goes on from where the rig
/// stands and follows the wall clock.
///
/// # Errors
/// The system gives no pseudo-terminal or thread.
pub fn serve(rig: &SharedRig) -> Result<Ptys, SimError> {
    let stop = Arc::new(AtomicBool::new(false));
    let origin = Instant::now()
        .checked_sub(Duration::from_micros(rig.now_us()))
        .unwrap_or_else(Instant::now);
    let mut ptys = Ptys {
        ports: Vec::new(),
        links: std::sync::Mutex::new(Vec::new()),
        stop: Arc::clone(&stop),
    };
    for (number, (name, baud)) in rig.lines().into_iter().enumerate() {
        let (master, slave, path) =
            open().map_err(|source| terminal("open a pseudo-terminal", source))?;
        let mut port = Port {
            line: name,
            path,
            slave,
            threads: Vec::new(),
        };
        let server = Server {
            rig: rig.clone(),
            number,
            origin,
            receiver: line::Receiver::new(baud),
            arrivals: Vec::new(),
            replies: Vec::new(),
        };
        port.start(master, server, &stop)
            .map_err(|source| terminal("start the thread of a line", source))?;
        ptys.ports.push(port);
    }
    Ok(ptys)
}

fn terminal(what: &str, source: io::Error) -> SimError {
    SimError::Terminal {
        what: what.into(),
        source,
    }
}

fn open() -> io::Result<(File, OwnedFd, PathBuf)> {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    let name = ptsname(&master, Vec::new())?;
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
    let slave = rustix::fs::open(name.as_c_str(), flags, Mode::empty())?;
    let mut mode = tcgetattr(&slave)?;
    mode.make_raw();
    tcsetattr(&slave, OptionalActions::Now, &mode)?;
    let path = PathBuf::from(std::ffi::OsString::from_vec(name.into_bytes()));
    Ok((File::from(master), slave, path))
}

impl Ptys {
    /// Name of each line and the port a client opens.
    pub fn paths(&self) -> Vec<(String, PathBuf)> {
        let path = |port: &Port| (port.line.clone(), port.path.clone());
        self.ports.iter().map(path).collect()
    }

    /// Makes a symbolic link per line name in `dir` (created if need be); an older link is
    /// replaced, any other file is not. Stopping removes the links.
    ///
    /// # Errors
    /// The folder or a link cannot be made.
    pub fn link(&self, dir: &Path) -> Result<(), SimError> {
        std::fs::create_dir_all(dir)
            .map_err(|source| terminal(&format!("make the folder {}", dir.display()), source))?;
        for port in &self.ports {
            let link = dir.join(&port.line);
            if link.is_symlink() {
                // Should this fail, making the link fails with the reason.
                let _ = std::fs::remove_file(&link);
            }
            std::os::unix::fs::symlink(&port.path, &link)
                .map_err(|source| terminal(&format!("make the link {}", link.display()), source))?;
            if let Ok(mut links) = self.links.lock() {
                links.push(link);
            }
        }
        Ok(())
    }

    /// Ends all threads, closes the ports and removes the links.
    pub fn stop(self) {}
}

impl Drop for Ptys {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        for port in &mut self.ports {
            port.stop();
        }
        for link in self
            .links
            .get_mut()
            .into_iter()
            .flat_map(|links| links.drain(..))
        {
            // A link that somebody removed already is as good as removed.
            let _ = std::fs::remove_file(link);
        }
    }
}

impl Port {
    fn start(&mut self, master: File, server: Server, stop: &Arc<AtomicBool>) -> io::Result<()> {
        let (sender, pieces) = mpsc::channel();
        let reading = master.try_clone()?;
        let reader_stop = Arc::clone(stop);
        let reader_name = format!("{} reader", self.line);
        let reader = std::thread::Builder::new()
            .name(reader_name)
            .spawn(move || read(reading, &sender, &reader_stop))?;
        self.threads.push(reader);
        let stop = Arc::clone(stop);
        let line = std::thread::Builder::new()
            .name(self.line.clone())
            .spawn(move || server.serve(master, &pieces, &stop))?;
        self.threads.push(line);
        Ok(())
    }

    /// Wakes the reader by a character, frees a writer whose host does not read, and waits.
    fn stop(&mut self) {
        let _ = rustix::io::write(self.slave.as_fd(), b"\r");
        let _ = tcflush(&self.slave, QueueSelector::IFlush);
        for thread in self.threads.drain(..) {
            // A thread that panicked has said so already.
            let _ = thread.join();
        }
    }
}

fn read(mut master: File, pieces: &Sender<Piece>, stop: &AtomicBool) {
    let mut bytes = [0u8; 512];
    while !stop.load(Ordering::Acquire) {
        let Ok(count) = master.read(&mut bytes) else {
            return;
        };
        let piece = (Instant::now(), bytes[..count].to_vec());
        if count == 0 || pieces.send(piece).is_err() {
            return;
        }
    }
}

/// One line in real time.
struct Server {
    rig: SharedRig,
    number: usize,
    origin: Instant,
    receiver: line::Receiver,
    arrivals: Vec<Arrival>,
    replies: Vec<Reply>,
}

impl Server {
    fn serve(mut self, mut master: File, pieces: &Receiver<Piece>, stop: &AtomicBool) {
        while !stop.load(Ordering::Acquire) {
            match pieces.recv_timeout(self.pause()) {
                Ok((at, bytes)) => {
                    let at_us = self.rig_us(at);
                    self.arrivals.extend(self.receiver.take(&bytes, at_us));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            if self.act(&mut master).is_err() {
                return;
            }
        }
    }

    fn rig_us(&self, at: Instant) -> u64 {
        at.saturating_duration_since(self.origin).as_micros() as u64
    }

    fn next_us(&self) -> Option<u64> {
        let arrival = self.arrivals.iter().map(|arrival| arrival.at_us);
        let reply = self.replies.iter().map(|reply| reply.at_us);
        arrival.chain(reply).min()
    }

    fn pause(&self) -> Duration {
        match self.next_us() {
            None => IDLE,
            Some(due_us) => (self.origin + Duration::from_micros(due_us))
                .saturating_duration_since(Instant::now())
                .saturating_sub(EARLY)
                .min(IDLE),
        }
    }

    /// Rig time; when a deadline is as near as the thread was woken early, at that deadline.
    fn close_to_deadline(&self) -> u64 {
        let next_us = self.next_us();
        loop {
            let now_us = self.rig_us(Instant::now());
            match next_us {
                Some(due_us)
                    if (1..=EARLY.as_micros() as u64).contains(&due_us.saturating_sub(now_us)) =>
                {
                    std::thread::yield_now();
                }
                _ => return now_us,
            }
        }
    }

    fn act(&mut self, master: &mut File) -> io::Result<()> {
        let now_us = self.close_to_deadline();
        while self
            .arrivals
            .first()
            .is_some_and(|next| next.at_us <= now_us)
        {
            let arrival = self.arrivals.remove(0);
            let reply = self.rig.exchange(self.number, &arrival.text, arrival.at_us);
            self.replies.extend(reply);
        }
        while let Some(place) = self.replies.iter().position(|reply| reply.at_us <= now_us) {
            master.write_all(&self.replies.remove(place).bytes)?;
        }
        if self.arrivals.is_empty() && self.replies.is_empty() {
            self.rig.advance(now_us);
        }
        Ok(())
    }
}
