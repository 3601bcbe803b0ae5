//! Checks the files that the rig writes: folder, disk, history, people, backups.

use super::account::{Account, rights};
use super::finding::{Check, Finding, Subject};
use crate::backup_folder::backups;
use history::{Examination, HistoryError, SCHEMA, examine, with_end};
use jiff::Timestamp;
use page::access::access_path;
use rustix::fs::{StatVfsMountFlags, statvfs};
use std::fs::{self, Metadata};
use std::io::ErrorKind;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// Free space below which the disk gets a warning, bytes.
const ROOM: u64 = 1_000_000_000;
/// Free space below which the disk gets a fault, bytes: the history may soon fail to grow.
const NO_ROOM: u64 = 100_000_000;
/// Greatest age of the newest backup, hours: one of the daily backups may fail.
const BACKUP_H: i64 = 50;

/// Checks folder and disk of the history.
pub(super) fn check_disk(folder: &Path, account: &Account) -> Vec<Finding> {
    let subject = |check, expected: &str| Subject::new(check, folder.display(), expected);
    let writable = subject(
        Check::DataFolder,
        &format!("a folder that {} may write", account.name),
    );
    let (Ok(meta), Ok(disk)) = (fs::metadata(folder), statvfs(folder)) else {
        let remedy = "make the folder, or name another history with --db";
        return vec![writable.fault("nothing readable", remedy)];
    };
    let found = rights(&meta);
    let writable = match disk.f_flag.contains(StatVfsMountFlags::RDONLY) {
        true => writable.fault(
            "a read-only file system",
            "look for errors of the disk (dmesg), then mount it writable",
        ),
        false if account.may_write(&meta) => writable.ok(found),
        false => writable.fault(
            found,
            format!("chown {} {}", account.name, folder.display()),
        ),
    };
    let room = subject(Check::DiskSpace, &format!("at least {}", size(ROOM)));
    let free = disk.f_bavail.saturating_mul(disk.f_frsize);
    vec![writable, check_room(room, free)]
}

fn check_room(room: Subject, free: u64) -> Finding {
    let found = format!("{} free", size(free));
    let remedy = "free some: old .trace files, then `relayrig history prune`";
    match free {
        ..NO_ROOM => room.fault(found, remedy),
        NO_ROOM..ROOM => room.warning(found, remedy),
        ROOM.. => room.ok(found),
    }
}

/// Checks the history; returns its facts when it is whole.
pub(super) fn check_history(db: &Path, account: &Account) -> (Finding, Option<Examination>) {
    let expected = format!("a whole history that {} may write", account.name);
    let subject = Subject::new(Check::History, db.display(), expected);
    if is_hidden(db) {
        return (subject.unknown(HIDDEN, as_rig(account)), None);
    }
    let facts = match examine(db) {
        Err(HistoryError::Missing { .. }) => {
            return (subject.ok("none yet; the first run makes it"), None);
        }
        Err(error) => {
            let remedy = remedy_of(&error);
            let found = format!("{:#}", anyhow::Error::from(error));
            return (subject.fault(found, remedy), None);
        }
        Ok(facts) => facts,
    };
    let files = ["", "-wal", "-shm"].map(|end| with_end(db, end));
    let locked = files.iter().find_map(|file| {
        let meta = fs::metadata(file).ok()?;
        let open = account.may_write(&meta) && !meta.permissions().readonly();
        (!open).then(|| (file, rights(&meta)))
    });
    let finding = match locked {
        Some((file, found)) => subject.fault(
            format!("{} of {found}", file.display()),
            format!("chown {0} {1}; chmod u+w {1}", account.name, file.display()),
        ),
        None => subject.ok(describe(&files, facts.schema)),
    };
    (finding, Some(facts))
}

fn describe(files: &[PathBuf], schema: i64) -> String {
    let bytes = files.iter().filter_map(|it| fs::metadata(it).ok());
    let bytes = size(bytes.map(|it| it.len()).sum());
    match schema {
        SCHEMA => format!("{bytes}, whole"),
        older => format!("{bytes}, whole, schema {older}; the next start brings it to {SCHEMA}"),
    }
}

