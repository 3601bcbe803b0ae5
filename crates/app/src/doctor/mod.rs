//! Finds what is wrong with an installation, and says what to do.
//!
//! The doctor reads files, rights and the state of the computer. It opens no port and writes no file, so it may run
//! while the rig works. It judges the rights of the account that runs the rig, which owns the data, not the rights of
//! the person who calls the doctor.

pub(crate) mod account;
mod calibration;
pub(crate) mod finding;
mod host;
pub(crate) mod ports;
mod storage;

use crate::order::Files;
use crate::source::LinePort;
use account::Account;
pub use account::own_account;
use config::{ConfigFaults, Folder, Plant, check_all, recipe_names};
use finding::Subject;
pub use finding::{Check, Finding, Health};
use jiff::Timestamp;
use std::path::Path;

/// An installation to examine.
#[derive(Debug, Clone, Copy)]
pub struct Installation<'a> {
    /// Configuration and history.
    pub files: &'a Files,
    /// Ports that replace those of `rig.toml`; `None` for a simulated rig, which has no ports.
    pub lines: Option<&'a [LinePort]>,
    /// Folder of the backups; `None`: the backups are not checked. Without a history no backup is expected.
    pub backups: Option<&'a Path>,
}

/// Returns the findings in the order of [`Check`]; the latency of a port follows that port.
pub fn examine(installation: &Installation<'_>) -> Vec<Finding> {
    let files = installation.files;
    let folder = files.data_folder();
    let account = Account::of_rig(folder);
    let plant = check_all(&files.config);
    let now = Timestamp::now();
    let (history, facts) = storage::check_history(&files.db, &account);
    let mut findings = vec![configuration(&files.config, &plant)];
    findings.extend(storage::check_disk(folder, &account));
    findings.push(history);
    findings.extend(storage::check_people(&files.db, &account));
    let backups = installation.backups.filter(|_| files.db.exists());
    findings.extend(backups.map(|folder| storage::check_backup(folder, &account, now)));
    if let (Some(given), Ok(plant)) = (installation.lines, &plant) {
        findings.extend(ports::check(&plant.wiring, given, &account));
    }
    findings.push(host::check_clock());
    let facts = facts.filter(|_| installation.lines.is_some());
    let certified = plant.as_ref().ok();
    let certified = certified.and_then(|it| calibration::of_plant(&files.config, it));
    let check = |it| calibration::check(it, certified.as_ref(), now);
    findings.extend(facts.iter().flat_map(check));
    findings.extend(host::check_privileges());
    findings
}

fn configuration(folder: &Folder, plant: &Result<Plant, ConfigFaults>) -> Finding {
    let name = folder.root().display();
    if folder.check_exists().is_err() {
        let remedy = format!("`relayrig init {name}`, or name another folder by --config");
        let subject = Subject::new(Check::Configuration, name, "a configuration");
        return subject.fault("no such folder", remedy);
    }
    let subject = Subject::new(Check::Configuration, name, "no fault");
    match plant {
        Ok(_) => subject.ok(format!("{} recipes, no fault", recipe_names(folder).len())),
        Err(faults) => subject.fault(
            faults.to_string().replace('\n', "; "),
            "correct the files, then `relayrig config check`; the ports were not checked",
        ),
    }
}
