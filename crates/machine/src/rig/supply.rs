//! Ranges of the coil supply. Its amplifier has several gains: two outputs of the rig select one, and two inputs read
//! it back.
//!
//! The gains in `config/rig.toml` are those at factor 1. A lot runs in one range: [`Wiring::in_range`] returns the
//! wiring with the gains of that range, so that the code for levels, readings and rates needs to know no range.

use super::fault::Fault;
use super::point::{DigitalInput, DigitalOutput};
use super::settings::{RigSettings, SupplyRangeSettings};
use super::wiring::{Module, Wiring};
use std::collections::BTreeMap;
use std::fmt;
use units::{Ampere, Span, Volt};

/// Outputs that select a range, bit 0 first.
pub const SELECT: [&str; 2] = ["supply_range_0", "supply_range_1"];
/// Inputs that read the range back, bit 0 first.
pub const READ_BACK: [&str; 2] = ["supply_range_0_set", "supply_range_1_set"];

/// Longest time that the relays of a range may take to switch, with all sources at zero.
pub const SWITCHING_TIMEOUT: Span = Span::ms(500);

/// One range of the supply.
#[derive(Debug, Clone, PartialEq)]
pub struct SupplyRange {
    /// Name in `rig.toml`; on a rig without ranges the name of the module that is its strongest source.
    pub name: String,
    /// Bits that select the range and read it back.
    pub code: u8,
    /// Factor by which the range multiplies the gains of all sources, and divides those of the inputs behind the
    /// amplifier.
    pub factor: f64,
    /// Highest voltage of the supply.
    pub max: Volt,
    /// Largest current of the supply; `None` on a rig without ranges, whose `rig.toml` states none.
    pub max_current: Option<Ampere>,
}

/// Greatest voltage and current that a test needs from the supply, each with the key of the recipe that sets it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupplyDemand {
    /// Highest voltage, with the tolerance of the sources.
    pub volts: Volt,
    /// Key that sets the voltage.
    pub volts_key: &'static str,
    /// Largest current of a good part.
    pub current: Ampere,
    /// Key that sets the current.
    pub current_key: &'static str,
}

/// A supply in another range than the one selected, with the names of both ranges.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RangeMismatch {
    /// The range that the outputs select.
    pub selected: String,
    /// The range that the inputs read back.
    pub found: String,
}

impl fmt::Display for RangeMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, not {}", self.found, self.selected)
    }
}

/// The points that select a range and read it back, bit 0 first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RangeSelector {
    /// Outputs that select the range.
    pub outputs: [DigitalOutput; 2],
    /// Inputs that read the range back.
    pub inputs: [DigitalInput; 2],
    /// Names of the ranges by code.
    names: BTreeMap<u8, String>,
}

impl RangeSelector {
    /// Returns how the range that was read back differs from `range`; `None` when they agree.
    pub fn mismatch(&self, range: &SupplyRange, read_back: u8) -> Option<RangeMismatch> {
        let name = self.names.get(&read_back).cloned();
        (read_back != range.code).then(|| RangeMismatch {
            selected: range.name.clone(),
            found: name.unwrap_or_else(|| format!("code {read_back}")),
        })
    }

    /// Returns each output with its state for `code`.
    pub fn select(&self, code: u8) -> [(DigitalOutput, bool); 2] {
        std::array::from_fn(|bit| (self.outputs[bit], bit_of(code, bit)))
    }

    /// Returns each input with its state in the range of `code`.
    pub fn expects(&self, code: u8) -> [(DigitalInput, bool); 2] {
        std::array::from_fn(|bit| (self.inputs[bit], bit_of(code, bit)))
    }
}

fn bit_of(code: u8, bit: usize) -> bool {
    code >> bit & 1 == 1
}

/// Returns the code that these states of both inputs read back, bit 0 first.
pub fn code_of(states: [bool; 2]) -> u8 {
    u8::from(states[0]) | u8::from(states[1]) << 1
}

