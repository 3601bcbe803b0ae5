//! The order of a study: the lots to run, each in its own process of this very program, with a history in a temporary
//! folder.

use super::lot::{Admitted, Lot};
use super::pool::{self, LOTS_AT_ONCE};
use anyhow::{Context, ensure};
use config::Folder;
use machine::dut::{Characteristic, Recipe};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use std::time::Instant;
use tempfile::TempDir;

/// Exit status of a lot that an alarm ended; the study uses its rows like those of any other lot.
const RIG_TROUBLE: i32 = 3;

/// Lots to run.
#[derive(Debug, Clone)]
pub struct Order {
    /// Path of this program, which the study starts for every lot.
    pub program: PathBuf,
    /// Directory of the configuration.
    pub config: PathBuf,
    /// Recipe of every lot. Its limits apply to true values even where a [`super::variant`] changes the file of the
    /// recipe.
    pub recipe: Arc<Recipe>,
    /// World of the simulated rig; `None` uses the one of the configuration.
    pub world: Option<PathBuf>,
    /// Faults of the simulated rig, in the form of `--fault`.
    pub faults: Vec<String>,
    /// Number of lots.
    pub lots: u64,
    /// First seed of the study `storm`, and the seed of the study `gauge`.
    pub from: u64,
    /// The one seed to run, `None` for all; only the study `storm` reads it.
    pub seed: Option<u64>,
    /// Parts of each lot.
    pub parts: u64,
    /// Number of lots in worlds that keep every promise; only the study `promises` reads it.
    pub kept: u64,
    /// The one promise to break, `None` for all; only the study `promises` reads it.
    pub term: Option<String>,
}

impl Order {
    /// Returns the files of the configuration.
    pub fn folder(&self) -> Folder {
        Folder::Directory(self.config.clone())
    }

    /// Returns the nominal coil voltage of the recipe, V.
    ///
    /// # Errors
    /// Fails for a kind of part without a coil.
    pub fn nominal_v(&self) -> anyhow::Result<f64> {
        let nominal_v = self.recipe.device.part().nominal_v;
        let name = &self.recipe.name;
        nominal_v.with_context(|| {
            format!("--recipe {name}: found a part without a coil, expected a relay")
        })
    }

    /// Returns the characteristics of the recipe's kind of part, in the order of reports.
    pub fn characteristics(&self) -> Vec<Characteristic> {
        self.recipe.device.kind().characteristics()
    }

    /// Returns the range that the recipe admits for every characteristic; a limit that it does not set is infinite.
    pub fn admitted(&self) -> Admitted {
        let range = |characteristic: Characteristic| {
            let limit = self.recipe.limits.of(characteristic);
            let low = limit.low.unwrap_or(f64::NEG_INFINITY);
            (characteristic, low..=limit.high.unwrap_or(f64::INFINITY))
        };
        self.characteristics().into_iter().map(range).collect()
    }

    /// Describes the lots for the head of a report.
    pub fn about(&self) -> String {
        let world = self
            .world
            .as_ref()
            .map_or_else(|| "the default world".into(), |it| it.display().to_string());
        format!(
            "{} x {} parts of {} in {world}",
            self.lots, self.parts, self.recipe.name
        )
    }

    /// Runs a lot for each seed, `at_once` processes at a time; returns the lots in the order of the seeds.
    ///
    /// # Errors
    /// Fails with the first lot that does not start, ends with an unexpected status, or writes unreadable rows.
    pub fn run(&self, seeds: &[u64], at_once: usize) -> anyhow::Result<Vec<Lot>> {
        let named = |seed: &u64| format!("the lot with seed {seed}");
        pool::map(seeds, at_once, |seed| {
            self.lot(*seed).with_context(|| named(seed))
        })
    }

    /// Runs the lots with seeds 1 to `lots`.
    ///
    /// # Errors
    /// Fails as [`Order::run`] does.
    pub fn run_all(&self) -> anyhow::Result<Vec<Lot>> {
        let seeds: Vec<u64> = (1..=self.lots).collect();
        self.run(&seeds, LOTS_AT_ONCE)
    }

    fn lot(&self, seed: u64) -> anyhow::Result<Lot> {
        let folder = TempDir::new()?;
        let truth = folder.path().join("truth.jsonl");
        let mut command =
            self.lot_command("study", &folder.path().join("history.db"), self.parts, seed);
        let began = Instant::now();
        let output = finished(command.arg("--truth").arg(&truth), &[0, RIG_TROUBLE])?;
        let wall_s = began.elapsed().as_secs_f64();
        let rows = String::from_utf8_lossy(&output.stdout);
        let mut lot = Lot::read(seed, &rows, &std::fs::read_to_string(&truth)?)?;
        lot.mark_out_of_limits(&self.admitted());
        Ok(Lot {
            errors_logged: String::from_utf8_lossy(&output.stderr).lines().count() as u64,
            wall_s,
            ..lot
        })
    }

    /// Returns the command `run` for one lot in virtual time, with its rows as JSON.
    pub fn lot_command(&self, lot: &str, db: &Path, parts: u64, seed: u64) -> Command {
        let mut command = self.rig_command("run", db, seed);
        command.args(["--pace", "virtual", "--lot", lot]);
        command.args(["--count", &parts.to_string()]);
        command
    }

    /// Returns the command `action` on the simulated rig, with recipe, world and faults of the order. The command
    /// answers in JSON and logs only errors.
    pub fn rig_command(&self, action: &str, db: &Path, seed: u64) -> Command {
        let mut command = self.command(db, "error");
        command.args([action, "--sim", "--json", "--recipe", &self.recipe.name]);
        command.args(["--seed", &seed.to_string()]);
        if let Some(world) = &self.world {
            command.arg("--world").arg(world);
        }
        for fault in &self.faults {
            command.args(["--fault", fault]);
        }
        command
    }

    /// Returns this program with configuration, history and log level; the caller adds the action.
    pub fn command(&self, db: &Path, log: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.arg("--config").arg(&self.config);
        command.arg("--db").arg(db).args(["--log", log]);
        command.stdin(Stdio::null());
        command
    }
}

/// Runs a command to its end and returns its output.
///
/// # Errors
/// Fails when the command does not start, or ends with a status that is not in `accepted`; the error contains its
/// stderr.
pub fn finished(command: &mut Command, accepted: &[i32]) -> anyhow::Result<Output> {
    let output = command.output()?;
    let status = output.status;
    ensure!(
        status.code().is_some_and(|code| accepted.contains(&code)),
        "{status}, {}",
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(output)
}

/// Returns a value of `/proc/PID/status` in kB, such as `VmRSS` (current resident memory) or `VmHWM` (its peak).
pub fn memory_kb(process: u32, key: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with(key))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
