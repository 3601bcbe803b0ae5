//! Tests of the answers of the page as text: complete, small, and with every text that they use.

#![allow(clippy::unwrap_used)]

mod contrast;

use super::*;
use machine::dut::Characteristic;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

type Table = BTreeMap<String, BTreeMap<String, String>>;

fn table() -> Table {
    serde_json::from_str(&kinds::words(|_| true)).unwrap()
}

fn first() -> &'static str {
    std::str::from_utf8(&PAGE.plain).unwrap()
}

/// Markup of the answer to `GET /` and of the pages fetched later.
static MARKUP: LazyLock<String> = LazyLock::new(|| {
    let pages = page_scripts::SOURCES.iter().map(|[_, markup, _]| *markup);
    [FRAME, FLEET_FRAME].into_iter().chain(pages).collect()
});
/// Code of the answer to `GET /` and of the pages fetched later.
static CODE: LazyLock<String> = LazyLock::new(|| {
    let pages = page_scripts::SOURCES.iter().map(|[_, _, code]| *code);
    [SCRIPT, FLEET_SCRIPT].into_iter().chain(pages).collect()
});

/// Returns the code of a page with this script and of the pages that it fetches later.
fn code(script: &'static str, fetches: impl Fn(&str) -> bool) -> String {
    let fetched = page_scripts::SOURCES.iter().filter(|it| fetches(it[0]));
    std::iter::once(script)
        .chain(fetched.map(|it| it[2]))
        .collect()
}

/// Returns the texts between `before` and the next `"`.
fn quoted(text: &str, before: &str) -> BTreeSet<String> {
    let pieces = text.split(before).skip(1);
    pieces
        .map(|it| it.split('"').next().unwrap().to_owned())
        .collect()
}

#[test]
fn every_quantity_reaches_the_page_by_its_kind() {
    let kinds: Value = serde_json::from_str(&kinds::json()).unwrap();
    assert!(first().contains(&kinds::json()));
    let keys: Vec<&str> = kinds["characteristics"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["key"].as_str().unwrap())
        .collect();
    assert!(Characteristic::all().map(|it| it.key()).eq(keys));
    for text in [CODE.as_str(), &kinds::words(|_| true)] {
        assert!(!Characteristic::all().any(|it| text.contains(it.key())));
    }
}

#[test]
fn every_used_text_is_in_the_catalogue() {
    let table = table();
    let mut used = BTreeSet::new();
    for (text, before) in [
        (&*MARKUP, "data-word=\""),
        (&MARKUP, "data-label=\""),
        (&CODE, "word(\""),
        (&CODE, "word(missing ? \""),
        (&CODE, "word(needed ? \""),
    ] {
        used.extend(quoted(text, before));
    }
    // An id that ends in a hyphen is the start of a family; a code of the rig completes it.
    let (families, words): (Vec<_>, Vec<_>) = used.iter().partition(|it| it.ends_with('-'));
    for word in words {
        assert!(table.contains_key(word), "{word}");
    }
    for family in families {
        assert!(
            table.keys().any(|it| it.starts_with(family.as_str())),
            "{family}"
        );
    }
}

#[test]
fn every_text_of_the_pages_is_used() {
    let families = [
        "line",
        "link",
        "module",
        "order",
        "state",
        "stage",
        "verdict",
        "bin",
        "login",
        "actuator",
        "motion",
        "mode",
        "signal",
        "alarms",
        "q",
        "r",
        "field",
        "choice",
        "lots",
        "lot_state",
        "counter",
        "role",
        "factor",
        "failure",
        "body",
        "people",
        "rack_phase",
        "rack_socket",
        "tooling",
        "tooling_end",
        "tooling_kind",
        "tooling_side",
        "rigs",
        "rigs_remedy",
        "curve",
        "mark",
    ];
    for key in table().keys() {
        let family = key.split('-').next().unwrap();
        let used = [&MARKUP, &CODE]
            .iter()
            .any(|it| it.contains(&format!("\"{key}\"")));
        assert!(
            used || (key.contains('-') && families.contains(&family)),
            "{key}"
        );
    }
}

