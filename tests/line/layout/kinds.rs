//! What belongs to one kind of device stands in its folder: no name of it anywhere else.

use super::tree::{Source, assert_none, files};

/// A kind: its folder, and names that only it has.
const KINDS: &[(&str, &[&str])] = &[(
    "src/dut/em_relay/",
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
        "contact_resistance",
        "contact_drop",
        "zero_cross",
        "chamber_",
    ],
)];

/// Studies are about the parts of a kind; a released migration is never edited; examples show a question as it is asked.
const ALLOWED: &[&str] = &[
    "src/cli/study.rs",
    "src/cli/study/",
    "src/history/schema/",
    "src/cli/history.rs",
];

/// What still knows a kind, and where that goes. An entry that is no longer needed fails the test.
const NOT_YET: &[(&str, &str)] = &[
    ("src/config/keys/golden.rs", "keys of the kind: dut"),
    ("src/config/keys/recipe.rs", "keys of the kind: dut"),
    ("src/config/keys/rig/measuring.rs", "keys of the kind: dut"),
    (
        "src/hmi/page/words.json",
        "recipe keys, stages, points, factors: texts of the kind",
    ),
];

#[test]
fn a_name_of_a_kind_stands_in_its_folder_only() {
    let mut broken = Vec::new();
    for source in sources() {
        let waits = NOT_YET.iter().find(|(path, _)| *path == source.path);
        let found = foreign(&source);
        match (waits, found.is_empty()) {
            (None, _) => broken.extend(found),
            (Some(_), false) => {}
            (Some((path, _)), true) => broken.push(format!(
                "{path}: knows no kind any more, take it off the list of what waits"
            )),
        }
    }
    assert_none(&broken);
}

#[test]
fn everything_that_waits_exists() {
    let sources = sources();
    let is_there = |path: &str| sources.iter().any(|source| source.path == path);
    let gone = NOT_YET.iter().filter(|(path, _)| !is_there(path));
    let gone: Vec<String> = gone.map(|(path, _)| format!("{path}: not there")).collect();
    assert_none(&gone);
}

fn sources() -> Vec<Source> {
    let mut all = files(&["src"]);
    all.retain(|source| {
        let path = source.path.as_str();
        !source.is_test() && !ALLOWED.iter().any(|it| path.starts_with(it))
    });
    all
}

/// Names of kinds whose folder the file does not lie in.
fn foreign(source: &Source) -> Vec<String> {
    let end = source
        .text
        .find("\n#[cfg(test)]\nmod ")
        .unwrap_or(source.text.len());
    let last = source.text[..end].lines().count();
    let mut found = Vec::new();
    for (folder, names) in KINDS {
        if source.path.starts_with(folder) {
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
fn a_name_in_a_comment_a_test_or_its_own_folder_is_not_foreign() {
    let text = "/// coil_a\nlet a = coil_a;\n\n#[cfg(test)]\nmod tests {\n    let a = coil_a;\n}\n";
    let source = |path: &str| Source {
        path: path.to_owned(),
        text: text.to_owned(),
    };
    assert_eq!(
        foreign(&source("src/view.rs")),
        ["src/view.rs:2: `coil_` belongs to src/dut/em_relay/"]
    );
    assert!(foreign(&source("src/dut/em_relay/coil.rs")).is_empty());
}
