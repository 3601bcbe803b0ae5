//! Tests of wrong files and of the messages that the operator reads. Each case changes one place in the files of
//! `config/`.
#![allow(clippy::unwrap_used)]

mod fixture;
mod folder;
mod instruments;
mod interlocks;
mod plant;
mod rack;
mod revision;
mod rig_instruments;
mod wrong_recipes;

use super::check::File;
use super::error::ConfigError;
use super::keys;
use super::recipes::parse_recipe;
use machine::dut::em_relay::bins;
use machine::dut::recipe::Recipe;
use machine::rig::axis::AxisTable;
use machine::rig::bin::Bin;
use machine::rig::settings::RigSettings;
use machine::rig::wiring::Wiring;
use std::path::PathBuf;

const RIG: &str = include_str!("../../../config/rig.toml");
const GOLDEN: &str = include_str!("../../../config/golden.toml");
const RECIPE: &str = include_str!("../../../config/recipes/jzc-22f-012.toml");

fn rig(text: &str) -> Result<Wiring, ConfigError> {
    let file = File::parse(PathBuf::from("config/rig.toml"), text.to_owned())?;
    let settings: RigSettings = file.settings(keys::rig::FILE)?;
    Wiring::resolve(&settings, machine::dut::FIXTURES).map_err(|fault| file.locate(&fault))
}

fn recipe(text: &str) -> Result<Recipe, ConfigError> {
    let file = File::parse(
        PathBuf::from("config/recipes/jzc-22f-012.toml"),
        text.to_owned(),
    )?;
    parse_recipe(file, "jzc-22f-012")
}

/// Returns the text with one place changed; panics when `from` does not occur exactly once.
fn changed(text: &str, from: &str, to: &str) -> String {
    assert_eq!(
        text.matches(from).count(),
        1,
        "{from:?} must stand once in the file"
    );
    text.replace(from, to)
}

fn line_of(text: &str, part: &str) -> usize {
    text[..text.find(part).unwrap()].matches('\n').count() + 1
}

/// Asserts that one change to `rig.toml` is refused with `config/rig.toml:LINE: message`; LINE is the line that holds
/// `at`.
fn refused(from: &str, to: &str, at: &str, message: &str) {
    let text = changed(RIG, from, to);
    let expected = format!("config/rig.toml:{}: {message}", line_of(&text, at));
    assert_eq!(rig(&text).unwrap_err().to_string(), expected);
}

fn refused_recipe(from: &str, to: &str, at: &str, message: &str) {
    let text = changed(RECIPE, from, to);
    let expected = format!(
        "config/recipes/jzc-22f-012.toml:{}: {message}",
        line_of(&text, at)
    );
    assert_eq!(recipe(&text).unwrap_err().to_string(), expected);
}

#[test]
fn the_default_rig_and_its_recipes_are_accepted() {
    let wiring = rig(RIG).unwrap();
    assert_eq!((wiring.lines.len(), wiring.modules.len()), (2, 13));
    for (name, text) in [
        ("jzc-22f-012", RECIPE),
        (
            "jzc-22f-009",
            include_str!("../../../config/recipes/jzc-22f-009.toml"),
        ),
        (
            "jzc-22f-006",
            include_str!("../../../config/recipes/jzc-22f-006.toml"),
        ),
    ] {
        let file = File::parse(PathBuf::from(name), text.to_owned()).unwrap();
        let recipe = parse_recipe(file, name).unwrap();
        assert_eq!(recipe.hash.len(), 64);
        assert_eq!(recipe.source_text, text);
    }
    File::parse(PathBuf::from("golden"), GOLDEN.to_owned())
        .unwrap()
        .check(keys::golden::FILE)
        .unwrap();
}

#[test]
fn a_channel_beyond_the_module_is_refused() {
    refused(
        "coil_voltage      = { module = \"coil_ai\", channel = 0",
        "coil_voltage      = { module = \"coil_ai\", channel = 9",
        "coil_voltage      =",
        "[analog_in].coil_voltage.channel: found 9, expected 0..7 of an I-7017F",
    );
}

#[test]
fn an_unknown_module_is_refused_with_the_known_ones() {
    refused(
        "gate_0 = { module = \"timer\"",
        "gate_0 = { module = \"tiner\"",
        "gate_0",
        "[counter].gate_0.module: found \"tiner\", expected one of the modules coil_ai, ao_level, \
         timer, board_do, rtd, ao_coarse, ao_fine, board_di, contact_ai, mech_di_a, mech_di_b, mech_do_a, mech_do_b",
    );
}

#[test]
fn a_duplicate_address_is_refused_with_both_lines() {
    let text = changed(RIG, "address = \"12\"", "address = \"11\"");
    let message = rig(&text).unwrap_err().to_string();
    let expected = format!(
        "config/rig.toml:{}: [module.mech_di_b].address: found \"11\", expected an address of its own on line motion \
         (line {}: [module.mech_di_a].address)",
        line_of(&text, "[module.mech_di_b]") + 2,
        line_of(&text, "[module.mech_di_a]") + 2,
    );
    assert_eq!(message, expected);
}

