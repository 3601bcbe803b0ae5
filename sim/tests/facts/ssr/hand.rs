//! A client that writes outputs and reads inputs by DCON requests, and sends SCPI lines to the instruments.

use std::path::PathBuf;

use rigsim::config::{RigFile, read_rig};
use rigsim::scpi::bench::Desk;
use rigsim::scpi::port::Out;
use rigsim::{Files, Options, SharedRig};

pub const RECIPE: &str = "ssr-dc-60v-3a";

/// The instrument behind the adapter; the next text selects it there.
pub const AC: &str = "ac_source";
const ADAPTER: &str = "++mode 1\n++auto 0\n++eos 2\n++read_tmo_ms 3000\n++addr 9\n";

/// Client of one rig; time in microseconds.
pub struct Hand {
    pub rig: SharedRig,
    file: RigFile,
    bits: std::collections::BTreeMap<String, u16>,
    /// Names of the ports of the instruments.
    ports: Vec<String>,
    pub t_us: u64,
    /// Every byte that modules and instruments have sent.
    pub heard: Vec<u8>,
}

pub fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../config/rigs/ssr"))
}

pub fn options(seed: u64, faults: &[&str]) -> Options {
    Options {
        files: Files::Directory(folder()),
        world: None,
        seed,
        recipe: RECIPE.into(),
        parts: Some(400),
        reference_parts: false,
        faults: faults.iter().map(ToString::to_string).collect(),
    }
}

/// Returns the world file with these lines on top, in a folder that must live as long as the rig is built.
pub fn world(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("world.toml");
    std::fs::write(&path, text).expect("a file");
    (folder, path)
}

impl Hand {
    pub fn new(seed: u64) -> Self {
        Self::of(&options(seed, &[]))
    }

    /// Builds a rig whose world differs by these lines.
    pub fn in_world(seed: u64, text: &str) -> Self {
        let (_folder, path) = world(text);
        Self::of(&Options {
            world: Some(path),
            ..options(seed, &[])
        })
    }

    pub fn of(options: &Options) -> Self {
        let rig = rigsim::build(options).expect("a rig");
        let ports = rig.ports().into_iter().map(|(name, _)| name).collect();
        Self {
            rig,
            file: read_rig(&options.files).expect("a rig file"),
            bits: Default::default(),
            ports,
            t_us: 0,
            heard: Vec::new(),
        }
    }

    /// Sends a request to the line of a module and returns the reply without checksum.
    pub fn request(&mut self, module: &str, text: &str) -> String {
        let spec = self.file.modules.iter().find(|it| it.id == module);
        let line = spec.map(|it| it.line.clone()).expect("a module");
        let lines = self.file.lines.iter().position(|it| it.name == line);
        let sum = text.bytes().fold(0u8, u8::wrapping_add);
        let bytes = format!("{text}{sum:02X}").into_bytes();
        let reply = self.rig.exchange(lines.expect("a line"), &bytes, self.t_us);
        let Some(reply) = reply else {
            return String::new();
        };
        self.t_us = self.t_us.max(reply.at_us);
        self.heard.extend(&reply.bytes);
        let text = String::from_utf8_lossy(&reply.bytes).into_owned();
        text[..text.len() - 3].to_owned()
    }

    fn address(&self, module: &str) -> u8 {
        let spec = self.file.modules.iter().find(|it| it.id == module);
        spec.map(|it| it.address).expect("a module")
    }

    /// Switches an output by its name; the request takes no time before it acts.
    pub fn set(&mut self, point: &str, on: bool) {
        let terminal = self.file.digital_out[point].clone();
        let bits = self.bits.entry(terminal.module.clone()).or_default();
        *bits = *bits & !(1 << terminal.channel) | u16::from(on) << terminal.channel;
        let bits = *bits;
        let request = format!("@{:02X}{bits:04X}", self.address(&terminal.module));
        assert_eq!(self.request(&terminal.module, &request), ">", "{point}");
    }

    /// Reads an input by its name.
    pub fn is_on(&mut self, point: &str) -> bool {
        let terminal = self.file.digital_in[point].clone();
        let request = format!("@{:02X}", self.address(&terminal.module));
        let reply = self.request(&terminal.module, &request);
        let levels = u16::from_str_radix(&reply[1..], 16).expect("levels");
        (levels >> terminal.channel & 1 == 1) != terminal.active_low
    }

    /// Reads the voltage at the socket, apart from the instruments, volts.
    pub fn residual_v(&mut self) -> f64 {
        self.wait(100.0);
        let reply = self.request("residual_ai", "#090");
        let code = u16::from_str_radix(&reply[1..], 16).expect("a code");
        f64::from(code as i16) / 32_768.0 * 10.0 / 0.01
    }

    pub fn wait(&mut self, ms: f64) {
        self.t_us += (ms * 1e3) as u64;
        self.rig.advance(self.t_us);
    }

    fn pulse(&mut self, point: &str, ms: f64) {
        self.set(point, true);
        self.wait(ms);
        self.set(point, false);
    }

