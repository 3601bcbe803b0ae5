//! Reads the state of the computer from the files of the kernel. Opens no port: a rig may be running.

use super::cpu_time::CpuTime;
use super::facts::{
    Access, Facts, PortFacts, Preemption, RealTimeShare, is_virtual, latency_timer_file,
};
use machine::rig::wiring::{Line, Wiring};
use machine::view::HostView;
use rustix::fs::{AtFlags, CWD, accessat};
use rustix::io::Errno;
use rustix::param::clock_ticks_per_second;
use rustix::process::{Resource, getrlimit};
use std::fs;
use std::path::Path;
use std::str::FromStr;

/// Returns the time of the CPUs since boot; `None` where the kernel does not say it.
pub(super) fn cpu_time() -> Option<CpuTime> {
    let stat = fs::read_to_string("/proc/stat").ok()?;
    CpuTime::parse(&stat, clock_ticks_per_second())
}

/// Looks at the computer; `cpu_time` is that of the test.
pub(super) fn facts(wiring: &Wiring, rights: &HostView, cpu_time: CpuTime) -> Facts {
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
        ports: wiring.lines.iter().map(port).collect(),
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

fn port(line: &Line) -> PortFacts {
    let path = Path::new(&line.port);
    let device = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let timer = latency_timer_file(&device);
    PortFacts {
        line: line.name.clone(),
        port: line.port.clone(),
        access: access(path),
        latency_timer: timer.and_then(|file| number(&file).map(|ms| (file, ms))),
    }
}

/// Asks the kernel for the permission of this process, without opening the port.
fn access(path: &Path) -> Access {
    let wanted = rustix::fs::Access::READ_OK | rustix::fs::Access::WRITE_OK;
    match accessat(CWD, path, wanted, AtFlags::EACCESS) {
        Ok(()) => Access::Granted,
        Err(Errno::NOENT | Errno::NOTDIR) => Access::Missing,
        Err(_) => Access::Denied,
    }
}

fn number<T: FromStr>(file: impl AsRef<Path>) -> Option<T> {
    fs::read_to_string(file).ok()?.trim().parse().ok()
}
