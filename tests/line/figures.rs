//! The document of the figures: made from plan and stored results alone, and every command of the plan exists.

use crate::layout::tree::{assert_none, root};
use crate::program::{Workshop, objects};
use clap::Parser;
use relayrig::cli::Cli;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use studies::figures::{Plan, Row, RunResult, folder, render};

fn docs() -> std::path::PathBuf {
    root().join("docs")
}

#[test]
fn the_document_is_what_plan_and_results_render() {
    let rendered = render(&docs()).unwrap();
    assert_stored(&docs().join("figures.md"), &rendered.document);
    for (file, svg) in rendered.pictures {
        assert_stored(&docs().join("pictures").join(file), &svg);
    }
}

fn assert_stored(file: &Path, rendered: &str) {
    let stored = fs::read_to_string(file).unwrap();
    let lines = (1..).zip(stored.lines().zip(rendered.lines()));
    let differing = lines.filter(|(_, (stored, rendered))| stored != rendered);
    let first = differing.take(1).collect::<Vec<_>>();
    assert!(
        stored == rendered,
        "{}: stored and rendered line differ, {first:?}; run `relayrig study figures --render`",
        file.display()
    );
}

#[test]
fn every_result_and_picture_belongs_to_the_plan() {
    let plan = Plan::load(&docs()).unwrap();
    let names: BTreeSet<String> = plan
        .runs()
        .map(|run| format!("{}.jsonl", run.name))
        .collect();
    let pictures = plan.runs().flat_map(|run| &run.pictures);
    let pictures: BTreeSet<String> = pictures.map(|it| it.file.clone()).collect();
    let mut broken = stray(&folder(&docs()), &names);
    broken.extend(stray(&docs().join("pictures"), &pictures));
    assert_none(&broken);
}

fn stray(folder: &Path, known: &BTreeSet<String>) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let files = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    let unknown = files.filter(|file| !known.contains(file));
    unknown
        .map(|file| format!("{}: no run of the plan makes {file}", folder.display()))
        .collect()
}

#[test]
fn every_command_of_the_plan_is_accepted() {
    let plan = Plan::load(&docs()).unwrap();
    let commands = plan.runs().flat_map(|run| {
        let larger = run.larger.iter().map(|it| it.command.as_str());
        std::iter::once(run.command.as_str()).chain(larger)
    });
    let mut broken = Vec::new();
    for command in commands {
        let words: Vec<&str> = command.split_whitespace().collect();
        let flaw = match words.as_slice() {
            ["relayrig", ..] => Cli::try_parse_from(&words).err().map(|it| it.to_string()),
            ["cargo", "bench", rest @ ..] => flaw_of_benchmark(rest),
            [script, ..] => (!root().join(script).is_file()).then(|| "no such file".to_owned()),
            [] => Some("empty".to_owned()),
        };
        broken.extend(flaw.map(|it| format!("{command}: {it}")));
    }
    assert_none(&broken);
}

/// Returns what is wrong with `-p PACKAGE --bench NAME`, both optional.
fn flaw_of_benchmark(words: &[&str]) -> Option<String> {
    let after = |option: &str| {
        let mut words = words.iter().skip_while(|word| **word != option);
        words.nth(1).copied()
    };
    let manifest = match after("-p") {
        None => "Cargo.toml".to_owned(),
        Some("rigsim") => "sim/Cargo.toml".to_owned(),
        Some(package) => format!("crates/{package}/Cargo.toml"),
    };
    let Ok(text) = fs::read_to_string(root().join(&manifest)) else {
        return Some(format!("no file {manifest}"));
    };
    let name = after("--bench").or(after("-p"))?;
    let declared = format!("[[bench]]\nname = \"{name}\"");
    (!text.contains(&declared)).then(|| format!("{manifest} declares no benchmark {name}"))
}

