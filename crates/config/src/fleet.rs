//! Loads `fleet.toml`, which names the databases that collect the histories of many rigs. Without the file, or without
//! a target, the rig sends nothing.

use super::error::ConfigError;
use super::folder::Folder;
use super::keys;
use machine::rig::fault::Fault;
use serde::Deserialize;
use std::path::PathBuf;

/// Whether the link to a database is encrypted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TlsChoice {
    /// Encrypted; the certificate of the server is checked.
    #[default]
    Verify,
    /// Plain text.
    Off,
}

/// Choice of the raw replies that go to a database.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleChoice {
    /// No raw replies.
    #[default]
    None,
    /// Raw replies of parts that did not pass.
    Rejects,
    /// All raw replies.
    All,
}

/// A database to which the rig sends its history.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
pub struct FleetTarget {
    /// `postgres://USER@HOST:PORT/DATABASE`, without password.
    pub url: String,
    /// Encryption of the link.
    #[serde(default)]
    pub tls: TlsChoice,
    /// Path of the certificate (PEM) of the authority that signed the server's certificate.
    pub ca: Option<PathBuf>,
    /// Raw replies to send.
    #[serde(default)]
    pub samples: SampleChoice,
    /// Age of the oldest part that the database lacks at which an alarm is raised, seconds.
    #[serde(default = "an_hour_s")]
    pub alarm_after_s: u32,
}

/// A shift of the plant, in local time of each day.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
pub struct Shift {
    /// Name of the shift.
    pub name: String,
    /// Begin, `HH:MM`.
    pub start: String,
    /// End, `HH:MM`; an end at or before `start` is on the next day.
    pub end: String,
}

/// Minutes of a day.
const DAY_MIN: u16 = 24 * 60;

impl Shift {
    /// Returns start and end, minutes from the midnight before the start; the end is at most a day after the start.
    #[must_use]
    pub fn minutes(&self) -> (u16, u16) {
        let [start, end] = [&self.start, &self.end].map(|it| minute(it).unwrap_or_default());
        match end > start {
            true => (start, end),
            false => (start, end + DAY_MIN),
        }
    }
}

/// Returns the minute of the day of `HH:MM`.
fn minute(text: &str) -> Option<u16> {
    let (hour, minute) = text.split_once(':')?;
    let two = |it: &str, limit| {
        let digits = it.len() == 2 && it.bytes().all(|it| it.is_ascii_digit());
        it.parse().ok().filter(|it: &u16| digits && *it < limit)
    };
    Some(60 * two(hour, 24)? + two(minute, 60)?)
}

/// Settings of `fleet.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
pub struct FleetSettings {
    /// Name of the plant; not empty when there is a target.
    #[serde(default)]
    pub site: String,
    /// Name of the rig; not empty when there is a target.
    #[serde(default)]
    pub rig: String,
    /// Databases to which the rig sends its history.
    #[serde(default, rename = "target")]
    pub targets: Vec<FleetTarget>,
    /// Shifts of the plant.
    #[serde(default, rename = "shift")]
    pub shifts: Vec<Shift>,
}

const fn an_hour_s() -> u32 {
    3600
}

/// Reads and checks `fleet.toml`; returns settings without targets when the file is missing.
///
/// # Errors
/// Fails as [`super::Plant::load`] does.
pub fn load_fleet(folder: &Folder) -> Result<FleetSettings, ConfigError> {
    if !folder.has("fleet.toml") {
        return Ok(FleetSettings::default());
    }
    let file = folder.file("fleet.toml", "the databases that collect histories")?;
    let fleet: FleetSettings = file.settings(keys::fleet::FILE)?;
    check(&fleet).map_err(|fault| file.locate(&fault))?;
    Ok(fleet)
}

fn check(fleet: &FleetSettings) -> Result<(), Fault> {
    for (key, name) in [("site", &fleet.site), ("rig", &fleet.rig)] {
        let found = if name.is_empty() { "nothing" } else { name };
        if name.is_empty() && !fleet.targets.is_empty() {
            return Err(Fault::new(
                key,
                found,
                "a name, because the file has a target",
            ));
        }
    }
    check_shifts(&fleet.shifts)?;
    for (place, target) in fleet.targets.iter().enumerate() {
        check_target(&format!("target.{place}"), target)?;
        let same = |it: &FleetTarget| it.url == target.url;
        if let Some(other) = fleet.targets[..place].iter().position(same) {
            let fault = Fault::new(
                format!("target.{place}.url"),
                quoted(&target.url),
                "a database of its own",
            );
            return Err(fault.against(format!("target.{other}.url")));
        }
    }
    Ok(())
}