#[test]
fn every_listed_verdict_motion_and_mode_has_a_name() {
    let table = table();
    let list = |name: &str| {
        let text = CODE.split(&format!("const {name} = [")).nth(1).unwrap();
        let text = text.split(']').next().unwrap();
        text.split('"')
            .skip(1)
            .step_by(2)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    for (name, family, count) in [
        ("VERDICTS", "verdict", 3),
        ("JOGS", "motion", 15),
        ("MODES", "mode", 3),
    ] {
        let names = list(name);
        assert_eq!(names.len(), count);
        assert!(
            names
                .iter()
                .all(|it| table.contains_key(&format!("{family}-{it}"))),
            "{name}"
        );
    }
}

#[test]
fn every_bin_of_a_kind_has_a_name() {
    let (table, kinds) = (table(), kinds::json());
    let kinds: serde_json::Value = serde_json::from_str(&kinds).unwrap();
    let bins = kinds["bins"].as_array().unwrap();
    for (bin, place) in [("pass", 0), ("retest", bins.len() - 1)] {
        assert_eq!(bins[place], bin);
    }
    for bin in bins {
        let id = format!("bin-{}", bin.as_str().unwrap());
        assert!(table.contains_key(&id), "{id}");
    }
}

#[test]
fn every_recipe_key_and_choice_has_a_text() {
    let table = table();
    let recipe = config::revision(&config::Folder::built_in(), "jzc-22f-012", None).unwrap();
    for field in serde_json::to_value(recipe).unwrap()["fields"]
        .as_array()
        .unwrap()
    {
        let path = field["path"].as_str().unwrap();
        let mut parts = path.split('.');
        let named = parts.any(|it| Characteristic::from_key(it).is_some());
        assert!(
            named || table.contains_key(&format!("field-{}", path.replace('.', "-"))),
            "{path}"
        );
        for word in field["words"].as_array().into_iter().flatten() {
            let name = format!("choice-{}", word.as_str().unwrap());
            assert!(table.contains_key(&name), "{name}");
        }
    }
}

#[test]
fn every_body_of_the_scene_has_a_text() {
    let table = table();
    let scene = std::fs::read_to_string("../../config/scene.toml").unwrap();
    let scene: toml::Table = scene.parse().unwrap();
    let bodies = scene["elements"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["id"].as_str().unwrap());
    let parts = [
        "part_feed",
        "part_pocket",
        "part_pusher",
        "part_nest",
        "part_gripper",
    ];
    for body in bodies.chain(parts) {
        assert!(table.contains_key(&format!("body-{body}")), "{body}");
    }
}

/// A script fetched later shares the names of the answer to `GET /`: a second definition would silently hide the first.
#[test]
fn every_top_level_name_of_the_scripts_is_unique() {
    let of_rig = unique_names(&code(SCRIPT, |_| true));
    let of_fleet = unique_names(&code(FLEET_SCRIPT, |it| FLEET_PAGES.contains(&it)));
    assert!(of_rig > 100 && of_fleet > 50, "{of_rig} {of_fleet}");
}

/// Counts the names that code defines; asserts that it defines none twice.
fn unique_names(code: &str) -> usize {
    let mut seen = BTreeSet::new();
    for line in code.lines() {
        let words = line.strip_prefix("async ").unwrap_or(line);
        let Some(("function" | "const" | "let", rest)) = words.split_once(' ') else {
            continue;
        };
        let end = rest
            .find(|it: char| !it.is_alphanumeric() && it != '_')
            .unwrap_or(rest.len());
        assert!(seen.insert(&rest[..end]), "{line}");
    }
    seen.len()
}

#[test]
fn scripts_leave_punctuation_to_the_language() {
    for mark in ["+ \": \"", "+ \"; \""] {
        assert!(!CODE.contains(mark), "{mark}");
    }
}

/// Largest answer to `GET /` when compressed, bytes.
const FIRST_BYTES: usize = 60_000;

#[test]
fn first_answer_is_small_and_names_no_other_host() {
    assert!(PAGE.gzip.len() < FIRST_BYTES, "{}", PAGE.gzip.len());
    assert!(PAGE.gzip.len() > 10_000 && PAGE.plain.len() < 150_000);
    for mark in [
        "/*look*/",
        "/*words*/",
        "/*kinds*/",
        "/*scripts*/",
        "/*script*/",
    ] {
        assert_eq!(FRAME.matches(mark).count(), 1);
        assert!(!first().contains(mark));
    }
    let scripts = page_scripts::SCRIPTS.values().map(|it| &it.plain[..]);
    for text in scripts.chain([first().as_bytes()]) {
        let text = std::str::from_utf8(text).unwrap();
        for foreign in ["http://", "https://", "//cdn", "@import", "src=", "url("] {
            assert!(!text.contains(foreign), "{foreign}");
        }
    }
}

fn scripts_of(has: impl Fn(&str) -> bool) -> BTreeMap<String, String> {
    serde_json::from_str(&page_scripts::json(has)).unwrap()
}

#[test]
fn each_page_of_the_menu_comes_once() {
    let paths = scripts_of(|_| true);
    for (frame, paths) in [
        (FRAME, paths.clone()),
        (FLEET_FRAME, scripts_of(|it| FLEET_PAGES.contains(&it))),
    ] {
        let home = quoted(frame, "<main data-page=\"");
        for page in quoted(frame, "href=\"#") {
            assert!(home.contains(&page) || paths.contains_key(&page), "{page}");
        }
        assert_eq!(frame.matches("data-page=").count(), 2, "home and fetching");
    }
    let later: String = page_scripts::SOURCES.map(|it| it[1]).concat();
    assert_eq!(later.matches("data-page=").count(), paths.len());
    for page in paths.keys() {
        assert!(CODE.contains(&format!("PAGES.{page} = ")), "{page}");
        assert!(!FRAME.contains(&format!("data-page=\"{page}\"")));
    }
    for path in paths.values() {
        assert!(page_scripts::SCRIPTS.contains_key(path), "{path}");
    }
}

#[test]
fn no_inline_text_ends_its_element_early() {
    let (words, kinds) = (kinds::words(|_| true), kinds::json());
    for (text, end) in [
        (LOOK, "</style"),
        (&words, "</script"),
        (&kinds, "</script"),
        (SCRIPT, "</script"),
        (FLEET_SCRIPT, "</script"),
    ] {
        assert!(!text.to_ascii_lowercase().contains(end));
    }
    assert!(first().contains(&format!("<style>{LOOK}</style>")));
    assert!(first().contains(&format!("<script>{SCRIPT}</script>")));
}
