//! Counts of transactions and latencies of each module, since the start of the line's task.

use super::{Failure, LineError};
use dcon::{Address, Reply};
use std::collections::BTreeMap;
use units::Span;

/// Counts of latencies in classes a quarter of an octave wide, so that a reported percentile is at most 19 % too high.
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
    /// Number of classes: they cover 2^24 us (16 s), and the last one also holds longer latencies.
    const CLASSES: usize = 96;

    /// Counts a latency; one below 1 us counts as 1 us.
    pub fn add(&mut self, latency: Span) {
        let class = (latency.0.max(1) as f64).log2() * 4.0;
        let class = (class as usize).min(Self::CLASSES - 1);
        self.classes[class] = self.classes[class].saturating_add(1);
        self.total += 1;
    }

    /// Returns the number of latencies counted.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// Returns the number of latencies in the classes up to `edge`, exact for an edge that is a power of two.
    pub fn count_up_to(&self, edge: Span) -> u64 {
        let classes = (edge.0.max(1) as f64).log2() * 4.0;
        let classes = (classes.round() as usize).min(Self::CLASSES);
        self.classes[..classes]
            .iter()
            .map(|it| u64::from(*it))
            .sum()
    }

    /// Returns the upper edge of the class that contains the percentile `share` (0 to 1); `None` when nothing was
    /// counted.
    pub fn percentile(&self, share: f64) -> Option<Span> {
        assert!(
            (0.0..=1.0).contains(&share),
            "a percentile between 0 and 1, not {share}"
        );
        let wanted = (self.total as f64 * share).ceil().max(1.0) as u64;
        let mut seen = 0u64;
        let class = self.classes.iter().position(|count| {
            seen += u64::from(*count);
            seen >= wanted
        })?;
        Some(Span(2f64.powf((class + 1) as f64 / 4.0).ceil() as u64))
    }
}

/// Counts and latencies of one module.
#[derive(Debug, Clone, Default)]
pub struct ModuleHealth {
    /// Number of tries, repetitions included.
    pub transactions: u64,
    /// Number of tries without a complete reply in time.
    pub time_outs: u64,
    /// Number of replies with a wrong checksum.
    pub checksum_errors: u64,
    /// Number of replies with any other defect.
    pub other_errors: u64,
    /// Number of replies in which the module refused the command.
    pub refusals: u64,
    /// Number of reads that found the reset status set: the module was powered on, or reset by its own watchdog.
    pub resets: u64,
    /// Latencies of the answered tries: times from the end of the request to the start of the reply, computed as the
    /// duration of the try minus the time on the wire.
    pub latency: Histogram,
}

/// Health of the modules of a line, by address.
#[derive(Debug, Clone, Default)]
pub struct Health {
    modules: BTreeMap<Address, ModuleHealth>,
    /// Number of times that the line lost its port.
    pub ports_lost: u64,
}

impl Health {
    /// Yields the modules that received a request, in order of address.
    pub fn modules(&self) -> impl Iterator<Item = (Address, &ModuleHealth)> {
        self.modules
            .iter()
            .map(|(address, health)| (*address, health))
    }

    /// Returns the health of one module; `None` when it never received a request.
    pub fn module(&self, address: Address) -> Option<&ModuleHealth> {
        self.modules.get(&address)
    }

    pub(super) fn count(
        &mut self,
        address: Address,
        reads_reset: bool,
        outcome: &Result<Reply, LineError>,
        latency: Span,
    ) {
        let module = self.modules.entry(address).or_default();
        module.transactions += 1;
        match outcome {
            Ok(reply) => {
                module.latency.add(latency);
                if reads_reset && *reply == Reply::Flag(true) {
                    module.resets += 1;
                }
            }
            Err(error) => match &error.failure {
                Failure::Reply(reason) if reason.is_answer() => module.refusals += 1,
                Failure::Reply(reason) if reason.is_checksum() => module.checksum_errors += 1,
                Failure::TimeOut(_) => module.time_outs += 1,
                Failure::PortLost(_) => self.ports_lost += 1,
                Failure::Reply(_)
                | Failure::Echo
                | Failure::SecondReply
                | Failure::OutOfStep
                | Failure::Contradicted
                | Failure::NeverSilent => module.other_errors += 1,
            },
        }
    }
}
