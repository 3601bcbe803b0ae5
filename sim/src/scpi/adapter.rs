//! GPIB adapter of the Prologix kind, between a byte stream and the instruments on the bus.
//!
//! `++` begins a command of the adapter; every other line goes to the instrument at the present address. An ESC makes
//! the next byte (CR, LF, ESC or `+`) data. The adapter works line by line: a line that follows `++read` waits until
//! the reply has arrived or the time limit of the read is over.

use std::collections::{BTreeMap, VecDeque};

use super::device::Device;
use super::status::Failure;
use crate::fault::instrument::{InstrumentFault as Fault, InstrumentFaults};

const ESCAPE: u8 = 0x1b;

/// Settings: name of the command; minimum, maximum and initial value.
const SETTINGS: [(&str, u32, u32, u32); 9] = [
    ("addr", 0, 30, 0),
    ("auto", 0, 1, 0),
    ("eoi", 0, 1, 1),
    // Terminator appended to data: 0 CR LF, 1 CR, 2 LF, 3 none.
    ("eos", 0, 3, 3),
    ("eot_enable", 0, 1, 0),
    ("eot_char", 0, 255, 0),
    ("read_tmo_ms", 1, 3_000, 500),
    ("mode", 0, 1, 1),
    ("savecfg", 0, 1, 1),
];

/// State of an adapter.
pub struct Adapter {
    /// Index of the instrument at each primary address.
    pub instruments: BTreeMap<u8, usize>,
    name: String,
    /// Value of each of [`SETTINGS`].
    settings: [u32; SETTINGS.len()],
    /// Bytes from the host, each with the instant at which it is complete.
    input: VecDeque<(u64, u8)>,
    line: Vec<u8>,
    escaped: bool,
    /// True when the first byte of the line was escaped: the line is data even if it begins with `++`.
    literal: bool,
    reading: Option<Read>,
    /// Instant at which the last read ended; the next line runs no earlier.
    free_us: u64,
}

/// A read in progress: the instrument (`None` at an empty address), and the deadline.
#[derive(Clone, Copy)]
struct Read {
    device: Option<usize>,
    until_us: u64,
}

/// Bytes that an adapter sends to the host.
pub struct Sent {
    /// Instant at which the bytes leave the adapter, microseconds.
    pub at_us: u64,
    /// Bytes, terminator included.
    pub bytes: Vec<u8>,
    /// Instrument that sent the reply; `None` for an answer of the adapter itself.
    pub device: Option<usize>,
}

impl Adapter {
    /// Creates an adapter in its state at power-on.
    pub fn new(name: &str) -> Self {
        Self {
            instruments: BTreeMap::new(),
            name: name.to_owned(),
            settings: SETTINGS.map(|(.., first)| first),
            input: VecDeque::new(),
            line: Vec::new(),
            escaped: false,
            literal: false,
            reading: None,
            free_us: 0,
        }
    }

    /// Forgets an unfinished line and read, as a new connection does.
    pub fn disconnect(&mut self) {
        self.input.clear();
        self.line.clear();
        (self.escaped, self.literal) = (false, false);
        self.reading = None;
    }

    /// Takes one byte of the host, complete at `at_us`.
    pub fn take(&mut self, byte: u8, at_us: u64) {
        self.input.push_back((at_us, byte));
    }

    /// Works on the input until `now_us`; returns the next bytes to send.
    pub fn work(
        &mut self,
        now_us: u64,
        devices: &mut [Device],
        faults: &mut InstrumentFaults,
    ) -> Option<Sent> {
        loop {
            if let Some(Read { device, until_us }) = self.reading {
                let ready = device.and_then(|it| devices[it].outbox.front());
                if ready.is_some_and(|(at_us, _)| *at_us <= until_us) {
                    return self.fetch(device?, devices);
                }
                if now_us < until_us {
                    return None;
                }
                self.reading = None;
                self.free_us = until_us;
                let silent = device.map(|it| &mut devices[it]);
                if let Some(device) = silent.filter(|it| !it.is_busy() && it.outbox.is_empty()) {
                    device.status.push(Failure::UNTERMINATED);
                }
            }
            let at_us = self.free_us.max(self.input.front()?.0);
            if at_us > now_us {
                return None;
            }
            let (_, byte) = self.input.pop_front()?;
            if let Some(text) = self.byte(byte, at_us, devices, faults) {
                return Some(Sent {
                    at_us,
                    bytes: format!("{text}\r\n").into_bytes(),
                    device: None,
                });
            }
        }
    }

    /// Ends a read with the reply of its instrument.
    fn fetch(&mut self, device: usize, devices: &mut [Device]) -> Option<Sent> {
        let (at_us, mut bytes) = devices[device].outbox.pop_front()?;
        let eot = self.of("eot_enable") == 1;
        bytes.extend(eot.then_some(self.of("eot_char") as u8));
        self.reading = None;
        self.free_us = at_us;
        let device = Some(device);
        Some(Sent {
            at_us,
            bytes,
            device,
        })
    }

