//! How the modules of a line are doing: counts and latencies since the start.

use super::LineError;
use dcon::{Address, Reply, ReplyError};
use std::collections::BTreeMap;
use units::Span;

/// Latencies in classes of a quarter octave: a percentile is right within 19 %.
#[derive(Debug, Clone)]
pub struct Histogram {
    classes: [u32; Histogram::CLASSES],
    total: u64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            classes: [0; Self::CLASSES],
            total: 0,
        }
    }
}

impl Histogram {
    /// Up to 2^24 us, 16 s; longer ones fall into the last class.
    const CLASSES: usize = 96;

    pub(super) fn add(&mut self, latency: Span) {
        let class = (latency.0.max(1) as f64).log2() * 4.0;
        let class = (class as usize).min(Self::CLASSES - 1);
        self.classes[class] = self.classes[class].saturating_add(1);
        self.total += 1;
    }

    /// Upper edge of the class that holds the share `share` (0 to 1) of all; none before the first.
    pub fn percentile(&self, share: f64) -> Option<Span> {
        assert!((0.0..=1.0).contains(&share), "no share: {share}");
        let wanted = (self.total as f64 * share).ceil().max(1.0) as u64;
        let mut seen = 0u64;
        let class = self.classes.iter().position(|count| {
            seen += u64::from(*count);
            seen >= wanted
        })?;
        Some(Span(2f64.powf((class + 1) as f64 / 4.0).ceil() as u64))
    }
}

/// One module.
#[derive(Debug, Clone, Default)]
pub struct ModuleHealth {
    /// Tries, repeats included.
    pub transactions: u64,
    /// Tries without a whole reply in time.
    pub time_outs: u64,
    /// Replies whose characters did not add up.
    pub checksum_errors: u64,
    /// Replies that were wrong in another way.
    pub other_errors: u64,
    /// Answers that said no.
    pub refusals: u64,
    /// Reset status found set: power-on and resets by the module's own watchdog.
    pub resets: u64,
    /// From the end of the request to the beginning of the reply; wire time left out.
    pub latency: Histogram,
}

/// The modules of a line by address.
#[derive(Debug, Clone, Default)]
pub struct Health {
    modules: BTreeMap<Address, ModuleHealth>,
    /// Times that the port was lost.
    pub ports_lost: u64,
}

impl Health {
    /// In order of addresses; only modules that were asked.
    pub fn modules(&self) -> impl Iterator<Item = (Address, &ModuleHealth)> {
        self.modules
            .iter()
            .map(|(address, health)| (*address, health))
    }

    /// None when the module was never asked.
    pub fn module(&self, address: Address) -> Option<&ModuleHealth> {
        self.modules.get(&address)
    }

    pub(super) fn count(
        &mut self,
        address: Address,
        asked_reset: bool,
        outcome: &Result<Reply, LineError>,
        latency: Span,
    ) {
        let module = self.modules.entry(address).or_default();
        module.transactions += 1;
        match outcome {
            Ok(reply) => {
                module.latency.add(latency);
                if asked_reset && *reply == Reply::Flag(true) {
                    module.resets += 1;
                }
            }
            Err(LineError::Reply { reason, .. }) if reason.is_answer() => module.refusals += 1,
            Err(LineError::Reply { reason, .. }) if ReplyError::is_checksum(*reason) => {
                module.checksum_errors += 1
            }
            Err(LineError::TimeOut { .. }) => module.time_outs += 1,
            Err(LineError::PortLost { .. }) => self.ports_lost += 1,
            Err(
                LineError::Reply { .. }
                | LineError::Echo { .. }
                | LineError::SecondReply { .. }
                | LineError::OutOfStep { .. }
                | LineError::Contradicted { .. }
                | LineError::NeverSilent { .. },
            ) => module.other_errors += 1,
        }
    }
}
