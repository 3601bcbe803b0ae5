//! Follows the live traffic of a running controller through its page. The controller keeps the port for itself, and the
//! follower sends nothing to a module.
//!
//! The page's server keeps the last messages of every line (`/api/trace`). The follower polls these messages and
//! reports the new ones, all lines merged in order of time, with a gap where more messages passed between two polls
//! than the server keeps. The follower ends when the controller does.

use anyhow::{Context, anyhow, bail};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::time::Duration;
use thiserror::Error;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// Time between two polls, in which a line at 115200 baud carries some 130 messages; the server keeps a thousand.
const POLL_INTERVAL: Duration = Duration::from_millis(200);
/// Longest wait for an answer of the server.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(10);

/// Host and port of a page, from the address `http://HOST:PORT`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page(String);

/// Error: the text is not the address of a page.
#[derive(Debug, PartialEq, Eq, Error)]
#[error("found \"{0}\", expected http://HOST:PORT")]
pub struct InvalidPage(String);

/// Parses the address of a page.
///
/// # Errors
/// Fails on anything but `http://HOST:PORT`.
pub fn page(text: &str) -> Result<Page, InvalidPage> {
    let rest = text.strip_prefix("http://");
    let host = rest.map(|rest| rest.strip_suffix('/').unwrap_or(rest));
    let fits = |host: &&str| {
        let port = host.rsplit_once(':').map(|(_, port)| port.parse::<u16>());
        port.is_some_and(|port| port.is_ok()) && !host.contains(['/', '?', '@', ' ', '\r', '\n'])
    };
    match host.filter(fits) {
        Some(host) => Ok(Page(host.to_owned())),
        None => Err(InvalidPage(text.to_owned())),
    }
}

/// One line of the rig with its messages, as `/api/trace` gives them.
#[derive(Debug, Clone, Deserialize)]
struct Line {
    line: String,
    entries: Vec<Message>,
}

/// A message as `/api/trace` gives it.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct Message {
    /// Instant of the message, microseconds of rig time.
    pub at_us: u64,
    /// Direction as one character: `>` sent, `<` received, `~` stray.
    pub way: String,
    /// Bytes of the message, escaped.
    pub text: String,
    /// Decoded meaning.
    pub meaning: String,
}

/// One entry that the follower reports.
#[derive(Debug, PartialEq, Eq)]
pub struct Update {
    /// Instant of the entry, microseconds of rig time.
    pub at_us: u64,
    /// Name of the line.
    pub line: String,
    /// A message or a gap.
    pub what: UpdateContent,
}

/// Content of an entry.
#[derive(Debug, PartialEq, Eq)]
pub enum UpdateContent {
    /// More messages passed between two polls than the server keeps.
    Gap,
    /// One message.
    Message(Message),
}

/// Last message delivered to the caller, by name of the line.
#[derive(Debug, Default)]
struct Delivered(BTreeMap<String, Message>);

impl Delivered {
    /// Returns the messages that are new since the last call, with a gap where some passed unseen; oldest first.
    fn news(&mut self, lines: Vec<Line>) -> Vec<Update> {
        let mut news = Vec::new();
        for Line { line, entries } in lines {
            let Some(newest) = entries.last().cloned() else {
                continue;
            };
            let reported = self.0.insert(line.clone(), newest);
            let known = reported
                .as_ref()
                .map(|reported| entries.iter().rposition(|it| it == reported));
            let of = |at_us, what| Update {
                at_us,
                line: line.clone(),
                what,
            };
            if known == Some(None) {
                news.push(of(entries[0].at_us, UpdateContent::Gap));
            }
            let from = known.flatten().map_or(0, |place| place + 1);
            let fresh = entries.into_iter().skip(from);
            news.extend(fresh.map(|it| of(it.at_us, UpdateContent::Message(it))));
        }
        news.sort_by_key(|it| it.at_us);
        news
    }
}

/// Passes each new message to `report` until the controller ends. Fails when the first poll or `report` fails.
pub async fn follow(
    page: &Page,
    mut report: impl FnMut(&Update) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut delivered = Delivered::default();
    let mut lines = poll(page).await?;
    loop {
        for news in delivered.news(lines) {
            report(&news)?;
        }
        tokio::time::sleep(POLL_INTERVAL).await;
        lines = match poll(page).await {
            Ok(lines) => lines,
            Err(end) => {
                tracing::warn!("the controller stopped answering: {end:#}");
                return Ok(());
            }
        };
    }
}

async fn poll(page: &Page) -> anyhow::Result<Vec<Line>> {
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

/// Returns the body of the answer to a GET request; fails on a status other than 200.
async fn get(host: &str, path: &str) -> anyhow::Result<Vec<u8>> {
    let mut stream = TcpStream::connect(host).await?;
    let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).await?;
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).await?;
    let end = answer
        .windows(4)
        .position(|four| four == b"\r\n\r\n")
        .context("the answer is not HTTP")?;
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

    fn seen(news: &[Update]) -> Vec<(u64, &str, bool)> {
        let seen = |it: &'_ Update| matches!(it.what, UpdateContent::Message(_));
        news.iter()
            .map(|it| (it.at_us, it.line.as_str(), seen(it)))
            .collect()
    }

    #[test]
    fn messages_come_once_in_order_of_time() {
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
    fn lost_messages_leave_a_gap() {
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
    fn a_page_address_is_host_and_port() {
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
