//! What to change on a computer, from what a look at it found.

use super::facts::{Access, Facts, PortFacts, Preemption};
use super::verdict::{EMERGENCY_STOP, Verdict};
use crate::real_time::PRIORITY;
use serde::Serialize;
use std::fmt::{self, Display};

/// One thing to change.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Advice {
    /// What was looked at.
    pub subject: String,
    /// What it is.
    pub found: String,
    /// What it should be.
    pub expected: String,
    /// What to do.
    pub remedy: String,
}

impl Display for Advice {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            subject,
            found,
            expected,
            remedy,
        } = self;
        write!(
            out,
            "{subject}: found {found}, expected {expected}. {remedy}."
        )
    }
}

fn advice(
    subject: impl Display,
    found: impl Display,
    expected: impl Display,
    remedy: impl Display,
) -> Advice {
    Advice {
        subject: subject.to_string(),
        found: found.to_string(),
        expected: expected.to_string(),
        remedy: remedy.to_string(),
    }
}

/// Returns what to change, the most effective first; empty when everything is as expected.
pub fn advise(facts: &Facts, verdict: &Verdict) -> Vec<Advice> {
    let causes = [
        fifo(facts),
        memory(facts),
        stolen(facts, verdict),
        kernel(facts),
        real_time_share(facts),
        governor(facts),
    ];
    let mut all: Vec<Advice> = causes.into_iter().flatten().collect();
    if all.is_empty() {
        all.extend(unexplained(facts, verdict));
    }
    all.extend(
        facts
            .ports
            .iter()
            .flat_map(|it| [permission(it), timer(it)].into_iter().flatten()),
    );
    all.extend(demand(facts, verdict));
    all
}

fn stolen(facts: &Facts, verdict: &Verdict) -> Option<Advice> {
    let time = facts.cpu_time;
    let is_suspect = facts.is_virtual && !verdict.is_kept;
    (time.stolen_ms > 0.0 || is_suspect).then(|| {
        advice(
            "hypervisor",
            format_args!(
                "{:.0} ms of CPU time stolen during the test ({:.1} %)",
                time.stolen_ms,
                time.stolen_percent()
            ),
            "none",
            "This is a virtual machine: its host may stop it for 100 ms, whatever the priority, and not every host \
             reports it. Run the rig on real hardware, or give the virtual machine CPUs that no other one uses",
        )
    })
}

fn fifo(facts: &Facts) -> Option<Advice> {
    (!facts.is_fifo).then(|| {
        advice(
            "SCHED_FIFO",
            "no right to it",
            format_args!("priority {PRIORITY}"),
            format_args!(
                "Put AmbientCapabilities=CAP_SYS_NICE into the systemd unit, or run setcap cap_sys_nice=ep {}",
                facts.program.display()
            ),
        )
    })
}

fn memory(facts: &Facts) -> Option<Advice> {
    let limit = facts.memory_limit.map_or_else(
        || "without a limit".to_owned(),
        |bytes| format!("a limit of {} kB", bytes / 1024),
    );
    (!facts.memory_locked).then(|| {
        advice(
            "locked memory",
            format_args!("none, {limit}"),
            "all memory of the program locked (RLIMIT_MEMLOCK)",
            "Put LimitMEMLOCK=infinity into the systemd unit, or memlock unlimited into /etc/security/limits.conf",
        )
    })
}

fn kernel(facts: &Facts) -> Option<Advice> {
    (facts.preemption == Some(Preemption::Absent)).then(|| {
        advice(
            "kernel",
            "no preemption",
            "PREEMPT or PREEMPT_RT",
            "Boot with preempt=full, or install a kernel with PREEMPT_RT",
        )
    })
}

fn real_time_share(facts: &Facts) -> Option<Advice> {
    let share = facts.real_time_share.filter(|it| !it.is_enough())?;
    Some(advice(
        "/proc/sys/kernel/sched_rt_runtime_us",
        format_args!("{} of {} us", share.runtime_us, share.period_us),
        "at least 95 %, or -1",
        "Set it with sysctl -w kernel.sched_rt_runtime_us=950000, for good in /etc/sysctl.d",
    ))
}

fn governor(facts: &Facts) -> Option<Advice> {
    let all = &facts.governors;
    let other: Vec<&String> = all.iter().filter(|it| *it != "performance").collect();
    let first = other.first()?;
    Some(advice(
        "CPU governor",
        format_args!("{first} ({} of {} CPUs)", other.len(), all.len()),
        "performance",
        "Run cpupower frequency-set -g performance, and again after each boot",
    ))
}

/// Advises on lateness that nothing else explains.
fn unexplained(facts: &Facts, verdict: &Verdict) -> Option<Advice> {
    let (found, remedy) = match facts.preemption {
        Some(Preemption::RealTime) => (
            "PREEMPT_RT, and nothing that explains the lateness",
            "Switch off power saving (deep C-states) in the firmware; look for drivers that block a CPU",
        ),
        Some(Preemption::Full | Preemption::Absent) | None => (
            "no PREEMPT_RT, and nothing else that explains the lateness",
            "Install a kernel with PREEMPT_RT, and switch off power saving (deep C-states) in the firmware",
        ),
    };
    (!verdict.is_kept).then(|| advice("kernel and firmware", found, "no late wait", remedy))
}

fn permission(it: &PortFacts) -> Option<Advice> {
    let subject = format_args!("port {} of line {}", it.port, it.line).to_string();
    match it.access {
        Access::Granted => None,
        Access::Denied => Some(advice(
            subject,
            "no permission to open it",
            "permission to read and write",
            "Add the user of the program to the group of the port (dialout on Debian and Ubuntu) and log in again",
        )),
        Access::Missing => Some(advice(
            subject,
            "no such port",
            "a serial port",
            "Plug the converter in, or correct the port in rig.toml",
        )),
    }
}

fn timer(it: &PortFacts) -> Option<Advice> {
    let (file, ms) = it.latency_timer.as_ref().filter(|it| it.1 != 1)?;
    Some(advice(
        format_args!("USB latency timer of {}", it.port),
        format_args!("{ms} ms"),
        "1 ms",
        format_args!(
            "Run echo 1 > {}; for good, a udev rule: ACTION==\"add\", SUBSYSTEM==\"usb-serial\", ATTR{{latency_timer}}=\"1\"",
            file.display()
        ),
    ))
}

/// Advises on the emergency stop, once the program has its real-time rights.
fn demand(facts: &Facts, verdict: &Verdict) -> Option<Advice> {
    let need = verdict.needs.iter().find(|it| it.key == EMERGENCY_STOP)?;
    if need.is_kept || !facts.is_fifo {
        return None;
    }
    Some(advice(
        "safety.estop_reaction_ms in rig.toml",
        format_args!("{:.1} ms left for late waits", need.tolerated_ms),
        format_args!("{:.1} ms", verdict.worst_ms),
        format_args!(
            "If the risk assessment of the plant allows it, accept {} ms; otherwise only a prompter computer helps",
            verdict.reaction_with_lateness_ms
        ),
    ))
}

#[cfg(test)]
mod tests;
