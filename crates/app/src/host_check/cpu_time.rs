//! CPU time, and how much of it a hypervisor has given to other machines.

use serde::Serialize;
use std::iter::Sum;

/// Time of all CPUs together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct CpuTime {
    /// Time in any state, idle included, ms.
    pub cpu_ms: f64,
    /// Time during which a CPU had work and the hypervisor did not run it, ms.
    pub stolen_ms: f64,
}

/// Number of fields of the line `cpu` that add up to all time: user, nice, system, idle, iowait, irq, softirq, steal.
/// The fields after them count time of guests, which `user` contains.
const FIELDS: usize = 8;

impl CpuTime {
    /// Reads the time since boot from `/proc/stat`, whose ticks are `ticks_per_s` a second; `None` without a complete
    /// line `cpu`.
    pub fn parse(stat: &str, ticks_per_s: u64) -> Option<Self> {
        let fields = stat.lines().find_map(|line| line.strip_prefix("cpu "))?;
        let ticks = fields.split_whitespace().take(FIELDS).map(str::parse);
        let ticks: Vec<u64> = ticks.collect::<Result<_, _>>().ok()?;
        let stolen = ticks.get(FIELDS - 1)?;
        let ms = |ticks: u64| ticks as f64 * 1e3 / ticks_per_s as f64;
        Some(Self {
            cpu_ms: ms(ticks.iter().sum()),
            stolen_ms: ms(*stolen),
        })
    }

    /// Returns the time between two readings; zero when a reading is missing.
    pub fn between(before: Option<Self>, after: Option<Self>) -> Self {
        let both = before.zip(after);
        both.map_or_else(Self::default, |(before, after)| Self {
            cpu_ms: (after.cpu_ms - before.cpu_ms).max(0.0),
            stolen_ms: (after.stolen_ms - before.stolen_ms).max(0.0),
        })
    }

    /// Returns the stolen share, percent.
    pub fn stolen_percent(&self) -> f64 {
        match self.cpu_ms > 0.0 {
            true => 100.0 * self.stolen_ms / self.cpu_ms,
            false => 0.0,
        }
    }
}

impl Sum for CpuTime {
    fn sum<I: Iterator<Item = Self>>(times: I) -> Self {
        times.fold(Self::default(), |sum, it| Self {
            cpu_ms: sum.cpu_ms + it.cpu_ms,
            stolen_ms: sum.stolen_ms + it.stolen_ms,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stat_is_parsed_in_ticks() {
        let guests = "cpu  100 10 20 300 5 0 5 60 70 80\ncpu0 1 1 1 1 1 1 1 1 1 1\n";
        let table = [
            (guests, Some((5_000.0, 600.0))),
            ("intr 5\ncpu  1 0 0 0 0 0 0 2\n", Some((30.0, 20.0))),
            ("cpu  100 10 20 300 5 0 5\n", None),
            ("cpu  100 10 20 many 5 0 5 60\n", None),
            ("cpu0 1 1 1 1 1 1 1 1\n", None),
            ("", None),
        ];
        for (stat, expected) in table {
            let found = CpuTime::parse(stat, 100).map(|it| (it.cpu_ms, it.stolen_ms));
            assert_eq!(found, expected, "{stat:?}");
        }
    }

    #[test]
    fn stolen_time_is_the_difference_of_two_readings() {
        let at = |cpu_ms, stolen_ms| Some(CpuTime { cpu_ms, stolen_ms });
        let table = [
            (at(1_000.0, 50.0), at(11_000.0, 250.0), (200.0, 2.0)),
            (at(1_000.0, 50.0), at(1_000.0, 50.0), (0.0, 0.0)),
            (None, at(1_000.0, 50.0), (0.0, 0.0)),
        ];
        for (before, after, expected) in table {
            let stolen = CpuTime::between(before, after);
            assert_eq!((stolen.stolen_ms, stolen.stolen_percent()), expected);
        }
    }
}
