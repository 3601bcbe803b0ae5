//! Lots as processes of this very program, a few at a time, each with a history of its own that is thrown away.

use super::lot::{Admitted, Lot};
use anyhow::{Context, anyhow, bail};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Exit status of a lot that an alarm ended: its rows count all the same.
const RIG_TROUBLE: i32 = 3;

/// Lots to run.
#[derive(Debug, Clone)]
pub struct Order {
    /// The program, this one.
    pub program: PathBuf,
    /// Directory of the configuration.
    pub config: PathBuf,
    /// Recipe of every lot.
    pub recipe: String,
    /// What the recipe admits.
    pub admitted: Admitted,
    /// Nominal coil voltage of the recipe, V; NaN for a kind without one.
    pub nominal_v: f64,
    /// World of the simulated rig; none is the one of the configuration.
    pub world: Option<PathBuf>,
    /// Faults of the simulated rig, in the form of `--fault`.
    pub faults: Vec<String>,
    /// Number of lots.
    pub lots: u64,
    /// First seed, where a study takes it.
    pub from: u64,
    /// One seed alone, where a study takes it.
    pub seed: Option<u64>,
    /// Parts of each.
    pub parts: u64,
}

impl Order {
    /// Describes the lots for the head of a report.
    pub fn about(&self) -> String {
        let world = self
            .world
            .as_ref()
            .map_or_else(|| "the default world".into(), |it| it.display().to_string());
        format!(
            "{} x {} parts of {} in {world}",
            self.lots, self.parts, self.recipe
        )
    }

    /// Lots with the given seeds, in their order, `at_once` processes at a time.
    ///
    /// # Errors
    /// The first lot that could not be run.
    pub fn run(&self, seeds: &[u64], at_once: usize) -> anyhow::Result<Vec<Lot>> {
        let folder = Folder::new()?;
        let (next, progress) = (AtomicU64::new(0), Progress::new(seeds.len()));
        let done: Mutex<Vec<(usize, anyhow::Result<Lot>)>> = Mutex::new(Vec::new());
        let worker = || loop {
            let place = usize::try_from(next.fetch_add(1, Ordering::Relaxed)).unwrap_or(usize::MAX);
            let Some(&seed) = seeds.get(place) else { break };
            let lot = self.lot(seed, &folder.0.join(place.to_string()));
            if lot.is_err() {
                next.store(seeds.len() as u64, Ordering::Relaxed);
            }
            let mut done = done
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            done.push((place, lot));
            progress.show(done.len());
        };
        std::thread::scope(|scope| {
            for _ in 0..at_once.min(seeds.len()) {
                scope.spawn(worker);
            }
        });
        progress.clear();
        let mut done = done
            .into_inner()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        done.sort_by_key(|(place, _)| *place);
        done.into_iter().map(|(_, lot)| lot).collect()
    }

    /// The lots of a study, seeds 1 to `lots`, two at a time.
    ///
    /// # Errors
    /// The first lot that could not be run.
    pub fn run_all(&self) -> anyhow::Result<Vec<Lot>> {
        let seeds: Vec<u64> = (1..=self.lots).collect();
        self.run(&seeds, 2)
    }

    fn lot(&self, seed: u64, folder: &Path) -> anyhow::Result<Lot> {
        let told = || format!("the lot with seed {seed}");
        std::fs::create_dir(folder).with_context(told)?;
        let truth = folder.join("truth.jsonl");
        let began = Instant::now();
        let output = self
            .command(seed, folder, &truth)
            .output()
            .with_context(told)?;
        let wall_s = began.elapsed().as_secs_f64();
        let said = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0 | RIG_TROUBLE) => {}
            _ => bail!("{}: {}, {}", told(), output.status, said.trim()),
        }
        let text = std::fs::read_to_string(&truth).with_context(told)?;
        let mut lot =
            Lot::read(seed, &String::from_utf8_lossy(&output.stdout), &text).with_context(told)?;
        lot.hold_against(&self.admitted);
        std::fs::remove_dir_all(folder).with_context(told)?;
        Ok(Lot {
            errors_logged: said.lines().count() as u64,
            wall_s,
            ..lot
        })
    }

    fn command(&self, seed: u64, folder: &Path, truth: &Path) -> Command {
        let mut command = Command::new(&self.program);
        command.arg("--config").arg(&self.config);
        command.arg("--db").arg(folder.join("history.db"));
        command.args([
            "--log", "error", "run", "--sim", "--pace", "virtual", "--json",
        ]);
        command.args(["--lot", "study", "--recipe", &self.recipe]);
        command.arg("--count").arg(self.parts.to_string());
        command.arg("--seed").arg(seed.to_string());
        command.arg("--truth").arg(truth);
        if let Some(world) = &self.world {
            command.arg("--world").arg(world);
        }
        for fault in &self.faults {
            command.arg("--fault").arg(fault);
        }
        command.stdin(std::process::Stdio::null());
        command
    }
}

/// A temporary directory, gone with its owner.
pub(super) struct Folder(pub(super) PathBuf);

impl Folder {
    pub(super) fn new() -> anyhow::Result<Self> {
        let base = std::env::temp_dir();
        for attempt in 0..1000 {
            let path = base.join(format!("relayrig-study-{}-{attempt}", std::process::id()));
            match std::fs::create_dir(&path) {
                Ok(()) => return Ok(Self(path)),
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error).with_context(|| path.display().to_string()),
            }
        }
        Err(anyhow!(
            "{}: no free name for a temporary directory",
            base.display()
        ))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

/// Number of finished lots on stderr; silent when stderr is no terminal.
struct Progress {
    of: usize,
    seen: bool,
}

impl Progress {
    fn new(of: usize) -> Self {
        let it = Self {
            of,
            seen: std::io::stderr().is_terminal(),
        };
        it.show(0);
        it
    }

    fn show(&self, done: usize) {
        if self.seen {
            write!(std::io::stderr(), "\r{done} of {} lots ", self.of).ok();
        }
    }

    fn clear(&self) {
        if self.seen {
            write!(std::io::stderr(), "\r{:30}\r", "").ok();
        }
    }
}
