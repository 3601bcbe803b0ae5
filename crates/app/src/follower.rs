//! A follower of the bus: the live traffic of a running controller, as it tells it itself. The port stays the
//! controller's alone, and nothing goes to a module that would not go otherwise.
//!
//! The page's server keeps the last messages of every line (`/api/trace`). They are fetched again and again; what was not
//! there before is told, lines mixed in the order of time. Where more passed between two looks than the server keeps, the
//! gap is told too. It ends with the controller.

use anyhow::{Context, anyhow, bail};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::time::Duration;
use thiserror::Error;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// Between two looks: a line at 115200 baud makes some 130 messages in this time, and a thousand are kept.
const BETWEEN_LOOKS: Duration = Duration::from_millis(200);
/// Longest wait for an answer of the server.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(10);

/// Where a page is served: host and port of `http://HOST:PORT`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page(String);

/// A text that is no address of a page.
#[derive(Debug, PartialEq, Eq, Error)]
#[error("found \"{0}\", expected http://HOST:PORT")]
pub struct NoPage(String);

/// Reads the address of a page.
///
/// # Errors
/// No `http://HOST:PORT`.
pub fn page(text: &str) -> Result<Page, NoPage> {
    let rest = text.strip_prefix("http://");
    let host = rest.map(|rest| rest.strip_suffix('/').unwrap_or(rest));
    let fits = |host: &&str| {
        let port = host.rsplit_once(':').map(|(_, port)| port.parse::<u16>());
        port.is_some_and(|port| port.is_ok()) && !host.contains(['/', '?', '@', ' ', '\r', '\n'])
    };
    match host.filter(fits) {
        Some(host) => Ok(Page(host.to_owned())),
        None => Err(NoPage(text.to_owned())),
    }
}

/// Of `/api/trace`, a line of the rig.
#[derive(Debug, Clone, Deserialize)]
struct Line {
    line: String,
    entries: Vec<Message>,
}

/// A message as the controller shows it.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct Message {
    /// When it passed, microseconds of rig time.
    pub at_us: u64,
    /// Sent, heard or stray, as one character.
    pub way: String,
    /// The bytes, escaped.
    pub text: String,
    /// What they mean.
    pub meaning: String,
}

/// Something to print.
#[derive(Debug, PartialEq, Eq)]
pub struct News {
    /// When it passed, microseconds of rig time.
    pub at_us: u64,
    /// The line on which it passed.
    pub line: String,
    /// What passed.
    pub what: What,
}

/// What passed on a line.
#[derive(Debug, PartialEq, Eq)]
pub enum What {
    /// More passed between two looks than is kept.
    Gap,
    /// One message.
    Message(Message),
}

/// The newest message handed over, by line.
#[derive(Debug, Default)]
struct Delivered(BTreeMap<String, Message>);

impl Delivered {
    /// Returns the messages that came after those handed over before, oldest first.
    fn news(&mut self, lines: Vec<Line>) -> Vec<News> {
        let mut news = Vec::new();
        for Line { line, entries } in lines {
            let Some(newest) = entries.last().cloned() else {
                continue;
            };
            let told = self.0.insert(line.clone(), newest);
            let known = told
                .as_ref()
                .map(|told| entries.iter().rposition(|it| it == told));
            let of = |at_us, what| News {
                at_us,
                line: line.clone(),
                what,
            };
            if known == Some(None) {
                news.push(of(entries[0].at_us, What::Gap));
            }
            let from = known.flatten().map_or(0, |place| place + 1);
            let fresh = entries.into_iter().skip(from);
            news.extend(fresh.map(|it| of(it.at_us, What::Message(it))));
        }
        news.sort_by_key(|it| it.at_us);
        news
    }
}

