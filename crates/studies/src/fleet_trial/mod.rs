//! Speed of the database behind many rigs, on a PostgreSQL server of its own on this computer.
//!
//! - `push` times how the program sends the history of a rig, and compares that with `psql`, the client of the server,
//!   which copies the same rows.
//! - `ask` fills the database with made-up rigs and times questions of the command line.
//!
//! All times are wall times; server and program share the processors.

mod ask;
mod push;

use super::chart::Chart;
use super::order::Order;
use super::output::Report;
use anyhow::Context;
use fleet::trial::Trial;
use std::time::Instant;
use tokio::runtime::{Builder, Runtime};

/// Sends a history of `order.parts` parts, then asks about `order.lots` made-up rigs of as many parts each.
///
/// # Errors
/// Fails without the programs of a PostgreSQL server, and when a file cannot be written.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let server = Trial::start().context("starting a PostgreSQL server")?;
    let runtime = Builder::new_current_thread().enable_all().build()?;
    let pushed = push::figures(&server, &runtime, order.parts)?;
    drop(server);
    let server = Trial::start()?;
    let asked = ask::figures(&server, &runtime, order)?;
    let title = format!("wall time of questions to {} rigs", order.lots);
    let chart = Chart::of(title, "ms", vec![100.0, 300.0], &asked[1]);
    let about = format!(
        "{} parts of a rig; {} made-up rigs",
        order.parts, order.lots
    );
    let blocks = [vec![pushed], asked.into()].concat();
    Ok(Report::new("fleet", about, blocks, chart))
}

/// Runs `work` and returns its result with its wall time, seconds.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let from = Instant::now();
    let done = work();
    (done, from.elapsed().as_secs_f64())
}

/// Runs `work` to its end.
fn wait<T>(runtime: &Runtime, work: impl Future<Output = fleet::Result<T>>) -> anyhow::Result<T> {
    Ok(runtime.block_on(work)?)
}
