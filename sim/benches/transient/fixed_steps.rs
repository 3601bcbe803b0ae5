//! Methods with a fixed step: forces follow the sign of the gap, events come from linear interpolation.

use super::{END_S, NoContactTimes, VOLTS};
use rigsim::world::relay::lumped::{Drive, LAMBDA, Model, State, V, W, X, Y};

fn rates(model: &Model, s: &State) -> State {
    let drive = Drive::still(VOLTS);
    model.rates(0.0, s, model.modes(s, &drive), &drive)
}

fn run(model: &Model, h: f64, per_step: u64, step: impl Fn(&State) -> State) -> NoContactTimes {
    let (mut s, mut changes) = (model.at_rest(0.0), Vec::new());
    let steps = (END_S / h).round() as u64;
    for i in 0..steps {
        let next = step(&s);
        let (from, to) = (s[Y] - model.stops.no, next[Y] - model.stops.no);
        if (from > 0.0) != (to > 0.0) {
            changes.push(h * (i as f64 + from / (from - to)));
        }
        s = next;
    }
    NoContactTimes::of_changes(&changes, steps * per_step)
}

/// Integrates with the classical Runge-Kutta method of order 4.
pub fn runge_kutta(model: &Model, h: f64) -> NoContactTimes {
    run(model, h, 4, |s| {
        let along = |k: &State, part: f64| std::array::from_fn(|i| s[i] + part * h * k[i]);
        let k1 = rates(model, s);
        let k2 = rates(model, &along(&k1, 0.5));
        let k3 = rates(model, &along(&k2, 0.5));
        let k4 = rates(model, &along(&k3, 1.0));
        std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    })
}

/// Integrates speeds first, then positions with the new speeds.
pub fn semi_implicit_euler(model: &Model, h: f64) -> NoContactTimes {
    run(model, h, 1, |s| {
        let k = rates(model, s);
        let mut next = *s;
        next[V] += h * k[V];
        next[W] += h * k[W];
        next[LAMBDA] += h * k[LAMBDA];
        next[X] += h * next[V];
        next[Y] += h * next[W];
        next
    })
}
