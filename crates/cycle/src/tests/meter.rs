//! An instrument in memory: answers commands over a stream in virtual time.

use super::Log;
use bus::Pace;
use bus::instrument::Opener;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader, DuplexStream, duplex};
use units::Span;

/// Profile of the instrument.
pub const PROFILE: &str = r#"
name = "meter"
class = "dmm"
dialect = "scpi"
makers = ["ACME"]
models = ["M1"]
timeout_ms = 200
latency_ms = 1.0
error_depth = 4
set_up = [{ send = "*RST" }]
safe = [{ send = ":OUTP OFF" }]
program.value.steps = [{ ask = "VALUE?", reply = "number" }]
program.hang.steps = [{ ask = "HANG?", reply = "number" }]
program.over.steps = [{ ask = "OVER?", reply = "number" }]
program.refused.steps = [{ send = ":WRONG" }]
program.late.steps = [{ ask = "LATE?", reply = "number" }]
program.slow.steps = [{ ask = "SLOW?", reply = "number", timeout_ms = 2000 }]
program.stuck.steps = [{ ask = "HANG?", reply = "number", timeout_ms = 60000 }]
program.level = { steps = [{ send = ":LEV {level_v}" }, { ask = ":LEV?", reply = "number" }], argument.level_v = { low = 0.0, high = 5.0 } }
"#;

/// First entry of an empty error queue.
const NO_ERROR: &str = "0,\"No error\"";

/// Reply that comes after the time of its query.
pub const LATE: f64 = 777.0;

/// What an instrument is, and how it behaves.
#[derive(Debug, Clone)]
pub struct Meter {
    /// Name in the log.
    pub name: &'static str,
    /// Reply to `*IDN?`.
    pub identity: &'static str,
    /// While true, connections succeed and nothing is answered.
    pub dead: Arc<AtomicBool>,
    /// While true, no connection succeeds.
    pub missing: bool,
}

impl Meter {
    pub fn new(name: &'static str) -> Self {
        Self {
            name,
            identity: "ACME,M1,7,1.0",
            dead: Arc::default(),
            missing: false,
        }
    }

    /// Returns what opens a stream to this instrument; each stream has a task of its own.
    pub fn opener(&self, pace: Pace, log: &Log) -> Opener {
        let (meter, log) = (self.clone(), log.clone());
        Opener::Streams(bus::from_streams(move || {
            if meter.missing {
                return None;
            }
            let (host, device) = duplex(1 << 12);
            tokio::spawn(serve(meter.clone(), device, pace, log.clone()));
            Some(host)
        }))
    }
}

async fn serve(meter: Meter, stream: DuplexStream, pace: Pace, log: Log) {
    let (reader, mut writer) = tokio::io::split(stream);
    let mut lines = BufReader::new(reader).lines();
    let (mut left, mut values, mut level) = (String::from("0"), 0, String::from("0"));
    let mut error = NO_ERROR;
    while let Ok(Some(line)) = lines.next_line().await {
        if meter.dead.load(Ordering::Acquire) {
            continue;
        }
        log.add(pace.now(), format!("{} {line}", meter.name));
        let (after, reply) = match line.as_str() {
            "*IDN?" => (Span::ms(1), meter.identity.to_owned()),
            "*ESE?" => (Span::ms(1), left.clone()),
            "*ESR?" => (Span::ms(1), "0".to_owned()),
            "SYST:ERR?" => {
                let error = std::mem::replace(&mut error, NO_ERROR);
                (Span::ms(1), error.to_owned())
            }
            "OVER?" => (Span::ms(1), "9.9E37".to_owned()),
            "VALUE?" => {
                values += 1;
                (Span::ms(1), values.to_string())
            }
            "SLOW?" => (Span::ms(1000), "5".to_owned()),
            "LATE?" => (Span::ms(350), LATE.to_string()),
            ":LEV?" => (Span::ms(1), level.clone()),
            other => {
                if let Some(number) = other.strip_prefix("*ESE ") {
                    number.clone_into(&mut left);
                } else if other == ":WRONG" {
                    error = "-113,\"Undefined header\"";
                } else if let Some(number) = other.strip_prefix(":LEV ") {
                    number.clone_into(&mut level);
                }
                continue;
            }
        };
        pace.sleep_until(pace.now() + after).await;
        if writer
            .write_all(format!("{reply}\n").as_bytes())
            .await
            .is_err()
        {
            return;
        }
    }
}
