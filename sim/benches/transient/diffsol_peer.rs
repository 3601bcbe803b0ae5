//! The transient as the library diffsol integrates it: Tsitouras 5(4) with root finding, restarted at every root.

use super::{END_S, NoContactTimes, VOLTS};
use diffsol::{
    DiffsolError, NalgebraMat, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason, Op,
};
use rigsim::world::relay::lumped::{Drive, Element, Model, State};
use std::cell::Cell;

/// Index of NO among the roots.
const NO: usize = 3;

fn state(slice: &[f64]) -> State {
    std::array::from_fn(|i| slice[i])
}

/// Integrates with root finding for all four stops.
///
/// # Errors
/// Fails when diffsol fails, with its error.
pub fn tsit45(model: &Model, rtol: f64) -> Result<NoContactTimes, DiffsolError> {
    let drive = Drive::still(VOLTS);
    let evaluations = Cell::new(0u64);
    let start = model.at_rest(0.0);
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(rtol)
        .atol([1e-2, 1e-5, 1e-1, 1e-5, 1e-1].map(|size| rtol * size))
        .h0(1e-6)
        .rhs(|s, _, _, rates| {
            evaluations.set(evaluations.get() + 1);
            let s = state(s);
            rates.copy_from_slice(&model.rates(0.0, &s, model.modes(&s, &drive), &drive));
        })
        .init(move |_, _, s| s.copy_from_slice(&start), 5)
        .root(
            |s, _, _, gaps| {
                let s = state(s);
                for (gap, element) in gaps.iter_mut().zip(Element::TOUCHING) {
                    *gap = model.stops.overlap(element, &s);
                }
            },
            4,
        )
        .build()?;
    debug_assert_eq!(problem.eqn.rhs().nstates(), 5);
    let mut solver = problem.tsit45()?;
    solver.set_stop_time(END_S)?;
    let mut changes = Vec::new();
    loop {
        match solver.step()? {
            OdeSolverStopReason::RootFound(t_s, which) => {
                solver.state_mut_back(t_s)?;
                if which == NO {
                    changes.push(t_s);
                }
            }
            OdeSolverStopReason::TstopReached => break,
            OdeSolverStopReason::InternalTimestep => {}
        }
    }
    Ok(NoContactTimes::of_changes(&changes, evaluations.get()))
}