/// Hands over what is new until the controller ends.
pub async fn follow(
    page: &Page,
    mut tell: impl FnMut(&News) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut delivered = Delivered::default();
    let mut lines = look(page).await?;
    loop {
        for news in delivered.news(lines) {
            tell(&news)?;
        }
        tokio::time::sleep(BETWEEN_LOOKS).await;
        lines = match look(page).await {
            Ok(lines) => lines,
            Err(end) => {
                tracing::warn!("the controller does not answer any more: {end:#}");
                return Ok(());
            }
        };
    }
}

async fn look(page: &Page) -> anyhow::Result<Vec<Line>> {
    let Page(host) = page;
    let body = tokio::time::timeout(ANSWER_TIMEOUT, get(host, "/api/trace?last=1000"));
    let body = body
        .await
        .map_err(|_| anyhow!("no answer within {} s", ANSWER_TIMEOUT.as_secs()))
        .and_then(|body| body)
        .with_context(|| format!("--from http://{host}"))?;
    serde_json::from_slice(&body)
        .with_context(|| format!("--from http://{host}: expected the traffic of a relayrig"))
}

/// Body of a plain GET.
async fn get(host: &str, path: &str) -> anyhow::Result<Vec<u8>> {
    let mut stream = TcpStream::connect(host).await?;
    let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).await?;
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).await?;
    let end = answer
        .windows(4)
        .position(|four| four == b"\r\n\r\n")
        .context("the answer is no HTTP")?;
    let body = answer.split_off(end + 4);
    let head = String::from_utf8_lossy(&answer);
    let status = head.split_whitespace().nth(1).unwrap_or_default();
    if status != "200" {
        bail!("{path}: found status {status}, expected 200");
    }
    Ok(body)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn line(name: &str, times: &[u64]) -> Line {
        let message = |at_us: &u64| Message {
            at_us: *at_us,
            way: "<".to_owned(),
            text: ">3E\\r".to_owned(),
            meaning: "accepted".to_owned(),
        };
        Line {
            line: name.to_owned(),
            entries: times.iter().map(message).collect(),
        }
    }

    fn seen(news: &[News]) -> Vec<(u64, &str, bool)> {
        let seen = |it: &'_ News| matches!(it.what, What::Message(_));
        news.iter()
            .map(|it| (it.at_us, it.line.as_str(), seen(it)))
            .collect()
    }

    #[test]
    fn what_was_seen_comes_once_and_in_order_of_time() {
        let mut delivered = Delivered::default();
        let news = delivered.news(vec![line("motion", &[1, 4]), line("measure", &[2])]);
        let expected = [
            (1, "motion", true),
            (2, "measure", true),
            (4, "motion", true),
        ];
        assert_eq!(seen(&news), expected);
        let news = delivered.news(vec![line("motion", &[1, 4]), line("measure", &[2, 5])]);
        assert_eq!(seen(&news), [(5, "measure", true)]);
    }

    #[test]
    fn where_more_passed_than_is_kept_there_is_a_gap() {
        let mut delivered = Delivered::default();
        delivered.news(vec![line("motion", &[1, 4])]);
        let news = delivered.news(vec![line("motion", &[7, 9])]);
        let expected = [
            (7, "motion", false),
            (7, "motion", true),
            (9, "motion", true),
        ];
        assert_eq!(seen(&news), expected);
        assert!(delivered.news(vec![line("motion", &[7, 9])]).is_empty());
    }

    #[test]
    fn a_page_is_named_by_host_and_port() {
        let host = |text: &str| page(text).map(|Page(host)| host);
        assert_eq!(host("http://127.0.0.1:8080/").unwrap(), "127.0.0.1:8080");
        assert_eq!(host("http://[::1]:80").unwrap(), "[::1]:80");
        for wrong in [
            "127.0.0.1:8080",
            "https://a:1",
            "http://a",
            "http://a:1/api",
        ] {
            assert!(
                host(wrong)
                    .unwrap_err()
                    .to_string()
                    .contains("http://HOST:PORT"),
                "{wrong}"
            );
        }
    }
}
