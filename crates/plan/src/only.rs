//! The fewest units that must come off so that wanted ones can.
//!
//! Each wanted unit needs one way whose blockers leave before it, each by a way of its own. The search chooses a way
//! for one open unit after the other and gives up a branch when it cannot beat the fewest units found so far.

use crate::problem::Problem;

/// Most choices that the search makes before it keeps the best set found so far.
const MOST_CHOICES: usize = 200_000;

/// Units that come off.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fewest {
    /// The units, in ascending order.
    pub units: Vec<usize>,
    /// True when no smaller set exists; false when the search ended early.
    pub is_proven: bool,
}

/// Returns the fewest units that must leave so that all `wanted` ones can; `None` when they cannot at all.
pub fn fewest(problem: &Problem, wanted: &[usize]) -> Option<Fewest> {
    let mut search = Search {
        problem,
        best: None,
        choices: 0,
    };
    search.go(&mut Open {
        state: vec![State::Unasked; problem.len()],
        goals: wanted.iter().map(|unit| Task::Remove(*unit)).collect(),
        count: 0,
    });
    let units = search.best?;
    Some(Fewest {
        units,
        is_proven: search.choices < MOST_CHOICES,
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Unasked,
    /// The unit is still in place; its blockers are leaving.
    Waiting,
    Gone,
}

#[derive(Debug, Clone, Copy)]
enum Task {
    /// Choose a way for the unit and remove its blockers first.
    Remove(usize),
    /// All blockers are gone: the unit leaves.
    Leave(usize),
}

#[derive(Clone)]
struct Open {
    state: Vec<State>,
    /// Tasks, the next one last.
    goals: Vec<Task>,
    /// Units that leave, those that wait included.
    count: usize,
}

struct Search<'a> {
    problem: &'a Problem,
    best: Option<Vec<usize>>,
    choices: usize,
}

impl Search<'_> {
    fn go(&mut self, open: &mut Open) {
        let chosen = loop {
            match open.goals.pop() {
                None => {
                    let gone = |unit: &usize| open.state[*unit] == State::Gone;
                    let units = (0..open.state.len()).filter(gone).collect();
                    self.best = Some(units);
                    return;
                }
                Some(Task::Leave(unit)) => open.state[unit] = State::Gone,
                Some(Task::Remove(unit)) => match open.state[unit] {
                    State::Gone => {}
                    State::Waiting => return,
                    State::Unasked => break unit,
                },
            }
        };
        open.state[chosen] = State::Waiting;
        open.count += 1;
        let mut ways: Vec<(usize, Vec<usize>)> = Vec::new();
        for way in self.problem.ways(chosen) {
            let left = way.blockers.iter().map(|blocker| *blocker as usize);
            let left: Vec<usize> = left.filter(|it| open.state[*it] != State::Gone).collect();
            let can_leave =
                |unit: &usize| self.problem.leaves(*unit) && open.state[*unit] == State::Unasked;
            if left.iter().all(can_leave) {
                ways.push((left.len(), left));
            }
        }
        ways.sort();
        ways.dedup();
        for (count, left) in ways {
            let bound = open.count + count.max(self.still_asked(open));
            let is_hopeless = self.best.as_ref().is_some_and(|best| bound >= best.len());
            if is_hopeless || self.choices >= MOST_CHOICES {
                continue;
            }
            self.choices += 1;
            let mut next = open.clone();
            next.goals.push(Task::Leave(chosen));
            next.goals.extend(left.into_iter().map(Task::Remove));
            self.go(&mut next);
        }
    }

    /// Returns the number of units that the search must still take out and whose path it has not yet chosen.
    fn still_asked(&self, open: &Open) -> usize {
        let mut asked: Vec<usize> = open
            .goals
            .iter()
            .filter_map(|task| match task {
                Task::Remove(unit) if open.state[*unit] == State::Unasked => Some(*unit),
                Task::Remove(_) | Task::Leave(_) => None,
            })
            .collect();
        asked.sort_unstable();
        asked.dedup();
        asked.len()
    }
}
