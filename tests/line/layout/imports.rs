//! Who may import whom. A module that is not in the table has no place in the house yet.

use super::tree::{Source, assert_none, files, has_word, rust_files};

/// Module, and what it may import besides itself.
const TABLE: &[(&str, &[&str])] = &[
    ("units", &[]),
    ("form", &[]),
    ("dcon", &[]),
    ("quality", &["units"]),
    ("lpm", &["units"]),
    ("guard", &["units", "lpm"]),
    ("plan", &["units", "lpm"]),
    ("rig", &["units", "dcon", "guard"]),
    ("gauge", &["units"]),
    ("bus", &["units", "dcon"]),
    ("instrument", &["units", "rig"]),
    ("dut", &["units", "form", "rig", "gauge", "instrument"]),
    (
        "handling",
        &["units", "rig", "guard", "gauge", "instrument", "dut"],
    ),
    (
        "station",
        &[
            "units",
            "rig",
            "guard",
            "gauge",
            "instrument",
            "dut",
            "handling",
        ],
    ),
    ("view", &["units", "dut"]),
    (
        "history",
        &[
            "units",
            "rig",
            "gauge",
            "instrument",
            "dut",
            "handling",
            "station",
            "quality",
            "plan",
        ],
    ),
    (
        "report",
        &[
            "units", "rig", "gauge", "dut", "station", "quality", "plan", "history",
        ],
    ),
    (
        "inquiry",
        &["units", "gauge", "dut", "history", "report", "quality"],
    ),
    (
        "hmi",
        &[
            "view", "history", "inquiry", "report", "config", "quality", "dut",
        ],
    ),
    (
        "config",
        &[
            "units", "form", "dcon", "bus", "lpm", "guard", "rig", "gauge", "dut", "station",
        ],
    ),
    (
        "cycle",
        &[
            "units",
            "dcon",
            "bus",
            "guard",
            "rig",
            "instrument",
            "dut",
            "handling",
            "station",
            "view",
        ],
    ),
    (
        "app",
        &[
            "units",
            "bus",
            "rig",
            "guard",
            "gauge",
            "instrument",
            "dut",
            "handling",
            "station",
            "cycle",
            "view",
            "config",
            "quality",
            "history",
            "hmi",
        ],
    ),
    (
        "study",
        &[
            "units", "bus", "lpm", "rig", "gauge", "dut", "handling", "station", "view", "config",
            "quality", "history", "inquiry", "app",
        ],
    ),
    (
        "cli",
        &[
            "cycle",
            "units",
            "form",
            "dcon",
            "bus",
            "lpm",
            "guard",
            "plan",
            "rig",
            "gauge",
            "instrument",
            "dut",
            "handling",
            "station",
            "quality",
            "history",
            "report",
            "inquiry",
            "view",
            "hmi",
            "config",
            "app",
            "study",
        ],
    ),
    ("main", &["app", "cli"]),
];

/// `lib.rs` names every module; it is the list itself.
const LIST_OF_MODULES: &str = "lib";

