//! A variant of the configuration: a copy with other values in the recipe, another baud rate, or a world whose
//! instruments have no errors.
//!
//! Controller and simulated rig both read the copy, so that line, modules and sequence are those of any lot; only the
//! keys of the variant differ. Dropping the [`ChangedConfig`] deletes the copy.

use super::order::Order;
use anyhow::{Context, anyhow};
use app::backup_folder::copy_folder;
use std::path::Path;
use tempfile::TempDir;
use toml::{Table, Value};

/// A key by its dotted path, and its new value.
pub type Change = (&'static str, Value);

/// Keys of an exact world: no errors of instruments, temperature and operations, so that only the error of the strategy
/// remains. Noise and resolution of the converters stay; there are no defects.
const EXACT: [(&str, f64); 13] = [
    ("devices.ai_gain_pct", 0.0),
    ("devices.ai_offset_pct_of_range", 0.0),
    ("devices.ao_gain_pct", 0.0),
    ("devices.ao_offset_mv", 0.0),
    ("devices.ao_slope_pct", 0.0),
    ("devices.clock_ppm", 0.0),
    ("board.gate_delay_us", 0.0),
    ("board.source_error_pct", 0.0),
    ("environment.part_minus_track_sd_k", 0.0),
    ("environment.rtd_error_sd_k", 0.0),
    ("lot.threshold_scatter_sd_mv", 0.0),
    ("lot.thermal_emf_sd_uv", 0.0),
    ("defects.rate_pct", 0.0),
];
/// Standard uncertainty of every certificate in a world without errors, in the unit of the certificate; the file format
/// requires a value above zero.
const CERTIFIED_U: f64 = 1e-6;
/// Baud rate below which the host watchdog gets a longer timeout: there the requests to all modules at the start take
/// longer than the usual timeout.
const SLOW_BAUD: u32 = 19_200;

/// Differences of a variant from the configuration that it copies.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// Changed keys of the recipe.
    pub recipe: Vec<Change>,
    /// Baud rate of the measuring line, bits per second.
    pub baud: u32,
    /// Whether instruments have no errors.
    pub exact: bool,
    /// Changed keys of the world; they take precedence over `exact`.
    pub world: Vec<Change>,
    /// Faults of the simulated rig, in the form of `--fault`.
    pub faults: Vec<String>,
}

/// A changed configuration in a temporary directory.
pub struct ChangedConfig {
    /// Lots that run with the changed configuration.
    pub order: Order,
    _folder: TempDir,
}

impl Variant {
    /// Creates a variant without errors of the instruments; `baud` applies to the measuring line, bits per second.
    pub fn exact(baud: u32, recipe: Vec<Change>) -> Self {
        Self {
            recipe,
            baud,
            exact: true,
            world: Vec::new(),
            faults: Vec::new(),
        }
    }

    /// Creates a variant as [`Self::exact`] does, but with the errors of the instruments.
    pub fn erring(baud: u32, recipe: Vec<Change>) -> Self {
        Self {
            exact: false,
            ..Self::exact(baud, recipe)
        }
    }

    /// Returns the variant with these changed keys of the world.
    pub fn in_world(self, world: Vec<Change>) -> Self {
        Self { world, ..self }
    }

    /// Copies the configuration of `order` and makes the changes in the copy.
    ///
    /// # Errors
    /// Fails when a file cannot be read or written, or is not TOML.
    pub fn of(&self, order: &Order) -> anyhow::Result<ChangedConfig> {
        let folder = TempDir::new()?;
        let to = folder.path().join("config");
        copy_folder(&order.config, &to)?;
        let recipe = to
            .join("recipes")
            .join(format!("{}.toml", order.recipe.name));
        edit(&recipe, |table| set_all(table, &self.recipe))?;
        edit(&to.join("rig.toml"), |rig| self.change_rig(rig))?;
        if self.exact {
            edit(&to.join("golden.toml"), certify)?;
        }
        let world = folder.path().join("world.toml");
        let base = order
            .world
            .as_ref()
            .map_or(Ok(Table::new()), |path| table(path))?;
        write(&world, &self.world_on(base)?)?;
        let order = Order {
            config: to,
            world: Some(world),
            faults: self.faults.clone(),
            ..order.clone()
        };
        Ok(ChangedConfig {
            order,
            _folder: folder,
        })
    }

