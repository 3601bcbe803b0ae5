//! Overview of a checked configuration, as `config check` prints it.

use super::faults::{ConfigFaults, check_all};
use super::folder::Folder;
use super::plant::Plant;
use super::recipes::{load_recipe, recipe_file, recipe_names};
use machine::rig::wiring::{LineId, Wiring};

/// Checks every file and returns a text with a line per file, serial line and recipe.
///
/// # Errors
/// Fails with every fault of the configuration.
pub fn overview(folder: &Folder) -> Result<String, ConfigFaults> {
    let plant = check_all(folder)?;
    let wiring = &plant.wiring;
    let mut lines = vec![format!(
        "{}: {} lines, {} modules",
        folder.path("rig.toml").display(),
        wiring.lines.len(),
        wiring.modules.len()
    )];
    lines.extend(wiring.line_ids().map(|line| describe_line(wiring, line)));
    lines.push(format!(
        "  emergency stop: worst reaction {:.1} ms, accepted {} ms",
        wiring.longest_reaction().as_seconds() * 1e3,
        wiring.safety.estop_reaction_ms
    ));
    lines
        .push("  every point has its own terminal; every address is unique on its line".to_owned());
    if let Some(scene) = &plant.scene {
        lines.push(format!(
            "{}: {} bodies, every actuator has its stroke",
            folder.path("scene.toml").display(),
            scene.elements.len()
        ));
    }
    if let Some(rack) = wiring.rack() {
        let (sockets, lists) = (rack.sockets().len(), rack.lists().len());
        lines.push(format!(
            "  rack: {sockets} sockets, {lists} unloading lists"
        ));
    }
    if let Some(file) = &plant.calibration.reference_file {
        let count = plant.reference_parts.parts.len();
        lines.push(format!(
            "{}: {count} reference parts",
            folder.path(file).display()
        ));
    }
    for name in recipe_names(folder) {
        lines.push(describe_recipe(folder, &plant, &name)?);
    }
    lines.push("ok\n".to_owned());
    Ok(lines.join("\n"))
}

fn describe_line(wiring: &Wiring, line: LineId) -> String {
    let modules = wiring.modules_on(line).count();
    let line = wiring.line(line);
    let checksum = if line.checksum {
        "checksum on"
    } else {
        "NO CHECKSUM: a damaged reply in the right form passes for a true one"
    };
    format!(
        "  line {}: {} at {} baud, {modules} modules, {checksum}",
        line.name, line.port, line.baud
    )
}

fn describe_recipe(folder: &Folder, plant: &Plant, name: &str) -> Result<String, ConfigFaults> {
    let recipe = load_recipe(folder, name)?;
    let file = folder.path(&recipe_file(name));
    let nominal_v = recipe.device.part().nominal_v;
    let reference = match nominal_v.map(|volts| plant.reference_parts.of_nominal(volts).count()) {
        None => "no reference parts needed".to_owned(),
        Some(count) => format!("{count} reference parts"),
    };
    let all = recipe.device.kind().characteristics().len();
    let judged = recipe
        .limits()
        .filter(|(_, limit)| limit.low.is_some() || limit.high.is_some())
        .count();
    Ok(format!(
        "{}: {judged} of {all} parameters judged, {reference}, sha256 {}",
        file.display(),
        &recipe.hash[..12]
    ))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn wiring(rig: &str) -> Wiring {
        Wiring::resolve(&toml::from_str(rig).unwrap(), machine::dut::FIXTURES).unwrap()
    }

    #[test]
    fn a_line_without_checksum_is_reported() {
        let rig = include_str!("../../../config/rig.toml");
        let careless = wiring(&rig.replace("checksum = true", "checksum = false"));
        assert!(describe_line(&careless, LineId(0)).contains("NO CHECKSUM"));
        assert!(describe_line(&wiring(rig), LineId(0)).ends_with("9 modules, checksum on"));
    }
}
