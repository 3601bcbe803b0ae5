//! Facts about pseudo-terminals: any client may come, go and come again.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};

use rigsim::{SharedRig, pty};

fn client(path: &std::path::Path) -> File {
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
fn a_naive_client_may_reopen_the_port_for_every_request() {
    let bench = "[[module]]\naddress = 1\nmodel = \"I-7017\"\ninputs = [1.0]";
    let rig = SharedRig::new(rigsim::bench::build_text(bench).expect("a bench"));
    let ptys = pty::serve(&rig).expect("a pseudo-terminal");
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
fn links_point_at_the_ports_and_go_with_them() {
    let bench = "[[module]]\naddress = 1\nmodel = \"I-7017\"";
    let rig = SharedRig::new(rigsim::bench::build_text(bench).expect("a bench"));
    let ptys = pty::serve(&rig).expect("a pseudo-terminal");
    let dir = std::env::temp_dir().join(format!("rigsim-links-{}", std::process::id()));
    ptys.link(&dir).expect("a link");
    assert_eq!(
        ask(&mut client(&dir.join("bench")), b"$01M\r"),
        b"!017017\r"
    );
    ptys.stop();
    assert!(!dir.join("bench").is_symlink());
    std::fs::remove_dir(&dir).expect("an empty folder");
}
