//! A serial line of DCON modules: one transaction at a time, in bounded time, and never another module's reply.
//!
//! One task owns one port ([`run`]). Each [`Request`] gets exactly one [`Answer`], in the order of the requests.
//!
//! ```
//! use bus::{LineSettings, Pace, Request, run};
//! use dcon::{Address, Counter, Reply, UpTo};
//! use tokio::io::{AsyncReadExt, AsyncWriteExt, duplex};
//! use tokio::sync::mpsc;
//!
//! # #[tokio::main(flavor = "current_thread")]
//! # async fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let (port, mut module) = duplex(64);
//! let (ask, requests) = mpsc::channel(1);
//! let (answers, mut replies) = mpsc::channel(1);
//! let settings = LineSettings::new("measure", 115_200);
//! tokio::spawn(run(port, settings, Pace::real(), requests, answers));
//!
//! let command = Counter::Read(UpTo::new(0).ok_or("counter 0")?).to(Address(3));
//! ask.send(Request { ticket: 7, command, tries: 2 }).await?;
//!
//! // The module's side: a request with its checksum comes in, the count 30 goes out.
//! let mut heard = [0; 7];
//! module.read_exact(&mut heard).await?;
//! assert_eq!(&heard, b"#030B6\r");
//! module.write_all(b">0000001ED4\r").await?;
//!
//! let answer = replies.recv().await.ok_or("no answer")?;
//! assert_eq!(answer.ticket, 7);
//! assert_eq!(answer.outcome, Ok(Reply::Count(30)));
//! # Ok(())
//! # }
//! ```
//!
//! # A transaction
//!
//! 1. The line discards the bytes that wait in the input, because they belong to no request.
//! 2. It writes the request. The reply must be complete within wire(request) + wire(longest reply) + allowance.
//! 3. It pauses for the turnaround (two characters). A byte during this pause reveals a second sender: the line rejects
//!    the reply.
//! 4. After a time-out or damage it resynchronises: it asks the module for its name, and the `!AA` reply proves that no
//!    older reply is on its way. When the module does not answer, the line must fall silent for the longest reply time
//!    plus the grace for late replies. For one second after that, every reply that an earlier request could have caused
//!    needs a confirmation, because `>` replies carry no address and a late one looks like the next.
//! 5. It reads at least twice from an address on probation, that is, one whose replies were damaged: a checksum misses
//!    one error in 256.
//! 6. It repeats only commands that change nothing, at most as often as the request allows.
//! 7. Before it writes a setting to an EEPROM, it reads the setting and skips the write if the module already has the
//!    value.
//!
//! A line that does not fall silent answers [`Failure::NeverSilent`]. A line whose port is lost answers
//! [`Failure::PortLost`], after the time that a silent module would take, and reopens the port at growing intervals.
//!
//! # Files
//!
//! | file | what it does |
//! |---|---|
//! | `line.rs` | the task of a line: tries, repetitions, reopening |
//! | `transaction.rs`, `exchange.rs` | one transaction, which drops late replies; the bytes of one exchange |
//! | `outstanding.rs` | remembers replies that may still arrive late |
//! | `probation.rs` | remembers addresses whose replies need confirmation |
//! | `pace.rs` | rig time, real or virtual |
//! | `passage.rs` | how late this computer passes bytes on |
//! | `settings.rs`, `wire.rs` | time-outs, and the time that characters take |
//! | `trace.rs`, `recorded.rs`, `health.rs`, `log.rs` | the last bytes, their text format, counts by module, shared log |
//! | `instrument/` | links to SCPI instruments over TCP, serial ports and GPIB adapters |
//! | `meaning.rs`, `words.rs` | texts of requests and replies, English and Chinese |
//! | `port.rs`, `raw.rs` | serial ports; single frames for tools |
//! | `task.rs` | hands tasks to the runtime |
//! | `reader.rs` | the line of a code reader, which speaks by itself |

mod answer;
mod exchange;
mod health;
pub mod instrument;
mod line;
mod log;
mod meaning;
mod outstanding;
mod pace;
mod passage;
mod port;
mod probation;
mod raw;
mod reader;
mod recorded;
mod settings;
mod task;
mod timer;
mod trace;
mod transaction;
mod wire;
mod words;

#[cfg(test)]
mod tests;

pub use answer::{Answer, Failure, LineError, Request};
pub use health::{Health, Histogram, ModuleHealth};
pub use line::{run, run_reopening};
pub use log::LineLog;
pub use meaning::{Meaning, meanings};
pub use pace::Pace;
pub use passage::Passage;
pub use port::{
    OpenPort, Port, PortError, from_streams, open_serial, open_serial_with, serial_port,
};
pub use probation::PROBATION_ANSWERS;
pub use raw::{RawReply, send_raw};
pub use reader::{Reading, run_reader};
pub use recorded::{Recorded, RecordedError, arrow, escaped, unescaped};
pub use settings::{LineSettings, longest_transaction};
pub use task::{Task, block_on, spawn};
pub use timer::Timer;
pub use trace::{Direction, Entry, Trace};
pub use wire::Wire;
pub use words::{reply, request};
