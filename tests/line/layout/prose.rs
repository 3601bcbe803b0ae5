//! Words that documents, comments and texts do without.

use super::documents::documents;
use super::tree::{Source, assert_none, files, has_word, rust_files};

/// Phrases that hide who acts, or how much.
const UNWANTED: [&str; 4] = ["so many", "whoever", "is told", "are told"];

/// This file, which names the phrases.
const OWN: &str = "tests/line/layout/prose.rs";

fn sources() -> Vec<Source> {
    let mut all = rust_files(&["src", "crates", "sim", "tests", "benches"]);
    all.extend(files(&["locale"]));
    all.extend(documents());
    all.retain(|source| source.path != OWN);
    all
}

/// Returns the unwanted phrases of a text with their lines; a phrase may go on after the end of a line.
fn found(text: &str) -> Vec<(usize, &'static str)> {
    let plain = |line: &str| line.trim_start_matches([' ', '/', '!', '#']).to_lowercase();
    let lines: Vec<String> = text.lines().map(plain).collect();
    let next = lines.iter().skip(1).map(|line| line.split(' ').next());
    let ends = next.chain([None]).map(Option::unwrap_or_default);
    let joined = lines
        .iter()
        .zip(ends)
        .map(|(line, end)| format!("{line} {end}"));
    let each = joined.enumerate().flat_map(|(index, line)| {
        let phrases = UNWANTED.into_iter().filter(move |it| has_word(&line, it));
        phrases.map(move |phrase| (index + 1, phrase))
    });
    each.collect()
}

#[test]
fn no_sentence_has_an_unwanted_phrase() {
    let mut broken = Vec::new();
    for source in sources() {
        let all = found(&source.text).into_iter();
        broken.extend(all.map(|(line, phrase)| format!("{}:{line}: {phrase}", source.path)));
    }
    assert_none(&broken);
}

#[test]
fn a_phrase_is_found_across_the_end_of_a_line() {
    // Both phrases are wrong on purpose; a line end divides the second one. The last line has neither.
    let text = "/// Waits so many\n/// seconds; the line is\n/// told.\nlet toldies = 1;";
    assert_eq!(found(text), [(1, "so many"), (2, "is told")]);
}
