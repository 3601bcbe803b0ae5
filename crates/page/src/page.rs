//! The page: one answer that holds everything, so that it shows even when nothing else is reachable.
//!
//! Texts, looks and scripts are put together once from the files in `page/`, words from the catalogue. The policy sent along lets
//! the browser run just that script, by its hash, and talk to this rig only.

mod kinds;
mod policy;

use axum::http::header::{CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::IntoResponse;
use std::sync::LazyLock;

const FRAME: &str = include_str!("page/page.html");
const PAGES: &str = concat!(
    include_str!("page/pages/alarms.html"),
    include_str!("page/pages/calibration.html"),
    include_str!("page/pages/history.html"),
    include_str!("page/pages/lots.html"),
    include_str!("page/pages/quality.html"),
    include_str!("page/pages/recipes.html"),
    include_str!("page/pages/rejudge.html"),
    include_str!("page/pages/service.html"),
);
const LOOK: &str = concat!(
    include_str!("page/look.css"),
    include_str!("page/pages.css")
);
/// One script in the order of use: what is shared, a file per page, and the start of everything.
const SCRIPT: &str = concat!(
    include_str!("page/script/shared.js"),
    include_str!("page/script/said.js"),
    include_str!("page/script/link.js"),
    include_str!("page/script/orders.js"),
    include_str!("page/script/people.js"),
    include_str!("page/script/mimic.js"),
    include_str!("page/script/operator.js"),
    include_str!("page/script/alarms.js"),
    include_str!("page/script/history.js"),
    include_str!("page/script/lots.js"),
    include_str!("page/script/calibration.js"),
    include_str!("page/script/quality.js"),
    include_str!("page/script/cycles.js"),
    include_str!("page/script/recipe_sheet.js"),
    include_str!("page/script/recipes.js"),
    include_str!("page/script/rejudge.js"),
    include_str!("page/script/service.js"),
    include_str!("page/script/trace.js"),
    include_str!("page/script/start.js"),
);

static WORDS: LazyLock<String> = LazyLock::new(kinds::words);
static PAGE: LazyLock<String> = LazyLock::new(|| {
    FRAME
        .replace("<!--pages-->", PAGES)
        .replace("/*look*/", LOOK)
        .replace("/*words*/", &WORDS)
        .replace("/*kinds*/", &kinds::json())
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
