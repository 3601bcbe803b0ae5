//! Compares the orders of random scenes with brute force.

use crate::figure::{Bar, Figure, percent};
use plan::fixture::{Brute, random_scene};
use plan::{Cost, Demands, Outcome, Planner, Sequence, verified};

/// Relative difference of lengths that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Counts over all scenes.
struct Counts {
    feasible: u64,
    solved: u64,
    infeasible: u64,
    named: u64,
    refused: u64,
    optimal: u64,
    /// Greatest ratio of a found cost to the optimum; the cost is the number of changes of direction, then the length.
    worst: f64,
}

pub(super) fn figures(scenes: u64) -> anyhow::Result<Vec<Figure>> {
    let mut counts = Counts {
        feasible: 0,
        solved: 0,
        infeasible: 0,
        named: 0,
        refused: 0,
        optimal: 0,
        worst: 1.0,
    };
    for seed in 0..scenes {
        counts.add(seed)?;
    }
    Ok(counts.figures())
}

impl Counts {
    fn add(&mut self, seed: u64) -> anyhow::Result<()> {
        let assembly = random_scene(seed)?;
        let mut brute = Brute::of(&assembly);
        let best = brute.best((1 << assembly.len()) - 1, None)?;
        let straight = Demands {
            straight_only: true,
            ..Demands::default()
        };
        let planner = Planner::new(&assembly, Vec::new())?;
        let outcome = planner.disassembly(&straight)?;
        self.feasible += u64::from(best.is_some());
        self.infeasible += u64::from(best.is_none());
        match (best, outcome) {
            (Some(best), Outcome::Sequence(sequence)) => {
                let is_refused = verified(&assembly, &sequence.steps)?.is_err();
                self.solved += 1;
                self.refused += u64::from(is_refused);
                self.compare(&sequence, best);
            }
            (None, Outcome::Locked(found)) => {
                self.named += u64::from(brute.is_locked(&found.elements)?);
            }
            (Some(_), Outcome::Locked(_)) | (None, Outcome::Sequence(_)) => {}
        }
        Ok(())
    }

    fn compare(&mut self, sequence: &Sequence, best: Cost) {
        let cost = sequence.cost();
        let is_best =
            cost.changes == best.changes && cost.length_mm <= best.length_mm * (1.0 + ROUNDING);
        self.optimal += u64::from(is_best);
        let changes = f64::from(cost.changes + 1) / f64::from(best.changes + 1);
        self.worst = self.worst.max(changes).max(cost.length_mm / best.length_mm);
    }

    fn figures(&self) -> Vec<Figure> {
        let share = |name: &str, some, all| {
            Figure::new(name, all, percent(some, all), "%").bar(Bar::AtLeast(100.0))
        };
        vec![
            share("feasible scenes solved", self.solved, self.feasible),
            share(
                "infeasible scenes with a locked set that is one",
                self.named,
                self.infeasible,
            ),
            Figure::none(
                "orders with a step that the collision core refuses",
                self.solved,
                self.refused,
            ),
            Figure::new(
                "orders whose cost is the optimum",
                self.solved,
                percent(self.optimal, self.solved),
                "%",
            )
            .bar(Bar::AtLeast(95.0)),
            Figure::new(
                "greatest cost, multiple of the optimum",
                self.solved,
                Some(self.worst),
                "",
            )
            .bar(Bar::AtMost(1.2)),
        ]
    }
}
