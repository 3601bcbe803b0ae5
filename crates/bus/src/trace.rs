//! The last bytes on a line, with their times.

use dcon::FRAME_LIMIT;
use std::collections::VecDeque;
use units::RigTime;

/// Direction of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Sent by the line.
    Sent,
    /// Received as a reply, or as the beginning of one.
    Received,
    /// Received without a request, and discarded.
    Stray,
}

/// A piece of traffic, at most one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Time at which the bytes were sent or received.
    pub at: RigTime,
    /// Direction of the bytes.
    pub direction: Direction,
    bytes: [u8; FRAME_LIMIT],
    length: u8,
}

impl Entry {
    /// Creates an entry; returns `None` for more bytes than a frame has.
    pub fn new(at: RigTime, direction: Direction, bytes: &[u8]) -> Option<Self> {
        let mut entry = Self {
            at,
            direction,
            bytes: [0; FRAME_LIMIT],
            length: bytes.len() as u8,
        };
        entry.bytes.get_mut(..bytes.len())?.copy_from_slice(bytes);
        Some(entry)
    }

    /// Returns the bytes, CR included.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }
}

/// A ring of the last entries, and a fingerprint of all bytes so far.
#[derive(Debug, Clone)]
pub struct Trace {
    ring: VecDeque<Entry>,
    capacity: usize,
    fingerprint: u64,
}

impl Default for Trace {
    /// Returns a trace of the last thousand entries: some seconds of a busy line.
    fn default() -> Self {
        Self::with_capacity(1000)
    }
}

impl Trace {
    /// Returns a trace that keeps the last `capacity` entries.
    pub fn with_capacity(capacity: usize) -> Self {
        // Offset basis of FNV-1a, 64 bit.
        Self {
            ring: VecDeque::new(),
            capacity,
            fingerprint: 0xCBF2_9CE4_8422_2325,
        }
    }

    /// Adds an entry, if given, and drops the oldest one when the ring is full.
    pub(super) fn extend(&mut self, entry: Option<Entry>) {
        let Some(entry) = entry else { return };
        self.stamp(entry.direction, entry.bytes());
        if self.ring.len() >= self.capacity {
            self.ring.pop_front();
        }
        self.ring.push_back(entry);
    }

    fn stamp(&mut self, direction: Direction, bytes: &[u8]) {
        /// Prime of FNV-1a, 64 bit.
        const PRIME: u64 = 0x0000_0100_0000_01B3;
        let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(PRIME);
        let hash = step(self.fingerprint, direction as u8);
        self.fingerprint = bytes.iter().fold(hash, |hash, byte| step(hash, *byte));
    }

    /// Yields the entries, oldest first.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.ring.iter()
    }

    /// Returns a hash of all bytes so far, with their order and direction but without their times.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }
}
