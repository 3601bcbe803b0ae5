//! A constant answer, ready to send plain and compressed.

use axum::body::Bytes;
use axum::http::HeaderMap;
use axum::http::header::{ACCEPT_ENCODING, CONTENT_ENCODING, CONTENT_TYPE, VARY};
use axum::response::{IntoResponse, Response};
use flate2::{Compression, write::GzEncoder};
use std::io::Write;

/// One body, plain and compressed.
#[derive(Debug)]
pub(super) struct CompressedBody {
    media_type: &'static str,
    pub plain: Bytes,
    /// Empty when the body could not be compressed; the answer is then always plain.
    pub gzip: Bytes,
}

impl CompressedBody {
    pub fn new(media_type: &'static str, plain: String) -> Self {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        let gzip = encoder
            .write_all(plain.as_bytes())
            .and_then(|()| encoder.finish());
        Self {
            media_type,
            plain: plain.into(),
            gzip: gzip.unwrap_or_default().into(),
        }
    }

    /// Returns the body, compressed for a client whose request `headers` accept gzip.
    pub fn answer(&self, headers: &HeaderMap) -> Response {
        let fixed = [(CONTENT_TYPE, self.media_type), (VARY, "accept-encoding")];
        match accepts_gzip(headers) && !self.gzip.is_empty() {
            true => (fixed, [(CONTENT_ENCODING, "gzip")], self.gzip.clone()).into_response(),
            false => (fixed, self.plain.clone()).into_response(),
        }
    }
}

/// Returns true when the client names gzip with a weight above zero (RFC 9110, clause 12.5.3).
fn accepts_gzip(headers: &HeaderMap) -> bool {
    let accepted = headers.get_all(ACCEPT_ENCODING).iter();
    let mut codings = accepted
        .filter_map(|it| it.to_str().ok())
        .flat_map(|it| it.split(','));
    codings.any(|coding| {
        let (name, weight) = coding.split_once(';').unwrap_or((coding, "q=1"));
        let weight = weight.trim().trim_start_matches("q=").parse::<f64>();
        name.trim().eq_ignore_ascii_case("gzip") && weight.is_ok_and(|it| it > 0.0)
    })
}
