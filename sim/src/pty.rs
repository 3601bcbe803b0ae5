//! Lines as pseudo-terminals in real time.
//!
//! The slave is in raw mode before a client opens it. One slave descriptor stays open, so that clients may open
//! and close the port for each request. A killed client leaves the terminal exclusive, so this module ends that
//! mode. Two threads serve a line: one reads the master and stamps the bytes with their time of arrival; the other
//! sends each reply at an absolute time, so that late wake-ups never add up. A pseudo-terminal has no baud rate: this module adds the time of every character, and a client may set any
//! rate unless [`Rates::Enforced`]. Each reply is one write. The rig advances while no client talks, so that
//! watchdogs expire in time.
//! A lost port closes its terminal: clients get an end of file or an I/O error, as with an unplugged
//! converter. Its link disappears until the port comes back, then points at another terminal.

mod server;
mod socket;
pub(crate) mod tty;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use crate::line;
use crate::{SharedRig, SimError};
use server::Server;
use socket::Socket;
use tty::Tty;

/// Pseudo-terminals of a rig; dropping the value stops them.
pub struct Ptys {
    ports: Vec<Port>,
    stop: Arc<AtomicBool>,
}

/// Effect of the baud rate that a client sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rates {
    /// The rate has no effect: the line's own rate applies.
    Ignored,
    /// A module receives only requests at its own rate (9600 with INIT* grounded), as on a wire. A client that sets
    /// no rate has the line's rate.
    Enforced,
}

struct Port {
    line: String,
    socket: Arc<Socket>,
    thread: Option<JoinHandle<()>>,
}

/// Opens a pseudo-terminal per line and starts to answer. Rig time continues from its present value and follows
/// the wall clock.
///
/// # Errors
/// Fails when the system refuses a pseudo-terminal or a thread.
pub fn serve(rig: &SharedRig, rates: Rates) -> Result<Ptys, SimError> {
    let origin = rig.start_real_time();
    let mut ptys = Ptys {
        ports: Vec::new(),
        stop: Arc::new(AtomicBool::new(false)),
    };
    for (number, (name, baud)) in rig.lines().into_iter().enumerate() {
        let server = Server {
            rig: rig.clone(),
            number,
            baud,
            host_baud: (rates == Rates::Enforced).then_some(baud),
            origin,
            socket: Arc::new(Socket::default()),
            stop: Arc::clone(&ptys.stop),
            receiver: line::Receiver::new(baud),
            arrivals: Vec::new(),
            replies: Vec::new(),
        };
        ptys.ports.push(Port::start(name, server)?);
    }
    Ok(ptys)
}

fn terminal(what: &str, source: io::Error) -> SimError {
    SimError::Terminal {
        what: what.into(),
        source,
    }
}

impl Ptys {
    /// Returns the name of each line with the path of its port.
    pub fn paths(&self) -> Vec<(String, PathBuf)> {
        let path = |port: &Port| (port.line.clone(), port.socket.path());
        self.ports.iter().map(path).collect()
    }

    /// Makes a symbolic link per line name in `dir` (created if missing). Replaces an older link, never another
    /// kind of file. Stopping removes the links.
    ///
    /// # Errors
    /// Fails when the folder or a link cannot be made.
    pub fn link(&self, dir: &Path) -> Result<(), SimError> {
        std::fs::create_dir_all(dir)
            .map_err(|source| terminal(&format!("make the folder {}", dir.display()), source))?;
        for port in &self.ports {
            let link = dir.join(&port.line);
            let what = format!("make the link {}", link.display());
            port.socket
                .link(link)
                .map_err(|source| terminal(&what, source))?;
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
            port.socket.wake_reader();
            port.socket.unblock_writer();
            if let Some(thread) = port.thread.take() {
                // The panic message of the thread is already on stderr.
                let _ = thread.join();
            }
            port.socket.unlink();
        }
    }
}

impl Port {
    fn start(line: String, server: Server) -> Result<Self, SimError> {
        let tty =
            Tty::open(server.baud).map_err(|source| terminal("open a pseudo-terminal", source))?;
        let socket = Arc::clone(&server.socket);
        socket
            .plug(&tty.path, tty.slave)
            .map_err(|source| terminal("plug in a pseudo-terminal", source))?;
        let thread = std::thread::Builder::new()
            .name(line.clone())
            .spawn(move || server.serve(tty.master))
            .map_err(|source| terminal("start the thread of a line", source))?;
        Ok(Self {
            line,
            socket,
            thread: Some(thread),
        })
    }
}
