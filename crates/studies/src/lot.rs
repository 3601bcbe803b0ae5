//! The rows of one lot, joined with the truth about its parts.
//!
//! [`Lot::read`] joins two files of one run by `seq`, each with one JSON object per line: the rows of `run --json` and
//! the truth of `--truth`. [`Lot::read`] ignores unknown keys, so that later versions may add keys to either file.

use anyhow::{Context, bail};
use machine::dut::Characteristic;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// One judged part: its row, and its truth.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct Part {
    /// Number of the part in the order of entering the nest, from 1.
    pub seq: u64,
    /// `pass`, `fail` or `void`.
    pub verdict: String,
    /// Bin that the row names; empty for a part that never landed.
    pub bin: String,
    /// Reasons for a verdict other than `pass`.
    #[serde(default)]
    pub reasons: Vec<String>,
    /// Values by key; a value that is not a number states whether the part conforms.
    #[serde(default)]
    values: BTreeMap<String, Value>,
    #[serde(default)]
    uncertainty: BTreeMap<String, Option<f64>>,
    /// Rig time from raised probes to the verdict, seconds.
    pub test_s: Option<f64>,
    /// Rig time from the nest exit of the previous part to that of this part, seconds.
    pub cycle_s: Option<f64>,
    /// Rig time of each piece of the test: name of the piece, and seconds.
    #[serde(default)]
    pub spent: BTreeMap<String, f64>,
    /// Rig time of each stage of the test: name of the stage, and seconds.
    #[serde(default)]
    pub stages: BTreeMap<String, f64>,
    /// True when a true value lies beyond a limit of the recipe, defect or not.
    #[serde(skip)]
    pub is_out_of_limits: bool,
    /// Truth about the part; `None` when the truth file has no such part.
    #[serde(skip)]
    pub truth: Option<Truth>,
}

/// Truth about a part.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct Truth {
    seq: u64,
    defect: Option<String>,
    landed_in: Option<String>,
    #[serde(flatten)]
    values: BTreeMap<String, Value>,
}

/// Each characteristic with the range within the limits of the recipe, in its unit.
pub type Admitted = Vec<(Characteristic, RangeInclusive<f64>)>;

impl Truth {
    fn value(&self, characteristic: Characteristic) -> Option<f64> {
        self.values.get(characteristic.key())?.as_f64()
    }

    fn is_out_of_limits(&self, admitted: &[(Characteristic, RangeInclusive<f64>)]) -> bool {
        let out = |(characteristic, range): &(Characteristic, RangeInclusive<f64>)| {
            self.value(*characteristic)
                .is_some_and(|value| !range.contains(&value))
        };
        admitted.iter().any(out)
    }
}

/// A measured value and its truth, in the unit of the characteristic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Measured value.
    pub value: f64,
    /// Expanded uncertainty, k = 2.
    pub uncertainty: Option<f64>,
    /// True value.
    pub truth: f64,
}

impl Part {
    /// Returns the name of the defect; `None` for a part without one, or without a truth.
    pub fn defect(&self) -> Option<&str> {
        self.truth.as_ref()?.defect.as_deref()
    }

    /// Returns the bin where the body came to rest; `None` when it lies elsewhere, or without a truth.
    pub fn landed_in(&self) -> Option<&str> {
        self.truth.as_ref()?.landed_in.as_deref()
    }

    /// Returns true when the row names the pass bin, or when the body lies in it.
    pub fn has_passed(&self) -> bool {
        self.bin == "pass" || self.landed_in() == Some("pass")
    }

    /// Returns true when the truth file has the part and names no defect.
    pub fn is_good(&self) -> bool {
        self.truth.is_some() && self.defect().is_none()
    }

    /// Returns true for a part without a defect whose true values all lie within the limits.
    pub fn is_conforming(&self) -> bool {
        self.is_good() && !self.is_out_of_limits
    }

