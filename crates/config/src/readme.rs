//! Generates the tables of `config/README.md` from [`keys`](super::keys); a test compares them with the file.

use machine::form::{Form, Key, Points};
use std::fmt::Write;

/// Returns one table row for each key of a file; a table comes before its keys.
pub fn rows(keys: &[Key]) -> String {
    let mut text = "| key | what it may be | read by | meaning |\n|---|---|---|---|\n".to_owned();
    write_rows("", keys, &mut text);
    text
}

fn write_rows(path: &str, keys: &[Key], text: &mut String) {
    for key in keys {
        let own = format!("{path}{}", key.name);
        let left_out = if key.optional { ", or left out" } else { "" };
        // Writing to a string always succeeds.
        let _ = writeln!(
            text,
            "| `{own}` | {}{left_out} | {} | {} |",
            form_text(&key.form),
            key.reader,
            key.meaning
        );
        write_inner(&own, &key.form, text);
    }
}

fn write_inner(path: &str, form: &Form, text: &mut String) {
    match form {
        Form::Table(keys) => write_rows(&format!("{path}."), keys, text),
        Form::Named(inner) => write_inner(&format!("{path}.NAME"), inner, text),
        Form::NamedWith(_, inner) | Form::Each(_, inner) => {
            write_inner(&format!("{path}.NAME"), inner, text)
        }
        Form::Points(points) => write_inner(&format!("{path}.NAME"), points.entry, text),
        Form::List(inner) => write_inner(&format!("{path}[]"), inner, text),
        Form::Text
        | Form::Choice(_)
        | Form::Hex(_)
        | Form::Number(_)
        | Form::Whole { .. }
        | Form::Listed(_)
        | Form::Flag
        | Form::Numbers(..) => {}
    }
}

fn points_in_words(points: &Points) -> String {
    let may = (points.may)();
    let sentence = |is_so: bool, words: String| is_so.then_some(words);
    let words = [
        sentence(
            !points.must.is_empty(),
            format!("a table for each of {}", points.must.join(", ")),
        ),
        sentence(
            !may.is_empty(),
            format!("a table for each that the rig has of {}", may.join(", ")),
        ),
        sentence(points.free, "a table for each beam of a bin".to_owned()),
    ];
    let words: Vec<String> = words.into_iter().flatten().collect();
    words.join("; ")
}

fn form_text(form: &Form) -> String {
    match form {
        Form::Named(_) => "tables with names of your choice".to_owned(),
        Form::NamedWith(names, _) => format!(
            "tables with names of your choice, {} among them",
            names.join(" and ")
        ),
        Form::Each(names, _) => format!("a table for each of {}", names.join(", ")),
        Form::Points(points) => points_in_words(points),
        Form::Text
        | Form::Choice(_)
        | Form::Hex(_)
        | Form::Number(_)
        | Form::Whole { .. }
        | Form::Listed(_)
        | Form::Flag
        | Form::Numbers(..)
        | Form::Table(_)
        | Form::List(_) => form.expected(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::keys;
    use super::*;
    use machine::dut::Kind;

    #[test]
    fn the_readme_holds_every_key_as_it_is_checked() {
        let readme = include_str!("../../../config/README.md");
        let files = [
            ("rig", keys::rig::FILE),
            ("rig with a rack", keys::rig::WITH_RACK),
            ("golden", keys::golden::FILE),
            ("rack", keys::golden::CERTIFICATE),
            ("card", keys::card::FILE),
            ("fleet", keys::fleet::FILE),
            ("lot", keys::lot::FILE),
            ("instrument", keys::instrument::FILE),
        ];
        let recipes = Kind::ALL.map(|kind| (kind.name(), keys::recipe::of(kind)));
        let recipes = recipes.iter().map(|(kind, keys)| (*kind, keys.as_slice()));
        for (file, keys) in files.into_iter().chain(recipes) {
            let rows = rows(keys);
            assert!(
                readme.contains(&rows),
                "config/README.md lacks the table of {file}:\n{rows}"
            );
        }
    }
}
