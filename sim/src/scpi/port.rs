//! One link of a host: incoming bytes, outgoing bytes with their instants, and the faults between.

use super::adapter::{Adapter, Sent};
use super::device::Device;
use super::file::Link;
use super::message::Framer;
use crate::fault::instrument::{InstrumentFault as Fault, InstrumentFaults};

/// Greatest number of pieces, one millisecond apart, into which a fault splits a reply.
const PIECES: usize = 200;

/// Output of a port to its host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Out {
    /// Bytes in one piece.
    Bytes(Vec<u8>),
    /// End of the connection.
    Close,
}

/// Instrument or adapter behind a port.
pub enum Behind {
    /// One instrument, by its index.
    Instrument(usize),
    /// A GPIB adapter.
    Adapter(Adapter),
}

/// State of one link.
pub struct Port {
    /// Name in the file of instruments.
    pub name: String,
    /// Kind of the link.
    pub link: Link,
    behind: Behind,
    framer: Framer,
    out: Vec<(u64, Out)>,
    /// A reply that a fault holds back until the next one.
    held: Vec<u8>,
    /// Instant until which the port sends nothing more: until then earlier bytes occupy the wire, or a fault pauses the
    /// instrument.
    free_us: u64,
    /// Instant at which the last received character is complete.
    received_us: u64,
}

impl Port {
    /// Creates a closed port.
    pub fn new(name: String, link: Link, behind: Behind) -> Self {
        Self {
            name,
            link,
            behind,
            framer: Framer::default(),
            out: Vec::new(),
            held: Vec::new(),
            free_us: 0,
            received_us: 0,
        }
    }

    /// Returns each instrument behind the port: its name, and its link with the port at `place`.
    pub fn links(&self, place: &str, devices: &[Device]) -> Vec<(String, String)> {
        match &self.behind {
            Behind::Instrument(number) => vec![(devices[*number].name.clone(), place.to_owned())],
            Behind::Adapter(adapter) => {
                let link = |(address, number): (&u8, &usize)| {
                    let name = devices[*number].name.clone();
                    (name, format!("gpib-{place}:{address}"))
                };
                adapter.instruments.iter().map(link).collect()
            }
        }
    }

    /// Accepts a host; returns `false` when a fault keeps the port busy.
    pub fn open(&mut self, now_us: u64, faults: &mut InstrumentFaults) -> bool {
        faults
            .strikes(Fault::PortBusy, &self.name, now_us)
            .is_none()
    }

    /// Discards the host's pending replies and partial message; a fault leaves half a command in the input.
    pub fn close(&mut self, now_us: u64, devices: &mut [Device], faults: &mut InstrumentFaults) {
        self.out.clear();
        self.held.clear();
        self.free_us = now_us;
        self.framer.clear();
        let half = faults.strikes(Fault::HalfKept, &self.name, now_us);
        for byte in half.into_iter().flat_map(|_| *b"*ID") {
            // Three bytes end no message and overrun no buffer.
            let _ = self.framer.push(byte);
        }
        match &mut self.behind {
            Behind::Instrument(number) => devices[*number].clear(),
            Behind::Adapter(adapter) => adapter.disconnect(),
        }
    }

    /// Accepts bytes from the host; on a serial link each byte takes its character time.
    pub fn receive(
        &mut self,
        bytes: &[u8],
        now_us: u64,
        devices: &mut [Device],
        faults: &mut InstrumentFaults,
    ) {
        self.received_us = self.received_us.max(now_us);
        for &byte in bytes {
            self.received_us += self.link.character_us();
            let at_us = self.received_us;
            match &mut self.behind {
                Behind::Adapter(adapter) => adapter.take(byte, at_us),
                Behind::Instrument(number) => match self.framer.push(byte) {
                    Ok(Some(message)) => devices[*number].receive(&message, at_us, faults),
                    Ok(None) => {}
                    Err(failure) => devices[*number].status.push(failure),
                },
            }
        }
    }

    /// Takes finished replies from the instrument or adapter.
    pub fn collect(&mut self, now_us: u64, devices: &mut [Device], faults: &mut InstrumentFaults) {
        loop {
            let (at_us, bytes, number) = match &mut self.behind {
                Behind::Instrument(number) => match devices[*number].outbox.pop_front() {
                    Some((at_us, bytes)) => (at_us, bytes, *number),
                    None => return,
                },
                Behind::Adapter(adapter) => match adapter.work(now_us, devices, faults) {
                    Some(Sent {
                        at_us,
                        bytes,
                        device: Some(number),
                    }) => (at_us, bytes, number),
                    Some(Sent { at_us, bytes, .. }) => {
                        let at_us = self.after_wire(at_us, bytes.len());
                        self.out.push((at_us, Out::Bytes(bytes)));
                        continue;
                    }
                    None => return,
                },
            };
            self.send(at_us, bytes, &devices[number].name, faults);
        }
    }

