//! Links to SCPI instruments against the simulated instruments: storms of faults in virtual time, commands in real time.

#[cfg(unix)]
mod commands;
mod storm;

use storm::{WAYS, alone, every_fault, storm};

/// Queries of a storm of all faults; `cargo bench --bench link_storm` sends a hundred thousand.
const TOGETHER: u64 = 600;
/// Queries of a storm of one fault.
const ALONE: u64 = 150;

#[tokio::test(start_paused = true)]
async fn no_reply_reaches_another_query_under_all_faults() {
    for (seed, way) in (1..).zip(WAYS) {
        let weather = storm(way, seed, TOGETHER, &every_fault(0.01)).await;
        assert!(weather.is_honest(), "{way:?}: {weather:#?}");
        assert!(weather.delivered > TOGETHER / 20, "{way:?}: {weather:#?}");
        assert!(weather.failures.len() >= 5, "{way:?}: {weather:#?}");
    }
}

#[tokio::test(start_paused = true)]
async fn each_fault_alone_is_survived() {
    for (seed, (way, faults)) in (1..).zip(alone(0.03)) {
        let weather = storm(way, seed, ALONE, &faults).await;
        assert!(weather.is_honest(), "{faults:?}: {weather:#?}");
        assert!(weather.delivered > ALONE / 4, "{faults:?}: {weather:#?}");
    }
}

#[tokio::test(start_paused = true)]
async fn a_calm_link_delivers_everything() {
    for way in WAYS {
        let weather = storm(way, 5, ALONE, &[]).await;
        assert_eq!(weather.delivered, weather.queries, "{way:?}: {weather:#?}");
        assert!(weather.is_honest(), "{way:?}: {weather:#?}");
        assert!(weather.failures.is_empty(), "{way:?}: {weather:#?}");
    }
}
