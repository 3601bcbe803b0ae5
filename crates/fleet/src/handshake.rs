//! Decides the next step for a target database from what file and database know of each other; accesses neither.
//!
//! | database | file | step |
//! |---|---|---|
//! | does not know the rig | has sent nothing | begin |
//! | last batch: the confirmed one | | send |
//! | last batch: the pending one | | confirm, then send |
//! | last batch: another one, after the confirmed one | | refuse: the file is older |
//! | lacks the confirmed batch | | refuse: the database is older |
//! | another file sends under this name | | refuse: other file |

use crate::error::Refusal;
use history::outbox::Target;

/// The file whose rows the database accepts for a rig.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Known {
    /// Number of this history in the database.
    pub id: i32,
    /// UUID of the file.
    pub identity: String,
    /// Epoch of the rig: 1 for its first file, one more for each file that took over.
    pub epoch: i32,
    /// Computer that began this epoch.
    pub host: String,
    /// Start of this epoch, as messages show it.
    pub since: String,
    /// Number and UUID of the last batch of the file.
    pub last: Option<(i64, String)>,
    /// UUID of the last run of the file, with the number of parts of that run.
    pub last_run: Option<(String, i64)>,
}

/// What the database knows of rig and file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Facts {
    /// The current file of the rig.
    pub current: Option<Known>,
    /// True when the database has the batch that the file confirmed last.
    pub has_confirmed: bool,
    /// True when this file held the rig in an earlier epoch.
    pub was_ours: bool,
}

/// The next step of a transfer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// Register the file as the first one of the rig.
    Begin,
    /// Send the next batch.
    Send,
    /// The pending batch, with this UUID, has arrived: confirm it first.
    Confirm(String),
}

/// Returns the next step for a file, or why the database refuses it.
///
/// # Errors
/// Fails when file and database contradict each other.
pub fn next_step(rig: &str, file: &Target, facts: &Facts) -> Result<Step, Refusal> {
    let rig = rig.to_owned();
    let here = file.sent;
    let Some(current) = &facts.current else {
        return match file.confirmed {
            None => Ok(Step::Begin),
            Some(_) => Err(Refusal::DatabaseOlder {
                rig,
                there: 0,
                here,
            }),
        };
    };
    if current.identity != file.identity {
        let (host, since, epoch) = (current.host.clone(), current.since.clone(), current.epoch);
        return Err(if facts.was_ours {
            Refusal::Superseded {
                rig,
                host,
                since,
                epoch,
            }
        } else {
            Refusal::OtherFile {
                rig,
                host,
                since,
                epoch,
            }
        });
    }
    let there = current.last.as_ref().map_or(0, |(number, _)| *number);
    let last = current.last.as_ref().map(|(_, uuid)| uuid);
    if last == file.confirmed.as_ref() {
        return Ok(Step::Send);
    }
    if let Some(pending) = last.filter(|it| Some(*it) == file.pending.as_ref()) {
        return Ok(Step::Confirm(pending.clone()));
    }
    if file.confirmed.is_none() || facts.has_confirmed {
        let (run, parts) = current.last_run.clone().unwrap_or_default();
        return Err(Refusal::FileOlder {
            rig,
            there,
            here,
            run,
            parts,
        });
    }
    Err(Refusal::DatabaseOlder { rig, there, here })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns what a file that sent 3 batches, the last of them `c`, does with a database whose last batch is `last`.
    fn step(last: Option<(i64, &str)>, has_confirmed: bool, pending: Option<&str>) -> String {
        let mut file = Target::default();
        (file.identity, file.sent) = ("file".to_owned(), 3);
        (file.confirmed, file.pending) = (Some("c".to_owned()), pending.map(str::to_owned));
        let current = Known {
            id: 1,
            identity: "file".to_owned(),
            epoch: 1,
            host: String::new(),
            since: String::new(),
            last: last.map(|(number, uuid)| (number, uuid.to_owned())),
            last_run: None,
        };
        let facts = Facts {
            current: Some(current),
            has_confirmed,
            was_ours: true,
        };
        said(&file, &facts)
    }

    fn said(file: &Target, facts: &Facts) -> String {
        match next_step("suzhou/rig-1", file, facts) {
            Ok(Step::Begin) => "begin".to_owned(),
            Ok(Step::Send) => "send".to_owned(),
            Ok(Step::Confirm(batch)) => format!("confirm {batch}"),
            Err(Refusal::FileOlder { there, here, .. }) => format!("file older: {there}, {here}"),
            Err(Refusal::DatabaseOlder { there, here, .. }) => {
                format!("database older: {there}, {here}")
            }
            Err(Refusal::OtherFile { .. }) => "other file".to_owned(),
            Err(Refusal::Superseded { .. }) => "superseded".to_owned(),
            Err(Refusal::RunDiffers { .. }) => "run differs".to_owned(),
        }
    }

    #[test]
    fn the_last_batch_decides_what_comes_next() {
        assert_eq!(step(Some((3, "c")), true, None), "send");
        assert_eq!(
            step(Some((3, "c")), true, Some("d")),
            "send",
            "the pending one did not arrive"
        );
        assert_eq!(step(Some((4, "d")), true, Some("d")), "confirm d");
        assert_eq!(step(Some((4, "x")), true, Some("d")), "file older: 4, 3");
        assert_eq!(step(Some((9, "x")), true, None), "file older: 9, 3");
        assert_eq!(
            step(Some((2, "b")), false, Some("d")),
            "database older: 2, 3"
        );
        assert_eq!(step(None, false, None), "database older: 0, 3");
    }

    #[test]
    fn a_file_begins_only_where_nothing_is() {
        let mut file = Target::default();
        let nothing = Facts::default();
        assert_eq!(said(&file, &nothing), "begin");
        (file.sent, file.confirmed) = (3, Some("c".to_owned()));
        assert_eq!(said(&file, &nothing), "database older: 0, 3");
        let mut other = nothing;
        other.current = Some(Known {
            id: 2,
            identity: "other".to_owned(),
            epoch: 2,
            host: "pc".to_owned(),
            since: String::new(),
            last: None,
            last_run: None,
        });
        assert_eq!(said(&file, &other), "other file");
        other.was_ours = true;
        assert_eq!(said(&file, &other), "superseded");
    }
}
