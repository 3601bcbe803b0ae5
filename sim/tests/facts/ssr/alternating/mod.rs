//! Tests of AC parts on the line and in the loop.

mod board;
mod lot;
mod waves;

use std::collections::BTreeMap;
use std::path::Path;

use rigsim::{Files, Options};

use super::hand::{AC, Hand, folder, options, world};

/// A world without errors of instruments, with a quiet line, and without defects.
pub const QUIET: &str = "[instrument]
smu_in.exact = true
smu_out.exact = true
digitizer.exact = true
pulse_source.exact = true
ac_source.exact = true
[mains]
amplitude_sd_pct = 0.0
frequency_sd_hz = 0.0
third_pct = 0.0
fifth_pct = 0.0
phase_sd_us = 0.0
[ssr_ac.defects]
rate_pct = 0.0
";

/// Returns the files of the rig with recipes of AC parts for this line.
fn files(mains_v: f64, mains_hz: f64) -> Files {
    let mut texts = BTreeMap::new();
    read(&folder(), "", &mut texts);
    let dc = texts["recipes/ssr-dc-60v-3a.toml"].clone();
    for output in ["ac_zero_cross", "ac_random"] {
        let mains =
            format!("output = \"{output}\"\nmains_v = {mains_v:?}\nmains_hz = {mains_hz:?}\n");
        let recipe = dc.replace("output = \"dc\"", &mains);
        let recipe = recipe.replace("rated_a = 3.0", "rated_a = 5.0");
        texts.insert(format!("recipes/{output}.toml"), recipe);
    }
    Files::Texts(texts)
}

fn read(folder: &Path, prefix: &str, texts: &mut BTreeMap<String, String>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        let name = format!("{prefix}{}", name.to_string_lossy());
        match path.is_dir() {
            true => read(&path, &format!("{name}/"), texts),
            false => {
                let text = std::fs::read_to_string(&path).expect("a text");
                texts.insert(name, text);
            }
        }
    }
}

/// Returns a rig with AC parts of this output, in a world with these lines added.
fn rig(output: &str, (mains_v, mains_hz): (f64, f64), seed: u64, text: &str) -> Hand {
    let (_folder, path) = world(text);
    Hand::of(&Options {
        files: files(mains_v, mains_hz),
        recipe: output.into(),
        world: Some(path),
        ..options(seed, &[])
    })
}

const EUROPE: (f64, f64) = (230.0, 50.0);
const AMERICA: (f64, f64) = (115.0, 60.0);

impl Hand {
    /// Switches the AC source on at this voltage, frequency and current limit.
    fn supply(&mut self, volts: f64, hz: f64, limit_a: f64) {
        self.tell(AC, &format!("CURR:LIM {limit_a}"));
        self.tell(AC, &format!("VOLT:AC {volts};:FREQ {hz};:OUTP ON"));
        self.wait(60.0);
        assert_eq!(self.ask(AC, ":OUTP?"), "1");
    }

    /// Feeds a part, and connects it to the line.
    fn line(&mut self, (volts, hz): (f64, f64)) {
        self.feed();
        self.supply(volts, hz, 2.0);
        self.set("bleed_open", true);
        self.set("line_contactor", true);
        self.wait(40.0);
        assert!(!self.is_on("line_open"));
    }

    /// Feeds a part, and connects it to the loop of 5 A.
    fn in_loop(&mut self, hz: f64) {
        self.feed();
        self.supply(24.0, hz, 8.0);
        self.set("bleed_open", true);
        self.set("loop_contactor", true);
        self.wait(40.0);
        assert!(!self.is_on("loop_open"));
    }

    /// Sets the scales of the channels, volts per division, and the length of the record.
    fn scales(
        &mut self,
        [control, output, clamped, shunt]: [f64; 4],
        (length_s, points): (f64, usize),
    ) {
        for line in [
            format!(":CHAN1:SCAL {control};:CHAN2:SCAL {output}"),
            format!(":CHAN3:SCAL {clamped};:CHAN4:SCAL {shunt}"),
            format!(":TIM:SCAL {};:ACQ:MDEP {points}", length_s / 10.0),
            ":TIM:REF LEFT".into(),
        ] {
            self.tell("digitizer", &line);
        }
    }

    /// Records now; returns the volts of each channel.
    fn record(&mut self, points: usize) -> [Vec<f64>; 4] {
        self.tell("digitizer", ":TRIG:SOUR CHAN1;:TRIG:LEV 2;:SING");
        self.wait(60.0);
        self.tell("digitizer", ":TFOR");
        self.fetch(points)
    }

    /// Returns the record in memory, volts at the terminals: control, output, clamped, shunt.
    fn fetch(&mut self, points: usize) -> [Vec<f64>; 4] {
        while self.ask("digitizer", ":TRIG:STAT?") != "STOP" {
            self.wait(10.0);
        }
        self.tell(
            "digitizer",
            &format!(":WAV:MODE RAW;FORM WORD;STAR 1;STOP {points}"),
        );
        [1, 2, 3, 4].map(|channel| {
            self.tell("digitizer", &format!(":WAV:SOUR CHAN{channel}"));
            let scales: Vec<f64> = self
                .ask("digitizer", ":WAV:PRE?")
                .split(',')
                .map(|it| it.parse().expect("a scale"))
                .collect();
            let block = self.ask_bytes("digitizer", ":WAV:DATA?");
            let ratio = if channel == 2 { 0.01 } else { 1.0 };
            let codes = block[11..block.len() - 1].chunks(2);
            let codes = codes.map(|it| u16::from_le_bytes([it[0], it[1]]));
            codes
                .map(|code| (f64::from(code) - scales[8] - scales[9]) * scales[7] / ratio)
                .collect()
        })
    }

    /// Prepares a train of control pulses, and starts the record at its first edge.
    fn pulsed(
        &mut self,
        (period_s, width_s, count): (f64, f64, u32),
        points: usize,
    ) -> [Vec<f64>; 4] {
        self.set("drive_select", true);
        for line in [
            "*RST;:FUNC PULS;:OUTP:LOAD INF;:VOLT:LOW 0".to_owned(),
            ":BURS:MODE TRIG;:TRIG:SOUR BUS;:BURS:STAT ON;:VOLT:HIGH 5".into(),
            format!(":PULS:PER {period_s};:FUNC:PULS:WIDT {width_s};:BURS:NCYC {count}"),
            ":OUTP ON".into(),
        ] {
            self.tell("pulse_source", &line);
        }
        self.wait(200.0);
        self.tell(
            "digitizer",
            ":TRIG:SOUR CHAN1;:TRIG:LEV 2;:TRIG:SLOP POS;:SING",
        );
        self.wait(100.0);
        self.tell("pulse_source", "*TRG");
        self.fetch(points)
    }
}
