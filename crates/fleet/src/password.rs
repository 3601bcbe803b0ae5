//! Reads passwords from a password file of PostgreSQL, which has one `host:port:database:user:password` a line.

use crate::error::{FleetError, Result};
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;

/// Path of a password file, which need not exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PasswordFile(PathBuf);

impl PasswordFile {
    /// Returns the file that PGPASSFILE names, else `.pgpass` of the home directory.
    #[must_use]
    pub fn of_environment() -> Option<Self> {
        let named = std::env::var_os("PGPASSFILE").map(PathBuf::from);
        let home = || std::env::var_os("HOME").map(|it| PathBuf::from(it).join(".pgpass"));
        named.or_else(home).map(Self)
    }

    /// Returns the password for a connection; `None` without a file, or without a line for this connection.
    ///
    /// # Errors
    /// Fails when others than the owner can read the file, or when the program cannot.
    pub fn password(&self, connection: [&str; 4]) -> Result<Option<String>> {
        let wrong = |found: String| FleetError::PasswordFile {
            path: self.0.clone(),
            found,
        };
        let Ok(meta) = std::fs::metadata(&self.0) else {
            return Ok(None);
        };
        let mode = meta.permissions().mode() & 0o777;
        if mode & 0o077 != 0 {
            return Err(wrong(format!("mode {mode:o}")));
        }
        let text = std::fs::read_to_string(&self.0).map_err(|error| wrong(error.to_string()))?;
        Ok(password_in(&text, connection))
    }
}

/// Returns the password of the first line that fits host, port, database and user. A field `*` fits everything; a
/// backslash makes the next character plain.
#[must_use]
pub fn password_in(text: &str, connection: [&str; 4]) -> Option<String> {
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .find_map(|line| {
            let (wanted, password) = fields(line)?;
            let fits = |(wanted, found): (&String, &str)| wanted == "*" || wanted == found;
            wanted.iter().zip(connection).all(fits).then_some(password)
        })
}

/// Splits a line into its four fields and the password.
fn fields(line: &str) -> Option<([String; 4], String)> {
    let mut fields = vec![String::new()];
    let mut characters = line.chars();
    while let Some(character) = characters.next() {
        let plain = match character {
            '\\' => characters.next()?,
            ':' if fields.len() < 5 => {
                fields.push(String::new());
                continue;
            }
            other => other,
        };
        fields.last_mut()?.push(plain);
    }
    let password = fields.pop()?;
    Some((fields.try_into().ok()?, password))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const FILE: &str =
        "# plant\ndb:5432:relayrig:rig\\:07:a\\\\b:c\ndb:*:*:reader:second\n*:*:*:*:any\nbroken\n";

    #[test]
    fn the_first_fitting_line_gives_the_password() {
        let asked = |host, user| password_in(FILE, [host, "5432", "relayrig", user]);
        assert_eq!(asked("db", "rig:07").as_deref(), Some("a\\b:c"));
        assert_eq!(asked("db", "reader").as_deref(), Some("second"));
        assert_eq!(asked("other", "reader").as_deref(), Some("any"));
        assert_eq!(password_in("db:1:x:y:p", ["db", "2", "x", "y"]), None);
    }

    #[test]
    fn a_file_that_others_can_read_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("pgpass");
        std::fs::write(&path, "*:*:*:*:secret").unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o644)).unwrap();
        let file = PasswordFile(path.clone());
        let error = file.password(["a", "1", "b", "c"]).unwrap_err().to_string();
        assert!(
            error.contains("found mode 644, expected") && !error.contains("secret"),
            "{error}"
        );
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).unwrap();
        assert_eq!(
            file.password(["a", "1", "b", "c"]).unwrap().as_deref(),
            Some("secret")
        );
        let missing = PasswordFile(dir.path().join("no"));
        assert_eq!(missing.password(["a", "1", "b", "c"]).unwrap(), None);
    }
}