    /// Queues a reply for sending, altered by the faults of the link.
    fn send(&mut self, at_us: u64, bytes: Vec<u8>, name: &str, faults: &mut InstrumentFaults) {
        let port = self.name.clone();
        let mut strikes = |fault| {
            let own = faults.strikes(fault, name, at_us);
            own.or_else(|| {
                if port == name {
                    None
                } else {
                    faults.strikes(fault, &port, at_us)
                }
            })
        };
        if strikes(Fault::ReplyLost).is_some() {
            return;
        }
        if let Some(pause_us) = strikes(Fault::SendPaused) {
            self.free_us = self.free_us.max(at_us + pause_us);
        }
        let late_us = strikes(Fault::ReplyLate).unwrap_or(0);
        let mut bytes = damaged(bytes, &mut strikes);
        if strikes(Fault::ReplyCrlf).is_some() && bytes.ends_with(b"\n") {
            bytes.pop();
            bytes.extend(b"\r\n");
        }
        if strikes(Fault::ReplyJoined).is_some() {
            self.held.extend(bytes);
            return;
        }
        let mut whole = std::mem::take(&mut self.held);
        whole.extend(bytes);
        if strikes(Fault::ReplyTwice).is_some() {
            whole.extend_from_within(..);
        }
        let at_us = self.after_wire(at_us + late_us, whole.len());
        if strikes(Fault::ClosedBefore).is_some() {
            self.out.push((at_us, Out::Close));
        } else if strikes(Fault::ClosedInside).is_some() {
            whole.truncate(whole.len() / 2);
            self.out.push((at_us, Out::Bytes(whole)));
            self.out.push((at_us, Out::Close));
        } else if strikes(Fault::ReplySplit).is_some() {
            for piece in whole.chunks(whole.len().div_ceil(PIECES)) {
                self.out.push((self.free_us, Out::Bytes(piece.to_vec())));
                self.free_us += 1_000;
            }
        } else {
            self.out.push((at_us, Out::Bytes(whole)));
        }
    }

    /// Returns the instant at which `count` bytes that are ready at `at_us` have left. The bytes of a port keep their
    /// order, so a late reply delays those after it.
    fn after_wire(&mut self, at_us: u64, count: usize) -> u64 {
        self.free_us = self.free_us.max(at_us) + self.link.character_us() * count as u64;
        self.free_us
    }

    /// Removes and returns everything that has left the port up to `now_us`.
    pub fn due(&mut self, now_us: u64) -> Vec<Out> {
        let (due, later): (Vec<_>, _) = self.out.drain(..).partition(|(at_us, _)| *at_us <= now_us);
        self.out = later;
        due.into_iter().map(|(_, out)| out).collect()
    }

    /// Returns the next instant at which something may leave.
    pub fn next_us(&self, devices: &[Device]) -> Option<u64> {
        let sent = self.out.iter().map(|(at_us, _)| *at_us).min();
        let behind = match &self.behind {
            Behind::Instrument(number) => {
                let device = &devices[*number];
                let ready = device.outbox.front().map(|(at_us, _)| *at_us);
                ready.or_else(|| device.reply_us())
            }
            Behind::Adapter(adapter) => adapter.next_us(devices),
        };
        [sent, behind].into_iter().flatten().min()
    }
}

/// Damages the reply when it is a block and a fault strikes.
fn damaged(mut bytes: Vec<u8>, strikes: &mut impl FnMut(Fault) -> Option<u64>) -> Vec<u8> {
    if bytes.first() != Some(&b'#') {
        return bytes;
    }
    let digits = bytes
        .get(1)
        .map_or(0, |digit| usize::from(digit.saturating_sub(b'0')));
    let header = (2 + digits).min(bytes.len());
    if strikes(Fault::BlockCut).is_some() {
        bytes.truncate(header + (bytes.len() - header) / 2);
        bytes.push(b'\n');
    }
    if strikes(Fault::BlockEmpty).is_some() {
        bytes[2..header].fill(b'0');
    }
    if strikes(Fault::BlockHuge).is_some() {
        bytes[2..header].fill(b'9');
    }
    if strikes(Fault::BlockNewline).is_some() {
        bytes[header..]
            .iter_mut()
            .step_by(7)
            .for_each(|byte| *byte = b'\n');
    }
    bytes
}
