//! The critical path of a cycle, and how close the line comes to it.
//!
//! The nest is never idle between one nest exit and the next: the pusher pushes the next part in, the jaws clamp it and
//! the probes rise while the pusher returns, the test runs, the fingers grip while the probes go down, the jaws open
//! and z lifts the part. Each of these strokes waits for the previous one; all others (escapement, the way to the bin
//! and back, z down) overlap with them. No overlap can make a cycle shorter than the sum of the mean travel times of
//! the path and the mean test.

use super::figure::{self, Bar, Figure};
use super::lot::{Lot, Part};
use super::order::Order;
use rigsim::config::read_world;
use rigsim::world::table::{MechanismTable, present};

/// Least number of parts per hour with the default recipe.
const PARTS_PER_HOUR: f64 = 2100.0;
/// The line must make at least this share of the parts per hour that the critical path permits.
const SHARE: f64 = 0.95;

/// Returns the strokes of the path with their mean times, ms; of two simultaneous strokes, the longer time.
fn strokes(mechanism: &MechanismTable) -> [(&'static str, f64); 5] {
    [
        ("path: pusher to the nest", mechanism.pusher_ms),
        (
            "path: jaws closed, then probes up",
            mechanism.clamp_ms + mechanism.probe_lift_ms,
        ),
        (
            "path: probes down, fingers beside them",
            mechanism.probe_lift_ms.max(mechanism.gripper_ms),
        ),
        ("path: jaws open", mechanism.clamp_ms),
        ("path: z up", mechanism.sort_z_ms),
    ]
}

/// Returns the critical path stroke by stroke, its sum, and the parts per hour.
///
/// # Errors
/// Fails when the world file cannot be read.
pub fn path(order: &Order, lots: &[Lot]) -> anyhow::Result<Vec<Figure>> {
    let files = order.config.as_path().into();
    let world = read_world(&files, order.world.as_deref())?;
    let strokes = strokes(&present(&world.mechanism, "mechanism", &files)?);
    let parts: Vec<&Part> = lots.iter().flat_map(|lot| &lot.parts).collect();
    let mean = |of: fn(&Part) -> Option<f64>| {
        let whole = parts.iter().filter(|part| part.cycle_s.is_some());
        figure::mean(whole.filter_map(|part| of(part)))
    };
    let (test, cycle) = (mean(|part| part.test_s), mean(|part| part.cycle_s));
    let travel: f64 = strokes.iter().map(|(_, ms)| ms / 1e3).sum();
    let bound = test.map(|test| travel + test);
    let per_hour = |cycle: Option<f64>| cycle.map(|seconds| 3600.0 / seconds);
    let share = bound.zip(cycle).map(|(bound, cycle)| bound / cycle);
    let n = parts.len() as u64;
    let stroke = |(name, ms): &(&str, f64)| Figure::new(*name, 1, Some(ms / 1e3), "s");
    let mut rows: Vec<Figure> = strokes.iter().map(stroke).collect();
    rows.extend([
        Figure::new("path: mean test", n, test, "s"),
        Figure::new("bound: the whole path", n, bound, "s"),
        Figure::new("parts an hour of the bound", n, per_hour(bound), ""),
        Figure::new("parts an hour", n, per_hour(cycle), "").bar(Bar::AtLeast(PARTS_PER_HOUR)),
        Figure::new("parts an hour against the bound", n, share, "").bar(Bar::AtLeast(SHARE)),
    ]);
    Ok(rows)
}