    fn change_rig(&self, rig: &mut Table) -> anyhow::Result<()> {
        set(rig, "line.measure.baud", i64::from(self.baud).into())?;
        if self.baud < SLOW_BAUD {
            set(rig, "bus.host_watchdog_ms", 5000.into())?;
        }
        Ok(())
    }

    fn world_on(&self, mut world: Table) -> anyhow::Result<Table> {
        if self.exact {
            let nothing = EXACT.map(|(key, value)| (key, Value::from(value)));
            set_all(&mut world, &nothing)?;
        }
        set_all(&mut world, &self.world)?;
        Ok(world)
    }
}

/// Sets the uncertainty of every certificate to [`CERTIFIED_U`].
fn certify(golden: &mut Table) -> anyhow::Result<()> {
    let parts = golden.get_mut("golden").and_then(Value::as_array_mut);
    for part in parts.into_iter().flatten().filter_map(Value::as_table_mut) {
        let certified = part
            .iter_mut()
            .filter_map(|(_, value)| value.as_table_mut());
        for value in certified {
            value.insert("u".into(), CERTIFIED_U.into());
        }
    }
    Ok(())
}

fn set_all(table: &mut Table, changes: &[Change]) -> anyhow::Result<()> {
    changes
        .iter()
        .try_for_each(|(key, value)| set(table, key, value.clone()))
}

/// Sets a key by its dotted path and adds missing tables; fails when a key on the path is not a table.
fn set(table: &mut Table, path: &str, value: Value) -> anyhow::Result<()> {
    match path.split_once('.') {
        None => {
            table.insert(path.to_owned(), value);
            Ok(())
        }
        Some((first, rest)) => {
            let inner = table
                .entry(first)
                .or_insert_with(|| Table::new().into())
                .as_table_mut()
                .ok_or_else(|| anyhow!("{first} is no table"))?;
            set(inner, rest, value)
        }
    }
}

/// Reads a TOML file as a table.
///
/// # Errors
/// Fails when the file cannot be read, or is not TOML.
pub fn table(path: &Path) -> anyhow::Result<Table> {
    let named = || path.display().to_string();
    let text = std::fs::read_to_string(path).with_context(named)?;
    text.parse().with_context(named)
}

fn write(path: &Path, table: &Table) -> anyhow::Result<()> {
    let named = || path.display().to_string();
    let text = toml::to_string(table).with_context(named)?;
    std::fs::write(path, text).with_context(named)
}

fn edit(path: &Path, change: impl Fn(&mut Table) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let mut read = table(path)?;
    change(&mut read).with_context(|| path.display().to_string())?;
    write(path, &read)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_set_by_its_path() {
        let mut table: Table = "a = 1\n[b]\nc = 2\nd = 3\n".parse().expect("a table");
        set(&mut table, "b.c", 7.into()).expect("a key of a table");
        set(&mut table, "x.y", "new".into()).expect("a new table");
        let expected = "a = 1\n[b]\nc = 7\nd = 3\n[x]\ny = \"new\"\n";
        assert_eq!(table, expected.parse::<Table>().expect("a table"));
        assert!(set(&mut table, "a.b", 1.into()).is_err(), "a is a number");
    }

    #[test]
    fn keys_of_the_world_override_exact() {
        let variant =
            Variant::exact(115_200, Vec::new()).in_world(vec![("devices.clock_ppm", 50.0.into())]);
        let own = "[devices]\nclock_ppm = 9.0\nao_gain_pct = 9.0\nlatency_ms_mean = 5.0\n";
        let world = variant
            .world_on(own.parse().expect("a table"))
            .expect("a world");
        let devices = world["devices"].as_table().expect("a table");
        assert_eq!(devices["clock_ppm"], Value::from(50.0));
        assert_eq!(devices["ao_gain_pct"], Value::from(0.0));
        assert_eq!(devices["latency_ms_mean"], Value::from(5.0), "of --world");
    }

    #[test]
    fn certified_uncertainties_become_small() {
        let text = "[[golden]]\nserial = \"G\"\noperate_voltage_v = { value = 7.4, u = 0.001 }\n";
        let mut golden: Table = text.parse().expect("a table");
        certify(&mut golden).expect("certificates");
        let certified = &golden["golden"][0]["operate_voltage_v"];
        assert_eq!(certified["u"], Value::from(CERTIFIED_U));
        assert_eq!(certified["value"], Value::from(7.4));
    }
}
