//! A client of the chamber that switches outputs and reads inputs by DCON requests.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use rigsim::config::{RigFile, read_rig};
use rigsim::{Files, Options, SharedRig};

const RECIPE: &str = "thermostat-ksd9700";

/// Client of one rig; times in microseconds.
pub struct Hand {
    pub rig: SharedRig,
    file: RigFile,
    bits: BTreeMap<String, u16>,
    pub t_us: u64,
}

fn files() -> Files {
    let folder = PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../config/rigs/thermostat"
    ));
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).expect("a file");
    let recipe = "[limits]\n\
        operate_temperature_c = { low = 80.0, high = 90.0 }\n\
        differential_k = { low = 14.0, high = 26.0 }\n";
    let texts = [
        ("rig.toml".to_owned(), text("rig.toml")),
        ("sim.toml".to_owned(), text("sim.toml")),
        ("rack.toml".to_owned(), text("rack.toml")),
        (format!("recipes/{RECIPE}.toml"), recipe.to_owned()),
    ];
    Files::Texts(texts.into())
}

pub fn options(seed: u64, faults: &[&str]) -> Options {
    Options {
        files: files(),
        world: None,
        seed,
        recipe: RECIPE.into(),
        parts: Some(100),
        reference_parts: true,
        faults: faults.iter().map(ToString::to_string).collect(),
    }
}

impl Hand {
    pub fn new(faults: &[&str]) -> Self {
        Self::of(&options(1, faults))
    }

    /// Builds a rig in a world with these lines added.
    pub fn in_world(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("world.toml");
        std::fs::write(&path, text).expect("a file");
        Self::of(&Options {
            world: Some(path),
            ..options(1, &[])
        })
    }

    pub fn of(options: &Options) -> Self {
        Self {
            rig: rigsim::build(options).expect("a rig"),
            file: read_rig(&options.files).expect("a rig file"),
            bits: BTreeMap::new(),
            t_us: 0,
        }
    }

    /// Sends a request and returns the reply without its checksum; empty without a reply.
    pub fn request(&mut self, text: &str) -> String {
        let sum = text.bytes().fold(0u8, u8::wrapping_add);
        let bytes = format!("{text}{sum:02X}").into_bytes();
        let Some(reply) = self.rig.exchange(0, &bytes, self.t_us) else {
            return String::new();
        };
        self.t_us = self.t_us.max(reply.at_us);
        let text = String::from_utf8_lossy(&reply.bytes).into_owned();
        text[..text.len() - 3].to_owned()
    }

    fn address(&self, module: &str) -> u8 {
        let spec = self.file.modules.iter().find(|it| it.id == module);
        spec.map(|it| it.address).expect("a module")
    }

    /// Switches outputs by name.
    pub fn set(&mut self, points: &[&str], on: bool) {
        for point in points {
            let terminal = self.file.digital_out[*point].clone();
            let bits = self.bits.entry(terminal.module.clone()).or_default();
            *bits = *bits & !(1 << terminal.channel) | u16::from(on) << terminal.channel;
            let bits = *bits;
            let digits = if terminal.module == "relay_do" { 2 } else { 4 };
            let address = self.address(&terminal.module);
            let request = format!("@{address:02X}{bits:0digits$X}");
            assert_eq!(self.request(&request), ">", "{point}");
        }
    }

    fn level(&mut self, module: &str, channel: u8) -> bool {
        let reply = self.request(&format!("@{:02X}", self.address(module)));
        let levels = u16::from_str_radix(&reply[1..], 16).expect("levels");
        levels >> channel & 1 == 1
    }

    /// Reads an input by its name.
    pub fn is_on(&mut self, point: &str) -> bool {
        let terminal = self.file.digital_in[point].clone();
        self.level(&terminal.module, terminal.channel) != terminal.active_low
    }

    /// Checks whether the contact of the socket at `place`, from 0, is closed.
    pub fn is_closed(&mut self, place: usize) -> bool {
        let terminal = self.file.sockets[place].terminal.clone();
        !self.level(&terminal.module, terminal.channel)
    }

    /// Returns for each place whether its contact is closed; sends one request per module.
    pub fn closed(&mut self) -> Vec<bool> {
        let modules = self
            .file
            .sockets
            .iter()
            .map(|it| it.terminal.module.clone());
        let modules: BTreeSet<String> = modules.collect();
        let mut levels = BTreeMap::new();
        for module in modules {
            let reply = self.request(&format!("@{:02X}", self.address(&module)));
            let word = u16::from_str_radix(&reply[1..], 16).expect("levels");
            levels.insert(module, word);
        }
        let sockets = self.file.sockets.iter();
        let closed = |it: &rigsim::config::Socket| {
            levels[&it.terminal.module] >> it.terminal.channel & 1 == 0
        };
        sockets.map(closed).collect()
    }

    /// Reads the counter of the socket at a place.
    pub fn count(&mut self, place: usize) -> u64 {
        let terminal = self.file.sockets[place].terminal.clone();
        let address = self.address(&terminal.module);
        let reply = self.request(&format!("#{address:02X}{:X}", terminal.channel));
        reply[3..].parse().expect("a count")
    }

    /// Sets heater and vent, 0 to 1.
    pub fn drive(&mut self, duty: f64, vent: f64) {
        for (channel, share) in [(0, duty), (1, vent)] {
            assert_eq!(
                self.request(&format!("#23{channel}{:+07.3}", share * 10.0)),
                ">"
            );
        }
    }

    /// Returns the three Pt100 temperatures, degrees Celsius: control, reference, rack.
    pub fn temperatures(&mut self) -> [f64; 3] {
        let reply = self.request("#21");
        [0, 1, 2].map(|n| {
            let code = u16::from_str_radix(&reply[1 + n * 4..5 + n * 4], 16).expect("a code");
            f64::from(code) / 32_768.0 * 200.0
        })
    }

    /// Returns the temperature of the heater surface, degrees Celsius.
    pub fn heater_c(&mut self) -> f64 {
        let reply = self.request("#220");
        reply[1..].parse().expect("a temperature")
    }

    /// Reads the drop of the selected contact, millivolts.
    pub fn drop_mv(&mut self) -> f64 {
        let reply = self.request("#290");
        let code = u16::from_str_radix(&reply[1..], 16).expect("a code");
        f64::from(code as i16) / 32_768.0 * 10.0 / 50.0 * 1e3
    }

    /// Selects a socket by its number at the multiplexer.
    pub fn select(&mut self, number: u8) {
        for bit in 0..6 {
            self.set(&[&format!("socket_select_{bit}")], number >> bit & 1 == 1);
        }
    }

    /// Waits for `s` seconds, and sends a host OK each second.
    pub fn wait(&mut self, s: f64) {
        let end_us = self.t_us + (s * 1e6) as u64;
        while self.t_us < end_us {
            self.request("~**");
            self.t_us = end_us.min(self.t_us + 1_000_000);
            self.rig.advance(self.t_us);
        }
    }

    /// Lets the person fill the rack and locks the door.
    pub fn load(&mut self) {
        self.set(&["door_lock_release"], true);
        self.wait(130.0);
        assert!(self.is_on("door_closed"));
        self.set(&["door_lock_release"], false);
        assert!(self.is_on("door_locked"));
    }

    /// Switches fan and contactor on, and waits for the airflow.
    pub fn start(&mut self) {
        self.set(&["fan"], true);
        self.wait(3.0);
        assert!(self.is_on("airflow_ok"));
        self.set(&["main_contactor"], true);
    }
}
