//! Notifications of `serve` to systemd, over a real datagram socket.

use crate::interruptions::send;
use crate::program::Workshop;
use std::os::unix::net::UnixDatagram;
use std::process::{Child, Stdio};
use std::time::Duration;

/// Longest wait for a message; far more than a busy computer needs.
const MESSAGE_TIMEOUT: Duration = Duration::from_secs(120);

/// A service with the end of the socket that systemd would hold; dropping kills the service.
struct Notified {
    process: Child,
    socket: UnixDatagram,
    _folder: tempfile::TempDir,
}

impl Drop for Notified {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Notified {
    /// Starts a service whose watchdog expects a ping within `watchdog_us`.
    fn start(workshop: &Workshop, watchdog_us: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("notify");
        let socket = UnixDatagram::bind(&path).unwrap();
        socket.set_read_timeout(Some(MESSAGE_TIMEOUT)).unwrap();
        let mut command = workshop.command("serve --listen 127.0.0.1:0 --sim --speed 5");
        let process = command
            .env("NOTIFY_SOCKET", &path)
            .env("WATCHDOG_USEC", watchdog_us)
            .env_remove("WATCHDOG_PID")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        Self {
            process,
            socket,
            _folder: folder,
        }
    }

    /// Returns the lines of the next message.
    fn next(&self) -> Vec<String> {
        let mut bytes = [0; 4096];
        // A signal to this process, such as the end of another test's child, interrupts the call.
        let count = loop {
            match self.socket.recv(&mut bytes) {
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                received => break received.unwrap(),
            }
        };
        let text = std::str::from_utf8(&bytes[..count]).unwrap();
        text.lines().map(str::to_owned).collect()
    }

    /// Returns all lines up to the first one that is `expected`.
    fn until(&self, expected: &str) -> Vec<String> {
        let mut lines = Vec::new();
        while !lines.iter().any(|line| line == expected) {
            lines.extend(self.next());
        }
        lines
    }
}

#[test]
fn systemd_is_notified_from_ready_to_stopping() {
    let workshop = Workshop::new("notify");
    let mut service = Notified::start(&workshop, "2000000");
    let before = service.until("READY=1");
    assert!(!before.contains(&"STOPPING=1".to_owned()), "{before:?}");
    let alive = [service.until("WATCHDOG=1"), service.until("WATCHDOG=1")].concat();
    let all = [before, alive].concat();
    let said = |start: &str| all.iter().any(|line| line.starts_with(start));
    assert!(said("STATUS=between lots"), "{all:?}");
    send("TERM", &service.process);
    service.until("STOPPING=1");
    assert_eq!(service.process.wait().unwrap().code(), Some(0));
}