    /// Returns value and truth of a characteristic; `None` when the row has no value or the part has no true one.
    pub fn reading(&self, characteristic: impl Into<Characteristic>) -> Option<Reading> {
        let characteristic = characteristic.into();
        let key = characteristic.key();
        Some(Reading {
            value: self.values.get(key)?.as_f64()?,
            uncertainty: self.uncertainty.get(key).copied().flatten(),
            truth: self.truth.as_ref()?.value(characteristic)?,
        })
    }

    /// Returns true when the row names the bin where the body came to rest.
    pub fn is_in_named_bin(&self) -> bool {
        self.landed_in() == Some(self.bin.as_str())
    }
}

/// Figures of a lot as a whole.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct Summary {
    /// Number of alarms that the lot raised.
    pub alarms: u64,
    /// Writes to any EEPROM during the lot; `None` when the run did not count them.
    pub eeprom_writes: Option<u64>,
    /// Hash of all bytes on each line, by the name of the line.
    #[serde(default)]
    pub bytes: BTreeMap<String, String>,
    /// Promises of rig and recipe that the run found broken.
    #[serde(default)]
    pub broken_promises: Vec<BrokenPromise>,
    /// `complete`, `stopped` or `alarm`.
    #[serde(default)]
    pub ended: String,
    /// Wall time by activity, seconds.
    #[serde(default)]
    pub wall_profile: BTreeMap<String, f64>,
}

/// A promise that a run found broken.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct BrokenPromise {
    /// Name of the promise.
    pub promise: String,
    /// Number of parts of the lot judged before the run found the promise broken.
    pub after_parts: u64,
}

/// A lot on the simulated rig, with the truth about its parts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lot {
    /// Seed of rig and lot.
    pub seed: u64,
    /// Parts in order of entering the nest.
    pub parts: Vec<Part>,
    /// Parts of the truth file without a row.
    pub unrecorded: u64,
    /// Figures of the lot as a whole.
    pub summary: Summary,
    /// Number of log lines at level error; each touch of two bodies is one of them.
    pub errors_logged: u64,
    /// Wall time of the whole process, start and calibration included, seconds.
    pub wall_s: f64,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum Line {
    Part(Box<Part>),
    Summary(Summary),
}

impl Lot {
    /// Reads a lot from the rows of `run --json` and the text of the truth file.
    ///
    /// # Errors
    /// Fails when a line does not parse, or when the rows have no summary.
    pub fn read(seed: u64, rows: &str, truth: &str) -> anyhow::Result<Self> {
        let mut known = BTreeMap::new();
        for it in lines::<Truth>("truth", truth) {
            let it = it?;
            known.insert(it.seq, it);
        }
        let (mut parts, mut summary) = (Vec::new(), None);
        for line in lines("rows", rows) {
            match line? {
                Line::Part(part) => parts.push(*part),
                Line::Summary(it) => summary = Some(it),
            }
        }
        let Some(summary) = summary else {
            bail!("rows: found no summary after {} parts", parts.len())
        };
        for part in &mut parts {
            part.truth = known.remove(&part.seq);
        }
        parts.sort_by_key(|part| part.seq);
        Ok(Self {
            seed,
            parts,
            unrecorded: known.len() as u64,
            summary,
            ..Self::default()
        })
    }

    /// Marks the parts with a true value outside its range.
    pub fn mark_out_of_limits(&mut self, admitted: &[(Characteristic, RangeInclusive<f64>)]) {
        for part in &mut self.parts {
            let truth = part.truth.as_ref();
            part.is_out_of_limits = truth.is_some_and(|it| it.is_out_of_limits(admitted));
        }
    }

    /// Returns the parts without a defect.
    pub fn good(&self) -> impl Iterator<Item = &Part> {
        self.parts.iter().filter(|part| part.is_good())
    }
}

/// Parses one JSON object per line of `text`; an error names `file` and the number of the line.
fn lines<'a, T: Deserialize<'a>>(
    file: &str,
    text: &'a str,
) -> impl Iterator<Item = anyhow::Result<T>> {
    let line = move |(number, line): (u64, &'a str)| {
        serde_json::from_str(line).with_context(|| format!("{file}, line {number}"))
    };
    (1..).zip(text.lines()).map(line)
}
