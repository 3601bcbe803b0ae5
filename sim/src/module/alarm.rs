//! Alarms of the counter module; an alarm that is on controls the digital outputs instead of the host.
//!
//! | request | mode 0: a limit per counter | mode 1: two limits on counter 0 |
//! |---|---|---|
//! | `~AAAS` | S = 0 | S = 1 (factory setting of the 7080D) |
//! | `~AAA` | `!AA0` | `!AA1`; the manuals lack this request, but a vendor's library sends it |
//! | `@AADI` | `!AAS0D00`, S: bit n for the alarm of counter n | S: 0 off, 1 momentary, 2 latched |
//! | `@AAPA(8 hex)`, `@AARP` | limit of counter 0 | high limit, output 0 |
//! | `@AASA(8 hex)`, `@AARA` | limit of counter 1 | high-high limit, output 1 |
//! | `@AAEAN`, `@AADAN` | alarm of counter N on, off | refused |
//! | `@AAEAM`, `@AAEAL`, `@AADA` | refused | momentary, latched, off |
//! | `@AACA` | refused | clears a latched alarm; it returns when its counter reaches the limit again |
//!
//! An output is on while its counter is at its limit or above; a latched output stays on.

/// Assignment of alarms to counters, with their state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    PerCounter { on: [bool; 2] },
    TwoLimits(Kind),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Off,
    Momentary,
    Latched,
}

/// Effect of an alarm command.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum CommandEffect {
    /// The command changed a setting that survives a power loss.
    Stored,
    /// The command changed a volatile state.
    Done,
    /// The command read this limit.
    Limit(u32),
    /// The command belongs to the other mode.
    Refused,
    /// The command does not exist.
    Unknown,
}

/// Mode, limits and latches of the alarms.
#[derive(Debug, Clone)]
pub(super) struct Alarm {
    mode: Mode,
    limits: [u32; 2],
    latched: u8,
}

impl Alarm {
    /// Creates alarms that are off; `two_limits` selects mode 1, the factory setting of some models.
    pub(super) fn new(two_limits: bool) -> Self {
        let mode = if two_limits {
            Mode::TwoLimits(Kind::Off)
        } else {
            Mode::PerCounter { on: [false; 2] }
        };
        Self {
            mode,
            limits: [u32::MAX; 2],
            latched: 0,
        }
    }

    /// Returns the digit that answers `~AAA`: 0 for a limit per counter, 1 for two limits on counter 0.
    pub(super) fn mode(&self) -> u8 {
        match self.mode {
            Mode::PerCounter { .. } => 0,
            Mode::TwoLimits(_) => 1,
        }
    }

    /// Returns digit S of the reply to `@AADI`: in mode 0, bit n is set while the alarm of counter n is on; in mode 1,
    /// S is 0 for off, 1 for momentary, 2 for latched.
    pub(super) fn state(&self) -> u8 {
        match self.mode {
            Mode::PerCounter {
                on: [first, second],
            } => u8::from(first) | u8::from(second) << 1,
            Mode::TwoLimits(Kind::Off) => 0,
            Mode::TwoLimits(Kind::Momentary) => 1,
            Mode::TwoLimits(Kind::Latched) => 2,
        }
    }

    /// Checks whether the alarms control the outputs, so that the host may not write them.
    pub(super) fn owns_outputs(&self) -> bool {
        self.state() != 0
    }

    /// Returns the outputs from the word of the host and the present counts; updates the latches.
    pub(super) fn outputs(&mut self, host: u8, values: [u64; 2]) -> u8 {
        let reached = |value: u64, limit: usize| value >= u64::from(self.limits[limit]);
        match self.mode {
            Mode::PerCounter { on } => (0..2).fold(0, |outputs, n| {
                let host = host & 1 << n;
                let own = u8::from(reached(values[n], n)) << n;
                outputs | if on[n] { own } else { host }
            }),
            Mode::TwoLimits(Kind::Off) => host,
            Mode::TwoLimits(kind) => {
                let now = u8::from(reached(values[0], 0)) | u8::from(reached(values[0], 1)) << 1;
                self.latched = if kind == Kind::Latched {
                    self.latched | now
                } else {
                    now
                };
                self.latched
            }
        }
    }

