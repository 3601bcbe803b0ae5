//! Tests whether this computer keeps the timing of the rig: a latency test like cyclictest's, on the thread and the
//! timer of the rig, first with the computer as it is, then under load.
//!
//! | module | holds |
//! |---|---|
//! | `phase` | the waits of one phase |
//! | `load` | the load that the test makes |
//! | `verdict` | what `rig.toml` tolerates |
//! | `cpu_time` | time that a hypervisor has stolen |
//! | `facts`, `survey` | state of the computer, and its files |
//! | `advice` | what to change |
//! | `histogram`, `plot` | the waits as text and as a picture |

mod advice;
mod cpu_time;
mod facts;
pub mod histogram;
mod load;
pub mod phase;
pub mod plot;
mod survey;
pub mod verdict;

use crate::block_on;
use crate::controls::Interrupts;
use crate::doctor::account::Account;
use crate::doctor::{Finding, Health, ports};
use crate::real_time::RigThread;
use crate::source::RigSource;
use advice::advise;
use anyhow::Context;
use bus::Pace;
use cpu_time::CpuTime;
use load::{Load, scratch_file};
use machine::rig::wiring::Wiring;
use phase::{Phase, PhaseResult, measure};
use std::fs::File;
use std::path::Path;
use units::Span;
use verdict::Verdict;

/// Answer of the test.
#[derive(Debug)]
pub struct Report {
    /// Results in the order of [`Phase::ALL`].
    pub phases: Vec<PhaseResult>,
    /// Comparison of the worst lateness with what `rig.toml` tolerates.
    pub verdict: Verdict,
    /// Causes of late waits and faults of ports, with what to change; empty when there are none.
    pub advice: Vec<Finding>,
}

/// Tests this computer for `span`, half of it per phase, against the needs of `wiring`. The load writes an unnamed file
/// in `folder`. Calls `ended` after each phase. Opens no port. Returns `None` after Ctrl-C.
///
/// # Errors
/// Fails when `folder` refuses a file, when the system refuses a thread, or as `ended` does.
pub fn run(
    wiring: &Wiring,
    folder: &Path,
    span: Span,
    ended: &mut dyn FnMut(&PhaseResult) -> anyhow::Result<()>,
) -> anyhow::Result<Option<Report>> {
    let mut scratch = Some(scratch_file(folder)?);
    let thread = RigThread::start(Pace::real())?;
    block_on(&RigSource::Serial(Vec::new()), async {
        let mut interrupts = Interrupts::listen().context("catching Ctrl-C")?;
        let mut phases = Vec::new();
        for phase in Phase::ALL {
            let file = scratch.take_if(|_| phase == Phase::Loaded);
            let result = tokio::select! {
                biased;
                () = interrupts.next() => return Ok(None),
                result = test(phase, Span(span.0 / 2), &thread, file) => result?,
            };
            ended(&result)?;
            phases.push(result);
        }
        let mut report = report(wiring, &thread, phases);
        let mut ports = ports::check(wiring, &[], &Account::of_rig(folder));
        ports.retain(|it| it.health != Health::Ok);
        report.advice.extend(ports);
        Ok(Some(report))
    })
}

/// Measures one phase; with a `file`, under a load that writes this file.
async fn test(
    phase: Phase,
    span: Span,
    thread: &RigThread,
    file: Option<File>,
) -> anyhow::Result<PhaseResult> {
    let before = survey::cpu_time();
    let load = file.map(Load::start).transpose()?;
    let lateness = thread.keeper().handle.spawn(measure(span)).await;
    load.map_or(Ok(()), Load::end)?;
    Ok(PhaseResult {
        phase,
        lateness: lateness.context("measuring on the rig's thread")?.view(),
        cpu_time: CpuTime::between(before, survey::cpu_time()),
    })
}

fn report(wiring: &Wiring, thread: &RigThread, phases: Vec<PhaseResult>) -> Report {
    let worst_ms = phases.iter().map(|it| it.lateness.worst_ms);
    let verdict = Verdict::of(wiring, worst_ms.fold(0.0, f64::max));
    let spent = phases.iter().map(|it| it.cpu_time);
    let facts = survey::facts(&thread.rights, spent.sum());
    Report {
        advice: advise(&facts, &verdict),
        phases,
        verdict,
    }
}
