//! What the browser may do for the page: its own style and script, connections to this rig, no more.

use data_encoding::BASE64;
use sha2::{Digest, Sha256};

/// Value of `Content-Security-Policy` for a page with one inline style and one inline script.
pub(super) fn of(style: &str, script: &str) -> String {
    let (style, script) = (hash(style), hash(script));
    format!(
        "default-src 'none'; style-src '{style}'; script-src '{script}'; connect-src 'self'; \
         img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

fn hash(text: &str) -> String {
    format!("sha256-{}", BASE64.encode(&Sha256::digest(text.as_bytes())))
}
