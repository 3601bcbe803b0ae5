//! The same rig a little different: a copy of the configuration with other strategies, another baud rate, or
//! a world whose instruments err by nothing.
//!
//! Both programs read the copy, so the line, the modules and the sequence are those of any lot; only what
//! the name of the variant says is changed. The copy is gone with its owner.

use super::fleet::{Folder, Order};
use crate::gauge::Strategy;
use anyhow::{Context, anyhow};
use std::cell::Cell;
use std::path::{Path, PathBuf};

/// A world without errors of the rig, of temperature and of the part from operation to operation: what is left
/// is the strategy's own. Noise and resolution of the converters stay.
const EXACT_WORLD: &str = "[devices]
ai_gain_pct = 0.0
ai_offset_pct_of_range = 0.0
ao_gain_pct = 0.0
ao_offset_mv = 0.0
ao_slope_pct = 0.0
clock_ppm = 0.0

[board]
gate_delay_us = 0.0
source_error_pct = 0.0

[environment]
part_minus_track_sd_k = 0.0
rtd_error_sd_k = 0.0

[lot]
threshold_scatter_sd_mv = 0.0
thermal_emf_sd_uv = 0.0

[defects]
rate_pct = 0.0
";

/// What is different.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variant {
    /// Of both thresholds.
    pub strategy: Strategy,
    /// Of the measuring line, bits per second.
    pub baud: u32,
    /// Instruments that err by nothing.
    pub exact: bool,
}

/// A configuration that has been changed.
pub struct Changed {
    /// What to run.
    pub order: Order,
    _folder: Folder,
}

impl Variant {
    /// The configuration of `order` with this variant's changes.
    ///
    /// # Errors
    /// A file that cannot be read or written, or one without the line that is to be changed.
    pub fn of(&self, order: &Order) -> anyhow::Result<Changed> {
        let folder = Folder::new()?;
        let to = folder.0.join("config");
        copy(&order.config, &to)?;
        let strategy = self.strategy.name();
        edit(
            &to.join("recipes").join(format!("{}.toml", order.recipe)),
            |line| {
                let key = line.split('=').next().unwrap_or("").trim();
                let chosen =
                    matches!(key, "operate_voltage_v" | "release_voltage_v") && !line.contains('{');
                chosen.then(|| format!("{key} = \"{strategy}\""))
            },
        )?;
        let measuring = Cell::new(false);
        edit(&to.join("rig.toml"), |line| {
            if line.starts_with('[') {
                measuring.set(line.starts_with("[line.measure]"));
            }
            let baud = measuring.get() && line.starts_with("baud");
            // Asking every module at the start takes a slow line longer than the usual watchdog waits.
            let watchdog = line.starts_with("host_watchdog_ms") && self.baud < 19_200;
            match (baud, watchdog) {
                (true, _) => Some(format!("baud = {}", self.baud)),
                (false, true) => Some("host_watchdog_ms = 5000".to_owned()),
                (false, false) => None,
            }
        })?;
        let world = if self.exact {
            let path = folder.0.join("exact.toml");
            std::fs::write(&path, EXACT_WORLD).context("writing the world")?;
            Some(path)
        } else {
            order.world.clone()
        };
        let order = Order {
            config: to,
            world,
            ..order.clone()
        };
        Ok(Changed {
            order,
            _folder: folder,
        })
    }
}

fn copy(from: &Path, to: &Path) -> anyhow::Result<()> {
    let told = || format!("copying {}", from.display());
    std::fs::create_dir(to).with_context(told)?;
    for entry in std::fs::read_dir(from).with_context(told)? {
        let entry = entry.with_context(told)?;
        let (path, target): (PathBuf, PathBuf) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy(&path, &target)?;
        } else {
            std::fs::copy(&path, &target).with_context(told)?;
        }
    }
    Ok(())
}

/// Replaces the lines for which `change` has another one; at least one must be found.
fn edit(path: &Path, change: impl Fn(&str) -> Option<String>) -> anyhow::Result<()> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let mut changed = 0;
    let lines: Vec<String> = text
        .lines()
        .map(|line| match change(line) {
            Some(other) => {
                changed += 1;
                other
            }
            None => line.to_owned(),
        })
        .collect();
    if changed == 0 {
        return Err(anyhow!(
            "{}: found no line to change for the study",
            path.display()
        ));
    }
    std::fs::write(path, lines.join("\n") + "\n").with_context(|| path.display().to_string())
}
