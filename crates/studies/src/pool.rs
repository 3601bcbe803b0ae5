//! Runs work for many items on several threads, with a progress bar; the results keep the order of the items.

use app::progress::{PIECES, progress};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Number of lots that run simultaneously in a study whose figures contain no wall time.
pub const LOTS_AT_ONCE: usize = 2;

/// Returns the number of threads that this machine runs simultaneously.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Calls `work` for every item on at most `threads` threads. Begins no further item after a failure.
///
/// # Errors
/// Fails with the first failure of `work`, in the order of the items.
pub fn map<I: Sync, T: Send>(
    items: &[I],
    threads: usize,
    work: impl Fn(&I) -> anyhow::Result<T> + Sync,
) -> anyhow::Result<Vec<T>> {
    let (next, bar) = (
        AtomicUsize::new(0),
        progress(Some(items.len() as u64), PIECES),
    );
    let thread = || {
        let mut done = Vec::new();
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(place) else {
                return done;
            };
            let result = work(item);
            if result.is_err() {
                next.store(items.len(), Ordering::Relaxed);
            }
            bar.inc(1);
            done.push((place, result));
        }
    };
    let mut done: Vec<(usize, anyhow::Result<T>)> = std::thread::scope(|scope| {
        let started: Vec<_> = (0..threads.min(items.len()))
            .map(|_| scope.spawn(thread))
            .collect();
        let ended = started.into_iter().map(|it| it.join());
        ended
            .flat_map(|it| it.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    });
    bar.finish_and_clear();
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::map;

    #[test]
    fn results_keep_the_order_of_the_items() {
        let items: Vec<u64> = (0..100).collect();
        let squares = map(&items, 4, |it| Ok(it * it)).expect("squares");
        assert!(
            squares
                .iter()
                .zip(&items)
                .all(|(square, it)| *square == it * it)
        );
    }

    #[test]
    fn the_first_failure_ends_the_work() {
        let fails = |it: &u64| match it % 7 {
            6 => anyhow::bail!("item {it}"),
            _ => Ok(*it),
        };
        let error = map(&[0, 6, 13], 1, fails).expect_err("6 fails");
        assert_eq!(error.to_string(), "item 6");
    }
}
