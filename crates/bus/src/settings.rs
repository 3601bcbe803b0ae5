//! What a line must be told, and how long it may take.

use super::owing::question;
use super::{LineLog, Wire};
use dcon::{Address, Command, Common};
use units::Span;

/// Settings of one line. Every time is a length, in the unit its name ends in.
#[derive(Debug, Clone)]
pub struct LineSettings {
    /// Name of the line, as in the wiring.
    pub name: String,
    /// Bits per second, 8N1.
    pub baud: u32,
    /// Frames carry checksums. Without them a damaged digit is believed.
    pub checksum: bool,
    /// What a module may think before it answers; modules take 2 ms, `~AARD` up to 30.
    pub digital_allowance_ms: u64,
    /// The same for analog inputs, which may be in a conversion.
    pub analog_allowance_ms: u64,
    /// The same where a module writes its EEPROM or changes its configuration.
    pub store_allowance_ms: u64,
    /// Grace beyond the time-out in which a late reply may still begin; added to the silence after trouble.
    pub late_reply_ms: u64,
    /// Rest between a reply and the next request, in characters.
    pub turnaround_characters: u8,
    /// First wait before a lost port is opened again; doubles with each failure.
    pub reopen_first_ms: u64,
    /// Longest such wait.
    pub reopen_longest_ms: u64,
    /// Where bytes and counts are kept; shared with whoever shows them.
    pub log: LineLog,
}

impl LineSettings {
    /// With the usual times, an 8N1 line with checksum.
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

    /// Time of characters on this line.
    pub fn wire(&self) -> Wire {
        Wire { baud: self.baud }
    }

    /// Rest between frames.
    pub fn turnaround(&self) -> Span {
        self.wire().time(usize::from(self.turnaround_characters))
    }

    /// From the first character of the request to the last moment at which the reply may be whole.
    pub fn time_out(&self, command: &Command) -> Span {
        self.request_time(command) + self.reply_limit(command)
    }

    /// The same for a request whose length is known.
    pub(super) fn time_out_of(&self, command: &Command, request_characters: usize) -> Span {
        self.wire().time(request_characters) + self.reply_limit(command)
    }

    fn reply_limit(&self, command: &Command) -> Span {
        self.longest_reply_time(command) + Span::ms(self.allowance_ms(command))
    }

    /// How long the line must have been silent after trouble.
    pub fn silence(&self, command: &Command) -> Span {
        self.longest_reply_time(command) + Span::ms(self.late_reply_ms)
    }

    /// How long a module is asked who it is, after trouble with `command`: once at least, and for as long as the
    /// silence would last.
    pub(super) fn step_limit(&self, command: &Command, address: Address) -> Span {
        self.silence(command).max(self.time_out(&question(address)))
    }

    /// Time of the request on the wire.
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

/// The longest that one try of any of `commands` can hold the line, given up or believed only after it was said
/// again: two answers at the last moment (or three that are prompt), then the way back into step and a silence that is
/// broken once. What writes a setting asks for it first. A request that allows several tries may take as many times this.
/// Zero for no commands.
pub fn longest_transaction(settings: &LineSettings, commands: &[Command]) -> Span {
    let one = |command: &Command| match command.address() {
        Some(address) => {
            let asked = settings.time_out(command) + settings.turnaround();
            let step = settings.step_limit(command, address) + settings.turnaround();
            asked + asked + step + settings.silence(command)
        }
        None => settings.request_time(command) + settings.turnaround(),
    };
    let longest = |command: &Command| {
        let setting = command.setting().as_ref().map(one);
        one(command) + setting.unwrap_or_default()
    };
    commands.iter().map(longest).max().unwrap_or_default()
}
