//! The files of `config/`, compiled into the program.

/// Lists files of `config/` with their texts.
macro_rules! files {
    ($($name:literal,)*) => { &[$(($name, include_str!(concat!("../../../config/", $name)))),*] };
}

/// Name and text of every file of `config/`; a test compares the names with the folder.
pub(super) const BUILT_IN: &[(&str, &str)] = files![
    "README.md",
    "card.toml",
    "golden.toml",
    "instruments/ac-source-61500.toml",
    "instruments/digitizer-keysight.toml",
    "instruments/digitizer-rigol.toml",
    "instruments/dmm-34461a.toml",
    "instruments/pulse-source.toml",
    "instruments/smu-2450.toml",
    "lot.toml",
    "nests/body-18x12.toml",
    "recipes/jzc-22f-003.toml",
    "recipes/jzc-22f-005.toml",
    "recipes/jzc-22f-006.toml",
    "recipes/jzc-22f-009.toml",
    "recipes/jzc-22f-012-adaptive.toml",
    "recipes/jzc-22f-012.toml",
    "recipes/jzc-22f-018.toml",
    "recipes/jzc-22f-024.toml",
    "recipes/jzc-22f-048.toml",
    "recipes/resistor-390.toml",
    "rig.toml",
    "scene.toml",
    "sim.toml",
];
