//! The windows of a batch: where its passes begin their slow rate, by what earlier batches and passes have shown.

use super::super::device::Lesson;
use super::contacts::Events;
use chamber::lag::{Record, Transition};
use chamber::plan::{Strategy, narrowed};
use chamber::program::{Pass, Window};

/// Returns the passes of the next batch. Earlier batches have shown where the slow rate begins, except in a batch that
/// measures the lag: it looks through the whole windows again.
pub fn planned(
    strategy: &Strategy,
    lesson: Option<&Lesson>,
    [operate, reset]: [Window; 2],
) -> Vec<Pass> {
    let batch = lesson.map_or(0, |it| usize::try_from(it.batch).unwrap_or(usize::MAX));
    let knows = lesson.is_some_and(|it| it.lag.is_some());
    let all = strategy.passes(batch, knows, operate, reset);
    match lesson.filter(|_| !strategy.learns(batch, knows)) {
        Some(Lesson {
            windows: [operate, reset],
            ..
        }) => all
            .into_iter()
            .map(|it| it.entered(*operate, *reset))
            .collect(),
        None => all,
    }
}

/// Returns the operate and reset windows, narrowed to the temperatures at which the contacts last switched.
pub fn shown(record: &Record, events: &[Events], lag_s: f64, expected: [Window; 2]) -> [Window; 2] {
    let filtered = record.filtered(lag_s);
    let window = |of: &dyn Fn(&Events) -> Option<Transition>, expected: Window| {
        let last = |it: &Events| filtered.at(of(it)?.first_s).map(|at| at.celsius);
        let temperatures: Vec<f64> = events.iter().filter_map(last).collect();
        narrowed(&temperatures, expected)
    };
    let [operate, reset] = expected;
    [
        window(&|it| it.switching.operate.last().copied(), operate),
        window(&|it| it.switching.reset.last().copied(), reset),
    ]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use chamber::lag::{LAG_SPREAD, LotLag};
    use chamber::tune::{FirstOrder, Identified};

    const fn window(low_c: f64, high_c: f64) -> Window {
        Window { low_c, high_c }
    }

    const EXPECTED: [Window; 2] = [window(77.0, 93.0), window(54.0, 76.0)];

    /// Returns the last pass of the batch after this number of batches whose parts operated at 82 C and reset at 62 C.
    fn after(batch: u64) -> Pass {
        let first_order = FirstOrder {
            gain_k: 65.0,
            time_constant_s: 52.0,
            delay_s: 4.5,
        };
        let lesson = Lesson {
            batch,
            ambient_c: 23.0,
            chamber: Identified {
                gain_k: 30.6,
                time_constant_s: 21.9,
                delay_s: 7.0,
                slope_k_per_s: 0.264,
                loss_per_k: 0.0,
                fan: 0.0,
                vent_per_k: 0.008,
                first_order,
            },
            lag: Some(LotLag {
                seconds: 31.0,
                u_s: 1.0,
                spread: LAG_SPREAD,
                parts: 40,
            }),
            windows: [window(81.5, 82.5), window(61.0, 63.0)],
            scatter_k: 0.15,
        };
        *planned(&Strategy::usual(), Some(&lesson), EXPECTED)
            .last()
            .unwrap()
    }

    #[test]
    fn a_tight_batch_leaves_the_far_ends_of_the_next() {
        let pass = after(1);
        assert_eq!(
            (pass.operate, pass.reset),
            (window(81.5, 93.0), window(54.0, 63.0))
        );
    }

    #[test]
    fn a_batch_that_measures_the_lag_looks_everywhere() {
        let pass = after(5);
        assert_eq!([pass.operate, pass.reset], EXPECTED);
    }
}
