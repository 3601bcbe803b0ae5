//! Allowed imports: dependencies that manifests must not have, and the order of the modules inside `machine`.

use super::tree::{Source, assert_none, files, has_word, root, rust_files};
use std::collections::BTreeSet;

/// Crates without clock, file, socket or thread, with their allowed dependencies.
const PURE: &[(&str, &[&str])] = &[
    ("units", &["serde"]),
    ("dcon", &["thiserror"]),
    ("scpi", &["serde", "thiserror", "units"]),
    (
        "lpm",
        &["serde", "serde_json", "thiserror", "toml", "units"],
    ),
    ("plan", &["lpm", "thiserror"]),
    ("chamber", &["thiserror"]),
    ("quality", &["serde", "statrs", "thiserror", "utoipa"]),
    (
        "machine",
        &[
            "chamber",
            "dcon",
            "lpm",
            "scpi",
            "serde",
            "serde_json",
            "statrs",
            "texts",
            "thiserror",
            "toml",
            "units",
            "utoipa",
        ],
    ),
    (
        "texts",
        &[
            "fluent-bundle",
            "fluent-syntax",
            "serde",
            "unic-langid",
            "utoipa",
        ],
    ),
];

/// Crates of the real-time thread, with their allowed dependencies: no file, page, log or database can delay the rig.
const REAL_TIME: &[(&str, &[&str])] = &[
    (
        "bus",
        &[
            "dcon",
            "rustix",
            "scpi",
            "texts",
            "thiserror",
            "tokio",
            "tokio-serial",
            "units",
            "virtual_time",
        ],
    ),
    (
        "cycle",
        &[
            "bus", "dcon", "jiff", "machine", "scpi", "texts", "tokio", "units",
        ],
    ),
];

/// Modules of `machine` with their allowed imports.
const MACHINE: &[(&str, &[&str])] = &[
    ("form", &[]),
    ("named", &[]),
    ("gauge", &[]),
    ("guard", &[]),
    ("rig", &["guard"]),
    ("instrument", &["rig"]),
    ("dut", &["form", "gauge", "instrument", "rig"]),
    ("handling", &["dut", "guard", "instrument", "rig"]),
    (
        "station",
        &["dut", "guard", "handling", "instrument", "rig"],
    ),
    ("view", &["dut", "handling", "station"]),
];

#[test]
fn a_pure_crate_depends_only_on_pure_crates() {
    assert_dependencies(PURE, "is pure");
}

#[test]
fn nothing_that_blocks_reaches_the_real_time_thread() {
    assert_dependencies(REAL_TIME, "runs on the real-time thread");
}

fn assert_dependencies(table: &[(&str, &[&str])], why: &str) {
    let manifests = files(&["crates"]);
    let mut broken = Vec::new();
    for (name, allowed) in table {
        let path = format!("crates/{name}/Cargo.toml");
        let manifest = manifests.iter().find(|it| it.path == path);
        let manifest = manifest.unwrap_or_else(|| panic!("{path} is missing"));
        for found in dependencies(&manifest.text) {
            if !allowed.contains(&found.as_str()) {
                broken.push(format!(
                    "{path}: `{name}` {why} and must not need `{found}`"
                ));
            }
        }
    }
    assert_none(&broken);
}

/// Returns the keys of `[dependencies]`.
fn dependencies(manifest: &str) -> Vec<String> {
    let lines = manifest.lines().map(str::trim);
    let inside = lines
        .skip_while(|line| *line != "[dependencies]")
        .skip(1)
        .take_while(|line| !line.starts_with('['));
    let keys = inside.filter_map(|line| line.split(['.', ' ', '=']).next());
    keys.filter(|key| !key.is_empty() && !key.starts_with('#'))
        .map(str::to_owned)
        .collect()
}

