//! Checks serial ports. Opens none of them, because opening would change control lines of a running rig.

use super::account::{Account, group, rights};
use super::finding::{Check, Finding, Subject};
use crate::source::LinePort;
use machine::rig::instruments::InstrumentWiring;
use machine::rig::wiring::Wiring;
use scpi::{LinkAddress, Transport};
use std::fs::{self, Metadata};
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};

/// Names that the kernel gives in the order of plugging in.
const UNSTABLE: [&str; 2] = ["/dev/ttyUSB", "/dev/ttyACM"];

/// Latency timer of a USB converter that suits the protocol, ms.
const LATENCY_MS: u32 = 1;

/// A line or an instrument with its serial port.
#[derive(Debug)]
struct Wired {
    /// The word `line` or `instrument`, as in `rig.toml`.
    kind: &'static str,
    name: String,
    /// Key of the port in `rig.toml`.
    key: &'static str,
    port: PathBuf,
    /// Path of the port with all links resolved; `None` when the port is missing.
    device: Option<PathBuf>,
}

/// Checks the serial port of every line and instrument, and the latency timer of a USB converter; `given` replaces
/// ports of the wiring.
pub(crate) fn check(wiring: &Wiring, given: &[LinePort], account: &Account) -> Vec<Finding> {
    let wired = wiring.lines.iter().map(|line| {
        let other = given.iter().find(|it| it.line == line.name);
        let port = PathBuf::from(other.map_or(&line.port, |it| &it.port));
        Wired {
            kind: "line",
            name: line.name.clone(),
            key: "port",
            device: fs::canonicalize(&port).ok(),
            port,
        }
    });
    let instruments = wiring.instruments.iter();
    let instruments = instruments.filter_map(|it| instrument(it, given));
    let wired: Vec<Wired> = wired.chain(instruments).collect();
    let mut findings = Vec::new();
    for (index, one) in wired.iter().enumerate() {
        let same = |other: &&Wired| other.device.is_some() && other.device == one.device;
        let twin = wired[..index].iter().find(same);
        findings.push(check_port(one, twin, account));
        let device = one.device.as_deref();
        findings.extend(device.and_then(|device| check_latency(Path::new("/sys"), device)));
    }
    findings
}

/// Returns the serial port of an instrument; `None` for one on the network.
fn instrument(wired: &InstrumentWiring, given: &[LinePort]) -> Option<Wired> {
    let other = given.iter().find(|it| it.line == wired.name);
    let other = other.and_then(|it| it.port.parse::<LinkAddress>().ok());
    let link = other.unwrap_or_else(|| wired.link.clone());
    let Transport::Serial { path, .. } = link.transport else {
        return None;
    };
    Some(Wired {
        kind: "instrument",
        name: wired.name.clone(),
        key: "link",
        device: fs::canonicalize(&path).ok(),
        port: path.into(),
    })
}

fn check_port(wired: &Wired, twin: Option<&Wired>, account: &Account) -> Finding {
    let Wired {
        kind, name, key, ..
    } = wired;
    let port = wired.port.display();
    let expected = format!("a serial port that {} may open", account.name);
    let subject = Subject::new(Check::Port, format!("{port} of {kind} {name}"), expected);
    let Some(meta) = wired.device.as_ref().and_then(|it| fs::metadata(it).ok()) else {
        let remedy = format!(
            "plug the converter in, or correct `{key}` of [{kind}.{name}] in rig.toml (ls -l /dev/serial/by-id)"
        );
        return subject.fault("nothing", remedy);
    };
    if !meta.file_type().is_char_device() {
        let remedy = format!("correct `{key}` of [{kind}.{name}] in rig.toml");
        return subject.fault("no device", remedy);
    }
    if let Some(twin) = twin {
        let remedy = "give each line and each instrument its own converter";
        return subject.fault(
            format!("the port of {} {} too", twin.kind, twin.name),
            remedy,
        );
    }
    if !account.may_write(&meta) {
        return subject.fault(rights(&meta), open_up(&meta, account));
    }
    let path = port.to_string();
    match UNSTABLE.iter().any(|start| path.starts_with(start)) {
        true => subject.warning(
            "a name that may change at the next start",
            "use a link of /dev/serial/by-id, or name the converter in /etc/udev/rules.d/70-relayrig.rules",
        ),
        false => subject.ok(rights(&meta)),
    }
}

/// Returns the remedy by which the account gets the right to open the device.
fn open_up(device: &Metadata, account: &Account) -> String {
    match group(device).as_str() {
        "root" => "look for another program's udev rule".to_owned(),
        group => format!("adduser {} {group}, then restart the service", account.name),
    }
}

/// Checks the latency timer of a USB converter; `None` for a port without one. `sys` is the mount point of sysfs.
fn check_latency(sys: &Path, device: &Path) -> Option<Finding> {
    let name = device.file_name()?;
    let file = sys
        .join("class/tty")
        .join(name)
        .join("device/latency_timer");
    let found: u32 = fs::read_to_string(&file).ok()?.trim().parse().ok()?;
    let expected = format!("{LATENCY_MS} ms");
    let subject = Subject::new(Check::Latency, device.display(), expected);
    let remedy = format!(
        "echo 1 > {}; for good, install /etc/udev/rules.d/70-relayrig.rules",
        file.display()
    );
    Some(match found {
        ..=LATENCY_MS => subject.ok(format!("{found} ms")),
        _ => subject.warning(format!("{found} ms, which every request waits"), remedy),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::finding::Health;
    use super::*;

    #[test]
    fn a_slow_latency_timer_is_a_warning() {
        let sys = tempfile::tempdir().unwrap();
        let folder = sys.path().join("class/tty/ttyUSB0/device");
        fs::create_dir_all(&folder).unwrap();
        for (text, health) in [("16\n", Health::Warning), ("1\n", Health::Ok)] {
            fs::write(folder.join("latency_timer"), text).unwrap();
            let found = check_latency(sys.path(), Path::new("/dev/ttyUSB0")).unwrap();
            assert_eq!(found.health, health, "{found:?}");
        }
        assert_eq!(check_latency(sys.path(), Path::new("/dev/ttyS0")), None);
    }
}
