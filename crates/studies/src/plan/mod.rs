//! `relayrig study plan`: interference tables and orders for taking tooling apart.
//!
//! - `boxes`: how often extruded boxes, as the paper uses them, block a move for which the true bodies are free: shafts
//!   in holes, bevels, the default fixture.
//! - `orders`: random scenes of 4 to 7 elements against a brute-force search over all orders and directions.
//! - `growth`: time and memory for 1,000 and 10,000 elements. The time of a table is divided by that of plain
//!   first-contact sweeps of all elements in all directions, measured in the same run.

mod boxes;
mod growth;
mod orders;

use super::chart::Chart;
use super::output::Report;
use config::Folder;

/// Default number of random scenes.
pub const SCENES: u64 = 2_000;

/// Runs the study and returns its report; `config` holds the default fixture.
///
/// # Errors
/// Fails when a scene cannot be read, and when the collision core refuses a body.
pub fn study(config: &Folder, scenes: u64) -> anyhow::Result<Report> {
    let boxes = boxes::figures(config)?;
    let groups = vec![boxes.clone(), orders::figures(scenes)?, growth::figures()?];
    let title = "false blocks of extruded boxes, share of all their blocks";
    let chart = Chart::of(title.to_owned(), "%", Vec::new(), &boxes);
    let about = format!("{scenes} random scenes; scenes of 1,000 and 10,000 elements");
    Ok(Report::new("plan", about, groups, chart))
}
