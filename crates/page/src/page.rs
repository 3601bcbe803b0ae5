//! Serves the page: the answer to `GET /` holds everything that the operator's page needs; the script of any other page
//! follows when a browser first opens that page. Nothing comes from another host.
//!
//! The program makes and compresses each answer once, from the files in `page/` and the catalogue of texts. The content
//! security policy lets a browser run the inline script, which it checks by a hash, and the scripts that this rig
//! sends.

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
    include_str!("page/script/mimic.js"),
    include_str!("page/script/operator.js"),
    include_str!("page/script/rack.js"),
    include_str!("page/script/alarm_bar.js"),
    include_str!("page/script/prompt.js"),
    include_str!("page/script/activity.js"),
    include_str!("page/script/parts.js"),
    include_str!("page/script/start.js"),
);

static PAGE: LazyLock<CompressedBody> = LazyLock::new(|| {
    let page = FRAME
        .replace("/*look*/", LOOK)
        .replace("/*words*/", &kinds::words())
        .replace("/*kinds*/", &kinds::json())
        .replace("/*scripts*/", &page_scripts::json())
        .replace("/*script*/", SCRIPT);
    CompressedBody::new("text/html; charset=utf-8", page)
});
static POLICY: LazyLock<String> = LazyLock::new(|| {
    let hash = |text: &str| BASE64.encode(&Sha256::digest(text));
    let (look, script) = (hash(LOOK), hash(SCRIPT));
    format!(
        "default-src 'none'; style-src 'sha256-{look}'; script-src 'self' 'sha256-{script}'; connect-src 'self'; \
         img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
});

/// Members of `GET /`, which the script of the page reads.
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
