//! Advice: causes of late waits that this computer shows, each with the change that removes it.

use super::facts::{Facts, Preemption};
use super::verdict::{EMERGENCY_STOP, Verdict};
use crate::doctor::finding::{Check, Finding, Subject};
use crate::real_time::PRIORITY;

/// Returns the warning that `subject` delays the rig.
fn late(
    subject: &str,
    found: impl ToString,
    expected: impl ToString,
    remedy: impl ToString,
) -> Finding {
    Subject::new(Check::Lateness, subject, expected).warning(found, remedy)
}

/// Returns what to change, the most effective first; empty when everything is as expected.
pub fn advise(facts: &Facts, verdict: &Verdict) -> Vec<Finding> {
    let causes = [
        fifo(facts),
        memory(facts),
        stolen(facts, verdict),
        kernel(facts),
        real_time_share(facts),
        governor(facts),
    ];
    let mut all: Vec<Finding> = causes.into_iter().flatten().collect();
    if all.is_empty() {
        all.extend(unexplained(facts, verdict));
    }
    all.extend(demand(facts, verdict));
    all
}

fn stolen(facts: &Facts, verdict: &Verdict) -> Option<Finding> {
    let time = facts.cpu_time;
    let is_suspect = facts.is_virtual && !verdict.is_kept;
    (time.stolen_ms > 0.0 || is_suspect).then(|| {
        late(
            "hypervisor",
            format_args!(
                "{:.0} ms of CPU time stolen during the test ({:.1} %)",
                time.stolen_ms,
                time.stolen_percent()
            ),
            "none",
            "run the rig on real hardware, or give this virtual machine CPUs that no other one uses: its host may stop \
             it whatever the priority, and not every host reports it",
        )
    })
}

fn fifo(facts: &Facts) -> Option<Finding> {
    (!facts.is_fifo).then(|| {
        late(
            "SCHED_FIFO",
            "no right to it",
            format_args!("priority {PRIORITY}"),
            format_args!(
                "put AmbientCapabilities=CAP_SYS_NICE into the systemd unit, or run setcap cap_sys_nice=ep {}",
                facts.program.display()
            ),
        )
    })
}

fn memory(facts: &Facts) -> Option<Finding> {
    let limit = facts.memory_limit.map_or_else(
        || "without a limit".to_owned(),
        |bytes| format!("a limit of {} kB", bytes / 1024),
    );
    (!facts.memory_locked).then(|| {
        late(
            "locked memory",
            format_args!("none, {limit}"),
            "all memory of the program locked (RLIMIT_MEMLOCK)",
            "put LimitMEMLOCK=infinity into the systemd unit, or memlock unlimited into /etc/security/limits.conf",
        )
    })
}

fn kernel(facts: &Facts) -> Option<Finding> {
    (facts.preemption == Some(Preemption::Absent)).then(|| {
        late(
            "kernel",
            "no preemption",
            "PREEMPT or PREEMPT_RT",
            "boot with preempt=full, or install a kernel with PREEMPT_RT",
        )
    })
}

fn real_time_share(facts: &Facts) -> Option<Finding> {
    let share = facts.real_time_share.filter(|it| !it.is_enough())?;
    Some(late(
        "/proc/sys/kernel/sched_rt_runtime_us",
        format_args!("{} of {} us", share.runtime_us, share.period_us),
        "at least 95 %, or -1",
        "set it with sysctl -w kernel.sched_rt_runtime_us=950000, for good in /etc/sysctl.d",
    ))
}

fn governor(facts: &Facts) -> Option<Finding> {
    let all = &facts.governors;
    let other: Vec<&String> = all.iter().filter(|it| *it != "performance").collect();
    let first = other.first()?;
    Some(late(
        "CPU governor",
        format_args!("{first} ({} of {} CPUs)", other.len(), all.len()),
        "performance",
        "run cpupower frequency-set -g performance, and again after each boot",
    ))
}

/// Advises on lateness without a known cause.
fn unexplained(facts: &Facts, verdict: &Verdict) -> Option<Finding> {
    let (found, remedy) = match facts.preemption {
        Some(Preemption::RealTime) => (
            "PREEMPT_RT, and no cause of the lateness",
            "switch off power saving (deep C-states) in the firmware; look for drivers that block a CPU",
        ),
        Some(Preemption::Full | Preemption::Absent) | None => (
            "no PREEMPT_RT, and no other cause of the lateness",
            "install a kernel with PREEMPT_RT, and switch off power saving (deep C-states) in the firmware",
        ),
    };
    (!verdict.is_kept).then(|| late("kernel and firmware", found, "no late wait", remedy))
}

/// Advises to accept a slower emergency stop when late waits exceed the margin of this stop although the thread has
/// real-time priority.
fn demand(facts: &Facts, verdict: &Verdict) -> Option<Finding> {
    let need = verdict.needs.iter().find(|it| it.key == EMERGENCY_STOP)?;
    if need.is_kept || !facts.is_fifo {
        return None;
    }
    Some(late(
        "safety.estop_reaction_ms in rig.toml",
        format_args!("{:.1} ms left for late waits", need.tolerated_ms),
        format_args!("{:.1} ms", verdict.worst_ms),
        format_args!(
            "accept {} ms if the risk assessment of the plant allows it; otherwise take another computer",
            verdict.reaction_with_lateness_ms
        ),
    ))
}

#[cfg(test)]
mod tests;
