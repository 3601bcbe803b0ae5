//! Language of a printed page: the language that the request asks for.

use super::api::Input;
use axum::extract::FromRequestParts;
use axum::http::header::ACCEPT_LANGUAGE;
use axum::http::request::Parts;
use history::report::Lang;
use std::convert::Infallible;

/// Language that the header `Accept-Language` prefers; English without this header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Preferred(Lang);

impl Preferred {
    /// Returns the language that the query string names, or the preferred one.
    pub fn unless(self, asked: Option<Lang>) -> Lang {
        asked.unwrap_or(self.0)
    }

    /// Returns the first language of the list with the greatest weight (`q`, 1 when absent); ignores all languages but
    /// English and Chinese.
    fn of(header: &str) -> Self {
        let mut best = (Lang::En, 0.0);
        for entry in header.split(',') {
            let mut fields = entry.split(';').map(str::trim);
            let tag = fields.next().unwrap_or_default();
            let weight = fields.find_map(|it| it.strip_prefix("q="));
            let weight: f64 = weight
                .map_or(Some(1.0), |it| it.parse().ok())
                .unwrap_or(0.0);
            let mut known = Lang::ALL.into_iter();
            let known = known.find(|it| primary(tag).eq_ignore_ascii_case(primary(it.tag())));
            if let Some(lang) = known.filter(|_| weight > best.1) {
                best = (lang, weight);
            }
        }
        Self(best.0)
    }
}

/// Returns the language of a tag such as `zh-CN`, without region and script.
fn primary(tag: &str) -> &str {
    tag.split('-').next().unwrap_or_default()
}

impl<S: Sync> FromRequestParts<S> for Preferred {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Infallible> {
        let header = parts.headers.get(ACCEPT_LANGUAGE);
        let header = header.and_then(|it| it.to_str().ok());
        Ok(Self::of(header.unwrap_or_default()))
    }
}

impl Input for Preferred {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_weight_decides_and_english_is_usual() {
        for (header, lang) in [
            ("", Lang::En),
            ("*", Lang::En),
            ("de-DE,de;q=0.9", Lang::En),
            ("zh-CN,zh;q=0.9,en;q=0.8", Lang::Zh),
            ("en-GB, zh;q=0.9", Lang::En),
            ("de, en;q=0.4, ZH-Hans;q=0.7", Lang::Zh),
            ("zh;q=0", Lang::En),
            ("zh;q=x", Lang::En),
        ] {
            assert_eq!(Preferred::of(header).0, lang, "{header}");
        }
    }
}
