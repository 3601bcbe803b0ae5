#![allow(clippy::unwrap_used)]

use super::*;

const HOUR_US: i64 = 3_600_000_000;

/// Returns a new register with the guard that removes its folder.
pub(super) fn fresh() -> (Register, tempfile::TempDir) {
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
fn a_setup_code_is_wrong_once_there_is_an_engineer() {
    let (mut register, _folder) = fresh();
    register.add("li", Role::Operator, "secret-12", 0).unwrap();
    let code = register.setup_code().unwrap().unwrap();
    let typed = code.to_string();
    let proved = |register: &mut Register| register.prove_code(Some(&code), &typed, 0).unwrap();
    assert_eq!(proved(&mut register), Login::Right(()));
    register.set_role("li", Role::Engineer).unwrap();
    assert_eq!(register.setup_code().unwrap(), None);
    assert_eq!(proved(&mut register), Login::Wrong { known: false });
}

#[test]
fn the_file_holds_no_password_in_plain_text() {
    let (mut register, folder) = fresh();
    register.add("li", Role::Operator, "secret-12", 0).unwrap();
    let bytes = std::fs::read(folder.path().join("people.db")).unwrap();
    assert!(!bytes.windows(9).any(|it| it == b"secret-12"));
}

#[test]
fn a_file_of_schema_1_keeps_its_people() {
    let (mut register, folder) = fresh();
    register.add("li", Role::Operator, "secret-12", 0).unwrap();
    let earlier = "DROP TABLE failure; PRAGMA user_version = 1";
    register.connection.execute_batch(earlier).unwrap();
    let path = folder.path().join("people.db");
    let (unchanged, schema) = (Register::open_unchanged(&path).unwrap(), "user_version");
    assert_eq!(unchanged.checked_people().unwrap().len(), 1);
    let schema = unchanged
        .connection
        .pragma_query_value(None, schema, |row| row.get::<_, i64>(0));
    assert_eq!(schema.unwrap(), 1);
    let mut register = Register::open(&path).unwrap();
    for _ in 0..5 {
        register.log_in("li", "secret-13", 0).unwrap();
    }
    assert_eq!(
        register.entries(0).unwrap()[0].locked_until,
        Some(Moment(300_000_000))
    );
}

#[test]
fn a_clock_set_back_locks_no_name_longer() {
    let (mut register, _folder) = fresh();
    register.add("li", Role::Operator, "secret-12", 0).unwrap();
    for _ in 0..5 {
        register.log_in("li", "secret-13", HOUR_US).unwrap();
    }
    let try_at = |register: &mut Register, at_us| register.log_in("li", "secret-12", at_us);
    let locked = try_at(&mut register, HOUR_US).unwrap();
    assert!(matches!(locked, Login::Wait(_)), "{locked:?}");
    let set_back = try_at(&mut register, 0).unwrap();
    assert!(matches!(set_back, Login::Right(_)), "{set_back:?}");
}

#[test]
fn wrong_names_and_wrong_passwords_are_wrong() {
    let (mut register, _folder) = fresh();
    register.add("li", Role::Operator, "secret-12", 0).unwrap();
    let wrong = |known| Login::Wrong { known };
    assert_eq!(register.log_in("li", "secret-13", 0).unwrap(), wrong(true));
    assert_eq!(
        register.log_in("nobody", "secret-12", 0).unwrap(),
        wrong(false)
    );
    let right = register.log_in("li", "secret-12", 0).unwrap();
    assert!(matches!(right, Login::Right(_)));
}

#[test]
fn a_session_ends_by_time_logout_and_new_password() {
    let (mut register, _folder) = fresh();
    register.add("li", Role::Operator, "secret-12", 0).unwrap();
    let enter = |register: &mut Register| register.open_session("li", 0).unwrap();
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
    let mut add = |name, role| register.add(name, role, "secret-12", 0).unwrap();
    add("engineer", Role::Engineer);
    add("zhao", Role::Maintainer);
    let token = register.open_session("zhao", 0).unwrap();
    register.remove("zhao").unwrap();
    assert_eq!(register.holder(&token, 0).unwrap(), None);
    assert!(matches!(
        register.remove("zhao"),
        Err(AccessError::Unknown { .. })
    ));
    for refused in [
        register.remove("engineer"),
        register.set_role("engineer", Role::Operator),
    ] {
        assert!(matches!(refused, Err(AccessError::LastEngineer { .. })));
    }
    register.set_role("engineer", Role::Engineer).unwrap();
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