fn remedy_of(error: &HistoryError) -> &'static str {
    match error {
        HistoryError::Newer { .. } => "install the newer program again, or restore a backup",
        HistoryError::Foreign { .. } => "name the history with --db, or restore a backup",
        HistoryError::Locked { .. } => "end the other program, then look again",
        _ => "stop the rig, keep a copy of the file, restore the newest backup",
    }
}

/// Checks the rights of the file of people and sessions; `None` before the first start, which creates the file.
pub(super) fn check_people(db: &Path, account: &Account) -> Option<Finding> {
    let file = access_path(db);
    let meta = fs::metadata(&file).ok()?;
    let expected = format!("a file that {} alone may read and write", account.name);
    let subject = Subject::new(Check::People, file.display(), expected);
    let found = rights(&meta);
    let remedy = format!("chown {0} {1}; chmod 600 {1}", account.name, file.display());
    Some(match (account.may_write(&meta), is_private(&meta)) {
        (true, true) => subject.ok(found),
        (true, false) => subject.warning(found, remedy),
        (false, _) => subject.fault(found, remedy),
    })
}

fn is_private(file: &Metadata) -> bool {
    file.mode() & 0o077 == 0
}

/// Finding for a file that only another account may see.
const HIDDEN: &str = "no right to look";

/// Returns true when the file may exist, but this process has no right to see it.
fn is_hidden(file: &Path) -> bool {
    let error = fs::metadata(file).err().map(|it| it.kind());
    error == Some(ErrorKind::PermissionDenied)
}

fn as_rig(account: &Account) -> String {
    format!("run the doctor as root or as {}", account.name)
}

/// Checks the age of the newest backup inside `folder`.
pub(super) fn check_backup(folder: &Path, account: &Account, now: Timestamp) -> Finding {
    let expected = format!("a backup of the last {BACKUP_H} hours");
    let subject = Subject::new(Check::Backup, folder.display(), expected);
    let remedy = "systemctl start relayrig-backup; look whether relayrig-backup.timer is enabled";
    if is_hidden(&folder.join(".")) {
        return subject.unknown(HIDDEN, as_rig(account));
    }
    let Some((made, newest)) = backups(folder).pop() else {
        return subject.warning("none", remedy);
    };
    let hours = now.duration_since(made).as_hours();
    let name = newest.file_name().unwrap_or_default().display();
    match hours <= BACKUP_H {
        true => subject.ok(format!("{name}, {hours} h old")),
        false => subject.warning(format!("{name}, {hours} h old"), remedy),
    }
}

/// Returns a size with its decimal unit.
fn size(bytes: u64) -> String {
    let value = bytes as f64;
    match bytes {
        ..1_000_000 => format!("{:.1} kB", value / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", value / 1e6),
        1_000_000_000.. => format!("{:.1} GB", value / 1e9),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::finding::Health;
    use super::*;

    #[test]
    fn little_room_is_a_warning_and_then_a_fault() {
        let health = |free| check_room(Subject::new(Check::DiskSpace, "", ""), free).health;
        assert_eq!(health(2_000_000_000), Health::Ok);
        assert_eq!(health(500_000_000), Health::Warning);
        assert_eq!(health(1_000), Health::Fault);
    }

    #[test]
    fn a_backup_may_be_two_days_old() {
        let folder = tempfile::tempdir().unwrap();
        let now: Timestamp = "2026-03-03T12:00:00Z".parse().unwrap();
        let account = Account::of_rig(folder.path());
        let health = || check_backup(folder.path(), &account, now).health;
        assert_eq!(health(), Health::Warning);
        for (name, expected) in [
            ("relayrig-20260228T000000Z", Health::Warning),
            ("relayrig-20260302T020000Z", Health::Ok),
        ] {
            fs::create_dir(folder.path().join(name)).unwrap();
            assert_eq!(health(), expected, "{name}");
        }
    }
}
