//! Sends the log to stderr or, with its fields, to the journal of systemd.

use std::os::unix::fs::MetadataExt;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{EnvFilter, Layer, fmt, registry};

/// Prefix of a field in the journal: `code` of a message becomes `RELAYRIG_CODE`.
const PREFIX: &str = "RELAYRIG";

/// Starts the log; a filter that cannot be read becomes `info`.
pub fn start(filter: &str) {
    let filter = EnvFilter::try_new(filter).unwrap_or_else(|_| EnvFilter::new("info"));
    let journal = is_journal().then(tracing_journald::layer);
    let layer = match journal {
        Some(Ok(journal)) => journal.with_field_prefix(Some(PREFIX.to_owned())).boxed(),
        Some(Err(_)) | None => fmt::layer()
            .with_writer(std::io::stderr)
            .with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr()))
            .boxed(),
    };
    registry().with(filter).with(layer).init();
}

/// Returns true when stderr is the stream that `JOURNAL_STREAM` names. A terminal inherits the variable from its session,
/// but has another stderr.
fn is_journal() -> bool {
    let stderr = std::fs::metadata("/proc/self/fd/2");
    match (std::env::var("JOURNAL_STREAM"), stderr) {
        (Ok(stream), Ok(stderr)) => stream == format!("{}:{}", stderr.dev(), stderr.ino()),
        (Ok(_) | Err(_), Ok(_) | Err(_)) => false,
    }
}