impl SupplyRange {
    /// Returns true for a range of `rig.toml`, which two outputs select; false for the only range of a rig without
    /// ranges.
    pub fn is_selected(&self) -> bool {
        self.max_current.is_some()
    }

    /// Returns the setting that limits the voltage.
    fn limits_volts(&self) -> String {
        match self.is_selected() {
            true => format!("rig.toml supply_range.{}.max_v", self.name),
            false => format!("the full scale of module {}", self.name),
        }
    }

    fn gives_current(&self, current: Ampere) -> bool {
        self.max_current.is_none_or(|max| current <= max)
    }
}

impl SupplyDemand {
    /// Returns the smallest range that meets the demand; panics for a rig without sources.
    ///
    /// # Errors
    /// Fails with the key of the recipe that needs too much, and the limit of the rig.
    pub fn range<'a>(&self, wiring: &'a Wiring) -> Result<&'a SupplyRange, Fault> {
        let enough = |range: &&SupplyRange| self.volts <= range.max;
        let mut ranges = wiring.supply_ranges.iter().filter(enough);
        if let Some(range) = ranges.find(|range| range.gives_current(self.current)) {
            return Ok(range);
        }
        let strong = wiring.supply_ranges.iter().filter(enough);
        let strongest = strong.max_by(|a, b| {
            let milliampere = |range: &SupplyRange| range.max_current.map_or(f64::MAX, |it| it.0);
            milliampere(a).total_cmp(&milliampere(b))
        });
        Err(match (strongest, wiring.supply_ranges.last()) {
            (Some(range), _) => self.current_above(range),
            (None, Some(range)) => self.volts_above(range),
            (None, None) => panic!("a supply without a source"),
        })
    }

    fn volts_above(&self, range: &SupplyRange) -> Fault {
        let found = format!("{:.2} V at the supply", self.volts.0);
        let expected = format!("at most {} V: {}", range.max.0, range.limits_volts());
        Fault::new(self.volts_key, found, expected)
    }

    fn current_above(&self, range: &SupplyRange) -> Fault {
        let found = format!("{:.1} mA at {:.2} V", self.current.0 * 1e3, self.volts.0);
        let max_ma = range.max_current.map_or(f64::INFINITY, |it| it.0 * 1e3);
        let expected = format!(
            "at most {max_ma:.1} mA: rig.toml supply_range.{}.max_ma",
            range.name
        );
        Fault::new(self.current_key, found, expected)
    }
}

impl Wiring {
    /// Returns this wiring with the gains that hold in `range`; panics if it has those of a range already.
    pub fn in_range(&self, range: &SupplyRange) -> Self {
        assert!(self.supply_range.is_none(), "gains of one range already");
        let mut ranged = self.clone();
        for (_, source) in &mut ranged.analog_out {
            source.gain *= range.factor;
        }
        let divided = ranged
            .analog_in
            .iter_mut()
            .filter(|(point, _)| point.ranged);
        divided.for_each(|(_, at)| at.gain /= range.factor);
        ranged.supply_range = Some(range.clone());
        ranged
    }

    /// Returns the points that select the range of the supply; `None` on a rig without ranges.
    pub fn range_selector(&self) -> Option<RangeSelector> {
        let [low, high] = SELECT.map(|name| self.digital_output(name));
        let [low_set, high_set] = READ_BACK.map(|name| self.digital_input(name));
        let ranges = self.supply_ranges.iter();
        Some(RangeSelector {
            outputs: [low?, high?],
            inputs: [low_set?, high_set?],
            names: ranges.map(|it| (it.code, it.name.clone())).collect(),
        })
    }
}

