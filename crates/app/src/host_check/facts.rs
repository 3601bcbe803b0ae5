//! Facts about the computer that may delay the rig, parsed from files of the kernel.

use super::cpu_time::CpuTime;
use std::path::PathBuf;

/// State of the computer that may delay the rig.
#[derive(Debug, Default)]
pub struct Facts {
    /// Path of this program.
    pub program: PathBuf,
    /// True when the rig's thread runs under SCHED_FIFO.
    pub is_fifo: bool,
    /// True when the memory of the program is locked.
    pub memory_locked: bool,
    /// Limit of locked memory, bytes; `None` without a limit.
    pub memory_limit: Option<u64>,
    /// Governor of each CPU with frequency scaling.
    pub governors: Vec<String>,
    /// Preemption of the kernel; `None` when unknown.
    pub preemption: Option<Preemption>,
    /// Share of each period that threads under SCHED_FIFO may run; `None` when unknown.
    pub real_time_share: Option<RealTimeShare>,
    /// True on a virtual machine whose CPU flags name a hypervisor.
    pub is_virtual: bool,
    /// Time of the CPUs during the test.
    pub cpu_time: CpuTime,
}

/// Places in the kernel where a thread of higher priority may interrupt the kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preemption {
    /// Nearly everywhere (PREEMPT_RT).
    RealTime,
    /// Outside sections under a lock.
    Full,
    /// Only at chosen places.
    Absent,
}

impl Preemption {
    /// Reads `/proc/version` and `/proc/cmdline`.
    pub fn parse(version: &str, command_line: &str) -> Self {
        let mut words = command_line.split_whitespace();
        let is_switched_off = words.any(|it| ["preempt=none", "preempt=voluntary"].contains(&it));
        match (version.contains("PREEMPT_RT"), version.contains("PREEMPT")) {
            (true, _) => Self::RealTime,
            (false, true) if !is_switched_off => Self::Full,
            (false, _) => Self::Absent,
        }
    }
}

/// Time that threads under SCHED_FIFO may run in each period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RealTimeShare {
    /// `kernel.sched_rt_runtime_us`; negative without a limit.
    pub runtime_us: i64,
    /// `kernel.sched_rt_period_us`.
    pub period_us: i64,
}

impl RealTimeShare {
    /// Returns true when the share is unlimited or at least 95 %, as in a usual kernel.
    pub fn is_enough(self) -> bool {
        self.runtime_us < 0 || 100 * self.runtime_us >= 95 * self.period_us
    }
}

/// Returns true when `/proc/cpuinfo` names a hypervisor among the flags of a CPU.
pub fn is_virtual(cpu_info: &str) -> bool {
    let mut flags = cpu_info.lines().filter(|line| line.starts_with("flags"));
    flags.any(|line| line.split_whitespace().any(|flag| flag == "hypervisor"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preemption_follows_version_and_command_line() {
        let table = [
            ("#1 SMP PREEMPT_RT Debian", "quiet", Preemption::RealTime),
            ("#1 SMP PREEMPT_DYNAMIC", "quiet", Preemption::Full),
            (
                "#1 SMP PREEMPT_DYNAMIC",
                "quiet preempt=voluntary",
                Preemption::Absent,
            ),
            ("#1 SMP PREEMPT_DYNAMIC", "preempt=full", Preemption::Full),
            ("#60-Ubuntu SMP", "quiet", Preemption::Absent),
        ];
        for (version, command_line, expected) in table {
            let found = Preemption::parse(version, command_line);
            assert_eq!(found, expected, "{version} {command_line}");
        }
    }

    #[test]
    fn a_hypervisor_is_a_flag_of_its_own() {
        assert!(is_virtual("model : 1\nflags\t: fpu hypervisor lahf_lm\n"));
        assert!(!is_virtual("model : hypervisor\nflags\t: fpu lahf_lm\n"));
        assert!(!is_virtual(""));
    }
}