fn check_shifts(shifts: &[Shift]) -> Result<(), Fault> {
    let mut taken: Vec<(u16, usize)> = Vec::new();
    for (place, shift) in shifts.iter().enumerate() {
        for (key, text) in [("start", &shift.start), ("end", &shift.end)] {
            if minute(text).is_none() {
                let expected = "a time of the day from \"00:00\" to \"23:59\"";
                return Err(Fault::new(
                    format!("shift.{place}.{key}"),
                    quoted(text),
                    expected,
                ));
            }
        }
        if shift.name.is_empty() {
            return Err(Fault::new(
                format!("shift.{place}.name"),
                "nothing",
                "a name",
            ));
        }
        let (start, end) = shift.minutes();
        for minute in (start..end).map(|it| it % DAY_MIN) {
            if let Some((_, other)) = taken.iter().find(|(it, _)| *it == minute) {
                let span = format!("{} to {}", shift.start, shift.end);
                let fault = Fault::new(
                    format!("shift.{place}.start"),
                    span,
                    "shifts that do not overlap",
                );
                return Err(fault.against(format!("shift.{other}.start")));
            }
            taken.push((minute, place));
        }
    }
    Ok(())
}

fn check_target(key: &str, target: &FleetTarget) -> Result<(), Fault> {
    const URL: &str = "postgres://USER@HOST:PORT/DATABASE without a password";
    let url = format!("{key}.url");
    let rest = target
        .url
        .strip_prefix("postgres://")
        .or_else(|| target.url.strip_prefix("postgresql://"));
    let Some(rest) = rest else {
        return Err(Fault::new(url, quoted(&target.url), URL));
    };
    let authority = rest.split(['/', '?']).next().unwrap_or_default();
    let user = authority.rsplit_once('@').map_or("", |(user, _)| user);
    // The message must not show the password.
    if user.contains(':') || rest.contains("password=") {
        return Err(Fault::new(url, "a URL with a password", URL));
    }
    if user.is_empty() || !rest.contains('/') {
        return Err(Fault::new(url, quoted(&target.url), URL));
    }
    if target.tls == TlsChoice::Verify && target.ca.is_none() {
        let expected = "a PEM file with the authority that signed the certificate of the server, or tls = \"off\"";
        return Err(Fault::new(format!("{key}.ca"), "nothing", expected));
    }
    Ok(())
}

fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::check_all;

    /// A correct file, to which each case makes one change.
    const GOOD: &str = "site = \"suzhou\"\nrig = \"rig-07\"\n[[target]]\nurl = \"postgres://rig@db:5432/relayrig\"\n\
        tls = \"off\"\n[[shift]]\nname = \"early\"\nstart = \"06:00\"\nend = \"14:00\"\n[[shift]]\nname = \"night\"\n\
        start = \"22:00\"\nend = \"06:00\"\n";

    /// Returns what the check of a configuration with this file says.
    fn said(text: &str) -> String {
        let dir = tempfile::tempdir().unwrap();
        crate::init(dir.path(), "jzc-22f").unwrap();
        std::fs::write(dir.path().join("fleet.toml"), text).unwrap();
        check_all(&dir.path().into())
            .map_or_else(|faults| faults.to_string(), |_| "accepted".to_owned())
    }

    #[test]
    fn a_correct_file_becomes_settings() {
        assert_eq!(said(GOOD), "accepted");
        let built_in = load_fleet(&Folder::built_in()).unwrap();
        assert_eq!(
            built_in,
            FleetSettings::default(),
            "off until somebody names a database"
        );
    }

    #[test]
    fn each_fault_names_key_found_and_expected() {
        let cases = [
            (
                "rig = \"rig-07\"\n",
                "",
                "rig: found nothing, expected a name, because the file has a target",
            ),
            (
                "tls = \"off\"\n",
                "",
                "target[0].ca: found nothing, expected a PEM file",
            ),
            (
                "rig@db",
                "rig:s3cret@db",
                "target[0].url: found a URL with a password, expected postgres://USER@",
            ),
            (
                "postgres://",
                "mysql://",
                "target[0].url: found \"mysql://rig@db:5432/relayrig\", expected postgres://",
            ),
            (
                "tls = \"off\"",
                "tls = \"maybe\"",
                "target[0].tls: found \"maybe\", expected \"verify\" or \"off\"",
            ),
            (
                "site",
                "sight",
                "sight: found an unknown key, expected one of site, rig, target",
            ),
            (
                "end = \"06:00\"",
                "end = \"6:00\"",
                "shift[1].end: found \"6:00\", expected a time of the day",
            ),
            (
                "end = \"06:00\"",
                "end = \"06:01\"",
                "shift[1].start: found 22:00 to 06:01, expected shifts that do not overlap",
            ),
        ];
        for (old, new, expected) in cases {
            let said = said(&GOOD.replacen(old, new, 1));
            assert!(said.contains(expected), "{expected}\n{said}");
            assert!(
                said.contains("fleet.toml:") && !said.contains("s3cret"),
                "{said}"
            );
        }
    }
}
