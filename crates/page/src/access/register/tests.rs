#![allow(clippy::unwrap_used)]

use super::*;

const HOUR_US: i64 = 3_600_000_000;

/// Returns a new register with the guard that removes its folder.
fn fresh() -> (Register, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let register = Register::open(&folder.path().join("people.db")).unwrap();
    (register, folder)
}

#[cfg(unix)]
#[test]
fn only_the_owner_may_read_the_file() {
    use std::os::unix::fs::PermissionsExt;
    let (_register, folder) = fresh();
    let file = std::fs::metadata(folder.path().join("people.db")).unwrap();
    assert_eq!(file.permissions().mode() & 0o777, 0o600);
}

#[test]
fn the_first_start_adds_one_engineer_once() {
    let (mut register, folder) = fresh();
    let (name, password) = register.first_engineer(0).unwrap().unwrap();
    assert!(register.first_engineer(0).unwrap().is_none());
    let (person, _) = register.log_in(&name, &password, 0).unwrap().unwrap();
    assert_eq!(person.role, Role::Engineer);
    let bytes = std::fs::read(folder.path().join("people.db")).unwrap();
    let leaked = bytes
        .windows(password.len())
        .any(|it| it == password.as_bytes());
    assert!(!leaked, "the file holds the password in plain text");
}

#[test]
fn wrong_name_and_wrong_password_get_the_same_answer() {
    let (mut register, _folder) = fresh();
    register.add("li", Role::Operator, "secret-12", 0).unwrap();
    assert_eq!(register.log_in("li", "secret-13", 0).unwrap(), None);
    assert_eq!(register.log_in("nobody", "secret-12", 0).unwrap(), None);
    assert!(register.log_in("li", "secret-12", 0).unwrap().is_some());
}

#[test]
fn a_session_ends_by_time_logout_and_new_password() {
    let (mut register, _folder) = fresh();
    register.add("li", Role::Operator, "secret-12", 0).unwrap();
    let enter = |register: &mut Register| register.log_in("li", "secret-12", 0).unwrap().unwrap().1;
    let first = enter(&mut register);
    assert_eq!(
        register.holder(&first, 11 * HOUR_US).unwrap().unwrap().name,
        "li"
    );
    assert_eq!(register.holder(&first, 12 * HOUR_US).unwrap(), None);
    assert_eq!(register.holder("0000", 0).unwrap(), None);
    register.log_out(&first).unwrap();
    assert_eq!(register.holder(&first, 0).unwrap(), None);
    let second = enter(&mut register);
    register.set_password("li", "another-1").unwrap();
    assert_eq!(register.holder(&second, 0).unwrap(), None);
}

#[test]
fn removal_ends_sessions_and_spares_the_last_engineer() {
    let (mut register, _folder) = fresh();
    register.first_engineer(0).unwrap();
    register
        .add("zhao", Role::Maintainer, "secret-12", 0)
        .unwrap();
    let (_, token) = register.log_in("zhao", "secret-12", 0).unwrap().unwrap();
    register.remove("zhao").unwrap();
    assert_eq!(register.holder(&token, 0).unwrap(), None);
    assert!(matches!(
        register.remove("zhao"),
        Err(AccessError::Unknown { .. })
    ));
    assert!(matches!(
        register.remove("engineer"),
        Err(AccessError::LastEngineer { .. })
    ));
}

#[test]
fn malformed_and_taken_names_are_refused() {
    let (mut register, _folder) = fresh();
    for name in ["", "a b", "a\"", "a\n", &"x".repeat(41)] {
        let refused = register.add(name, Role::Operator, "secret-12", 0);
        assert!(matches!(refused, Err(AccessError::Name { .. })), "{name:?}");
    }
    register
        .add("李工", Role::Engineer, "secret-12", 0)
        .unwrap();
    let twice = register.add("李工", Role::Operator, "secret-12", 0);
    assert!(matches!(twice, Err(AccessError::Taken { .. })));
}

#[test]
fn a_foreign_file_is_refused_unchanged() {
    let (register, folder) = fresh();
    let path = folder.path().join("people.db");
    drop(register);
    std::fs::remove_file(&path).unwrap();
    Connection::open(&path)
        .unwrap()
        .execute_batch("CREATE TABLE t (a)")
        .unwrap();
    let before = std::fs::read(&path).unwrap();
    assert!(matches!(
        Register::open(&path),
        Err(AccessError::Foreign { .. })
    ));
    assert_eq!(before, std::fs::read(&path).unwrap());
}
