//! Sends the log to stderr as text or JSON lines, or with its fields to the journal of systemd.

use anyhow::Context;
use config::nearest::nearest;
use std::os::unix::fs::MetadataExt;
use tracing_subscriber::filter::LevelFilter;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{EnvFilter, Layer, fmt, registry};

/// Prefix of a field in the journal: `code` of a message becomes `RELAYRIG_CODE`.
const PREFIX: &str = "RELAYRIG";

/// Word of a filter that turns the log into JSON lines.
const JSON: &str = "json";

const LEVELS: [&str; 6] = ["off", "error", "warn", "info", "debug", "trace"];

/// Modules that `--log` knows: the crates of this program, and libraries that serve the page.
const MODULES: [&str; 27] = [
    "relayrig",
    "app",
    "bus",
    "chamber",
    "config",
    "cycle",
    "dcon",
    "fleet",
    "history",
    "lpm",
    "machine",
    "page",
    "plan",
    "quality",
    "rigsim",
    "scpi",
    "studies",
    "texts",
    "units",
    "virtual_time",
    "axum",
    "hyper",
    "hyper_util",
    "mio",
    "rustls",
    "tokio",
    "tokio_postgres",
];

/// Starts the log with the filter `words` of `--log`, else with that of `RUST_LOG`, else with `info`. A part of
/// `RUST_LOG` that is malformed gets a warning, because it may be meant for other programs.
///
/// # Errors
/// Fails for a word of `--log` that is no level and no known module, and for a malformed filter of `--log`.
pub fn start(words: Option<&str>) -> anyhow::Result<()> {
    let shared = std::env::var("RUST_LOG").unwrap_or_default();
    let all = words.unwrap_or(&shared).split(',').map(str::trim);
    let (json, directives): (Vec<&str>, Vec<&str>) =
        all.filter(|it| !it.is_empty()).partition(|it| *it == JSON);
    let filter = match directives.is_empty() {
        true => "info".to_owned(),
        false => directives.join(","),
    };
    let filter = match words {
        Some(words) => {
            directives.iter().try_for_each(|it| check(it))?;
            EnvFilter::try_new(&filter).with_context(|| format!("--log: {words:?}"))?
        }
        None => EnvFilter::new(&filter),
    };
    let journal = (json.is_empty() && is_journal()).then(tracing_journald::layer);
    let text = || {
        fmt::layer()
            .with_writer(std::io::stderr)
            .with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr()))
    };
    let layer = match journal {
        Some(Ok(journal)) => journal.with_field_prefix(Some(PREFIX.to_owned())).boxed(),
        Some(Err(_)) | None if json.is_empty() => text().boxed(),
        Some(Err(_)) | None => text().json().flatten_event(true).boxed(),
    };
    registry().with(filter).with(layer).init();
    Ok(())
}

/// Checks a directive: `LEVEL`, `MODULE` or `MODULE=LEVEL`. Leaves one with brackets (a span) to the filter library.
fn check(directive: &str) -> anyhow::Result<()> {
    if directive.contains(['[', ']', '{', '}']) {
        return Ok(());
    }
    let (module, level) = match directive.split_once('=') {
        Some((module, level)) => (Some(module), Some(level)),
        None if directive.parse::<LevelFilter>().is_ok() => (None, None),
        None => (Some(directive), None),
    };
    let is_level = level.is_none_or(|it| it.parse::<LevelFilter>().is_ok());
    let module = module.map(|it| it.split("::").next().unwrap_or(it));
    let is_module = module.is_none_or(|it| MODULES.contains(&it));
    let (found, known) = match (is_module, is_level, level) {
        (true, true, _) => return Ok(()),
        (true, false, level) => (level.unwrap_or_default(), LEVELS.to_vec()),
        (false, _, Some(_)) => (module.unwrap_or_default(), MODULES.to_vec()),
        (false, _, None) => {
            let words = LEVELS.iter().chain(&MODULES).chain(&[JSON]);
            (directive, words.copied().collect())
        }
    };
    let expected = match nearest(found, &known) {
        Some(near) => format!("{near:?}?"),
        None => format!("{}, a module such as app=debug, or json", LEVELS.join(", ")),
    };
    anyhow::bail!("--log: found {found:?}, expected {expected}")
}

/// Returns true when stderr is the stream that `JOURNAL_STREAM` names. A terminal inherits the variable from its
/// session, but has another stderr.
fn is_journal() -> bool {
    let stderr = std::fs::metadata("/proc/self/fd/2");
    match (std::env::var("JOURNAL_STREAM"), stderr) {
        (Ok(stream), Ok(stderr)) => stream == format!("{}:{}", stderr.dev(), stderr.ino()),
        (Ok(_) | Err(_), Ok(_) | Err(_)) => false,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_crate_of_the_program_is_a_known_module() {
        let crates = concat!(env!("CARGO_MANIFEST_DIR"), "/crates");
        for entry in std::fs::read_dir(crates).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            assert!(name == "manuals" || check(&name).is_ok(), "{name}");
        }
    }

    #[test]
    fn an_unknown_filter_is_refused_with_the_nearest() {
        for known in ["info", "OFF", "app=debug", "page::orders=trace", "bus"] {
            assert!(check(known).is_ok(), "{known}");
        }
        for (found, near) in [
            ("inof", "\"info\"?"),
            ("jsn", "\"json\"?"),
            ("ap=debug", "\"app\"?"),
            ("app=debg", "\"debug\"?"),
            ("zebras", "off, error"),
        ] {
            let refusal = check(found).unwrap_err().to_string();
            assert!(refusal.contains(near), "{found}: {refusal}");
        }
    }
}