    /// Changes the mode (`~AAAS`) and switches every alarm off.
    pub(super) fn set_mode(&mut self, two_limits: bool) {
        let limits = self.limits;
        *self = Self {
            limits,
            ..Self::new(two_limits)
        };
    }

    /// Carries out the body of a request that begins with `@`.
    pub(super) fn command(&mut self, body: &[u8]) -> CommandEffect {
        match (body, &mut self.mode) {
            ([b'E', b'A', n @ (b'0' | b'1')], Mode::PerCounter { on }) => {
                on[usize::from(n - b'0')] = true;
                CommandEffect::Stored
            }
            ([b'D', b'A', n @ (b'0' | b'1')], Mode::PerCounter { on }) => {
                on[usize::from(n - b'0')] = false;
                CommandEffect::Stored
            }
            (b"EAM", Mode::TwoLimits(kind)) => turn(kind, Kind::Momentary),
            (b"EAL", Mode::TwoLimits(kind)) => turn(kind, Kind::Latched),
            (b"DA", Mode::TwoLimits(kind)) => turn(kind, Kind::Off),
            (b"CA", Mode::TwoLimits(_)) => {
                self.latched = 0;
                CommandEffect::Done
            }
            ([b'E' | b'D', b'A', b'0' | b'1'] | b"EAM" | b"EAL" | b"DA" | b"CA", _) => {
                CommandEffect::Refused
            }
            (b"RP", _) => CommandEffect::Limit(self.limits[0]),
            (b"RA", _) => CommandEffect::Limit(self.limits[1]),
            ([b'P', b'A', digits @ ..], _) => self.limit(0, digits),
            ([b'S', b'A', digits @ ..], _) => self.limit(1, digits),
            (_, _) => CommandEffect::Unknown,
        }
    }

    fn limit(&mut self, n: usize, digits: &[u8]) -> CommandEffect {
        match crate::dcon::hex(digits) {
            Some(limit) if digits.len() == 8 => {
                self.limits[n] = limit;
                CommandEffect::Stored
            }
            _ => CommandEffect::Unknown,
        }
    }
}

fn turn(kind: &mut Kind, to: Kind) -> CommandEffect {
    *kind = to;
    CommandEffect::Stored
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_alarm_leaves_the_other_output_to_the_host() {
        let mut alarm = Alarm::new(false);
        assert_eq!(alarm.command(b"PA00000064"), CommandEffect::Stored);
        assert_eq!(alarm.outputs(0b11, [500, 500]), 0b11);
        assert_eq!(alarm.command(b"EA0"), CommandEffect::Stored);
        assert_eq!(alarm.outputs(0b10, [99, 500]), 0b10);
        assert_eq!(alarm.outputs(0b10, [100, 500]), 0b11);
        assert_eq!(alarm.command(b"EAL"), CommandEffect::Refused);
    }

    #[test]
    fn a_latched_alarm_holds_and_a_momentary_ends() {
        let mut alarm = Alarm::new(true);
        for command in [&b"PA00000064"[..], b"SA000000C8", b"EAL"] {
            assert_eq!(alarm.command(command), CommandEffect::Stored);
        }
        assert_eq!(alarm.outputs(0, [150, 0]), 0b01);
        assert_eq!(alarm.outputs(0, [200, 0]), 0b11);
        assert_eq!(alarm.outputs(0, [0, 0]), 0b11);
        assert_eq!(alarm.command(b"CA"), CommandEffect::Done);
        assert_eq!(alarm.outputs(0, [0, 0]), 0);
        assert_eq!(alarm.command(b"EAM"), CommandEffect::Stored);
        assert_eq!(
            (alarm.outputs(0, [150, 0]), alarm.outputs(0, [0, 0])),
            (1, 0)
        );
        assert_eq!(alarm.command(b"RA"), CommandEffect::Limit(200));
        assert_eq!(alarm.command(b"EA0"), CommandEffect::Refused);
    }
}
