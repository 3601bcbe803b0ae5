//! Loads the configuration of a plant, all but its recipes.

use super::check::File;
use super::error::ConfigError;
use super::folder::Folder;
use super::instruments::load_profiles;
use super::keys;
use super::lot::{check_pictures, check_reader, load_lot};
use super::recipes::recipe_file;
use super::tree::{Node, NotToml, not_toml};
use machine::dut::accuracy::AccuracySettings;
use machine::dut::device::Rig;
use machine::dut::em_relay::settings::{CalibrationSettings, ReferenceSet, ReferenceSettings};
use machine::dut::prompt::Prompt;
use machine::dut::thermostat::certificate::Certificate;
use machine::dut::{self, Recipe};
use machine::form::Key;
use machine::guard::{Actuator, Guard, GuardSettings};
use machine::rig::axis::AxisTable;
use machine::rig::fault::Fault;
use machine::rig::settings::RigSettings;
use machine::rig::wiring::Wiring;
use machine::station::gates::LotSettings;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;
use std::sync::Arc;

/// Configuration of a plant, checked.
#[derive(Debug, Clone)]
pub struct Plant {
    /// Files of the configuration.
    pub folder: Folder,
    /// Serial lines, modules, points and mechanism of the rig.
    pub wiring: Arc<Wiring>,
    /// Bodies around the nest; `None` on a rig with a rack, where nothing moves.
    pub scene: Option<GuardSettings>,
    /// References on the interface board, if it has any.
    pub reference: Option<ReferenceSettings>,
    /// Accuracies that hold before the rig is calibrated.
    pub accuracy: AccuracySettings,
    /// How long a calibration stays valid.
    pub calibration: CalibrationSettings,
    /// Reference parts; empty when `rig.toml` names no file of reference parts.
    pub reference_parts: ReferenceSet,
    /// Certificate of thermometer chain and sockets; `None` when `rig.toml` names no certificate.
    pub certificate: Option<Certificate>,
    /// Gates of a lot: reference checks, reject-rate limit, first articles, wear limits.
    pub lot: LotSettings,
    /// Longest time for which writing the history may fail, and how long the traces of alarms are kept.
    pub history: HistorySettings,
    /// Code reader at the pocket, if the rig has one.
    pub serial_reader: Option<SerialReaderSettings>,
}

/// Settings `[serial_reader]` of `rig.toml`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SerialReaderSettings {
    /// Path of the serial port.
    pub port: String,
    /// Bits per second.
    pub baud: u32,
    /// Longest time from the arrival of a part to the reading of its code, ms.
    #[serde(default = "usual_timeout_ms")]
    pub timeout_ms: f64,
    /// Text that the reader sends when it finds no code, for example `NOREAD`.
    pub no_code: Option<String>,
}

fn usual_timeout_ms() -> f64 {
    1000.0
}

/// Settings of the history and of the traces of alarms beside its file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default)]
pub struct HistorySettings {
    /// Time for which writing the history may fail before the program ends, s.
    pub give_up_s: f64,
    /// Number of newest alarms whose traces are kept.
    pub traces: u32,
    /// Time for which the traces of an alarm are kept, days.
    pub trace_days: u32,
}

impl Default for HistorySettings {
    fn default() -> Self {
        Self {
            give_up_s: 600.0,
            traces: 200,
            trace_days: 90,
        }
    }
}

/// The sections of `rig.toml` about measuring, and the one about the history.
#[derive(Deserialize)]
struct GaugeSections {
    #[serde(default)]
    history: HistorySettings,
    serial_reader: Option<SerialReaderSettings>,
    reference: Option<ReferenceSettings>,
    accuracy: AccuracySettings,
    calibration: CalibrationSettings,
}

