//! The coil supply of the interface board: three sources behind an amplifier with ranges.
//!
//! The range relays follow the command after the drive has been off and all sources at zero for a few milliseconds;
//! until then the supply keeps its range. The factor of the range multiplies the gains of the sources and the change of
//! voltage that starts a ramp.

use crate::table::read_fields;
use crate::truth::Overdrive;
use crate::world::signal::{Commands, Out, Source};
use crate::world::table::BoardTable;
use crate::world::wiring::Wiring;

/// Range of the amplifier, from the table `[supply_range]` of `rig.toml`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupplyRange {
    /// State of the two range outputs, bit n = `supply_range_n`.
    pub code: u8,
    /// Factor by which the range multiplies the gains of the sources.
    pub factor: f64,
    /// Largest voltage, V.
    pub max_v: f64,
    /// Current limit, mA.
    pub max_ma: f64,
}

read_fields!(SupplyRange {
    code,
    factor,
    max_v,
    max_ma
});

/// Sources, range and limits of the supply.
#[derive(Debug, Clone)]
pub struct CoilSupply {
    ranges: Vec<SupplyRange>,
    range: SupplyRange,
    /// Range that the relays are moving to, and the instant at which they reach it, microseconds.
    change: Option<(SupplyRange, f64)>,
    change_us: f64,
    zero_mv: f64,
    /// Voltage at the terminal of each source, V.
    volts: [f64; 3],
    /// Volts that the supply gives per volt at the terminal of each source, in a range with factor 1.
    gain: [f64; 3],
    ramp_start_mv: f64,
    arm_level_v: f64,
    moved: bool,
    stuck: bool,
    overdriving: bool,
    overdrives: Vec<Overdrive>,
}

impl CoilSupply {
    /// Creates the supply in the range with the lowest code, with all sources at zero; without `ranges` it has one
    /// range with factor 1 and the limits of `table`.
    pub fn new(table: &BoardTable, wiring: &Wiring, mut ranges: Vec<SupplyRange>) -> Self {
        ranges.sort_by_key(|range| range.code);
        let only = SupplyRange {
            code: 0,
            factor: 1.0,
            max_v: table.supply_max_v,
            max_ma: table.supply_limit_ma,
        };
        Self {
            range: ranges.first().copied().unwrap_or(only),
            ranges,
            change: None,
            change_us: table.supply_range_ms * 1000.0,
            zero_mv: table.supply_zero_mv,
            volts: [0.0; 3],
            gain: gains(wiring),
            ramp_start_mv: table.ramp_start_mv,
            arm_level_v: 0.0,
            moved: false,
            stuck: false,
            overdriving: false,
            overdrives: Vec::new(),
        }
    }

    /// Sets the terminal of a source to `volts`; returns true when the supply thereby starts a ramp.
    pub fn set(&mut self, source: Source, volts: f64) -> bool {
        self.volts[source as usize] = volts;
        let moved_mv = (self.volts() - self.arm_level_v).abs() * 1000.0;
        let away = moved_mv > self.ramp_start_mv * self.range.factor;
        let before = std::mem::replace(&mut self.moved, away);
        away && !before
    }

    /// Takes the present voltage as the level from which a ramp starts.
    pub fn arm(&mut self) {
        self.arm_level_v = self.volts();
        self.moved = false;
    }

    /// Lets the range relays follow the commands; `drive_off` means that neither command nor switch drives the coil.
    pub fn follow(&mut self, now_us: f64, commands: Commands, drive_off: bool) {
        let at_zero = self.volts.iter().all(|v| v.abs() * 1000.0 < self.zero_mv);
        let to = self
            .commanded(commands)
            .filter(|to| drive_off && at_zero && !self.stuck && *to != self.range);
        self.change = to.map(|to| match self.change {
            Some((moving_to, at_us)) if moving_to == to => (to, at_us),
            Some(_) | None => (to, now_us + self.change_us),
        });
    }

    /// Makes the relays stick in a range from now on.
    pub fn stick(&mut self, range: SupplyRange) {
        self.range = range;
        self.change = None;
        self.stuck = true;
    }

    /// Records an overdrive when it begins; `on_coil` means that the drive reaches a coil.
    pub fn watch(&mut self, now_us: f64, commands: Commands, on_coil: bool) {
        // The drive may outlast its command while the contact source switches off first: that does not count as an
        // overdrive.
        let excess = self
            .commanded(commands)
            .filter(|_| on_coil && commands.is_on(Out::CoilDrive))
            .filter(|to| to.code != self.range.code && self.volts() > self.volts_in(*to));
        let before = std::mem::replace(&mut self.overdriving, excess.is_some());
        if let Some(to) = excess.filter(|_| !before) {
            self.overdrives.push(Overdrive {
                t_us: now_us as u64,
                commanded: to.code,
                range: self.range.code,
                supply_v: self.volts(),
            });
        }
    }

    /// Returns every overdrive so far, in order of time.
    pub fn overdrives(&self) -> &[Overdrive] {
        &self.overdrives
    }

    /// Returns the instant at which the relays reach another range, microseconds.
    pub fn next_us(&self) -> Option<f64> {
        self.change.map(|(_, at_us)| at_us)
    }

    /// Completes a change of range that is due; returns true when there was one.
    pub fn expire(&mut self, now_us: f64) -> bool {
        let due = self.change.take_if(|(_, at_us)| *at_us <= now_us);
        if let Some((range, _)) = due {
            self.range = range;
        }
        due.is_some()
    }

    /// Returns the range that the auxiliary contacts of the relays report.
    pub fn range(&self) -> SupplyRange {
        self.range
    }

    /// Returns the voltage without load, V.
    pub fn volts(&self) -> f64 {
        self.volts_in(self.range)
    }

    /// Returns the voltage into a resistance, V, reduced where the range limits the current.
    pub fn limited_v(&self, ohm: f64) -> f64 {
        self.volts().min(self.range.max_ma * 1e-3 * ohm)
    }

    fn volts_in(&self, range: SupplyRange) -> f64 {
        let sum: f64 = self.volts.iter().zip(self.gain).map(|(v, g)| v * g).sum();
        (sum * range.factor).clamp(0.0, range.max_v)
    }

    /// Returns the commanded range; `None` when the rig has no range of that code.
    fn commanded(&self, commands: Commands) -> Option<SupplyRange> {
        let bit = |out| u8::from(commands.is_on(out));
        let code = bit(Out::SupplyRange0) | bit(Out::SupplyRange1) << 1;
        self.ranges.iter().find(|range| range.code == code).copied()
    }
}

/// Returns, for each source, the volts of the supply per volt at its terminal; 0 for a source without a wire.
fn gains(wiring: &Wiring) -> [f64; 3] {
    let mut gains = [0.0; 3];
    for (_, wire) in wiring.sources.values().flatten() {
        gains[wire.signal as usize] = wire.gain;
    }
    gains
}
