//! Finds the account that runs the rig, and whether it may write a file.

use nix::unistd::{Gid, Group, Uid, User, getgrouplist};
use std::ffi::CString;
use std::fs::Metadata;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

/// An account of the operating system.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Account {
    /// Name of the account; its user id when it has no name.
    pub name: String,
    uid: u32,
    groups: Vec<u32>,
}

/// Returns the name of the account that runs this program; its user id when it has no name.
#[must_use]
pub fn own_account() -> String {
    Account::new(Uid::effective()).name
}

impl Account {
    /// Returns the account that runs the rig whose history lies in `folder`: the account of this process when it may
    /// write there and is not root, otherwise the owner of the folder.
    pub fn of_rig(folder: &Path) -> Self {
        let own = Self::new(Uid::effective());
        match std::fs::metadata(folder) {
            Ok(meta) if own.uid == 0 || !own.may_write(&meta) => {
                Self::new(Uid::from_raw(meta.uid()))
            }
            Ok(_) | Err(_) => own,
        }
    }

    fn new(uid: Uid) -> Self {
        let user = User::from_uid(uid).ok().flatten();
        let groups = user.as_ref().and_then(|user| {
            let name = CString::new(user.name.as_str()).ok()?;
            getgrouplist(&name, user.gid).ok()
        });
        Self {
            name: user.map_or_else(|| uid.to_string(), |user| user.name),
            uid: uid.as_raw(),
            groups: groups
                .unwrap_or_default()
                .into_iter()
                .map(Gid::as_raw)
                .collect(),
        }
    }

    /// Returns true when mode and owner let the account write the file; ignores access control lists.
    pub fn may_write(&self, file: &Metadata) -> bool {
        self.uid == 0 || self.has_write_bit(file)
    }

    fn has_write_bit(&self, file: &Metadata) -> bool {
        let shift = match (file.uid() == self.uid, self.groups.contains(&file.gid())) {
            (true, _) => 6,
            (false, true) => 3,
            (false, false) => 0,
        };
        file.mode() & (0o2 << shift) != 0
    }
}

/// Returns owner, group and mode of a file, for example `root:dialout 0660`.
pub(super) fn rights(file: &Metadata) -> String {
    let user = User::from_uid(Uid::from_raw(file.uid())).ok().flatten();
    let user = user.map_or_else(|| file.uid().to_string(), |user| user.name);
    format!("{user}:{} {:04o}", group(file), file.mode() & 0o7777)
}

/// Returns the name of the group of a file; its group id when it has no name.
pub(super) fn group(file: &Metadata) -> String {
    let group = Group::from_gid(Gid::from_raw(file.gid())).ok().flatten();
    group.map_or_else(|| file.gid().to_string(), |group| group.name)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::fs::{self, Permissions};
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn owner_group_and_others_have_their_own_bit() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let meta = || fs::metadata(file.path()).unwrap();
        let (uid, gid) = (meta().uid(), meta().gid());
        let account = |uid: u32, gid: u32| Account {
            name: String::new(),
            uid,
            groups: vec![gid],
        };
        let writers = |mode: u32| {
            fs::set_permissions(file.path(), Permissions::from_mode(mode)).unwrap();
            let others = account(uid + 1, gid + 1);
            [account(uid.max(1), gid + 1), account(uid + 1, gid), others]
                .map(|it| it.has_write_bit(&meta()))
        };
        assert!(writers(0o020)[1] && !writers(0o020)[2]);
        assert!(writers(0o002)[2]);
        assert_eq!(writers(0o440), [false; 3]);
    }
}
