//! Reads the state of the computer from the files of the kernel.

use super::cpu_time::CpuTime;
use super::facts::{Facts, Preemption, RealTimeShare, is_virtual};
use machine::view::HostView;
use rustix::param::clock_ticks_per_second;
use rustix::process::{Resource, getrlimit};
use std::fs;

/// Returns the time of the CPUs since boot; `None` where the kernel does not report it.
pub(super) fn cpu_time() -> Option<CpuTime> {
    let stat = fs::read_to_string("/proc/stat").ok()?;
    CpuTime::parse(&stat, clock_ticks_per_second())
}

/// Reads the state of the computer; `cpu_time` is the CPU time during the test.
pub(super) fn facts(rights: &HostView, cpu_time: CpuTime) -> Facts {
    Facts {
        program: std::env::current_exe().unwrap_or_default(),
        is_fifo: rights.fifo_priority.is_some(),
        memory_locked: rights.memory_locked,
        memory_limit: getrlimit(Resource::Memlock).current,
        governors: governors(),
        preemption: preemption(),
        real_time_share: real_time_share(),
        is_virtual: is_virtual(&fs::read_to_string("/proc/cpuinfo").unwrap_or_default()),
        cpu_time,
    }
}

fn preemption() -> Option<Preemption> {
    let version = fs::read_to_string("/proc/version").ok()?;
    let command_line = fs::read_to_string("/proc/cmdline").ok()?;
    Some(Preemption::parse(&version, &command_line))
}

fn real_time_share() -> Option<RealTimeShare> {
    Some(RealTimeShare {
        runtime_us: number("/proc/sys/kernel/sched_rt_runtime_us")?,
        period_us: number("/proc/sys/kernel/sched_rt_period_us")?,
    })
}

/// Returns the governors of the CPUs; empty without frequency scaling, as on most virtual machines.
fn governors() -> Vec<String> {
    let cpus = fs::read_dir("/sys/devices/system/cpu")
        .into_iter()
        .flatten();
    let files = cpus
        .flatten()
        .map(|cpu| cpu.path().join("cpufreq/scaling_governor"));
    let texts = files.filter_map(|file| fs::read_to_string(file).ok());
    texts.map(|text| text.trim().to_owned()).collect()
}

fn number(file: &str) -> Option<i64> {
    fs::read_to_string(file).ok()?.trim().parse().ok()
}
