//! Checks the computer: the clock, and the rights to a real-time priority and to locked memory.

use super::finding::{Check, Finding, Subject};
use crate::real_time::PRIORITY;
use std::fs;
use std::process::Command;

/// Name of the service in systemd.
const SERVICE: &str = "relayrig.service";
/// Number of the capability `CAP_SYS_NICE`.
const SYS_NICE: u32 = 23;

/// Checks that a time service keeps the wall clock.
pub(super) fn check_clock() -> Finding {
    let subject = Subject::new(Check::Clock, "wall clock", "kept by a time service (NTP)");
    let remedy = "apt install systemd-timesyncd or chrony, and let it reach a time server";
    let arguments = ["show", "--property=NTPSynchronized", "--value"];
    match output("timedatectl", &arguments).as_deref().map(str::trim) {
        Some("yes") => subject.ok("synchronised"),
        Some("no") => subject.warning("not synchronised", remedy),
        Some(_) | None => subject.unknown("no answer of timedatectl", remedy),
    }
}

/// Returns what a command prints on stdout; `None` when the command is missing or fails.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then_some(text)
}

/// Rights of the program that runs the rig.
#[derive(Debug, PartialEq, Eq)]
struct Privileges {
    /// Program that has these rights, in words for the finding.
    of: &'static str,
    /// Highest real-time priority, 0 for none.
    priority: u64,
    /// Most memory that the program may lock, bytes, `u64::MAX` for no limit; with a limit the program locks no memory.
    locked: u64,
}

/// Checks the rights of the running service, or of the installed service while it is stopped, or of this process when
/// no service is installed.
pub(super) fn check_privileges() -> Vec<Finding> {
    match of_service().or_else(|| of_process("this process", "self")) {
        Some(privileges) => privileges.findings().into(),
        None => Vec::new(),
    }
}

impl Privileges {
    fn findings(&self) -> [Finding; 2] {
        let subject = |check, expected: &str| Subject::new(check, self.of, expected);
        let least = u64::from(PRIORITY);
        let real_time = subject(Check::RealTime, &format!("priority {least} or more"));
        let memory = subject(Check::LockedMemory, "no limit");
        let remedy = "start the rig as the service, or give it CAP_SYS_NICE, LimitRTPRIO and LimitMEMLOCK=infinity";
        [
            match self.priority < least {
                true => real_time.warning(format!("priority up to {}", self.priority), remedy),
                false => real_time.ok(format!("priority up to {}", self.priority)),
            },
            match self.locked {
                u64::MAX => memory.ok("no limit"),
                bytes => memory.warning(format!("a limit of {} kB", bytes >> 10), remedy),
            },
        ]
    }

    /// Returns the rights under `limits`, first of priority, then of locked memory; `lifted` is true for a limit that a
    /// capability or the user root lifts.
    fn new(of: &'static str, limits: [Option<u64>; 2], lifted: [bool; 2]) -> Self {
        let [priority, locked] = limits.map(Option::unwrap_or_default);
        Self {
            of,
            priority: if lifted[0] { 99 } else { priority },
            locked: if lifted[1] { u64::MAX } else { locked },
        }
    }
}

fn of_service() -> Option<Privileges> {
    let wanted = "--property=LoadState,MainPID,AmbientCapabilities,LimitRTPRIO,LimitMEMLOCK";
    let text = output("systemctl", &["show", SERVICE, wanted])?;
    let process = property(&text, "MainPID").filter(|it| *it != "0");
    // The system may have granted less than the unit asks for.
    let granted = process.and_then(|process| of_process(SERVICE, process));
    granted.or_else(|| parse_service(&text))
}

/// Returns a property from the answer of `systemctl show`.
fn property<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let value = |line: &'a str| line.strip_prefix(key)?.strip_prefix('=');
    text.lines().find_map(value)
}

/// Reads the answer of `systemctl show`; `None` when the service is not installed.
fn parse_service(text: &str) -> Option<Privileges> {
    let value = |key| property(text, key);
    if value("LoadState") != Some("loaded") {
        return None;
    }
    let limits = ["LimitRTPRIO", "LimitMEMLOCK"].map(|key| value(key).and_then(limit));
    let given = value("AmbientCapabilities").unwrap_or_default();
    let lifted = [given.contains("cap_sys_nice"), false];
    Some(Privileges::new(SERVICE, limits, lifted))
}

fn of_process(of: &'static str, process: &str) -> Option<Privileges> {
    let read = |file| fs::read_to_string(format!("/proc/{process}/{file}")).ok();
    parse_process(of, &read("limits")?, &read("status")?)
}

/// Reads the files `limits` and `status` of a process.
fn parse_process(of: &'static str, limits: &str, status: &str) -> Option<Privileges> {
    let soft = |name: &str| {
        let line = limits.lines().find_map(|line| line.strip_prefix(name))?;
        limit(line.split_whitespace().next()?)
    };
    let value = |name: &str| status.lines().find_map(|line| line.strip_prefix(name));
    let effective = u64::from_str_radix(value("CapEff:")?.trim(), 16).ok()?;
    let is_root = value("Uid:")?.split_whitespace().nth(1) == Some("0");
    let limits = ["Max realtime priority", "Max locked memory"].map(soft);
    let lifted = [effective & (1 << SYS_NICE) != 0, is_root];
    Some(Privileges::new(of, limits, lifted))
}

fn limit(text: &str) -> Option<u64> {
    match text {
        "infinity" | "unlimited" => Some(u64::MAX),
        number => number.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::finding::Health;
    use super::*;

    #[test]
    fn the_rights_of_a_service_are_read() {
        let installed = "LoadState=loaded\nAmbientCapabilities=cap_sys_nice\nLimitRTPRIO=0\nLimitMEMLOCK=infinity\n";
        let found = parse_service(installed).unwrap();
        assert_eq!((found.priority, found.locked), (99, u64::MAX));
        assert_eq!(found.findings().map(|it| it.health), [Health::Ok; 2]);
        assert_eq!(parse_service("LoadState=not-found\n"), None);
    }

    #[test]
    fn the_rights_of_a_process_are_read() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units\n\
                      Max locked memory         8388608              8388608              bytes\n\
                      Max realtime priority     0                    0                    \n";
        let user = "Uid:\t101\t101\t101\t101\nCapEff:\t0000000000000000\n";
        let found = parse_process("", limits, user).unwrap();
        assert_eq!((found.priority, found.locked), (0, 8_388_608));
        assert_eq!(found.findings().map(|it| it.health), [Health::Warning; 2]);
        let root = "Uid:\t0\t0\t0\t0\nCapEff:\t0000000000800000\n";
        let root = parse_process("", limits, root).unwrap();
        assert_eq!((root.priority, root.locked), (99, u64::MAX));
    }
}
