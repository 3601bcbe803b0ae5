//! The files of `config/` and of the rigs below it, compiled into the program.

/// Lists files of `config/` with their texts.
macro_rules! files {
    ($($name:literal,)*) => { &[$(($name, include_str!(concat!("../../../config/", $name)))),*] };
}

/// Name and text of every file of `config/` without `rigs`; a test compares the names with the folder.
pub(super) const BUILT_IN: &[(&str, &str)] = files![
    "README.md",
    "card.toml",
    "fleet.toml",
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

/// Files of one rig, by name.
type Rig = (&'static str, &'static [(&'static str, &'static str)]);

/// Lists files of `config/rigs/NAME` with their texts.
macro_rules! rig {
    ($rig:literal: $($name:literal,)*) => {
        ($rig, &[$(($name, include_str!(concat!("../../../config/rigs/", $rig, "/", $name)))),*])
    };
}

/// The rigs of `config/rigs`, each a configuration of its own; a test compares the names with the folders.
pub(super) const RIGS: &[Rig] = &[
    rig!["ssr":
        "card.toml",
        "recipes/ssr-ac-240v-5a-random.toml",
        "recipes/ssr-ac-240v-5a-zc.toml",
        "recipes/ssr-dc-60v-3a.toml",
        "rig.toml",
        "scene.toml",
        "sim.toml",
    ],
    rig!["thermostat":
        "card.toml",
        "rack.toml",
        "recipes/thermostat-ksd301.toml",
        "recipes/thermostat-ksd9700.toml",
        "recipes/thermostat-referee.toml",
        "rig.toml",
        "sim.toml",
    ],
];

/// Name of the rig of `config/` itself.
pub(super) const FIRST_RIG: &str = "jzc-22f";

/// Returns name and text of every file of a rig; `None` for a name that no rig has.
pub(super) fn files_of(rig: &str) -> Option<&'static [(&'static str, &'static str)]> {
    if rig == FIRST_RIG {
        return Some(BUILT_IN);
    }
    let found = RIGS.iter().find(|(name, _)| *name == rig);
    found.map(|(_, files)| *files)
}
