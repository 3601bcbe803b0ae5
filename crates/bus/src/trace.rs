//! The last bytes of a line, with their times.

use dcon::FRAME_LIMIT;
use std::collections::VecDeque;
use units::RigTime;

/// Which way bytes went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// From us.
    Sent,
    /// Taken as a reply, or as the beginning of one.
    Heard,
    /// Heard when nothing was asked, and thrown away.
    Stray,
}

/// A piece of traffic: at most one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// When it was written, or when it had been heard.
    pub at: RigTime,
    /// Which way.
    pub direction: Direction,
    bytes: [u8; FRAME_LIMIT],
    length: u8,
}

impl Entry {
    /// None when there are more bytes than a frame has.
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

    /// The bytes, CR included.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }
}

/// A bounded ring of entries, and a fingerprint of all bytes that ever passed.
#[derive(Debug, Clone)]
pub struct Trace {
    ring: VecDeque<Entry>,
    capacity: usize,
    fingerprint: u64,
    bytes: u64,
}

impl Default for Trace {
    /// A thousand entries: some seconds of a busy line.
    fn default() -> Self {
        Self::with_capacity(1000)
    }
}

impl Trace {
    /// Keeps the last `capacity` entries.
    pub fn with_capacity(capacity: usize) -> Self {
        // Start value of FNV-1a, 64 bit.
        Self {
            ring: VecDeque::new(),
            capacity,
            fingerprint: 0xCBF2_9CE4_8422_2325,
            bytes: 0,
        }
    }

    /// Adds bytes; longer pieces take several entries.
    pub(super) fn add(&mut self, at: RigTime, direction: Direction, bytes: &[u8]) {
        for piece in bytes.chunks(FRAME_LIMIT) {
            self.stamp(direction, piece);
            if self.ring.len() >= self.capacity {
                self.ring.pop_front();
            }
            self.ring.extend(Entry::new(at, direction, piece));
        }
    }

    fn stamp(&mut self, direction: Direction, bytes: &[u8]) {
        /// Prime of FNV-1a, 64 bit.
        const PRIME: u64 = 0x0000_0100_0000_01B3;
        let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(PRIME);
        let hash = step(self.fingerprint, direction as u8);
        self.fingerprint = bytes.iter().fold(hash, |hash, byte| step(hash, *byte));
        self.bytes += bytes.len() as u64;
    }

    /// Oldest first.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.ring.iter()
    }

    /// Equal for equal bytes in equal order and direction, times left out.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// All bytes that ever passed.
    pub fn byte_count(&self) -> u64 {
        self.bytes
    }
}
