//! Refuses an order that a page of another site makes a browser send to this rig.
//!
//! A browser sends `Origin` with every POST, and the script of a page cannot forge it. An order passes when
//! - `Sec-Fetch-Site`, if present, is `same-origin` or `none`, and
//! - `Origin`, if present, is `http://` or `https://` and exactly the `Host` of the request, and
//! - with an `Origin` of `http://`, that host is an IP address, a name without a dot, or a name under `.local` or
//!   `.internal`. This defeats DNS rebinding, by which a public name resolves to this rig. Over `https://` the
//!   certificate defeats it: a browser accepts no name that the certificate lacks.
//!
//! A request with neither `Sec-Fetch-Site` nor `Origin` comes from a program that is no browser, and passes.

use super::error::ApiError;
use axum::extract::ConnectInfo;
use axum::extract::rejection::ExtensionRejection;
use axum::http::{HeaderMap, HeaderName, header, uri::Authority};
use std::net::{IpAddr, SocketAddr};

const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Address of the client; an error in tests, which use no socket.
pub(super) type Peer = Result<ConnectInfo<SocketAddr>, ExtensionRejection>;

/// Returns the IP address of the client for the audit; empty when absent.
pub(super) fn address(peer: Peer) -> String {
    peer.map_or_else(
        |_| String::new(),
        |peer| peer.0.ip().to_canonical().to_string(),
    )
}

/// Returns true when a page that came over https sent the request; scripts send no `Origin`.
pub(super) fn is_https(headers: &HeaderMap) -> bool {
    let origin = headers.get(header::ORIGIN);
    origin.is_some_and(|it| it.as_bytes().starts_with(b"https://"))
}

/// Fails when a page of another site sent the request.
pub(super) fn check(headers: &HeaderMap) -> Result<(), ApiError> {
    if let Some(site) = headers.get(SEC_FETCH_SITE)
        && site != "same-origin"
        && site != "none"
    {
        return Err(refusal("Sec-Fetch-Site", site.as_bytes()));
    }
    let mut origins = headers.get_all(header::ORIGIN).iter();
    let Some(origin) = origins.next() else {
        return Ok(());
    };
    let same = origin.to_str().is_ok_and(|it| is_of_host(it, headers));
    if same && origins.next().is_none() {
        return Ok(());
    }
    Err(refusal("Origin", origin.as_bytes()))
}

fn is_of_host(origin: &str, headers: &HeaderMap) -> bool {
    let host = headers.get(header::HOST).and_then(|it| it.to_str().ok());
    let (authority, proven) = match origin.split_once("://") {
        Some(("http", authority)) => (authority, false),
        Some(("https", authority)) => (authority, true),
        Some(_) | None => return false,
    };
    host.is_some_and(|host| authority.eq_ignore_ascii_case(host) && (proven || is_near(host)))
}

fn is_near(host: &str) -> bool {
    let Ok(authority) = host.parse::<Authority>() else {
        return false;
    };
    let name = authority.host().to_ascii_lowercase();
    let bare = name.trim_start_matches('[').trim_end_matches(']');
    bare.parse::<IpAddr>().is_ok()
        || !name.contains('.')
        || name.ends_with(".local")
        || name.ends_with(".internal")
}

fn refusal(header: &str, value: &[u8]) -> ApiError {
    let value: String = String::from_utf8_lossy(value).chars().take(80).collect();
    let found = format!("{header}: {value}");
    ApiError::CrossSite { found }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn judged(pairs: &[(&'static str, &str)]) -> bool {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(*name, value.parse().unwrap());
        }
        check(&headers).is_ok()
    }

    #[test]
    fn orders_of_the_own_page_and_of_scripts_pass() {
        assert!(judged(&[("host", "127.0.0.1:8080")]));
        for host in [
            "127.0.0.1:8080",
            "[::1]:8080",
            "localhost:8080",
            "rig-3",
            "rig.local",
        ] {
            let origin = format!("http://{host}");
            assert!(judged(&[("host", host), ("origin", &origin)]), "{host}");
        }
        assert!(judged(&[
            ("host", "rig"),
            ("sec-fetch-site", "same-origin")
        ]));
    }

    #[test]
    fn orders_of_other_sites_are_refused() {
        let host = ("host", "127.0.0.1:8080");
        for origin in [
            "http://evil.example",
            "http://127.0.0.1:8081",
            "http://127.0.0.1:8080.evil.example",
            "http://evil.example/127.0.0.1:8080",
            "ftp://127.0.0.1:8080",
            "null",
            "",
        ] {
            assert!(!judged(&[host, ("origin", origin)]), "{origin}");
        }
        assert!(!judged(&[host, ("sec-fetch-site", "cross-site")]));
        assert!(!judged(&[host, ("sec-fetch-site", "same-site")]));
        assert!(!judged(&[("origin", "http://127.0.0.1:8080")]));
        let own = ("origin", "http://127.0.0.1:8080");
        assert!(!judged(&[host, own, ("origin", "http://evil.example")]));
    }

    #[test]
    fn a_public_name_takes_a_certificate() {
        let name = "rig.evil.example:8080";
        assert!(!judged(&[
            ("host", name),
            ("origin", "http://rig.evil.example:8080")
        ]));
        let certified = ("origin", "https://rig.plant.example");
        assert!(judged(&[("host", "rig.plant.example"), certified]));
    }
}
