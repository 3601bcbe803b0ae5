//! Status registers and error queue of an instrument.

use std::collections::VecDeque;

/// Bit of the event register: operation complete.
pub const OPC: u8 = 1;

/// Bit of the event register: power was switched on, so the set-up is lost.
pub const POWER_ON: u8 = 1 << 7;

/// An entry of the error queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Failure(pub i16, pub &'static str);

impl Failure {
    pub(crate) const NONE: Self = Self(0, "No error");
    pub(crate) const INVALID_CHARACTER: Self = Self(-101, "Invalid character");
    pub(crate) const SYNTAX: Self = Self(-102, "Syntax error");
    pub(crate) const DATA_TYPE: Self = Self(-104, "Data type error");
    pub(crate) const PARAMETER_NOT_ALLOWED: Self = Self(-108, "Parameter not allowed");
    pub(crate) const MISSING_PARAMETER: Self = Self(-109, "Missing parameter");
    pub(crate) const UNDEFINED_HEADER: Self = Self(-113, "Undefined header");
    pub(crate) const SUFFIX_OUT_OF_RANGE: Self = Self(-114, "Header suffix out of range");
    pub(crate) const TRIGGER_IGNORED: Self = Self(-211, "Trigger ignored");
    pub(crate) const INIT_IGNORED: Self = Self(-213, "Init ignored");
    pub(crate) const TRIGGER_DEADLOCK: Self = Self(-214, "Trigger deadlock");
    pub(crate) const SETTINGS_CONFLICT: Self = Self(-221, "Settings conflict");
    pub(crate) const OUT_OF_RANGE: Self = Self(-222, "Data out of range");
    pub(crate) const ILLEGAL_VALUE: Self = Self(-224, "Illegal parameter value");
    pub(crate) const DATA_STALE: Self = Self(-230, "Data corrupt or stale");
    pub(crate) const QUEUE_OVERFLOW: Self = Self(-350, "Queue overflow");
    pub(crate) const INPUT_OVERRUN: Self = Self(-363, "Input buffer overrun");
    pub(crate) const INTERRUPTED: Self = Self(-410, "Query INTERRUPTED");
    pub(crate) const UNTERMINATED: Self = Self(-420, "Query UNTERMINATED");
    pub(crate) const UNTERMINATED_INDEFINITE: Self =
        Self(-440, "Query UNTERMINATED after indefinite response");
    pub(crate) const OVERCURRENT: Self = Self(-300, "Device-specific error;Overcurrent");
    pub(crate) const LOCAL: Self = Self(550, "Command not allowed in local");

    /// Returns the bit of the event register that this class of errors sets.
    fn event(self) -> u8 {
        match self.0 {
            -199..=-100 => 1 << 5,
            -299..=-200 => 1 << 4,
            -499..=-400 => 1 << 2,
            0 => 0,
            _ => 1 << 3,
        }
    }
}

/// Registers and error queue.
#[derive(Debug, Clone)]
pub struct Status {
    /// Standard event status register.
    pub event: u8,
    /// Enable mask of the event register (`*ESE`).
    pub event_enable: u8,
    /// Enable mask of the status byte (`*SRE`).
    pub service_enable: u8,
    errors: VecDeque<Failure>,
    depth: usize,
}

impl Status {
    /// Creates the status of an instrument that was just switched on.
    pub fn new(depth: usize) -> Self {
        Self {
            event: POWER_ON,
            event_enable: 0,
            service_enable: 0,
            errors: VecDeque::new(),
            depth,
        }
    }

    /// Queues an error; when the queue is full, its last entry becomes -350.
    pub fn push(&mut self, failure: Failure) {
        self.event |= failure.event();
        if self.errors.len() < self.depth {
            self.errors.push_back(failure);
        } else if let Some(last) = self.errors.back_mut() {
            *last = Failure::QUEUE_OVERFLOW;
            self.event |= Failure::QUEUE_OVERFLOW.event();
        }
    }

    /// Queues errors until the queue overflows.
    pub fn overflow(&mut self) {
        for _ in 0..=self.depth {
            self.push(Failure::UNDEFINED_HEADER);
        }
    }

    /// Removes and returns the oldest error, 0 when there is none.
    pub fn next_error(&mut self) -> Failure {
        self.errors.pop_front().unwrap_or(Failure::NONE)
    }

    /// Counts the queued errors.
    pub fn errors(&self) -> usize {
        self.errors.len()
    }

    /// Clears events and errors, as `*CLS`.
    pub fn clear(&mut self) {
        self.event = 0;
        self.errors.clear();
    }

    /// Returns the status byte; `message` sets the bit for an available reply.
    pub fn byte(&self, message: bool) -> u8 {
        let mut byte = u8::from(!self.errors.is_empty()) << 2
            | u8::from(message) << 4
            | u8::from(self.event & self.event_enable != 0) << 5;
        byte |= u8::from(byte & self.service_enable != 0) << 6;
        byte
    }
}