impl Plant {
    /// Reads and checks the files of `folder`; opens no port and moves no actuator.
    ///
    /// # Errors
    /// Fails on the first fault; the error names file, line, key, what was found and what was expected.
    pub fn load(folder: &Folder) -> Result<Self, ConfigError> {
        let rig = folder.file("rig.toml", "the wiring of the rig")?;
        let settings: RigSettings = rig.settings(rig.rig_keys())?;
        let gauge: GaugeSections = rig.settings(rig.rig_keys())?;
        let profiles = load_profiles(folder, &rig, &settings)?;
        let wiring = Wiring::resolve_with(&settings, dut::FIXTURES, &profiles);
        let wiring = wiring.map_err(|fault| rig.locate(&fault))?;
        let reference_parts = match &gauge.calibration.reference_file {
            Some(name) => load_reference_parts(folder, name)?,
            None => ReferenceSet::default(),
        };
        let certificate = match &gauge.calibration.certificate_file {
            Some(name) => Some(load_certificate(folder, name, &wiring)?),
            None => None,
        };
        let scene = match wiring.feeder() {
            Some(feeder) => {
                let scene = load_scene(folder)?;
                check_axis(&feeder.axis, &scene, &rig)?;
                Some(scene)
            }
            None => None,
        };
        let lot = load_lot(folder)?;
        check_reader(folder, &lot, gauge.serial_reader.is_some())?;
        Ok(Self {
            folder: folder.clone(),
            wiring: Arc::new(wiring),
            scene,
            reference: gauge.reference,
            accuracy: gauge.accuracy,
            calibration: gauge.calibration,
            reference_parts,
            certificate,
            lot,
            history: gauge.history,
            serial_reader: gauge.serial_reader,
        })
    }

    /// Returns wiring, references and accuracies: the part of the configuration that measurements depend on.
    pub fn rig(&self) -> Rig<'_> {
        Rig {
            wiring: &self.wiring,
            reference: self.reference.as_ref(),
            accuracy: &self.accuracy,
            reference_parts: &self.reference_parts,
            certificate: self.certificate.as_ref(),
        }
    }

    /// Returns the prompts of a lot: those of `lot.toml`, then those of its recipe.
    pub fn prompts<'a>(&'a self, recipe: &'a Recipe) -> impl Iterator<Item = &'a Prompt> {
        self.lot.prompts.iter().chain(&recipe.prompts)
    }

    /// Checks that this plant has the references and the modules that a recipe needs.
    ///
    /// # Errors
    /// Fails with the first reason that [`infeasible`](Self::infeasible) returns.
    pub fn admit(&self, recipe: &Recipe) -> Result<(), ConfigError> {
        self.infeasible(recipe)
            .into_iter()
            .next()
            .map_or(Ok(()), Err)
    }

    /// Returns every reason why this plant cannot carry out a recipe, each with file, line, key and cause.
    pub fn infeasible(&self, recipe: &Recipe) -> Vec<ConfigError> {
        let mut faults = recipe.infeasible(&self.rig());
        faults.extend(check_pictures(&self.folder, &recipe.prompts).err());
        let doubled = |it: &&Prompt| self.lot.prompts.iter().any(|own| own.name == it.name);
        if let Some(prompt) = recipe.prompts.iter().find(doubled) {
            let expected = "a name that no prompt of lot.toml has";
            faults.push(Fault::new(
                "prompt",
                format!("\"{}\"", prompt.name),
                expected,
            ));
        }
        let path = self.folder.path(&recipe_file(&recipe.name));
        match File::parse(path, recipe.source_text.clone()) {
            Ok(file) => faults.iter().map(|fault| file.locate(fault)).collect(),
            Err(error) => vec![error],
        }
    }
}

impl File {
    /// Parses a text; messages name `path` as its file.
    pub fn parse(path: PathBuf, text: String) -> Result<Self, ConfigError> {
        match Node::parse(&text) {
            Ok(root) => Ok(Self { path, text, root }),
            Err(NotToml { line, problem }) => Err(ConfigError::Syntax {
                file: path,
                line,
                problem,
            }),
        }
    }

    /// Returns the keys that this `rig.toml` may have: those of a rig with a feeder, or of one with a rack.
    pub(super) fn rig_keys(&self) -> &'static [Key] {
        match self.root.get("rack") {
            Some(_) => keys::rig::WITH_RACK,
            None => keys::rig::FILE,
        }
    }

    /// Checks the file against its keys and converts it to settings.
    pub fn settings<T: DeserializeOwned>(&self, keys: &[Key]) -> Result<T, ConfigError> {
        self.check(keys)?;
        toml::from_str(&self.text).map_err(|error| self.type_mismatch(&error))
    }
}