/// Resolves the ranges of `rig.toml`, smallest first. Without ranges there, returns the range of the strongest source,
/// at factor 1.
pub(super) fn resolve_ranges(
    settings: &RigSettings,
    modules: &[Module],
) -> Result<Vec<SupplyRange>, Fault> {
    check_points(settings)?;
    let Some(most) = strongest(settings, modules) else {
        return match settings.supply_range.keys().next() {
            Some(name) => Err(Fault::new(
                format!("supply_range.{name}"),
                "a range",
                "sources in [analog_out]",
            )),
            None => Ok(Vec::new()),
        };
    };
    if settings.supply_range.is_empty() {
        let (module, max) = most;
        return Ok(vec![SupplyRange {
            name: module.to_owned(),
            code: 0,
            factor: 1.0,
            max,
            max_current: None,
        }]);
    }
    let each = settings.supply_range.iter();
    let mut ranges: Vec<SupplyRange> = each
        .map(|(name, range)| resolve_range(name, range, most))
        .collect::<Result<_, Fault>>()?;
    check_codes(&ranges)?;
    ranges.sort_by(|a, b| a.max.0.total_cmp(&b.max.0));
    Ok(ranges)
}

/// Returns the source with the highest full scale: its module, and this full scale in volts of the supply at factor 1;
/// `None` without a source.
fn strongest<'a>(settings: &'a RigSettings, modules: &[Module]) -> Option<(&'a str, Volt)> {
    let full_scale = |name: &str| {
        let module = modules.iter().find(|module| module.name == name)?;
        Some(module.type_code.full_scale()?.high)
    };
    let sources = settings.analog_out.values();
    let volts = sources.filter_map(|source| {
        let volts = full_scale(&source.module)? * source.gain;
        Some((source.module.as_str(), Volt(volts)))
    });
    volts.max_by(|a, b| a.1.0.total_cmp(&b.1.0))
}

fn resolve_range(
    name: &str,
    range: &SupplyRangeSettings,
    (module, most): (&str, Volt),
) -> Result<SupplyRange, Fault> {
    let reaches = most.0 * range.factor;
    if range.max_v > reaches {
        let expected = format!(
            "at most {reaches} V, the full scale of module {module} at factor {}",
            range.factor
        );
        let key = format!("supply_range.{name}.max_v");
        return Err(Fault::new(key, range.max_v, expected));
    }
    Ok(SupplyRange {
        name: name.to_owned(),
        code: range.code,
        factor: range.factor,
        max: Volt(range.max_v),
        max_current: Some(Ampere(range.max_ma * 1e-3)),
    })
}

/// Checks that no two ranges share a code.
fn check_codes(ranges: &[SupplyRange]) -> Result<(), Fault> {
    for (index, range) in ranges.iter().enumerate() {
        let mut others = ranges[..index].iter();
        if let Some(other) = others.find(|other| other.code == range.code) {
            let key = |range: &SupplyRange| format!("supply_range.{}.code", range.name);
            let fault = Fault::new(key(range), range.code, "a code of its own");
            return Err(fault.against(key(other)));
        }
    }
    Ok(())
}

/// Checks that the points which select a range and read it back are wired exactly where `rig.toml` has ranges.
fn check_points(settings: &RigSettings) -> Result<(), Fault> {
    let has_ranges = !settings.supply_range.is_empty();
    let out = |name: &&str| settings.digital_out.contains_key(*name);
    let read = |name: &&str| settings.digital_in.contains_key(*name);
    let outputs = SELECT.iter().map(|it| ("digital_out", *it, out(it)));
    let inputs = READ_BACK.iter().map(|it| ("digital_in", *it, read(it)));
    let mut wrong = outputs.chain(inputs).filter(|it| it.2 != has_ranges);
    let Some((section, name, _)) = wrong.next() else {
        return Ok(());
    };
    let (found, expected) = match has_ranges {
        true => ("nothing", "a point for the ranges of [supply_range]"),
        false => ("a point", "ranges in [supply_range]"),
    };
    Err(Fault::new(format!("{section}.{name}"), found, expected))
}