#[test]
fn every_module_imports_only_what_the_table_allows() {
    let mut broken = Vec::new();
    for source in rust_files(&["src"])
        .into_iter()
        .filter(|source| !source.is_test())
    {
        let module = source.capability().unwrap().to_owned();
        if module == LIST_OF_MODULES {
            continue;
        }
        let Some((_, allowed)) = TABLE.iter().find(|(name, _)| *name == module) else {
            broken.push(format!(
                "{}: module `{module}` has no row in the import table",
                source.path
            ));
            continue;
        };
        for (line, import) in imports(&source) {
            if import != module && !allowed.contains(&import.as_str()) {
                let rule = if allowed.is_empty() {
                    "nothing of ours".to_owned()
                } else {
                    allowed.join(", ")
                };
                broken.push(format!(
                    "{}:{line}: `{module}` names `{import}`, it may import {rule}",
                    source.path
                ));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn the_simulated_rig_and_the_controller_share_no_code() {
    let mut broken = Vec::new();
    for source in files(&["sim"]) {
        let is_manifest = source.path.ends_with("Cargo.toml");
        for (line, code) in source.code() {
            let depends =
                is_manifest && (has_word(code, "relayrig") || code.contains("path = \".."));
            if depends || code.contains("relayrig::") {
                broken.push(format!(
                    "{}:{line}: the simulated rig never depends on the controller",
                    source.path
                ));
            }
        }
    }
    for source in rust_files(&["src"]) {
        if matches!(source.capability(), Some("app" | "study" | "cli")) {
            continue;
        }
        for (line, _) in source.code().filter(|(_, code)| has_word(code, "rigsim")) {
            broken.push(format!(
                "{}:{line}: only src/app, src/study and src/cli name the simulated rig",
                source.path
            ));
        }
    }
    assert_none(&broken);
}

/// First path segment after `crate::` or `relayrig::`, of every import and every path in the code.
fn imports(source: &Source) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut code = String::new();
    let mut starts = Vec::new();
    for (line, text) in source.code() {
        starts.push((code.len(), line));
        code.push_str(text);
        code.push('\n');
    }
    for root in ["crate::", "relayrig::"] {
        for (at, _) in code.match_indices(root) {
            if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
                continue;
            }
            let line = starts
                .iter()
                .rev()
                .find(|(start, _)| *start <= at)
                .map_or(1, |(_, line)| *line);
            let names = first_segments(&code[at + root.len()..]);
            found.extend(names.into_iter().map(|name| (line, name)));
        }
    }
    found.extend(climbs(source));
    found
}

/// `{bus::Line, dcon}` names two modules, `bus::Line` one; a macro or a type in the root names none.
fn first_segments(path: &str) -> Vec<String> {
    let Some(group) = path.strip_prefix('{') else {
        return leading_name(path).into_iter().collect();
    };
    let mut depth = 0;
    let mut names = Vec::new();
    let mut rest = group;
    names.extend(leading_name(rest.trim_start()));
    while let Some(at) = rest.find(['{', '}', ',']) {
        let mark = rest.as_bytes()[at];
        rest = &rest[at + 1..];
        match mark {
            b'{' => depth += 1,
            b'}' if depth == 0 => break,
            b'}' => depth -= 1,
            _ if depth == 0 => names.extend(leading_name(rest.trim_start())),
            _ => {}
        }
    }
    names
}

fn leading_name(path: &str) -> Option<String> {
    let end = path
        .find(|c: char| !(c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_'))
        .unwrap_or(path.len());
    (end > 0).then(|| path[..end].to_owned())
}

/// A chain of `super::` that climbs to the root and leaves the capability by the back door.
fn climbs(source: &Source) -> Vec<(usize, String)> {
    let names = source.path.split('/').count();
    let to_the_root = if source.path.ends_with("/mod.rs") {
        names - 2
    } else {
        names - 1
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
        let name = leading_name(rest).filter(|name| TABLE.iter().any(|(known, _)| known == name));
        found.extend(
            name.filter(|_| height >= to_the_root)
                .map(|name| (line, name)),
        );
    }
    found
}

#[test]
fn a_group_of_imports_names_each_of_its_modules() {
    let group = "{\n  bus::{Answer, Pace},\n  dcon, guard::Guard,\n};";
    assert_eq!(first_segments(group), ["bus", "dcon", "guard"]);
    assert_eq!(first_segments("rig::point::Counter;"), ["rig"]);
    assert!(first_segments("Counter;").is_empty());
}

#[test]
fn a_forbidden_import_is_found_with_its_line() {
    let text =
        "//! Doc.\n// use crate::bus;\n\nuse crate::{units::Ohm,\n    bus::Line};\n".to_owned();
    let source = Source {
        path: "src/lpm/x.rs".into(),
        text,
    };
    let found = imports(&source);
    assert_eq!(found, [(4, "units".to_owned()), (4, "bus".to_owned())]);
}

#[test]
fn an_import_through_the_parent_is_found_too() {
    let found = |path: &str| {
        let text = "use super::bus::Line;\nuse super::bounded::UpTo;\n".to_owned();
        imports(&Source {
            path: path.to_owned(),
            text,
        })
    };
    assert_eq!(found("src/dcon/mod.rs"), [(1, "bus".to_owned())]);
    assert!(
        found("src/dcon/level.rs").is_empty(),
        "there it is a module beside"
    );
}
