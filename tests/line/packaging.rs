//! Files of the Debian package: units, scripts, list of contents.

use crate::layout::tree::root;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Highest exposure of the service that `systemd-analyze security` may compute, 0 to 10.
const EXPOSURE: f64 = 3.0;

/// Runs a program; `None` when the program is missing. Reports that on the terminal, past the capture of the test.
fn output(program: &str, arguments: &[&str]) -> Option<Output> {
    match Command::new(program).args(arguments).output() {
        Ok(output) => Some(output),
        Err(error) => {
            let text = format!("SKIPPED: {program} {}: {error}\n", arguments.join(" "));
            std::io::stderr().write_all(text.as_bytes()).unwrap();
            None
        }
    }
}

/// Returns what a program printed on both streams; fails when the program failed.
fn said(output: &Output) -> String {
    let text = [&output.stdout, &output.stderr].map(|it| String::from_utf8_lossy(it).into_owned());
    let text = text.concat();
    assert!(output.status.success(), "{text}");
    text
}

/// Returns the files of `packaging/` with one of the extensions.
fn packaged(extensions: &[&str]) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("packaging")).unwrap();
    let mut found: Vec<PathBuf> = entries.map(|it| it.unwrap().path()).collect();
    found.retain(|path| {
        path.extension()
            .is_some_and(|it| extensions.iter().any(|e| it == *e))
    });
    assert!(!found.is_empty());
    found
}

#[test]
fn systemd_accepts_every_unit() {
    let folder = tempfile::tempdir().unwrap();
    let units = packaged(&["service", "timer"]).into_iter().map(|unit| {
        let copy = folder.path().join(unit.file_name().unwrap());
        let text = fs::read_to_string(unit).unwrap();
        let built = text.replace("/usr/bin/relayrig", env!("CARGO_BIN_EXE_relayrig"));
        fs::write(&copy, built).unwrap();
        copy.to_str().unwrap().to_owned()
    });
    let mut words = vec!["verify".to_owned(), "--man=no".to_owned()];
    words.extend(units);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    if let Some(output) = output("systemd-analyze", &words) {
        assert_eq!(said(&output), "");
    }
}

#[test]
fn units_are_little_exposed() {
    for unit in packaged(&["service"]) {
        let unit = unit.to_str().unwrap();
        let words = ["security", "--offline=yes", "--no-pager", unit];
        let Some(output) = output("systemd-analyze", &words) else {
            return;
        };
        let text = said(&output);
        let (_, rest) = text.split_once("Overall exposure level for ").unwrap();
        let (_, level) = rest.split_once(": ").unwrap();
        let level: f64 = level.split(' ').next().unwrap().parse().unwrap();
        assert!(level < EXPOSURE, "{unit}: {level}");
    }
}

#[test]
fn maintainer_scripts_are_shell() {
    for script in ["postinst", "postrm"] {
        let path = root().join("packaging/debian").join(script);
        let checked = Command::new("sh").arg("-n").arg(&path).output().unwrap();
        assert_eq!(said(&checked), "", "{script}");
    }
}

/// Returns the first path of each asset of the package.
fn assets() -> Vec<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let deb = &manifest["package"]["metadata"]["deb"];
    let assets = deb["assets"].as_array().unwrap().iter();
    assets
        .map(|asset| asset[0].as_str().unwrap().to_owned())
        .collect()
}

/// True when the asset, with at most one `*` in its file name, takes the file.
fn takes(asset: &str, file: &Path) -> bool {
    let (asset, file) = (Path::new(asset), file.strip_prefix(root()).unwrap());
    let (pattern, name) = (asset.file_name().unwrap(), file.file_name().unwrap());
    let (pattern, name) = (pattern.to_str().unwrap(), name.to_str().unwrap());
    let fits = match pattern.split_once('*') {
        Some((start, end)) => name.starts_with(start) && name.ends_with(end),
        None => name == pattern,
    };
    asset.parent() == file.parent() && fits
}

#[test]
fn the_package_contains_every_configuration_file() {
    let assets = assets();
    for folder in ["config", "config/recipes"] {
        for entry in fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let is_packaged = assets.iter().any(|asset| takes(asset, &path));
            assert!(path.is_dir() || is_packaged, "{}", path.display());
        }
    }
}

#[test]
fn every_asset_of_the_repository_exists() {
    for asset in assets().iter().filter(|it| !it.starts_with("target/")) {
        let folder = root().join(asset).parent().unwrap().to_owned();
        let mut files = fs::read_dir(folder).unwrap().map(|it| it.unwrap().path());
        assert!(files.any(|file| takes(asset, &file)), "{asset}");
    }
}
