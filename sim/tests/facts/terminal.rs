//! Tests of pseudo-terminals: clients open, close and reopen a port.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::process::Command;

use rigsim::pty::Rates;
use rigsim::{SharedRig, pty};
use rustix::termios::{OptionalActions, ioctl_tiocexcl, tcgetattr, tcsetattr};

fn client(path: &Path) -> File {
    let mut options = OpenOptions::new();
    options.read(true).write(true).open(path).expect("a port")
}

fn ask(port: &mut File, request: &[u8]) -> Vec<u8> {
    port.write_all(request).expect("a port");
    let mut reply = Vec::new();
    let mut byte = [0u8; 1];
    while reply.last() != Some(&b'\r') {
        port.read_exact(&mut byte).expect("a reply");
        reply.push(byte[0]);
    }
    reply
}

#[test]
fn a_client_may_reopen_the_port_for_every_request() {
    let bench = "[[module]]\naddress = 1\nmodel = \"I-7017\"\ninputs = [1.0]";
    let rig = SharedRig::new(rigsim::bench::build_text(bench).expect("a bench"));
    let ptys = pty::serve(&rig, Rates::Ignored).expect("a pseudo-terminal");
    let (name, path) = ptys.paths().remove(0);
    assert_eq!(name, "bench");
    for _ in 0..3 {
        assert_eq!(ask(&mut client(&path), b"#010\r"), b">+01.000\r");
    }
    let mut port = client(&path);
    port.write_all(b"$01").expect("a port");
    assert_eq!(ask(&mut port, b"M\r"), b"!017017\r");
    ptys.stop();
}

#[test]
fn links_point_at_the_ports_and_vanish_with_them() {
    let bench = "[[module]]\naddress = 1\nmodel = \"I-7017\"";
    let rig = SharedRig::new(rigsim::bench::build_text(bench).expect("a bench"));
    let ptys = pty::serve(&rig, Rates::Ignored).expect("a pseudo-terminal");
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path().join("links");
    ptys.link(&dir).expect("a link");
    assert_eq!(
        ask(&mut client(&dir.join("bench")), b"$01M\r"),
        b"!017017\r"
    );
    ptys.stop();
    assert!(!dir.join("bench").is_symlink());
    std::fs::remove_dir(&dir).expect("an empty folder");
}

#[test]
fn a_lost_port_ends_its_client_and_returns() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("bench.toml");
    std::fs::write(&file, "[[module]]\naddress = 1\nmodel = \"I-7017\"").expect("a file");
    let rig = rigsim::build_bench(&file, &["port_lost=1/100@0..0.5".to_owned()]).expect("a bench");
    let ptys = pty::serve(&rig, Rates::Ignored).expect("a pseudo-terminal");
    ptys.link(dir.path()).expect("a link");
    let link = dir.path().join("bench");
    let mut port = client(&link);
    // The request makes the port vanish: the client gets an error or an end, never an endless wait.
    port.write_all(b"$01M\r").expect("a port");
    let mut bytes = [0u8; 16];
    assert!(matches!(port.read(&mut bytes), Ok(0) | Err(_)));
    drop(port);
    // The rig restores the port by itself; until then the link is absent or points at the old terminal.
    let back = std::iter::repeat_with(|| {
        let mut options = OpenOptions::new();
        let port = options.read(true).write(true).open(&link);
        port.ok().and_then(|mut port| {
            port.write_all(b"$01M\r").ok()?;
            let mut byte = [0u8; 1];
            port.read_exact(&mut byte).ok()?;
            Some(byte[0])
        })
    });
    assert_eq!(back.flatten().next(), Some(b'!'));
    ptys.stop();
}

fn set_baud(port: &File, baud: u32) {
    let mut mode = tcgetattr(port).expect("a terminal");
    mode.set_speed(baud).expect("a rate");
    tcsetattr(port, OptionalActions::Now, &mode).expect("a terminal");
}

#[test]
fn a_module_ignores_requests_at_another_rate() {
    let bench = "[[module]]
        address = 1
        model = \"I-7017\"
        baud = 9600
        [[module]]
        address = 2
        model = \"I-7021\"
        [[module]]
        address = 3
        model = \"I-7080\"
        init = true";
    let rig = SharedRig::new(rigsim::bench::build_text(bench).expect("a bench"));
    let ptys = pty::serve(&rig, Rates::Enforced).expect("a pseudo-terminal");
    let mut port = client(&ptys.paths().remove(0).1);
    // A client without a rate has the line's rate: only module 02 runs at it, and it is asked last.
    assert_eq!(ask(&mut port, b"$01M\r$00M\r$02M\r"), b"!027021\r");
    set_baud(&port, 9_600);
    assert_eq!(ask(&mut port, b"$02M\r$01M\r"), b"!017017\r");
    assert_eq!(ask(&mut port, b"$00M\r"), b"!037080\r");
    ptys.stop();
}

/// Checks whether a user without privileges can open a port; an administrator always can.
fn opens_without_privileges(path: &Path, administrator: bool) -> bool {
    let open = format!("exec 3<>{}", path.display());
    let mut shell = Command::new(if administrator { "setpriv" } else { "sh" });
    if administrator {
        shell.args(["--reuid=65534", "--clear-groups", "sh"]);
    }
    let opened = shell.args(["-c", &open]).output();
    opened.expect("setpriv of util-linux").status.success()
}

#[test]
fn a_killed_client_does_not_lock_the_port() {
    let bench = "[[module]]\naddress = 1\nmodel = \"I-7017\"";
    let rig = SharedRig::new(rigsim::bench::build_text(bench).expect("a bench"));
    let ptys = pty::serve(&rig, Rates::Ignored).expect("a pseudo-terminal");
    let path = ptys.paths().remove(0).1;
    let all = std::fs::Permissions::from_mode(0o666);
    std::fs::set_permissions(&path, all).expect("own port");
    let folder = tempfile::tempdir().expect("a folder");
    let administrator = folder.path().metadata().expect("a folder").uid() == 0;
    // The client ends without cleanup, as after a kill.
    let port = client(&path);
    ioctl_tiocexcl(&port).expect("a terminal");
    drop(port);
    let mut tries = std::iter::repeat_with(|| opens_without_privileges(&path, administrator));
    assert!(tries.by_ref().take(1_000).any(|opened| opened));
    ptys.stop();
}
