//! Circumstances of a run: processor, load by other programs, and commit of the program.

use super::super::pool;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Time for which [`busy_cores`] watches other programs.
const WATCHED: Duration = Duration::from_secs(1);

/// Returns the name of the processor.
pub fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let names = text.lines().filter(|line| line.starts_with("model name"));
    let mut names = names.filter_map(|line| line.split_once(':'));
    let name = names.next().map(|(_, name)| name.trim().to_owned());
    name.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// Watches the processor for a second and returns the number of cores that other programs kept busy, programs of other
/// virtual machines on the host included; `None` where the system has no `/proc/stat`.
pub fn busy_cores() -> Option<f64> {
    let before = jiffies(&std::fs::read_to_string("/proc/stat").ok()?)?;
    std::thread::sleep(WATCHED);
    let after = jiffies(&std::fs::read_to_string("/proc/stat").ok()?)?;
    let all = after.all.saturating_sub(before.all);
    let busy = after.busy.saturating_sub(before.busy);
    (all > 0).then(|| pool::cores() as f64 * busy as f64 / all as f64)
}

/// Processor time of all cores since the start of the system, in clock ticks.
#[derive(Debug, PartialEq)]
struct Jiffies {
    busy: u64,
    all: u64,
}

/// Parses the text of `/proc/stat`.
fn jiffies(text: &str) -> Option<Jiffies> {
    let line = text.lines().next()?.strip_prefix("cpu ")?;
    let ticks: Vec<u64> = line
        .split_whitespace()
        .map_while(|it| it.parse().ok())
        .collect();
    // user, nice, system, idle, iowait, irq, softirq, steal; the later numbers are already part of these.
    let known = ticks.get(..8)?;
    let all = known.iter().sum::<u64>();
    let idle = known[3] + known[4];
    Some(Jiffies {
        busy: all - idle,
        all,
    })
}

/// Returns the commit of the working folder; `None` outside of a repository.
pub fn commit() -> Option<String> {
    git(&["rev-parse", "--short=8", "HEAD"])
}

/// Returns whether the working folder differs from its commit, figures and pictures in `docs` aside. The working folder
/// must be the root of the repository.
pub fn is_changed(docs: &Path) -> bool {
    git(&["status", "--porcelain"]).is_some_and(|listed| lists_others(&listed, docs))
}

/// Returns whether the output of `git status` lists a file that is neither a figure nor a picture.
fn lists_others(listed: &str, docs: &Path) -> bool {
    let own = ["figures.md", "figures/results", "pictures"].map(|it| docs.join(it));
    let mut files = listed
        .lines()
        .filter_map(|line| line.trim().split_once(' '));
    files.any(|(_, file)| {
        !own.iter()
            .any(|own| Path::new(file.trim()).starts_with(own))
    })
}

fn git(words: &[&str]) -> Option<String> {
    let done = Command::new("git").args(words).output().ok()?;
    let said = String::from_utf8_lossy(&done.stdout).trim().to_owned();
    done.status.success().then_some(said)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn idle_and_waiting_cores_are_not_busy() {
        let text = "cpu  10 1 5 70 4 1 1 8 0 0\ncpu0 1 2 3\n";
        assert_eq!(jiffies(text), Some(Jiffies { busy: 26, all: 100 }));
        assert_eq!(jiffies("cpu  1 2 3\n"), None);
    }

    #[test]
    fn figures_and_pictures_are_no_change() {
        let own =
            " M docs/figures.md\n?? docs/figures/results/cycle.jsonl\n M docs/pictures/a.svg\n";
        assert!(!lists_others(own, Path::new("docs")));
        assert!(lists_others(
            "M docs/figures/plan.toml\n",
            Path::new("docs")
        ));
        assert!(lists_others(
            " M docs/figures.md\n M src/main.rs\n",
            Path::new("docs")
        ));
    }
}