/// Loads the reference parts; fails when a serial number appears twice.
fn load_reference_parts(folder: &Folder, name: &str) -> Result<ReferenceSet, ConfigError> {
    let file = folder.file(name, "the reference parts")?;
    let set: ReferenceSet = file.settings(keys::golden::FILE)?;
    for (index, part) in set.parts.iter().enumerate() {
        if let Some(other) = set.parts[..index]
            .iter()
            .position(|other| other.serial == part.serial)
        {
            let key = format!("golden.{index}.serial");
            let fault = Fault::new(
                key,
                format!("\"{}\"", part.serial),
                "a serial number of its own",
            );
            return Err(file.locate(&fault.against(format!("golden.{other}.serial"))));
        }
    }
    Ok(set)
}

/// Loads the certificate of the rack; fails when the certificate names other sockets than the rack has.
fn load_certificate(
    folder: &Folder,
    name: &str,
    wiring: &Wiring,
) -> Result<Certificate, ConfigError> {
    let file = folder.file(name, "the certificate of thermometer and sockets")?;
    let certificate: Certificate = file.settings(keys::golden::CERTIFICATE)?;
    let sockets = wiring.rack().map_or(0, |it| it.sockets().len());
    let checked = certificate.check(sockets);
    checked.map_err(|fault| file.locate(&fault))?;
    Ok(certificate)
}

/// Loads the scene. The guard refuses unknown keys, bodies without size, and actuators whose stroke is blocked in an
/// empty rig.
pub(super) fn load_scene(folder: &Folder) -> Result<GuardSettings, ConfigError> {
    let file = folder.file("scene.toml", "the bodies around the nest")?;
    let settings: GuardSettings =
        toml::from_str(&file.text).map_err(|error| file.type_mismatch(&error))?;
    Guard::build(&settings).map_err(|error| file.broken_rule(&error))?;
    Ok(settings)
}

/// Checks that the scene allows the sort axis to reach each of its places.
fn check_axis(axis: &AxisTable, scene: &GuardSettings, rig: &File) -> Result<(), ConfigError> {
    let Some(slide) = scene
        .actuator
        .iter()
        .find(|actuator| actuator.id == Actuator::SortAxis)
    else {
        return Ok(());
    };
    let points = slide.points_mm.as_deref().unwrap_or_default();
    let low = points.iter().copied().fold(0.0, f64::min);
    let high = points
        .iter()
        .copied()
        .fold(slide.stroke_mm.unwrap_or(0.0), f64::max);
    for station in axis.stations() {
        let x_mm = axis.point(station).x_mm;
        if !(low..=high).contains(&x_mm) {
            let expected = format!("{low} to {high}, the stroke of sort_axis in scene.toml");
            return Err(rig.locate(&Fault::new(
                format!("{}.x_mm", station.key()),
                x_mm,
                expected,
            )));
        }
    }
    Ok(())
}

impl File {
    /// Makes the error for a file that cannot be converted to its settings.
    fn type_mismatch(&self, error: &toml::de::Error) -> ConfigError {
        let fault = not_toml(&self.text, error);
        let key = self.label(&self.root.path_at(fault.line));
        let problem = fault
            .problem
            .replace("invalid type: ", "found ")
            .replace("invalid value: ", "found ");
        ConfigError::Rule {
            file: self.path.clone(),
            line: fault.line,
            problem: format!("{key}: {problem}"),
        }
    }

    /// Makes the error for a broken rule of the scene; the text of `error` begins with the path of the field.
    fn broken_rule(&self, error: &dyn std::error::Error) -> ConfigError {
        let mut problem = error.to_string();
        let path = problem
            .split(':')
            .next()
            .unwrap_or_default()
            .replace('[', ".")
            .replace([']', ' '], "");
        let line = self.root.find(&path).0.line;
        let mut cause = error.source();
        while let Some(deeper) = cause {
            problem = format!("{problem}: {deeper}");
            cause = deeper.source();
        }
        ConfigError::Rule {
            file: self.path.clone(),
            line,
            problem,
        }
    }
}
