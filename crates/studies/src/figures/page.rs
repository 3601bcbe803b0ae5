//! The document as Markdown: first the missed bars, then the runs without a result, then the figures of every run.

use super::number;
use super::plan::{Machine, Plan, Run};
use super::plot;
use super::result::{Head, Row, RunResult};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Number of cores that other programs may keep busy on a quiet machine.
const QUIET: f64 = 0.2;

/// Results by the name of their run.
pub type Results = BTreeMap<String, RunResult>;

/// Returns the document.
pub fn document(plan: &Plan, results: &Results) -> String {
    let mut text = format!("# Figures\n\n{}\n\n", plan.about.trim());
    let _ = writeln!(text, "{}\n", summary(plan, results));
    missed(&mut text, plan, results);
    not_run(&mut text, plan, results);
    for section in &plan.sections {
        let _ = writeln!(text, "## {}\n\n{}\n", section.title, section.about.trim());
        for run in &section.runs {
            one(&mut text, run, results.get(&run.name));
        }
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// Returns the pictures that the document draws from figures: name and content of each file.
pub fn pictures(plan: &Plan, results: &Results) -> Vec<(String, String)> {
    let drawn = |run: &Run| -> Vec<(String, String)> {
        let rows = results.get(&run.name).map_or(&[][..], |it| &it.rows);
        let each = run.pictures.iter().filter_map(|picture| {
            let svg = plot::svg(picture.plot.as_ref()?, &picture.about, rows)?;
            Some((picture.file.clone(), svg))
        });
        each.collect()
    };
    plan.runs().flat_map(drawn).collect()
}

/// Returns every figure that misses its bar, each after its run.
pub fn missed_rows<'a>(plan: &'a Plan, results: &'a Results) -> Vec<(&'a Run, &'a Row)> {
    let of = |run: &'a Run| {
        let rows = results.get(&run.name).map_or(&[][..], |it| &it.rows);
        rows.iter()
            .filter(|row| row.is_missed())
            .map(move |row| (run, row))
    };
    plan.runs().flat_map(of).collect()
}

/// Returns the Markdown anchor of a heading.
pub fn anchor(title: &str) -> String {
    let kept = title
        .chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    let linked = kept.map(|c| if c == ' ' { '-' } else { c });
    linked.collect::<String>().to_lowercase()
}

fn summary(plan: &Plan, results: &Results) -> String {
    let runs = plan.runs().count();
    let rows = plan
        .runs()
        .filter_map(|run| results.get(&run.name))
        .flat_map(|it| &it.rows);
    let bars = rows.filter(|row| row.bar.is_some()).count();
    let missed = missed_rows(plan, results).len();
    format!(
        "{} of {runs} runs have a result; their figures miss {missed} of {bars} bars.",
        results.len()
    )
}

fn missed(text: &mut String, plan: &Plan, results: &Results) {
    let rows = missed_rows(plan, results);
    if rows.is_empty() {
        return;
    }
    text.push_str("## Missed bars\n\n| figure | value | bar | run |\n|---|---|---|---|\n");
    for (run, row) in rows {
        let bar = row.bar.map(number::bar).unwrap_or_default();
        let _ = writeln!(
            text,
            "| {} | {} | {bar} | {} |",
            name(row),
            value(row),
            linked(run)
        );
    }
    text.push('\n');
}

fn not_run(text: &mut String, plan: &Plan, results: &Results) {
    let runs: Vec<&Run> = plan
        .runs()
        .filter(|run| !results.contains_key(&run.name))
        .collect();
    if runs.is_empty() {
        return;
    }
    text.push_str("## Not run\n\n| run | machine | command |\n|---|---|---|\n");
    for run in runs {
        let _ = writeln!(
            text,
            "| {} | {} | `{}` |",
            linked(run),
            machine(run.machine),
            run.command
        );
    }
    text.push('\n');
}