    /// Returns the next instant at which a line may run or the present read may end; `None` without input.
    pub fn next_us(&self, devices: &[Device]) -> Option<u64> {
        let Some(read) = &self.reading else {
            return Some(self.free_us.max(self.input.front()?.0));
        };
        let device = read.device.map(|it| &devices[it]);
        let ready = device.and_then(|it| match it.outbox.front() {
            Some((at_us, _)) => Some(*at_us),
            None => it.reply_us(),
        });
        Some(ready.unwrap_or(read.until_us).min(read.until_us))
    }

    fn of(&self, name: &str) -> u32 {
        let mut values = SETTINGS.iter().zip(self.settings);
        let value = values.find(|(known, _)| known.0 == name);
        value.map_or(0, |(_, value)| value)
    }

    /// Returns the instrument at the present address.
    fn addressed(&self) -> Option<usize> {
        let address = u8::try_from(self.of("addr")).ok()?;
        self.instruments.get(&address).copied()
    }

    /// Interprets one byte; returns the adapter's own answer, if any.
    fn byte(
        &mut self,
        byte: u8,
        at_us: u64,
        devices: &mut [Device],
        faults: &mut InstrumentFaults,
    ) -> Option<String> {
        if std::mem::take(&mut self.escaped) {
            self.literal |= self.line.is_empty();
            self.line.push(byte);
            return None;
        }
        match byte {
            ESCAPE => self.escaped = true,
            b'\r' | b'\n' => {
                let line = std::mem::take(&mut self.line);
                let literal = std::mem::take(&mut self.literal);
                match line.strip_prefix(b"++") {
                    Some(command) if !literal => {
                        let command = String::from_utf8_lossy(command).into_owned();
                        return self.command(&command, at_us, devices);
                    }
                    Some(_) | None if line.is_empty() => {}
                    Some(_) | None => self.write(&line, at_us, devices, faults),
                }
            }
            byte => self.line.push(byte),
        }
        None
    }

    fn write(
        &mut self,
        line: &[u8],
        at_us: u64,
        devices: &mut [Device],
        faults: &mut InstrumentFaults,
    ) {
        let changed = faults.strikes(Fault::AddressChanged, &self.name, at_us);
        if changed.is_some() {
            self.settings[0] = (self.settings[0] + 1) % (SETTINGS[0].2 + 1);
        }
        let Some(number) = self.addressed() else {
            return;
        };
        let device = &mut devices[number];
        // Without END or a line feed the instrument waits for the rest of the message.
        let line_feed = matches!(self.of("eos"), 0 | 2) || line.ends_with(b"\n");
        if self.of("eoi") == 0 && !line_feed {
            return;
        }
        if !device.outbox.is_empty() {
            device.outbox.clear();
            device.status.push(Failure::INTERRUPTED);
        }
        device.receive(line.trim_ascii_end(), at_us, faults);
        if self.of("auto") == 1 {
            self.read(at_us);
        }
    }

    fn read(&mut self, at_us: u64) {
        self.reading = Some(Read {
            device: self.addressed(),
            until_us: at_us + u64::from(self.of("read_tmo_ms")) * 1_000,
        });
    }

    fn command(&mut self, text: &str, at_us: u64, devices: &mut [Device]) -> Option<String> {
        let mut words = text.split_whitespace();
        let name = words.next()?.to_ascii_lowercase();
        let value = words.next();
        let addressed = self.addressed();
        match name.as_str() {
            "read" => self.read(at_us),
            "ver" => return Some("Prologix GPIB-ETHERNET Controller version 01.06.06.00".into()),
            "clr" => addressed.into_iter().for_each(|it| devices[it].clear()),
            "rst" => self.settings = SETTINGS.map(|(.., first)| first),
            "spoll" => {
                let device = &devices[addressed?];
                return Some(device.status.byte(!device.outbox.is_empty()).to_string());
            }
            "srq" => {
                let asks = |number: &usize| devices[*number].status.byte(false) & 1 << 6 != 0;
                return Some(u8::from(self.instruments.values().any(asks)).to_string());
            }
            "trg" => {
                let none = &mut InstrumentFaults::none(0);
                addressed
                    .into_iter()
                    .for_each(|it| devices[it].receive(b"*TRG", at_us, none));
            }
            "ifc" | "loc" | "llo" | "help" | "lon" | "status" => {}
            name => return self.setting(name, value),
        }
        None
    }

    /// Sets a setting to a value within its range and ignores a value outside; without a value, returns the present
    /// one.
    fn setting(&mut self, name: &str, value: Option<&str>) -> Option<String> {
        let Some(index) = SETTINGS.iter().position(|it| it.0 == name) else {
            return Some("Unrecognized command".into());
        };
        let (_, least, most, _) = SETTINGS[index];
        let Some(value) = value else {
            return Some(self.settings[index].to_string());
        };
        let fits = value.parse().ok().filter(|it| (least..=most).contains(it));
        self.settings[index] = fits.unwrap_or(self.settings[index]);
        None
    }
}
