//! Scripts that a browser fetches when it first opens a page; each adds markup and code of one or more pages.

use super::compressed::CompressedBody;
use data_encoding::HEXLOWER;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Name, markup and code of each script.
pub(super) const SOURCES: [[&str; 3]; 11] = {
    macro_rules! source {
        ($name:literal, $($code:literal),+) => {
            [
                $name,
                include_str!(concat!("pages/", $name, ".html")),
                concat!($(include_str!(concat!("script/", $code, ".js"))),+),
            ]
        };
    }
    [
        source!("alarms", "alarms"),
        source!("calibration", "calibration"),
        source!("history", "curves", "history"),
        source!("lots", "lots"),
        source!("people", "people"),
        source!("quality", "quality"),
        source!("recipes", "recipe_sheet", "recipes"),
        source!("rejudge", "rejudge"),
        source!("service", "service"),
        source!("tooling", "tooling"),
        source!("trace", "trace"),
    ]
};

/// Scripts by path; the path holds a hash of the script, so that a browser may cache the script for ever.
pub(super) static SCRIPTS: LazyLock<BTreeMap<String, CompressedBody>> = LazyLock::new(|| {
    let body = |text| CompressedBody::new("text/javascript; charset=utf-8", text);
    let compressed = |(path, text)| (path, body(text));
    SOURCES.map(script).into_iter().map(compressed).collect()
});

/// Returns `{page: path}`, the path of the script of each page, for the scripts that `has` selects by name.
pub(super) fn json(has: impl Fn(&str) -> bool) -> String {
    let sources = SOURCES.iter().filter(|source| has(source[0]));
    let paths = sources.flat_map(|source| {
        let (path, _) = script(*source);
        pages(source[1]).map(move |page| (page.to_owned(), path.clone().into()))
    });
    serde_json::Value::Object(paths.collect()).to_string()
}

/// Returns the names of the pages in `markup`.
fn pages(markup: &str) -> impl Iterator<Item = &str> {
    let pieces = markup.split("data-page=\"").skip(1);
    pieces.filter_map(|it| it.split('"').next())
}

/// Returns the path of a script, and its text as the browser gets it.
fn script([name, markup, code]: [&str; 3]) -> (String, String) {
    let hash = HEXLOWER.encode(&Sha256::digest([markup, code].concat())[..8]);
    let path = format!("/page/{name}-{hash}.js");
    let (quoted_path, markup) = (json!(path), json!(markup));
    let text = format!("addPages({quoted_path}, {markup}, () => {{\n\"use strict\";\n{code}}});\n");
    (path, text)
}