fn one(text: &mut String, run: &Run, result: Option<&RunResult>) {
    let _ = writeln!(text, "### {}\n", run.title);
    if !run.about.is_empty() {
        let _ = writeln!(text, "{}\n", run.about.trim());
    }
    match result {
        Some(result) => {
            let _ = writeln!(text, "{}\n", circumstances(run, &result.head));
            tables(text, run, &result.rows);
            for picture in &run.pictures {
                let about = &picture.about;
                let _ = writeln!(text, "{about}:\n\n![{about}](pictures/{})\n", picture.file);
            }
        }
        None => {
            let _ = writeln!(text, "Not run: `{}`\n", run.command);
        }
    }
    if !run.larger.is_empty() {
        text.push_str("Larger runs, by hand:\n\n");
        for larger in &run.larger {
            let _ = writeln!(text, "- `{}`: {}", larger.command, larger.about.trim());
        }
        text.push('\n');
    }
}

/// Returns command, machine, date and commit of a result in one line.
fn circumstances(run: &Run, head: &Head) -> String {
    let commit = head
        .commit
        .as_deref()
        .map_or("no commit".to_owned(), |it| format!("commit `{it}`"));
    let changed = if head.is_changed { " with changes" } else { "" };
    let busy = match (run.machine, head.busy_cores) {
        (Machine::Quiet, Some(busy)) if busy > QUIET => {
            format!(
                ", **shared**: other programs kept {} cores busy",
                number::value(busy, None)
            )
        }
        (Machine::Quiet | Machine::Any, _) => String::new(),
    };
    format!(
        "`{}` ({} machine), {}, {commit}{changed}, {}, {} cores{busy}, {} s",
        head.command,
        machine(run.machine),
        head.date,
        head.cpu,
        head.cores,
        number::value(head.seconds.max(1.0).round(), None),
    )
}

/// Writes the figures that the run shows; neighbours with the same columns share a table.
fn tables(text: &mut String, run: &Run, rows: &[Row]) {
    let is_shown = |row: &&Row| {
        run.shows.is_empty()
            || run
                .shows
                .iter()
                .any(|start| row.figure.starts_with(start.as_str()))
    };
    let shown: Vec<&Row> = rows.iter().filter(is_shown).collect();
    for group in shown.chunk_by(|a, b| a.columns.keys().eq(b.columns.keys())) {
        table(text, group);
        text.push('\n');
    }
}

fn table(text: &mut String, rows: &[&Row]) {
    let has_bar = rows.iter().any(|row| row.bar.is_some());
    let keys: Vec<&String> = rows
        .first()
        .map_or(Vec::new(), |row| row.columns.keys().collect());
    let mut header = vec!["figure".to_owned(), "value".to_owned()];
    header.extend(has_bar.then(|| "bar".to_owned()));
    header.push("n".to_owned());
    header.extend(keys.iter().map(|key| key.replace('_', " ")));
    let _ = writeln!(
        text,
        "| {} |\n|{}",
        header.join(" | "),
        "---|".repeat(header.len())
    );
    for row in rows {
        let mut cells = vec![name(row), value(row)];
        cells.extend(has_bar.then(|| bar(row)));
        cells.push(number::count(row.n));
        let further = row.columns.values();
        cells.extend(further.map(|it| it.map_or("-".to_owned(), |it| number::value(it, None))));
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
}

fn name(row: &Row) -> String {
    row.figure.trim().replace('|', "/")
}

fn value(row: &Row) -> String {
    let known = |it| format!("{} {}", number::value(it, row.bar), row.unit);
    let text = row.value.map_or("none".to_owned(), known);
    text.trim_end().to_owned()
}

fn bar(row: &Row) -> String {
    let bar = row.bar.map(number::bar).unwrap_or_default();
    match row.is_missed() {
        true => format!("{bar}, **missed**"),
        false => bar,
    }
}

fn linked(run: &Run) -> String {
    format!("[{}](#{})", run.title, anchor(&run.title))
}

fn machine(machine: Machine) -> &'static str {
    match machine {
        Machine::Any => "any",
        Machine::Quiet => "quiet",
    }
}
