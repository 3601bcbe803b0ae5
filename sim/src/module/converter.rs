//! One free-running converter that several inputs share.
//!
//! The enabled channels take turns in channel order. Each conversion integrates the input over its own window of
//! `1/rate`, and its result appears at the end of the window. No request speeds up the scan: a faster line only reads
//! the same result again, and after a change of the world only a reading whose window began after the change is valid.
//! Simpson's rule over start, middle and end computes the integral. A change of the mask lets the running window
//! finish.

use super::Terminals;

/// Scan rate, channel mask and the window in progress.
#[derive(Debug, Clone)]
pub struct Converter {
    channels: u8,
    mask: u8,
    period_us: f64,
    window: Option<Window>,
    /// Start of the present scan rate; the next field counts the windows since then. Window ends stay exact although a
    /// period is not a whole number of microseconds.
    origin_us: u64,
    windows: u64,
}

#[derive(Debug, Clone, Copy)]
struct Window {
    channel: u8,
    begin: f64,
    middle: Option<f64>,
    middle_us: u64,
    end_us: u64,
}

impl Converter {
    /// Creates a stopped converter; [`Converter::start`] starts it.
    pub fn new(channels: u8, mask: u8, per_s: f64) -> Self {
        Self {
            channels,
            mask,
            period_us: 1e6 / per_s,
            window: None,
            origin_us: 0,
            windows: 0,
        }
    }

    /// Returns the enabled channels, bit n = channel n.
    pub fn mask(&self) -> u8 {
        self.mask
    }

    /// Begins a window with the first enabled channel unless a window is running.
    pub fn start(&mut self, at: &mut Terminals<'_>) {
        if self.window.is_none() {
            self.origin_us = at.now_us;
            self.windows = 0;
            self.open(self.channels - 1, at);
        }
    }

    /// Changes the enabled channels; the running window finishes first.
    pub fn enable(&mut self, mask: u8, at: &mut Terminals<'_>) {
        self.mask = mask;
        self.start(at);
    }

    /// Changes the conversions per second from the next window on.
    pub fn set_pace(&mut self, per_s: f64) {
        self.period_us = 1e6 / per_s;
        if let Some(window) = &self.window {
            self.origin_us = window.end_us;
            self.windows = 0;
        }
    }

    /// Returns the instant of the next sample; `u64::MAX` while no channel is enabled.
    pub fn next_us(&self) -> u64 {
        match &self.window {
            None => u64::MAX,
            Some(window) if window.middle.is_none() => window.middle_us,
            Some(window) => window.end_us,
        }
    }

    /// Takes the sample that is due; at the end of a window returns the channel and the mean of its window.
    pub fn run(&mut self, at: &mut Terminals<'_>) -> Option<(u8, f64)> {
        let window = self.window.as_mut()?;
        let sample = at.plant.analog_in(at.module, window.channel);
        let Some(middle) = window.middle else {
            window.middle = Some(sample);
            return None;
        };
        let (channel, mean) = (window.channel, (window.begin + 4.0 * middle + sample) / 6.0);
        self.open(channel, at);
        Some((channel, mean))
    }

    fn open(&mut self, after: u8, at: &mut Terminals<'_>) {
        let next = (1..=self.channels)
            .map(|step| after.wrapping_add(step) % self.channels)
            .find(|channel| self.mask & (1 << channel) != 0);
        self.window = next.map(|channel| {
            self.windows += 1;
            let end_us = self.origin_us + (self.period_us * self.windows as f64).round() as u64;
            Window {
                channel,
                begin: at.plant.analog_in(at.module, channel),
                middle: None,
                middle_us: at.now_us.midpoint(end_us),
                end_us,
            }
        });
    }
}