#[test]
fn two_points_on_one_terminal_are_refused_by_name() {
    let line = line_of(RIG, "emergency_stop_ok =");
    refused(
        "door_closed       = { module = \"mech_di_a\", channel = 1,",
        "door_closed       = { module = \"mech_di_a\", channel = 0,",
        "door_closed ",
        &format!(
            "[digital_in].door_closed: found mech_di_a channel 0, expected a terminal of its own \
             (line {line}: [digital_in].emergency_stop_ok)"
        ),
    );
}

#[test]
fn a_point_on_an_unfit_module_is_refused() {
    refused(
        "button_stop       = { module = \"mech_di_b\"",
        "button_stop       = { module = \"mech_do_b\"",
        "button_stop ",
        "[digital_in].button_stop.module: found \"mech_do_b\", an I-7043, expected a module with digital inputs",
    );
}

#[test]
fn a_missing_point_is_refused() {
    refused(
        "probe_up          = { module = \"mech_di_a\", channel = 14, active = \"low\" }\n",
        "",
        "[digital_in]",
        "[digital_in].probe_up: found nothing, expected a table",
    );
}

#[test]
fn a_mistyped_key_is_refused_with_its_neighbour() {
    refused(
        "tries = 3 ",
        "trys = 3 ",
        "trys = 3",
        "[bus].trys: found an unknown key, expected \"tries\"?",
    );
    refused_recipe(
        "operate_voltage_v = { high = 9.0 }",
        "operate_voltage_mv = { high = 9000.0 }",
        "operate_voltage_mv",
        "[limits].operate_voltage_mv: found an unknown key, expected \"operate_voltage_v\"?",
    );
}

#[test]
fn a_mistyped_point_is_refused_with_its_neighbour() {
    for (from, to, near) in [
        ("air_ok            =", "air_oki           =", "air_ok"),
        ("latch             =", "lach              =", "latch"),
        ("beam_pass         =", "beam_pas          =", ""),
    ] {
        let name = to.split(' ').next().unwrap();
        let message = match near {
            "" => {
                "[bin].pass.beam: found \"beam_pass\", expected the name of a digital input".into()
            }
            near => format!("[digital_in].{name}: found an unknown key, expected \"{near}\"?"),
        };
        let at = if near.is_empty() { "pass    =" } else { to };
        refused(from, to, at, &message);
    }
    refused(
        "coil_drive        =",
        "coil_driv         =",
        "coil_driv         =",
        "[digital_out].coil_driv: found an unknown key, expected \"coil_drive\"?",
    );
}

#[test]
fn a_beam_may_have_any_name() {
    let text = RIG.replace("beam_pass", "good_parts_fall_here");
    let wiring = rig(&text).unwrap();
    let beam = wiring.digital_input("good_parts_fall_here").unwrap();
    assert_eq!(wiring.axis().beam(Bin::PASS), beam);
}

#[test]
fn a_missing_key_is_refused_at_its_table() {
    refused(
        "scan_period_ms = 8 ",
        "# scan_period_ms = 8 ",
        "[bus]",
        "[bus].scan_period_ms: found nothing, expected a number of ms from 0 to 1000",
    );
    refused_recipe(
        "nominal_v = 12.0\n",
        "",
        "[part]",
        "[part].nominal_v: found nothing, expected a number of V above 0 up to 1000",
    );
}

#[test]
fn a_wrong_unit_or_type_is_refused() {
    refused(
        "coil_current      = { module = \"coil_ai\", channel = 1, unit = \"A\"",
        "coil_current      = { module = \"coil_ai\", channel = 1, unit = \"V\"",
        "coil_current      =",
        "[analog_in].coil_current.unit: found \"V\", expected \"A\", the unit of coil_current",
    );
    refused(
        "coil_current      = { module = \"coil_ai\", channel = 1, unit = \"A\"",
        "coil_current      = { module = \"coil_ai\", channel = 1, unit = \"mA\"",
        "coil_current      =",
        "[analog_in].coil_current.unit: found \"mA\", expected \"V\" or \"A\"",
    );
    refused_recipe(
        "nominal_v = 12.0",
        "nominal_v = \"12 V\"",
        "nominal_v",
        "[part].nominal_v: found \"12 V\", expected a number of V above 0 up to 1000",
    );
    refused_recipe(
        "pin_length_mm = 3.5",
        "pin_length_mm = nan",
        "pin_length_mm",
        "[part].pin_length_mm: found NaN, expected a number of mm from 0 to 50",
    );
    refused_recipe(
        "body_mm = [22.5, 16.5, 16.5]",
        "body_mm = [22.5, -16.5, 16.5]",
        "body_mm",
        "[part].body_mm[1]: found -16.5, expected a number of mm above 0 up to 200",
    );
}

