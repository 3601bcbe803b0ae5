//! `relayrig bus monitor --from`: the live traffic of a running controller, as it tells it itself. The port stays the
//! controller's alone, and nothing goes to a module that would not go otherwise.
//!
//! The page's server keeps the last messages of every line (`/api/trace`). They are fetched again and again; what was not
//! there before is told, lines mixed in the order of time. Where more passed between two looks than the server keeps, the
//! gap is told too. It ends with the controller.

use anyhow::{Context, anyhow, bail};
use bus::unescaped;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::time::Duration;
use thiserror::Error;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// Between two looks: a line at 115200 baud makes some 130 messages in this time, and a thousand are kept.
const BETWEEN_LOOKS: Duration = Duration::from_millis(200);
/// Longest wait for an answer of the server.
const PATIENCE: Duration = Duration::from_secs(10);

/// Where a page is served: host and port of `http://HOST:PORT`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Page(String);

/// A text that is no address of a page.
#[derive(Debug, PartialEq, Eq, Error)]
#[error("found \"{0}\", expected http://HOST:PORT")]
pub(super) struct NoPage(String);

/// For the command line.
pub(super) fn page(text: &str) -> Result<Page, NoPage> {
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

#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
struct Message {
    at_us: u64,
    way: String,
    text: String,
    meaning: String,
}

/// Something to print.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct News {
    at_us: u64,
    line: String,
    what: What,
}

#[derive(Debug, PartialEq, Eq)]
enum What {
    /// More passed between two looks than is kept.
    Gap,
    Message(Message),
}

impl News {
    /// Whether it passed on this line.
    pub(super) fn is_of(&self, line: &str) -> bool {
        self.line == line
    }

    /// One row, its end left off.
    pub(super) fn row(&self, level: super::monitor::Level) -> String {
        use super::monitor::Level;
        let seconds = self.at_us as f64 / 1e6;
        let line = &self.line;
        let What::Message(message) = &self.what else {
            return format!("{seconds:>14.6} {line} - more has passed than could be seen");
        };
        let said = match level {
            Level::Bytes => unescaped(&message.text)
                .unwrap_or_default()
                .iter()
                .map(|byte| format!("{byte:02X} "))
                .collect(),
            Level::Frames => message.text.clone(),
            Level::Meaning => format!("{:<24} {}", message.text, message.meaning),
        };
        let row = format!("{seconds:>14.6} {line} {} {said}", message.way);
        row.trim_end().to_owned()
    }
}

/// What has been told of every line.
#[derive(Debug, Default)]
struct Told(BTreeMap<String, Message>);

impl Told {
    /// What is new, oldest first.
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
pub(super) async fn follow(
    page: &Page,
    mut tell: impl FnMut(&News) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut told = Told::default();
    let mut lines = look(page).await?;
    loop {
        for news in told.news(lines) {
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
    let body = tokio::time::timeout(PATIENCE, get(host, "/api/trace?last=1000"));
    let body = body
        .await
        .map_err(|_| anyhow!("no answer within {} s", PATIENCE.as_secs()))
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
    use crate::cli::bus::monitor::Level;

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

    fn rows(news: &[News], level: Level) -> Vec<String> {
        news.iter().map(|it| it.row(level)).collect()
    }

    #[test]
    fn what_was_told_is_not_told_again_and_lines_come_in_the_order_of_time() {
        let mut told = Told::default();
        let news = told.news(vec![line("motion", &[1, 4]), line("measure", &[2])]);
        assert_eq!(
            rows(&news, Level::Frames),
            [
                "      0.000001 motion < >3E\\r",
                "      0.000002 measure < >3E\\r",
                "      0.000004 motion < >3E\\r"
            ]
        );
        let news = told.news(vec![line("motion", &[1, 4]), line("measure", &[2, 5])]);
        assert_eq!(
            rows(&news, Level::Bytes),
            ["      0.000005 measure < 3E 33 45 0D"]
        );
    }

    #[test]
    fn where_more_passed_than_is_kept_the_gap_is_told() {
        let mut told = Told::default();
        told.news(vec![line("motion", &[1, 4])]);
        let news = told.news(vec![line("motion", &[7, 9])]);
        let rows = rows(&news, Level::Meaning);
        assert_eq!(rows.len(), 3);
        assert!(rows[0].ends_with("motion - more has passed than could be seen"));
        assert!(rows[1].ends_with("accepted"), "{rows:?}");
        assert!(told.news(vec![line("motion", &[7, 9])]).is_empty());
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
