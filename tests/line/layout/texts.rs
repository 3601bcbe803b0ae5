//! Texts for people are in the catalogue only.

use super::tree::{Source, assert_none, files, rust_files};
use machine::station::catalogue::AlarmCode;
use std::collections::BTreeSet;
use texts::Lang;

/// Folders whose files use texts.
const USERS: [&str; 3] = ["src", "crates", "config"];

/// Longest coincidence between a text and code, characters.
const CHANCE: usize = 24;

/// Returns the lines of code before the tests, with numbers.
fn code(source: &Source) -> impl Iterator<Item = (usize, &str)> {
    let tests = source.text.find("\n#[cfg(test)]\nmod ");
    let last = source.text[..tests.unwrap_or(source.text.len())]
        .lines()
        .count();
    source.code().take_while(move |(line, _)| *line <= last)
}

fn sources() -> Vec<Source> {
    let mut all = rust_files(&["src", "crates"]);
    all.retain(|source| !source.is_test());
    all
}

#[test]
fn the_code_has_no_chinese() {
    let is_chinese = |c: char| matches!(c, '\u{3000}'..='\u{9fff}' | '\u{ff00}'..='\u{ffef}');
    let mut broken = Vec::new();
    for source in sources() {
        for (line, text) in code(&source).filter(|(_, it)| it.contains(is_chinese)) {
            if !text.trim_start().starts_with("//") {
                broken.push(format!("{}:{line}: {}", source.path, text.trim()));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn the_code_has_no_alarm_or_refusal_text() {
    let ours = |id: &&str| id.starts_with("alarm-") || id.starts_with("refusal-");
    let spoken: BTreeSet<&str> = texts::plain()
        .filter(|it| ours(&it.id))
        .map(|it| it.en)
        .chain(
            texts::ids(Lang::En)
                .filter(|it| it.starts_with("alarm-"))
                .flat_map(|id| ["cause", "action"].map(|it| Lang::En.attribute(id, it))),
        )
        .filter(|it| it.len() > CHANCE)
        .collect();
    let mut broken = Vec::new();
    // The command line speaks English only and has sentences of its own.
    let others = sources()
        .into_iter()
        .filter(|it| it.path != "src/cli/lot.rs");
    for source in others {
        for (line, text) in code(&source) {
            let found = spoken.iter().filter(|it| text.contains(**it));
            broken.extend(found.map(|it| format!("{}:{line}: {it}", source.path)));
        }
    }
    assert_none(&broken);
}

/// Returns the PackML spelling of a state.
fn capital(code: &str) -> String {
    let (first, rest) = code.split_at(1);
    first.to_uppercase() + rest
}

/// A text counts as used when its id or its code appears. The text of an interruption also counts when an alarm has its
/// code.
#[test]
fn no_text_is_left_without_use() {
    let written: String = files(&USERS)
        .into_iter()
        .filter(|it| !it.is_test() && !it.path.ends_with(".ftl"))
        .map(|it| it.text)
        .collect();
    let quoted: BTreeSet<&str> = written.split(['"', '\'', '`']).collect();
    let words: BTreeSet<&str> = written
        .split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .collect();
    let is_used = |id: &str| {
        let code = id.split_once('-').map_or(id, |(_, code)| code);
        let last = code.rsplit('-').next().unwrap_or(code);
        quoted.contains(id)
            || words.contains(code)
            || words.contains(last)
            || id.starts_with("interruption-") && AlarmCode::from_name(code).is_some()
            || id.starts_with("state-") && words.contains(capital(code).as_str())
    };
    let unused: Vec<String> = texts::ids(Lang::En)
        .filter(|id| !is_used(id))
        .map(str::to_owned)
        .collect();
    assert_none(&unused);
}
