//! Passwords and random words.
//!
//! Argon2id with the library's own parameters (19 MiB, 2 passes, 1 lane: the first choice that OWASP
//! gives); a hash carries its parameters, so that later ones may be stronger.

use super::error::{AccessError, Result};
use argon2::Argon2;
use argon2::password_hash::phc::PasswordHash;
use argon2::password_hash::{PasswordHasher, PasswordVerifier};

/// NIST SP 800-63B asks for 8 at least.
const LEAST: usize = 8;
/// Longer ones would only cost time.
const MOST: usize = 200;

/// The string to keep. Takes some 20 ms.
pub(super) fn hash(password: &str) -> Result<String> {
    let found = password.chars().count();
    if !(LEAST..=MOST).contains(&found) {
        return Err(AccessError::Password {
            found,
            least: LEAST,
            most: MOST,
        });
    }
    let hash = Argon2::default().hash_password(password.as_bytes());
    let hash = hash.map_err(|error| trouble("hashing a password", &error))?;
    Ok(hash.to_string())
}

/// Whether `password` is the one that `kept` was made of. Takes as long as [`hash`].
pub(super) fn fits(password: &str, kept: &str) -> Result<bool> {
    if password.chars().count() > MOST {
        return Ok(false);
    }
    let kept = PasswordHash::new(kept).map_err(|error| trouble("reading a hash", &error))?;
    Ok(Argon2::default()
        .verify_password(password.as_bytes(), &kept)
        .is_ok())
}

/// `bytes` random bytes in hexadecimal.
pub(super) fn random(bytes: usize) -> Result<String> {
    use std::fmt::Write;
    let mut drawn = vec![0_u8; bytes];
    getrandom::fill(&mut drawn).map_err(|error| trouble("drawing a random number", &error))?;
    Ok(drawn.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

fn trouble(doing: &'static str, error: &dyn std::fmt::Display) -> AccessError {
    let reason = error.to_string();
    AccessError::Crypto { doing, reason }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_hash_fits_its_password_and_no_other_and_has_a_salt_of_its_own() {
        let kept = hash("correct horse").unwrap();
        assert!(kept.starts_with("$argon2id$"), "{kept}");
        assert!(fits("correct horse", &kept).unwrap());
        assert!(!fits("correct horsf", &kept).unwrap());
        assert!(!fits("", &kept).unwrap());
        assert_ne!(kept, hash("correct horse").unwrap());
    }

    #[test]
    fn passwords_that_are_too_short_or_too_long_are_refused_with_the_bounds() {
        assert!(
            hash("1234567")
                .unwrap_err()
                .to_string()
                .contains("8 to 200")
        );
        assert!(hash(&"x".repeat(201)).is_err());
        assert!(hash("八个字的密码就够").is_ok());
    }
}
