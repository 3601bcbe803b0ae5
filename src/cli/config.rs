//! `relayrig config check` and `relayrig config schema NAME`: nothing is opened, nothing moves.

use anyhow::Context;
use app::exit::Exit;
use config::schema::{of_kinds, schema};
use config::{Plant, keys, load_recipe, recipe_names};
use machine::dut::Kind;
use machine::rig::wiring::Wiring;
use std::io::Write;
use std::path::Path;

/// What to do with the configuration.
#[derive(Debug, Clone, clap::Subcommand)]
pub enum Args {
    /// Check everything that loading would refuse, without moving anything
    #[command(
        after_help = "Examples:\n  relayrig config check\n  relayrig --config plant2 config check"
    )]
    Check,
    /// Print the JSON schema of a file: rig, golden, recipe, card or lot
    #[command(after_help = "Example:\n  relayrig config schema recipe > recipe.schema.json")]
    Schema {
        /// Which file
        #[arg(value_parser = ["rig", "golden", "recipe", "card", "lot"])]
        name: String,
    },
}

/// Runs the command on the configuration in `dir`.
///
/// # Errors
/// The first fault of the configuration: exit status 2.
pub fn run(dir: &Path, args: &Args) -> anyhow::Result<Exit> {
    let text = match args {
        Args::Check => check(dir)?,
        Args::Schema { name } => schema_text(name)?,
    };
    std::io::stdout()
        .lock()
        .write_all(text.as_bytes())
        .context("writing to stdout")?;
    Ok(Exit::Done)
}

/// Loads everything and says what was looked at.
fn check(dir: &Path) -> anyhow::Result<String> {
    let plant = Plant::load(dir)?;
    let wiring = &plant.wiring;
    let mut lines = vec![format!(
        "{}: {} lines, {} modules",
        dir.join("rig.toml").display(),
        wiring.lines.len(),
        wiring.modules.len()
    )];
    lines.extend(
        wiring
            .lines
            .iter()
            .enumerate()
            .map(|(index, _)| describe_line(wiring, index)),
    );
    lines.push(format!(
        "  emergency stop: worst reaction {:.1} ms, accepted {} ms",
        wiring.longest_reaction().as_seconds() * 1e3,
        wiring.safety.estop_reaction_ms
    ));
    lines.push(
        "  every point has a terminal of its own; every address is used once on its line"
            .to_owned(),
    );
    lines.push(format!(
        "{}: {} bodies, every actuator has its way",
        dir.join("scene.toml").display(),
        plant.scene.elements.len()
    ));
    if let Some(file) = &plant.calibration.reference_file {
        let count = plant.golden.parts.len();
        lines.push(format!(
            "{}: {count} golden parts",
            dir.join(file).display()
        ));
    }
    for name in recipe_names(dir) {
        lines.push(describe_recipe(dir, &plant, &name)?);
    }
    lines.push("ok\n".to_owned());
    Ok(lines.join("\n"))
}

fn describe_line(wiring: &Wiring, index: usize) -> String {
    let line = &wiring.lines[index];
    let modules = wiring
        .modules
        .iter()
        .filter(|module| module.line.0 == index)
        .count();
    let checksum = if line.checksum {
        "checksum on"
    } else {
        "NO CHECKSUM: a damaged reply that keeps its form cannot be told from a true one"
    };
    format!(
        "  line {}: {} at {} baud, {modules} modules, {checksum}",
        line.name, line.port, line.baud
    )
}

fn describe_recipe(dir: &Path, plant: &Plant, name: &str) -> anyhow::Result<String> {
    let recipe = load_recipe(dir, name)?;
    plant.admit(&recipe)?;
    let file = dir.join("recipes").join(format!("{name}.toml"));
    let golden = match recipe
        .device
        .part()
        .nominal_v
        .map(|volts| plant.golden.of_nominal(volts).count())
    {
        None => "no golden parts needed".to_owned(),
        Some(0) => "NO GOLDEN PARTS of its coil voltage: a lot cannot be calibrated".to_owned(),
        Some(count) => format!("{count} golden parts"),
    };
    let all = recipe.device.kind().characteristics().len();
    let judged = recipe
        .limits()
        .filter(|(_, limit)| limit.low.is_some() || limit.high.is_some())
        .count();
    Ok(format!(
        "{}: {judged} of {all} parameters judged, {golden}, sha256 {}",
        file.display(),
        &recipe.hash[..12]
    ))
}

fn schema_text(name: &str) -> anyhow::Result<String> {
    let schema = match name {
        "rig" => schema("rig.toml", keys::rig::FILE),
        "golden" => schema("golden.toml", keys::golden::FILE),
        "card" => schema("card.toml", keys::card::FILE),
        "lot" => schema("lot.toml", keys::lot::FILE),
        "recipe" => of_kinds("recipes/NAME.toml", &Kind::ALL.map(keys::recipe::of)),
        other => {
            anyhow::bail!(
                "config schema: found \"{other}\", expected rig, golden, recipe, card or lot"
            )
        }
    };
    let text = serde_json::to_string_pretty(&schema).context("writing the schema")?;
    Ok(text + "\n")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn wiring(rig: &str) -> Wiring {
        Wiring::resolve(&toml::from_str(rig).unwrap(), machine::dut::FIXTURES).unwrap()
    }

    #[test]
    fn a_line_without_checksum_is_pointed_out() {
        let rig = include_str!("../../config/rig.toml");
        let careless = wiring(&rig.replace("checksum = true", "checksum = false"));
        assert!(describe_line(&careless, 0).contains("NO CHECKSUM"));
        assert!(describe_line(&wiring(rig), 0).ends_with("9 modules, checksum on"));
    }

    #[test]
    fn only_known_files_have_a_schema() {
        assert!(
            schema_text("recipe")
                .unwrap()
                .contains("expected_operate_sd_v")
        );
        let message = schema_text("sim").unwrap_err().to_string();
        assert_eq!(
            message,
            "config schema: found \"sim\", expected rig, golden, recipe, card or lot"
        );
    }
}