#[test]
fn machine_modules_import_only_what_the_table_allows() {
    let mut broken = Vec::new();
    for source in rust_files(&["crates/machine/src"]) {
        let module = source.room().unwrap().to_owned();
        if source.is_test() || module == "lib" {
            continue;
        }
        let Some((_, allowed)) = MACHINE.iter().find(|(name, _)| *name == module) else {
            broken.push(format!(
                "{}: `{module}` has no row in the table",
                source.path
            ));
            continue;
        };
        for (line, import) in imports(&source) {
            if import != module && !allowed.contains(&import.as_str()) {
                broken.push(format!(
                    "{}:{line}: `{module}` names `{import}`, it may import {allowed:?}",
                    source.path
                ));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn the_simulated_rig_and_the_controller_share_no_code() {
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).unwrap();
    let own = files(&["crates"]).into_iter();
    let own = own.filter_map(|it| Some(it.path.strip_suffix("/Cargo.toml")?.to_owned()));
    let own: BTreeSet<String> = own
        .filter_map(|it| Some(it.strip_prefix("crates/")?.to_owned()))
        .collect();
    let mut broken: Vec<String> = needed(&lock, "rigsim")
        .intersection(&own)
        .filter(|it| *it != SHARED_CLOCK)
        .map(|it| format!("Cargo.lock: the simulated rig needs `{it}` of the controller"))
        .collect();
    for source in rust_files(&["crates"]) {
        let allowed = SIMULATING.iter().any(|it| source.path.starts_with(it));
        if allowed || source.path.contains("/benches/") {
            continue;
        }
        for (line, _) in source.code().filter(|(_, code)| has_word(code, "rigsim")) {
            broken.push(format!(
                "{}:{line}: the simulated rig is named in {SIMULATING:?} only",
                source.path
            ));
        }
    }
    assert_none(&broken);
}

/// Returns the packages that a package of the lock file needs, directly or not, for its program or its tests.
fn needed(lock: &str, package: &str) -> BTreeSet<String> {
    let lock: toml::Table = lock.parse().unwrap();
    let packages = lock["package"].as_array().unwrap();
    let mut needed = BTreeSet::new();
    let mut open = vec![package.to_owned()];
    while let Some(name) = open.pop() {
        let versions = packages
            .iter()
            .filter(|it| it["name"].as_str() == Some(&name));
        for list in versions.filter_map(|it| it.get("dependencies")) {
            for named in list.as_array().unwrap() {
                // A version follows the name where the lock file has several.
                let named = named.as_str().unwrap().split(' ').next().unwrap();
                if needed.insert(named.to_owned()) {
                    open.push(named.to_owned());
                }
            }
        }
    }
    needed
}

#[test]
fn an_indirect_dependency_is_found() {
    let lock = "[[package]]\nname = \"a\"\ndependencies = [\"b 1.0.0\"]\n[[package]]\nname = \"b\"\n\
                dependencies = [\"c\"]\n[[package]]\nname = \"c\"\n[[package]]\nname = \"d\"\n";
    assert_eq!(needed(lock, "a"), ["b", "c"].map(str::to_owned).into());
}

/// The crate that both sides use: virtual time, which knows neither.
const SHARED_CLOCK: &str = "virtual_time";

/// Crates that may start the simulated rig.
const SIMULATING: [&str; 2] = ["crates/app/", "crates/studies/"];

/// Returns the first segment after `crate::` of every import and path.
fn imports(source: &Source) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (line, code) in source.code() {
        for (at, root) in code.match_indices("crate::") {
            let after_a_name =
                code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '$');
            let name = leading_name(&code[at + root.len()..]);
            found.extend(name.filter(|_| !after_a_name).map(|name| (line, name)));
        }
        assert!(
            !code.contains("crate::{"),
            "{}:{line}: one import per module",
            source.path
        );
    }
    found.extend(climbs(source));
    found
}

fn leading_name(path: &str) -> Option<String> {
    let end = path
        .find(|c: char| !(c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_'))
        .unwrap_or(path.len());
    (end > 0).then(|| path[..end].to_owned())
}

/// Returns chains of `super::` that leave the module through the root.
fn climbs(source: &Source) -> Vec<(usize, String)> {
    let inside = source.path.strip_prefix("crates/machine/src/");
    let names = inside.unwrap_or(&source.path).split('/').count();
    let to_the_root = if source.path.ends_with("/mod.rs") {
        names - 1
    } else {
        names
    };
    let mut found = Vec::new();
    for (line, code) in source.code() {
        let Some(start) = code.find("super::") else {
            continue;
        };
        let mut rest = &code[start..];
        let mut height = 0;
        while let Some(above) = rest.strip_prefix("super::") {
            rest = above;
            height += 1;
        }
        let name = leading_name(rest).filter(|name| MACHINE.iter().any(|(known, _)| known == name));
        found.extend(
            name.filter(|_| height >= to_the_root)
                .map(|name| (line, name)),
        );
    }
    found
}

#[test]
fn a_forbidden_import_is_found_with_its_line() {
    let text = "//! Doc.\n// use crate::rig;\n\nuse crate::rig::Image;\n".to_owned();
    let source = Source {
        path: "crates/machine/src/gauge/x.rs".into(),
        text,
    };
    assert_eq!(imports(&source), [(4, "rig".to_owned())]);
}

#[test]
fn an_import_through_the_parent_is_found_too() {
    let found = |path: &str| {
        let text = "use super::rig::Image;\nuse super::budget::Budget;\n".to_owned();
        imports(&Source {
            path: path.to_owned(),
            text,
        })
    };
    assert_eq!(
        found("crates/machine/src/gauge/mod.rs"),
        [(1, "rig".to_owned())]
    );
    assert!(
        found("crates/machine/src/gauge/budget.rs").is_empty(),
        "there it is a module beside"
    );
}

#[test]
fn the_dependencies_of_a_manifest_are_read() {
    let manifest = "[package]\nname = \"x\"\n[dependencies]\nserde.workspace = true\n# a remark\ntoml = \"1\"\n\n[dev-dependencies]\nx = \"1\"\n";
    assert_eq!(dependencies(manifest), ["serde", "toml"]);
}
