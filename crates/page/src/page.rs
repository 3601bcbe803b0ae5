//! Serves the page: the answer to `GET /` holds everything that the operator's page needs; the script of any other page
//! follows when a browser first opens that page. Nothing comes from another host.
//!
//! The program makes and compresses each answer once, from the files in `page/` and the catalogue of texts. The content
//! security policy lets a browser run only the inline script, which the browser checks by a hash, and the scripts that
//! this rig sends.

mod compressed;
mod kinds;
mod page_scripts;

use super::answers::{As, Html, Script};
use super::asked::{Asked, members};
use super::error::ApiError;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY};
use axum::response::IntoResponse;
use compressed::CompressedBody;
use data_encoding::BASE64;
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::sync::LazyLock;
use utoipa::IntoParams;
use utoipa::openapi::schema::Type;
use utoipa::openapi::{Object, ObjectBuilder};

const FRAME: &str = include_str!("page/page.html");
const LOOK: &str = concat!(
    include_str!("page/look.css"),
    include_str!("page/pages.css"),
    include_str!("page/narrow.css")
);
/// Scripts of the answer to `GET /`, in order: shared functions, the operator's page, the start.
const SCRIPT: &str = concat!(
    include_str!("page/script/shared.js"),
    include_str!("page/script/texts.js"),
    include_str!("page/script/pages.js"),
    include_str!("page/script/link.js"),
    include_str!("page/script/orders.js"),
    include_str!("page/script/login.js"),
    include_str!("page/script/drawn.js"),
    include_str!("page/script/mimic.js"),
    include_str!("page/script/operator.js"),
    include_str!("page/script/rack.js"),
    include_str!("page/script/alarm_bar.js"),
    include_str!("page/script/prompt.js"),
    include_str!("page/script/activity.js"),
    include_str!("page/script/parts.js"),
    include_str!("page/script/frame.js"),
    include_str!("page/script/start.js"),
);

/// The page of many rigs, and its scripts in order.
const FLEET_FRAME: &str = include_str!("page/fleet.html");
const FLEET_SCRIPT: &str = concat!(
    include_str!("page/script/shared.js"),
    include_str!("page/script/texts.js"),
    include_str!("page/script/pages.js"),
    include_str!("page/script/drawn.js"),
    include_str!("page/script/parts.js"),
    include_str!("page/script/frame.js"),
    include_str!("page/script/fleet.js"),
    include_str!("page/script/fleet_start.js"),
);
/// Scripts that the page of many rigs fetches later.
const FLEET_PAGES: [&str; 2] = ["history", "quality"];
/// Family of the texts of the page of many rigs.
const FLEET_WORDS: &str = "rigs";

static PAGE: LazyLock<CompressedBody> = LazyLock::new(|| {
    let of_rig = |family: &str| !family.starts_with(FLEET_WORDS);
    whole(
        FRAME,
        SCRIPT,
        &kinds::words(of_rig),
        &page_scripts::json(|_| true),
    )
});
static POLICY: LazyLock<String> = LazyLock::new(|| policy(SCRIPT));
static FLEET_PAGE: LazyLock<CompressedBody> = LazyLock::new(|| {
    let scripts = page_scripts::json(|name| FLEET_PAGES.contains(&name));
    whole(FLEET_FRAME, FLEET_SCRIPT, &kinds::words(|_| true), &scripts)
});
static FLEET_POLICY: LazyLock<String> = LazyLock::new(|| policy(FLEET_SCRIPT));

/// Returns the answer made of `frame` with style, texts and scripts filled in.
fn whole(frame: &str, script: &str, words: &str, scripts: &str) -> CompressedBody {
    let page = frame
        .replace("/*look*/", LOOK)
        .replace("/*words*/", words)
        .replace("/*kinds*/", &kinds::json())
        .replace("/*scripts*/", scripts)
        .replace("/*script*/", script);
    CompressedBody::new("text/html; charset=utf-8", page)
}

/// Returns the content security policy of a page with this script.
fn policy(script: &str) -> String {
    let hash = |text: &str| BASE64.encode(&Sha256::digest(text));
    let (look, script) = (hash(LOOK), hash(script));
    format!(
        "default-src 'none'; style-src 'sha256-{look}'; script-src 'self' 'sha256-{script}'; connect-src 'self'; \
         img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

/// Members of `GET /`; only the script of the page reads them.
#[derive(Debug, Deserialize, IntoParams)]
#[expect(dead_code, reason = "the script of the page reads them")]
pub(super) struct PageOptions {
    /// Language, `zh` or `en`.
    #[param(example = "en")]
    lang: Option<String>,
    /// `light` or `dark`.
    #[param(example = "dark")]
    theme: Option<String>,
}

members!(PageOptions);

/// Member of the path of a script.
#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct ScriptName {
    /// Name with a hash of the script.
    #[param(schema_with = script_names)]
    file: String,
}

fn script_names() -> Object {
    let names = page_scripts::SCRIPTS.keys();
    let names = names.map(|it| it.trim_start_matches("/page/"));
    ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some(names))
        .description(Some("Name with a hash of the script."))
        .build()
}

/// `GET /`.
pub(super) async fn page(
    Asked(_options): Asked<PageOptions>,
    headers: HeaderMap,
) -> As<Html, impl IntoResponse> {
    let policy = [(CONTENT_SECURITY_POLICY, POLICY.as_str())];
    As::new((policy, PAGE.answer(&headers)))
}

/// `GET /` of the page of many rigs.
pub(super) async fn fleet_page(
    Asked(_options): Asked<PageOptions>,
    headers: HeaderMap,
) -> As<Html, impl IntoResponse> {
    let policy = [(CONTENT_SECURITY_POLICY, FLEET_POLICY.as_str())];
    As::new((policy, FLEET_PAGE.answer(&headers)))
}

/// `GET /page/{file}`: fails when no script has this name and hash.
pub(super) async fn script(
    Path(ScriptName { file }): Path<ScriptName>,
    headers: HeaderMap,
) -> Result<As<Script, impl IntoResponse>, ApiError> {
    let path = format!("/page/{file}");
    let script = page_scripts::SCRIPTS.get(&path);
    let script = script.ok_or(ApiError::NoSuchRoute { path })?;
    let kept = [(CACHE_CONTROL, "public, max-age=31536000, immutable")];
    Ok(As::new((kept, script.answer(&headers))))
}

#[cfg(test)]
mod tests;
