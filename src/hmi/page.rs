//! The page: one answer that holds everything, so that it shows even when nothing else is reachable.
//!
//! Text, look, words and script are four files that are put together once. The policy sent along lets
//! the browser run just that script, by its hash, and talk to this rig only.

mod policy;

use axum::http::header::{CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::IntoResponse;
use std::sync::LazyLock;

const FRAME: &str = include_str!("page/page.html");
const LOOK: &str = include_str!("page/look.css");
const WORDS: &str = include_str!("page/words.json");
const SCRIPT: &str = include_str!("page/script.js");

static PAGE: LazyLock<String> = LazyLock::new(|| {
    FRAME
        .replace("/*look*/", LOOK)
        .replace("/*words*/", WORDS)
        .replace("/*script*/", SCRIPT)
});
static POLICY: LazyLock<String> = LazyLock::new(|| policy::of(LOOK, SCRIPT));

/// `GET /`.
pub(super) async fn page() -> impl IntoResponse {
    let headers = [
        (CONTENT_TYPE, "text/html; charset=utf-8"),
        (CONTENT_SECURITY_POLICY, POLICY.as_str()),
    ];
    (headers, PAGE.as_str())
}

#[cfg(test)]
mod tests;
