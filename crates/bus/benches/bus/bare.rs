//! The peer for comparison with a busy line (`busy.rs`): a bare client that sends a request, reads up to the CR, waits
//! for the time of two characters and sends the next request. Its utilisation is below the bound because simulated
//! modules, pseudo-terminal and this machine slow any host.

use bus::Wire;
use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

/// Longest wait for a reply.
const TIME_OUT: Duration = Duration::from_secs(2);

/// Greatest lateness of a sleep; a wait sleeps that much less and then spins on the clock.
const LATE: Duration = Duration::from_micros(150);

/// Sends each of `requests` and reads its reply; returns the time from the first request to the last one.
pub fn exchange_all(path: &str, wire: Wire, requests: &[Vec<u8>]) -> io::Result<Duration> {
    let mut port = tokio_serial::new(path, wire.baud)
        .timeout(TIME_OUT)
        .open_native()?;
    let rest = Duration::from_micros(wire.time(2).0);
    let begun = Instant::now();
    let mut last = begun;
    for request in requests {
        last = Instant::now();
        port.write_all(request)?;
        heard(&mut port)?;
        wait_until(Instant::now() + rest);
    }
    Ok(last - begun)
}

fn heard(port: &mut impl Read) -> io::Result<()> {
    let mut piece = [0; 128];
    loop {
        let count = port.read(&mut piece)?;
        if piece[..count].ends_with(b"\r") {
            return Ok(());
        }
    }
}

fn wait_until(end: Instant) {
    let left = end.saturating_duration_since(Instant::now());
    std::thread::sleep(left.saturating_sub(LATE));
    while Instant::now() < end {
        std::hint::spin_loop();
    }
}