    /// Feeds a part from the magazine to the nest, clamped, probes up.
    pub fn feed(&mut self) {
        self.pulse("escapement_release", 300.0);
        self.pulse("pusher_extend", 600.0);
        self.wait(500.0);
        assert!(self.is_on("nest_present"));
        self.pulse("clamp_close", 250.0);
        self.set("probe_lift", true);
        self.wait(300.0);
        assert!(self.is_on("probe_chain"));
    }

    /// Sends the part in the nest to the bin at a point of the axis.
    pub fn sort(&mut self, point: u8) {
        self.set("axis_servo_on", true);
        self.axis(0);
        self.set("sort_z_lower", true);
        self.wait(500.0);
        self.pulse("gripper_close", 200.0);
        self.set("probe_lift", false);
        self.wait(300.0);
        self.pulse("clamp_open", 250.0);
        self.set("sort_z_lower", false);
        self.wait(500.0);
        self.axis(point);
        self.pulse("gripper_release", 500.0);
    }

    fn axis(&mut self, point: u8) {
        for (n, name) in ["axis_point_0", "axis_point_1", "axis_point_2"]
            .into_iter()
            .enumerate()
        {
            self.set(name, point >> n & 1 == 1);
        }
        self.pulse("axis_drive", 900.0);
    }

    /// Returns the port of an instrument; the AC source is the one behind the adapter.
    fn port(&self, instrument: &str) -> usize {
        let port = self
            .ports
            .iter()
            .position(|name| name == instrument || instrument == AC && name.contains(':'));
        port.expect("an instrument")
    }

    /// Sends a line to an instrument and gives it the time of a command.
    pub fn tell(&mut self, instrument: &str, line: &str) {
        let before = if instrument == AC { ADAPTER } else { "" };
        let bytes = format!("{before}{line}\n").into_bytes();
        let port = self.port(instrument);
        self.rig.receive(port, &bytes, self.t_us);
        self.wait(30.0);
        // The adapter works while its host listens.
        assert_eq!(self.rig.due(port, self.t_us), Vec::new(), "{line}");
        self.wait(5.0);
    }

    /// Sends a query and returns the bytes of its reply.
    pub fn ask_bytes(&mut self, instrument: &str, line: &str) -> Vec<u8> {
        let port = self.port(instrument);
        let text = match instrument == AC {
            true => format!("{ADAPTER}{line}\n++read eoi\n"),
            false => format!("{line}\n"),
        };
        self.rig.receive(port, text.as_bytes(), self.t_us);
        for _ in 0..10_000 {
            self.t_us += 500;
            for out in self.rig.due(port, self.t_us) {
                if let Out::Bytes(bytes) = out {
                    self.heard.extend(&bytes);
                    return bytes;
                }
            }
        }
        panic!("no reply to {line}");
    }

    pub fn ask(&mut self, instrument: &str, line: &str) -> String {
        let bytes = self.ask_bytes(instrument, line);
        String::from_utf8_lossy(&bytes).trim_end().to_owned()
    }

    /// Asks for one number.
    pub fn value(&mut self, instrument: &str, line: &str) -> f64 {
        self.ask(instrument, line).parse().expect("a number")
    }

    /// Returns a true figure of the part that came into the nest last.
    pub fn truth(&self, key: &str) -> serde_json::Value {
        let truth = self.rig.truth();
        truth.last().map(|it| it[key].clone()).expect("a part")
    }

    pub fn figure(&self, key: &str) -> f64 {
        self.truth(key).as_f64().expect("a figure")
    }

    /// Sets a source-measure unit up to source a voltage and to measure the current, four wires.
    pub fn source(&mut self, unit: &str, volts: f64, limit_a: f64, range_a: f64) {
        for line in [
            "*RST".to_owned(),
            ":SOUR:FUNC VOLT".into(),
            ":SOUR:VOLT:RANG 200".into(),
            format!(":SOUR:VOLT:ILIM {limit_a}"),
            ":SENS:FUNC \"CURR\";:SENS:CURR:RSEN ON".into(),
            format!(":SENS:CURR:RANG {range_a}"),
            format!(":SOUR:VOLT {volts}"),
            ":OUTP ON".into(),
        ] {
            self.tell(unit, &line);
        }
    }

    /// Sets the unit at the output up to source a current and to measure the voltage, four wires.
    pub fn source_amps(&mut self, amps: f64, plc: f64) {
        for line in [
            "*RST".to_owned(),
            ":SOUR:FUNC CURR;:SOUR:CURR:RANG 1;:SOUR:CURR:VLIM 2".into(),
            ":SENS:FUNC \"VOLT\";:SENS:VOLT:RSEN ON;:SENS:VOLT:RANG 2".into(),
            format!(":SENS:VOLT:NPLC {plc}"),
            format!(":SOUR:CURR {amps}"),
            ":OUTP ON".into(),
        ] {
            self.tell("smu_out", &line);
        }
    }

    /// Drives the input with a voltage from its unit.
    pub fn control(&mut self, volts: f64) {
        self.source("smu_in", volts, 0.05, 0.1);
    }

    /// Loads the output with 8 V behind 1 kohm.
    pub fn load(&mut self) {
        self.set("bleed_open", true);
        self.set("smu_load", true);
        self.source("smu_out", 8.0, 0.05, 0.1);
        self.set("smu_to_output", true);
        self.wait(10.0);
    }
}
