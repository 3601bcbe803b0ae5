//! Common part of every module: address, configuration word, name, firmware, INIT* terminal, watchdog, EEPROM,
//! and their commands.
//!
//! | request | reply |
//! |---|---|
//! | `$AA2` | `!AATTCCFF` as stored |
//! | `$AA5` | `!AAS`, S = 1 on the first read after a reset; on the I-7080, `$AA5N` reads the state of counter N |
//! | `$AAF`, `$AAM`, `~AAO(name)` | read firmware, read name, write name of up to 6 characters |
//! | `$AAI` | `!AA0` with INIT* grounded, else `!AA1` |
//! | `%AANNTTCCFF` | `!NN`; baud and checksum bit need INIT* and take effect at the next power-on |
//! | `~AA0`..`~AA3` | host watchdog |
//! | `~AARD`, `~AARDVV` | read, write response delay; newer modules only |
//! | `~AATnn`, `~AAI` | soft INIT, newer modules: for nn seconds after `~AAI`, `%` may change baud and checksum |
//! | `$AAP` | `!AA0`: DCON, newer modules |
//!
//! A module with INIT* grounded at power-on answers at address 00 (and at its own) without checksum; its replies
//! contain the stored address.

use super::setting;
use super::watchdog::Watchdog;
use crate::config::ConfigError;
use crate::dcon::{self, Answer, Request};
use crate::table::Table;
use crate::terminal::ModuleSpec;

/// Bit of FF that enables the checksum.
const CHECKSUM: u8 = 0x40;

/// Longest response delay, milliseconds.
const LONGEST_DELAY_MS: u8 = 30;

/// Baud rates, bits per second, in the order of their codes from 03.
pub(super) const BAUDS: [u32; 8] = [1200, 2400, 4800, 9600, 19200, 38400, 57600, 115_200];

/// Baud rate of a module with INIT* grounded, bits per second, whatever rate it stores.
const INIT_BAUD: u32 = 9_600;

/// Settings of a line that its modules take over at commissioning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Commissioning {
    /// Baud rate of the line.
    pub baud: u32,
    /// True when the line uses checksums.
    pub checksum: bool,
    /// Time-out of an enabled host watchdog, milliseconds.
    pub host_watchdog_ms: f64,
}

/// Registers and commands that every family shares.
#[derive(Debug, Clone)]
pub struct ModuleBase {
    /// Stored address, valid on the line unless INIT* is grounded.
    pub address: u8,
    /// Type code TT.
    pub type_code: u8,
    /// Baud code CC.
    pub baud_code: u8,
    /// Format word FF.
    pub format: u8,
    /// Host watchdog.
    pub watchdog: Watchdog,
    /// Writes to the EEPROM so far.
    pub eeprom_writes: u64,
    name: String,
    firmware: String,
    newer: bool,
    response_delay_ms: u8,
    /// Duration of the soft INIT window, 0 to 60 s; 0 at power-on.
    soft_init_s: u8,
    soft_init_until_us: u64,
    init_grounded: bool,
    checksum_running: bool,
    baud_running: u32,
    reset_unread: bool,
    /// Constant input signals of a bench file, by channel from 0: V, mA or degrees Celsius, or level 0 or 1; NaN or a
    /// missing value is an open terminal. Empty in a rig.
    pub inputs: Vec<f64>,
}

impl ModuleBase {
    /// Creates the common part from the module's table; `family_bits` are the bits of FF that the family sets.
    pub fn new(
        spec: &ModuleSpec,
        line: Commissioning,
        type_code: u8,
        family_bits: u8,
    ) -> Result<Self, ConfigError> {
        let keys = &spec.settings;
        let checksum = keys.get_or("checksum", line.checksum)?;
        let format = family_bits | if checksum { CHECKSUM } else { 0 };
        let longest_ms = f64::from(LONGEST_DELAY_MS);
        let delay_ms = setting::number(keys, "response_delay_ms", 0.0..=longest_ms)?;
        Ok(Self {
            address: spec.address,
            type_code,
            baud_code: baud_code(line.baud).unwrap_or(0x0A),
            format,
            watchdog: watchdog(keys, line.host_watchdog_ms)?,
            eeprom_writes: 0,
            name: name(spec)?,
            firmware: keys.get_or("firmware", "A2.0".into())?,
            newer: spec.model.starts_with("M-") || delay_ms.is_some(),
            response_delay_ms: delay_ms.unwrap_or(0.0) as u8,
            soft_init_s: 0,
            soft_init_until_us: 0,
            init_grounded: keys.get_or("init", false)?,
            checksum_running: checksum,
            baud_running: line.baud,
            reset_unread: !keys.get_or("reset_seen", false)?,
            inputs: Vec::new(),
        })
    }

