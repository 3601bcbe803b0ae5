//! Names of one kind of device appear in its folder only.

use super::tree::{Source, assert_none, files};

/// A kind of device: its folder and its identifiers.
const KINDS: &[(&str, &[&str])] = &[
    (
        "crates/machine/src/dut/em_relay/",
        &[
            "coil_",
            "Coil",
            "armature",
            "Armature",
            "operate_voltage",
            "release_voltage",
            "operate_time",
            "release_time",
            "operate_bounce",
            "release_bounce",
            "contact_resistance_n",
            "contact_drop",
            "zero_cross",
        ],
    ),
    (
        "crates/machine/src/dut/resistor/",
        &[
            "\"resistance_ohm",
            "tcr_ppm",
            "resistor_open",
            "resistor_short",
        ],
    ),
    (
        "crates/machine/src/dut/ssr/",
        &[
            "v_on_v",
            "v_off_v",
            "i_leak",
            "r_on_mohm",
            "smu_in",
            "smu_out",
            "kelvin_out",
            "output_safe",
            "short_check",
        ],
    ),
    (
        "crates/machine/src/dut/thermostat/",
        &[
            "operate_temperature",
            "reset_temperature",
            "contact_resistance_m",
            "chamber_",
            "chamber::",
            "socket_select",
            "socket_drop",
            "main_contactor",
            "heater_power",
        ],
    ),
];

/// Exceptions: studies of a kind, released migrations, examples of command lines.
const ALLOWED: &[&str] = &[
    "crates/studies/src/",
    "crates/history/src/schema/",
    "src/cli/history.rs",
];

#[test]
fn names_of_a_kind_stay_in_its_folder() {
    let broken: Vec<String> = sources().iter().flat_map(foreign).collect();
    assert_none(&broken);
}

fn sources() -> Vec<Source> {
    let mut all = files(&["src", "crates"]);
    all.retain(|source| {
        let path = source.path.as_str();
        !source.is_test() && !ALLOWED.iter().any(|it| path.starts_with(it))
    });
    all
}

/// Returns the identifiers of a kind that a file outside the folder of that kind uses.
fn foreign(source: &Source) -> Vec<String> {
    let end = source
        .text
        .find("\n#[cfg(test)]\nmod ")
        .unwrap_or(source.text.len());
    let last = source.text[..end].lines().count();
    let mut found = Vec::new();
    for (folder, names) in KINDS {
        // A kind may use points and bins of the board of another kind.
        if KINDS
            .iter()
            .any(|(of_a_kind, _)| source.path.starts_with(of_a_kind))
        {
            continue;
        }
        for (line, code) in source.code().take_while(|(line, _)| *line <= last) {
            for name in names.iter().filter(|name| code.contains(*name)) {
                found.push(format!(
                    "{}:{line}: `{name}` belongs to {folder}",
                    source.path
                ));
            }
        }
    }
    found
}

#[test]
fn comments_tests_and_own_folders_may_name_a_kind() {
    let text = "/// coil_a\nlet a = coil_a;\n\n#[cfg(test)]\nmod tests {\n    let a = coil_a;\n}\n";
    let source = |path: &str| Source {
        path: path.to_owned(),
        text: text.to_owned(),
    };
    assert_eq!(
        foreign(&source("crates/machine/src/view.rs")),
        ["crates/machine/src/view.rs:2: `coil_` belongs to crates/machine/src/dut/em_relay/"]
    );
    assert!(foreign(&source("crates/machine/src/dut/em_relay/coil.rs")).is_empty());
}
