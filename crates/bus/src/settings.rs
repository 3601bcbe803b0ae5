//! Settings of a line, and the time-outs computed from them.

use super::outstanding::identification;
use super::{LineLog, Wire};
use dcon::{Address, Command, Common};
use units::Span;

/// Settings of one line. The name of a time ends with its unit.
#[derive(Debug, Clone)]
pub struct LineSettings {
    /// Name of the line, as the wiring gives it.
    pub name: String,
    /// Bits per second (8 data bits, no parity, 1 stop bit).
    pub baud: u32,
    /// True when frames carry checksums. Without them a damaged digit goes unnoticed.
    pub checksum: bool,
    /// Longest time after which a digital module begins its reply. Modules take 2 ms, with `~AARD` up to 30 ms.
    pub digital_allowance_ms: u64,
    /// Longest time after which an analog input begins its reply, because it may be in the middle of a conversion.
    pub analog_allowance_ms: u64,
    /// Longest time after which a module begins its reply while it writes its EEPROM or changes its configuration.
    pub store_allowance_ms: u64,
    /// Time after the time-out during which a late reply may still begin; part of the required silence after trouble.
    pub late_reply_ms: u64,
    /// Pause between a reply and the next request, in times of one character.
    pub turnaround_characters: u8,
    /// Wait before the first attempt to reopen a lost port; it doubles with each failure.
    pub reopen_first_ms: u64,
    /// Longest wait between two attempts to reopen the port.
    pub reopen_longest_ms: u64,
    /// Log of the line: its trace and counts, which others may read.
    pub log: LineLog,
}

impl LineSettings {
    /// Returns settings with checksum and the usual times.
    pub fn new(name: &str, baud: u32) -> Self {
        Self {
            name: name.to_owned(),
            baud,
            checksum: true,
            digital_allowance_ms: 30,
            analog_allowance_ms: 60,
            store_allowance_ms: 100,
            late_reply_ms: 30,
            turnaround_characters: 2,
            reopen_first_ms: 100,
            reopen_longest_ms: 5_000,
            log: LineLog::default(),
        }
    }

    /// Returns the speed of the line, which gives the time of characters on the wire.
    pub fn wire(&self) -> Wire {
        Wire { baud: self.baud }
    }

    /// Returns the pause between a reply and the next request.
    pub fn turnaround(&self) -> Span {
        self.wire().time(usize::from(self.turnaround_characters))
    }

    /// Returns the longest time from the first character of the request to the end of the reply.
    pub fn time_out(&self, command: &Command) -> Span {
        self.request_time(command) + self.reply_limit(command)
    }

    /// Returns the time-out of `command` when its request has `request_characters` characters.
    pub(super) fn time_out_of(&self, command: &Command, request_characters: usize) -> Span {
        self.wire().time(request_characters) + self.reply_limit(command)
    }

    fn reply_limit(&self, command: &Command) -> Span {
        self.longest_reply_time(command) + Span::ms(self.allowance_ms(command))
    }

    /// Returns how long the line must be silent after trouble with `command`.
    pub fn silence(&self, command: &Command) -> Span {
        self.longest_reply_time(command) + Span::ms(self.late_reply_ms)
    }

    /// Returns the time for which the line asks a module for its name after trouble with `command`: as long as the
    /// required silence, and at least one time-out.
    pub(super) fn resynchronisation_limit(&self, command: &Command, address: Address) -> Span {
        self.silence(command)
            .max(self.time_out(&identification(address)))
    }

    /// Returns the time that the request takes on the wire.
    pub fn request_time(&self, command: &Command) -> Span {
        let mut request = Vec::with_capacity(24);
        command.encode(self.checksum, &mut request);
        self.wire().time(request.len())
    }

    fn longest_reply_time(&self, command: &Command) -> Span {
        let checksum = if self.checksum { 2 } else { 0 };
        self.wire().time(command.longest_reply() + checksum)
    }

    fn allowance_ms(&self, command: &Command) -> u64 {
        if command.writes_eeprom() || matches!(command, Command::Common(_, Common::EnterSoftInit)) {
            self.store_allowance_ms
        } else if command.is_analog_input() {
            self.analog_allowance_ms
        } else {
            self.digital_allowance_ms
        }
    }
}

/// Returns the longest time for which one try of any of `commands` can occupy the line; zero without commands. The
/// worst case is a reply that needs confirmation: two answers at the last moment (or three prompt ones), then the
/// request for the module's name and a required silence that is broken once. For a command that writes a setting, this
/// includes reading the setting first. A request with several tries may take this time for each try.
pub fn longest_transaction(settings: &LineSettings, commands: &[Command]) -> Span {
    let one = |command: &Command| match command.address() {
        Some(address) => {
            let exchange = settings.time_out(command) + settings.turnaround();
            let step = settings.resynchronisation_limit(command, address) + settings.turnaround();
            exchange + exchange + step + settings.silence(command)
        }
        None => settings.request_time(command) + settings.turnaround(),
    };
    let longest = |command: &Command| {
        let setting = command.setting().as_ref().map(one);
        one(command) + setting.unwrap_or_default()
    };
    commands.iter().map(longest).max().unwrap_or_default()
}