    /// Checks whether the module answers at this address.
    pub fn is_addressed_by(&self, address: u8) -> bool {
        address == self.address || (self.init_grounded && address == 0)
    }

    /// Checks whether requests and replies carry a checksum.
    pub fn uses_checksum(&self) -> bool {
        self.checksum_running && !self.init_grounded
    }

    /// Returns the bits per second at which the module listens and answers.
    pub fn baud(&self) -> u32 {
        if self.init_grounded {
            INIT_BAUD
        } else {
            self.baud_running
        }
    }

    /// Checks whether the firmware knows the commands of newer modules.
    pub fn is_newer(&self) -> bool {
        self.newer
    }

    /// Returns the delay added to every reply, microseconds.
    pub fn response_delay_us(&self) -> u64 {
        u64::from(self.response_delay_ms) * 1_000
    }

    /// Records a restart: `$AA5` reports it, and settings that need a power cycle take effect.
    pub fn power_cycled(&mut self) {
        self.reset_unread = true;
        self.soft_init_s = 0;
        self.soft_init_until_us = 0;
        self.checksum_running = self.format & CHECKSUM != 0;
        self.baud_running = BAUDS[usize::from(self.baud_code) - 3];
    }

    /// Simulates another product (a fault): other name, type 00.
    pub fn replace_product(&mut self, name: &str) {
        self.name = name.into();
        self.type_code = 0;
    }

    /// Carries out the commands that every module knows; `fits` checks whether the family accepts a type code and a
    /// format.
    pub fn answer(
        &mut self,
        request: &Request<'_>,
        now_us: u64,
        fits: impl Fn(u8, u8) -> bool,
    ) -> Answer {
        let address = self.address;
        match (request.lead, request.body) {
            (b'$', b"2") => dcon::done_hex(address, self.configuration_word(), 6),
            (b'$', b"5") => {
                let unread = std::mem::take(&mut self.reset_unread);
                dcon::done_hex(address, u64::from(unread), 1)
            }
            (b'$', b"F") => dcon::done_data(address, &self.firmware),
            (b'$', b"M") => dcon::done_data(address, &self.name),
            (b'$', b"I") => dcon::done_hex(address, u64::from(!self.init_grounded), 1),
            (b'$', b"P") if self.newer => dcon::done_hex(address, 0, 1),
            // Modbus is not simulated: the module accepts DCON only.
            (b'$', b"P0") if self.newer && self.init_grounded => dcon::done(address),
            (b'$', [b'P', b'0' | b'1']) if self.newer => dcon::refused(address),
            (b'%', body) => self.configure(body, now_us, fits),
            (b'~', [b'T', high, low]) if self.newer => match dcon::hex_byte(&[*high, *low]) {
                Some(seconds @ 0..=60) => {
                    self.soft_init_s = seconds;
                    dcon::done(address)
                }
                Some(_) => dcon::refused(address),
                None => Answer::Unknown,
            },
            (b'~', b"I") if self.newer => {
                self.soft_init_until_us = now_us + u64::from(self.soft_init_s) * 1_000_000;
                dcon::done(address)
            }
            (b'~', [b'O', name @ ..]) => self.rename(name),
            (b'~', [b'R', b'D', delay @ ..]) if self.newer => self.response_delay(delay),
            (b'~', body) => self.host_watchdog(body, now_us),
            (_, _) => Answer::Unknown,
        }
    }

    fn configuration_word(&self) -> u64 {
        u64::from(self.type_code) << 16 | u64::from(self.baud_code) << 8 | u64::from(self.format)
    }

