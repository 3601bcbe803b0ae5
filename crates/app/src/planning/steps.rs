//! Turns sequences into a plan for people: verified steps, what holds their elements, and drawings of the scenes.

use super::{PlanScene, Planning, rows};
use anyhow::bail;
use history::tooling::{ChangeoverRow, PlanAction, PlanBody, PlanKind, PlanPicture, ToolingPlan};
use lpm::{View, outlines};
use plan::{Assembly, Direction, Planner, Sequence, Step, Verified, verified};

/// A plan under construction; [`Drafted::append`] adds a sequence to it.
pub(super) struct Drafted {
    plan: ToolingPlan,
}

impl Drafted {
    /// Begins a plan that leads from the first scene to the last one.
    pub fn new(kind: PlanKind, scenes: &[&PlanScene]) -> Drafted {
        let name = |scene: &&PlanScene| scene.name.clone();
        Drafted {
            plan: ToolingPlan {
                kind,
                scene: scenes.first().map(name).unwrap_or_default(),
                to: scenes.get(1).map(name),
                remove: Vec::new(),
                summary: None,
                steps: Vec::new(),
                scenes: scenes.iter().map(|it| bodies(&it.assembly)).collect(),
                pictures: Vec::new(),
            },
        }
    }

    pub fn remove(&mut self, ids: &[String]) {
        self.plan.remove = ids.to_vec();
    }

    pub fn summary(&mut self, summary: ChangeoverRow) {
        self.plan.summary = Some(summary);
    }

    /// Verifies a disassembly and appends its steps. With [`PlanAction::Add`] appends the reverse, which assembles the
    /// last scene.
    ///
    /// # Errors
    /// Fails when the collision core refuses a step.
    pub fn append(
        &mut self,
        planner: &Planner,
        sequence: &Sequence,
        action: PlanAction,
    ) -> anyhow::Result<()> {
        let assembly = planner.assembly();
        let measured = measured(assembly, &sequence.steps)?;
        let held = held_by(planner, &sequence.steps);
        let count = sequence.steps.len();
        let first = self.plan.steps.len();
        let (steps, scene) = match action {
            PlanAction::Remove => (sequence.steps.clone(), 0),
            PlanAction::Add => (sequence.reversed(), self.plan.scenes.len() - 1),
        };
        // Converts a step's place in this action to its place in the disassembly, or back.
        let of_removal = |place: usize| match action {
            PlanAction::Remove => place,
            PlanAction::Add => count - 1 - place,
        };
        for (place, step) in steps.iter().enumerate() {
            let at = of_removal(place);
            let about = (&measured[at], held[at].as_slice());
            let row = rows::step(assembly, first + place + 1, action, step, about);
            self.plan.steps.extend(row);
            self.plan.pictures.push(PlanPicture {
                scene,
                subassembly: step.bench.map(|it| first + of_removal(it)),
            });
        }
        Ok(())
    }

    pub fn done(self) -> Planning {
        assert_eq!(self.plan.steps.len(), self.plan.pictures.len());
        Planning::Plan(Box::new(self.plan))
    }
}

fn bodies(assembly: &Assembly) -> Vec<PlanBody> {
    let rounded = |polygons: Vec<Vec<[f64; 2]>>| -> Vec<Vec<[f64; 2]>> {
        let corner = |at: [f64; 2]| at.map(|it| (it * 100.0).round() / 100.0);
        let polygons = polygons.into_iter();
        polygons
            .map(|it| it.into_iter().map(corner).collect())
            .collect()
    };
    let elements = assembly.elements().iter();
    let body = |it: &plan::Element| PlanBody {
        id: it.id.clone(),
        above: rounded(outlines(&it.shape, it.pose, View::Above)),
        front: rounded(outlines(&it.shape, it.pose, View::Front)),
    };
    elements.map(body).collect()
}

fn measured(assembly: &Assembly, steps: &[Step]) -> anyhow::Result<Vec<Verified>> {
    match verified(assembly, steps)? {
        Ok(measured) => Ok(measured),
        Err(refused) => bail!(
            "step {} of the plan: the way of {} is refused, blocked by {}",
            refused.step + 1,
            assembly.id(refused.mover),
            refused
                .blocker
                .map_or("(undecidable)", |it| assembly.id(it))
        ),
    }
}

/// Returns, for each step of a disassembly, the elements in place that hold the moving ones in some direction.
fn held_by(planner: &Planner, steps: &[Step]) -> Vec<Vec<usize>> {
    let mut spots = vec![Spot::Rig; planner.assembly().len()];
    let mut found = Vec::with_capacity(steps.len());
    for (place, step) in steps.iter().enumerate() {
        let here = step.bench.map_or(Spot::Rig, Spot::Bench);
        let rows = step.elements.iter().flat_map(|element| {
            Direction::ALL.map(|direction| planner.local().blockers(*element, direction))
        });
        let others = rows.flatten().map(|it| *it as usize);
        let holds = |it: &usize| spots[*it] == here && !step.elements.contains(it);
        let mut holding: Vec<usize> = others.filter(holds).collect();
        holding.sort_unstable();
        holding.dedup();
        found.push(holding);
        let is_subassembly = steps.iter().any(|it| it.bench == Some(place));
        for element in &step.elements {
            spots[*element] = match is_subassembly {
                true => Spot::Bench(place),
                false => Spot::Out,
            };
        }
    }
    found
}

/// Where an element is during a disassembly.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Spot {
    Rig,
    /// On the bench, as part of the subassembly that the step with this index took off.
    Bench(usize),
    Out,
}
