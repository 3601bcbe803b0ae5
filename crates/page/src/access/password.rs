//! Hashes of passwords, and random tokens.
//!
//! The hash is Argon2id with the default parameters of the library (19 MiB, 2 passes, 1 lane), which OWASP recommends.
//! Each hash includes its parameters, so that later versions may raise them.

use super::error::{AccessError, Result};
use argon2::Argon2;
use argon2::password_hash::phc::PasswordHash;
use argon2::password_hash::{PasswordHasher, PasswordVerifier};
use data_encoding::HEXLOWER;

/// Least length of a password, characters (NIST SP 800-63B).
const LEAST: usize = 8;
/// Greatest length of a password, characters: this limit bounds the time of hashing.
const MOST: usize = 200;

/// Returns the Argon2id string of `password`; takes about 20 ms. Fails when the length is out of range.
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

/// Checks `password` against the Argon2id string `kept`; takes as long as [`hash`], but answers at once for a password
/// that is too long.
pub(super) fn matches(password: &str, kept: &str) -> Result<bool> {
    if password.chars().count() > MOST {
        return Ok(false);
    }
    let kept = PasswordHash::new(kept).map_err(|error| trouble("reading a hash", &error))?;
    Ok(Argon2::default()
        .verify_password(password.as_bytes(), &kept)
        .is_ok())
}

/// Returns `bytes` random bytes.
pub(super) fn random(bytes: usize) -> Result<Vec<u8>> {
    let mut drawn = vec![0_u8; bytes];
    getrandom::fill(&mut drawn).map_err(|error| trouble("drawing a random number", &error))?;
    Ok(drawn)
}

/// Returns `bytes` random bytes in hexadecimal.
pub(super) fn random_hex(bytes: usize) -> Result<String> {
    Ok(HEXLOWER.encode(&random(bytes)?))
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
    fn a_hash_matches_only_its_password_and_is_salted() {
        let kept = hash("correct horse").unwrap();
        assert!(kept.starts_with("$argon2id$"), "{kept}");
        assert!(matches("correct horse", &kept).unwrap());
        assert!(!matches("correct horsf", &kept).unwrap());
        assert!(!matches("", &kept).unwrap());
        assert_ne!(kept, hash("correct horse").unwrap());
    }

    #[test]
    fn passwords_of_wrong_length_are_refused_with_the_bounds() {
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