    fn configure(&mut self, body: &[u8], now_us: u64, fits: impl Fn(u8, u8) -> bool) -> Answer {
        let (Some(word), 8) = (dcon::hex(body), body.len()) else {
            return Answer::Unknown;
        };
        let [address, type_code, baud_code, format] = word.to_be_bytes();
        let line_changes = baud_code != self.baud_code || (format ^ self.format) & CHECKSUM != 0;
        let known_baud = (0x03..=0x0A).contains(&baud_code);
        let may_change_line = self.init_grounded || now_us < self.soft_init_until_us;
        if (line_changes && !may_change_line) || !known_baud || !fits(type_code, format) {
            return dcon::refused(self.address);
        }
        self.eeprom_writes += 1;
        self.address = address;
        self.type_code = type_code;
        self.baud_code = baud_code;
        self.format = format;
        dcon::done(address)
    }

    fn rename(&mut self, name: &[u8]) -> Answer {
        match std::str::from_utf8(name) {
            Ok(name) if (1..=6).contains(&name.len()) => {
                self.name = name.into();
                self.eeprom_writes += 1;
                dcon::done(self.address)
            }
            _ => Answer::Unknown,
        }
    }

    fn response_delay(&mut self, digits: &[u8]) -> Answer {
        if digits.is_empty() {
            return dcon::done_hex(self.address, u64::from(self.response_delay_ms), 2);
        }
        match dcon::hex_byte(digits) {
            Some(delay) if delay <= LONGEST_DELAY_MS => {
                self.response_delay_ms = delay;
                dcon::done(self.address)
            }
            Some(_) => dcon::refused(self.address),
            None => Answer::Unknown,
        }
    }

    fn host_watchdog(&mut self, body: &[u8], now_us: u64) -> Answer {
        match body {
            b"0" => dcon::done_hex(self.address, u64::from(self.watchdog.status()), 2),
            b"1" => {
                self.watchdog.clear();
                self.eeprom_writes += 1;
                dcon::done(self.address)
            }
            b"2" => {
                let (enabled, tenths) = self.watchdog.setting();
                let word = u64::from(enabled) << 8 | u64::from(tenths);
                dcon::done_hex(self.address, word, 3)
            }
            [b'3', enable @ (b'0' | b'1'), high, low] => {
                match (dcon::hex_byte(&[*high, *low]), *enable == b'1') {
                    (None, _) => Answer::Unknown,
                    (Some(0), true) => dcon::refused(self.address),
                    (Some(tenths), enabled) => {
                        self.watchdog.set(enabled, tenths, now_us);
                        self.eeprom_writes += 1;
                        dcon::done(self.address)
                    }
                }
            }
            _ => Answer::Unknown,
        }
    }
}

/// Returns the CC code of a baud rate.
fn baud_code(baud: u32) -> Option<u8> {
    let place = BAUDS.iter().position(|known| *known == baud)?;
    u8::try_from(place).ok().map(|place| place + 3)
}

fn name(spec: &ModuleSpec) -> Result<String, ConfigError> {
    let printed = spec.model.trim_start_matches("I-").trim_start_matches("M-");
    let form = "text of 1 to 6 characters";
    let fits = |name: &&str| (1..=6).contains(&name.len()) && name.is_ascii();
    let name = spec
        .settings
        .fit("name", form, |entry| entry.text().filter(fits))?;
    Ok(name.unwrap_or(printed).into())
}

/// Reads the key `watchdog`: true, false, or a table of `enabled`, `timeout_s` and `tripped`. Without the key the
/// watchdog is off; without `timeout_s` its time-out is `plant_ms`, that of the line. Fails on any other value.
fn watchdog(keys: &Table, plant_ms: f64) -> Result<Watchdog, ConfigError> {
    let tenths_of = |seconds: f64| (seconds * 10.0).round().clamp(1.0, 255.0) as u8;
    let plant_s = plant_ms / 1e3;
    let with = |enabled, timeout_s, tripped| Watchdog::new(enabled, tenths_of(timeout_s), tripped);
    let Some(entry) = keys.find("watchdog") else {
        return Ok(with(false, plant_s, false));
    };
    if let Some(enabled) = entry.flag() {
        return Ok(with(enabled, plant_s, false));
    }
    let own = entry
        .table()
        .map_err(|_| entry.wrong("true, false or a table"))?;
    let timeout_s = setting::number(own, "timeout_s", 0.1..=25.5)?;
    let watchdog = with(
        own.get_or("enabled", false)?,
        timeout_s.unwrap_or(plant_s),
        own.get_or("tripped", false)?,
    );
    own.finish()?;
    Ok(watchdog)
}