#[test]
fn settings_that_do_not_fit_the_model_are_refused() {
    refused(
        "model = \"I-7080\"\ntype = \"50\"",
        "model = \"I-7080\"\ntype = \"51\"",
        "type = \"51\"",
        "[module.timer].type: found \"51\", expected 50 for an I-7080",
    );
    refused(
        "model = \"I-7041\"\n",
        "model = \"I-7041\"\nslew = \"5\"\n",
        "slew = \"5\"\ntype",
        "[module.board_di].slew: found \"5\", expected no such key: an I-7041 has no slew",
    );
}

#[test]
fn a_low_limit_above_the_high_one_is_refused() {
    refused_recipe(
        "coil_resistance_ohm = { low = 360.0, high = 440.0 }",
        "coil_resistance_ohm = { low = 460.0, high = 440.0 }",
        "coil_resistance_ohm",
        "[limits].coil_resistance_ohm.low: found 460, expected at most high, which is 440",
    );
}

#[test]
fn a_recipe_is_called_as_its_file() {
    refused_recipe(
        "name = \"jzc-22f-012\"",
        "name = \"jzc-22f-12\"",
        "name =",
        "name: found \"jzc-22f-12\", expected \"jzc-22f-012\", as the file is called",
    );
}

#[test]
fn a_recipe_without_a_known_kind_is_refused_first() {
    for (to, found) in [
        ("kind = \"em_rely\"\ntitel = 1", "\"em_rely\""),
        ("kind = 1", "1"),
    ] {
        let expected = format!(
            "kind: found {found}, expected \"em_relay\", \"resistor\", \"ssr\" or \"thermostat\""
        );
        refused_recipe("kind = \"em_relay\"", to, "kind =", &expected);
    }
    let expected =
        "kind: found nothing, expected \"em_relay\", \"resistor\", \"ssr\" or \"thermostat\"";
    refused_recipe("kind = \"em_relay\"\n", "", "", expected);
}

#[test]
fn two_bins_at_one_axis_point_are_refused() {
    let line = line_of(RIG, "pass    =");
    refused(
        "coil    = { point = 3,",
        "coil    = { point = 2,",
        "coil    = { point",
        &format!(
            "[bin].coil.point: found 2, expected a point of its own (line {line}: [bin].pass.point)"
        ),
    );
}

/// Returns the default `rig.toml` without one bin and without the beam of its chute.
fn without_bin(name: &str) -> String {
    let beam = format!("beam_{name} ");
    let gone =
        |line: &str| line.starts_with(name) && line.contains("beam = ") || line.starts_with(&beam);
    let kept = RIG.lines().filter(|line| !gone(line));
    kept.map(|line| format!("{line}\n")).collect()
}

#[test]
fn a_rig_may_have_fewer_bins_or_others() {
    let rig_of = |text: &str| rig(text).unwrap().axis().clone();
    let names = |axis: &AxisTable| axis.bins().map(|bin| bin.to_string()).collect::<Vec<_>>();
    let fewer = rig_of(&without_bin("coil"));
    assert_eq!(
        names(&fewer),
        ["pass", "voltage", "time", "contact", "retest"]
    );
    assert!(!fewer.has(bins::COIL) && fewer.has(Bin::RETEST));
    let other = rig(&changed(RIG, "coil    = { point", "grade_2 = { point")).unwrap();
    assert_eq!(names(other.axis())[1], "grade_2");
    let beam = other.digital_input("beam_coil").unwrap();
    assert_eq!(other.axis().beam(Bin::named("grade_2")), beam);
}

#[test]
fn a_rig_without_pass_or_retest_is_refused() {
    for name in ["pass", "retest"] {
        let text = without_bin(name);
        let expected = format!(
            "config/rig.toml:{}: [bin].{name}: found nothing, expected a table",
            line_of(&text, "[bin]")
        );
        assert_eq!(rig(&text).unwrap_err().to_string(), expected);
    }
}

#[test]
fn a_name_too_long_for_a_bin_is_refused() {
    refused(
        "coil    = { point",
        "sixteen_letters_ = { point",
        "sixteen_letters_ = { point",
        "[bin].sixteen_letters_: found the name \"sixteen_letters_\", expected a name of at most 15 characters: a to z, 0 to 9 and _",
    );
}

#[test]
fn a_plant_that_cannot_stop_in_time_is_refused() {
    refused(
        "estop_reaction_ms = 420",
        "estop_reaction_ms = 100",
        "estop_reaction_ms",
        "[safety].estop_reaction_ms: found 100, expected at least 417.9, the worst reaction on line motion",
    );
}

#[test]
fn invalid_toml_is_refused_with_its_line() {
    let text = changed(RIG, "[safety]", "[safety");
    let message = rig(&text).unwrap_err().to_string();
    let start = format!("config/rig.toml:{}: ", line_of(RIG, "[safety]"));
    assert!(
        message.starts_with(&start) && message.ends_with("expected valid TOML"),
        "{message}"
    );
    let text = changed(RIG, "tries = 3", "tries = 3\ntries = 4");
    let message = rig(&text).unwrap_err().to_string();
    assert_eq!(
        message,
        format!(
            "config/rig.toml:{}: duplicate key, expected valid TOML",
            line_of(&text, "tries = 4")
        )
    );
}
