//! These tests step feed, nest and sorter from every state under every combination of their inputs and compare the
//! transitions with a drawing, `golden/{feed,nest,sorter}.dot`.
//!
//! Inputs are those that the machine reads: the sensors of each actuator (one end, the other, neither), part sensors,
//! the ledger, permissions, and passed deadlines. The drawing omits a step that keeps its state, unless it commands
//! something.

mod feed;
mod nest;
mod sorter;

use super::MockRig;
use super::mock_rig::Output;
use crate::handling::moves::Move;
use crate::rig::point::DigitalIn;

use std::collections::BTreeSet;

/// Transitions found.
#[derive(Debug, Default)]
struct Graph {
    edges: BTreeSet<String>,
    steps: u64,
}

impl Graph {
    fn add(&mut self, from: &str, to: &str, output: &Output) {
        self.steps += 1;
        let motions = output.rig.motions.iter().map(|movement| named(*movement));
        let commands: Vec<String> = motions.chain(output.alarms()).collect();
        if from != to || !commands.is_empty() {
            let label = commands.join(", ");
            self.edges
                .insert(format!("  {from} -> {to} [label=\"{label}\"];\n"));
        }
    }

    /// Compares the transitions with the drawing, and checks that every combination was tried.
    fn assert_drawn(&self, name: &str, drawn: &str, steps: u64) {
        let edges: String = self.edges.iter().map(String::as_str).collect();
        let dot = format!("digraph {name} {{\n{edges}}}\n");
        assert_eq!(self.steps, steps, "{name}: combinations tried");
        assert!(
            dot == drawn,
            "{name}.dot differs from the drawing; review the difference and update the file:\n{dot}"
        );
    }

    /// Checks that each edge names a test, and that this folder has that test.
    fn assert_tests(&self, facts: &[(&str, &str, &str)], tests: &str) {
        for (from, to, fact) in facts {
            let edge = format!("  {from} -> {to} [");
            assert!(
                self.edges.iter().any(|known| known.starts_with(&edge)),
                "no such edge: {from} -> {to}"
            );
            assert!(
                tests.contains(&format!("fn {fact}()")),
                "no such test: {fact}"
            );
        }
        for edge in &self.edges {
            let walked = facts
                .iter()
                .any(|(from, to, _)| edge.starts_with(&format!("  {from} -> {to} [")));
            assert!(walked, "no named test walks {edge}");
        }
    }
}

/// Returns the name of a motion, without the station of the axis, of which there are many.
fn named(movement: Move) -> String {
    match movement {
        Move::AxisTo(_) => "AxisTo".to_owned(),
        other => format!("{other:?}"),
    }
}

/// Yields every combination of `n` booleans.
fn truths<const N: usize>() -> impl Iterator<Item = [bool; N]> {
    (0..1_u32 << N).map(|bits| std::array::from_fn(|n| bits >> n & 1 == 1))
}

/// Sensors of an actuator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SensedEnd {
    Rest,
    Far,
    Between,
}

const SEEN: [SensedEnd; 3] = [SensedEnd::Rest, SensedEnd::Far, SensedEnd::Between];

fn show(mock: &mut MockRig, rest: &[DigitalIn], far: &[DigitalIn], seen: SensedEnd) {
    for point in rest {
        mock.set(*point, seen == SensedEnd::Rest);
    }
    for point in far {
        mock.set(*point, seen == SensedEnd::Far);
    }
}