/// The command of a README figure writes `STUDY` for `relayrig study`.
#[test]
fn figures_of_the_readme_are_those_of_the_results() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let plan = Plan::load(&docs()).unwrap();
    let rows = readme
        .lines()
        .filter(|line| line.starts_with('|') && line.contains("`STUDY "));
    let mut broken = Vec::new();
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let command = cells[3]
            .trim_matches('`')
            .replace("STUDY", "relayrig study");
        let run = plan.runs().find(|run| run.command == command);
        let result = run.and_then(|run| RunResult::load(&docs(), run).unwrap());
        let known =
            result.is_some_and(|it| it.rows.iter().any(|row| is_shown(row, cells[1], cells[2])));
        count += 1;
        if !known {
            broken.push(format!(
                "{row}: no such figure in the result of `{command}`"
            ));
        }
    }
    assert_none(&broken);
    assert_eq!(count, 3, "figures in README.md");
}

/// Returns whether value and bar of a figure round to the numbers at the beginning of these texts.
fn is_shown(row: &Row, value: &str, bar: &str) -> bool {
    use studies::Bar;
    let rounds_to = |exact: f64, text: &str| {
        let number = text.split(' ').next().unwrap_or_default().replace(',', "");
        let decimals = number
            .split_once('.')
            .map_or(0, |(_, decimals)| decimals.len());
        format!("{exact:.decimals$}") == number
    };
    let bound = match row.bar {
        Some(Bar::AtMost(it) | Bar::Below(it) | Bar::AtLeast(it)) => it,
        Some(Bar::Within(..)) | None => return false,
    };
    row.value.is_some_and(|exact| rounds_to(exact, value)) && rounds_to(bound, bar)
}

const SMALL: &str = r##"
about = "Two runs."
[[section]]
title = "Pace"
about = "A lot."
[[section.run]]
name = "cycle"
title = "Cycle"
command = "relayrig study cycle --parts 7"
machine = "any"
pictures = [{ file = "cycle.svg", about = "Where a cycle goes" }]
[[section.run]]
name = "gauge"
title = "Gauge"
command = "relayrig study gauge"
machine = "any"
"##;

fn planned(name: &str, plan: &str) -> Workshop {
    let workshop = Workshop::new(name);
    fs::create_dir_all(workshop.folder.join("docs/figures")).unwrap();
    workshop.write("docs/figures/plan.toml", plan);
    workshop
}

#[test]
fn a_plan_is_run_stored_and_rendered() {
    let workshop = planned("figures", SMALL);
    let said = workshop.run("study figures --only cycle").with_status(1);
    assert!(
        said.stdout.starts_with("docs/figures.md: 1 of 2 runs"),
        "{said}"
    );
    let stored = objects(&workshop.read("docs/figures/results/cycle.jsonl"));
    assert_eq!(stored[0]["command"], "relayrig study cycle --parts 7");
    assert!(stored[0]["seconds"].as_f64() > Some(0.0) && stored[0]["cores"].as_u64() > Some(0));
    let document = workshop.read("docs/figures.md");
    assert!(
        document.contains("| parts an hour | ")
            && document.contains("Not run: `relayrig study gauge`")
    );
    assert!(workshop.read("docs/pictures/cycle.svg").contains("<svg"));

    workshop.write(
        "docs/figures/plan.toml",
        &SMALL.replace("--parts 7", "--parts 8"),
    );
    workshop.run("study figures --render").with_status(1);
    assert!(
        !workshop.read("docs/figures.md").contains("parts an hour"),
        "a result of another command"
    );
}

#[test]
fn a_failed_run_is_named_and_leaves_no_result() {
    let plan = SMALL.replace("--parts 7", "--recipe none-such");
    let workshop = planned("figures-failed", &plan);
    let said = workshop.run("study figures --only cycle").with_status(2);
    assert!(
        said.stderr.contains("cycle: ") && said.stderr.contains("exit status"),
        "{said}"
    );
    assert!(!workshop.has("docs/figures/results/cycle.jsonl"));
    let said = workshop.run("study figures --only cycles").with_status(2);
    assert!(
        said.stderr.contains("--only cycles: expected cycle, gauge"),
        "{said}"
    );
}
