//! Trace files beside the history, `NAME.alarm-MILLISECONDS-LINE.trace`: makes names, and deletes by number and age.

use crate::order::folder_of;
use config::HistorySettings;
use history::with_end;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// A day, milliseconds.
const DAY_MS: i64 = 86_400_000;

/// Returns the path of the trace of `line` for an alarm at `at_ms`, milliseconds since 1970 UTC; `stem` is the path of
/// the history without its extension.
pub(crate) fn trace_path(stem: &Path, at_ms: i64, line: &str) -> PathBuf {
    with_end(stem, &format!(".alarm-{at_ms}-{line}.trace"))
}

/// Deletes the traces of all but the newest alarms, and of alarms that are too old at `now_ms`. Logs a failed deletion.
///
/// A trace dated after `now_ms` comes from before the clock was set back. It counts as older than all others, so that it
/// never displaces a new one.
pub(crate) fn tidy(stem: &Path, keep: &HistorySettings, now_ms: i64) {
    let files = trace_files(stem);
    let alarms: BTreeSet<(bool, i64)> = files
        .iter()
        .map(|(at_ms, _)| (*at_ms <= now_ms, *at_ms))
        .collect();
    let since = now_ms - DAY_MS * i64::from(keep.trace_days);
    let newest = alarms.into_iter().rev().take(keep.traces as usize);
    let kept: BTreeSet<i64> = newest
        .map(|(_, at_ms)| at_ms)
        .filter(|it| *it >= since)
        .collect();
    for (_, path) in files.iter().filter(|(at_ms, _)| !kept.contains(at_ms)) {
        if let Err(error) = fs::remove_file(path) {
            tracing::warn!("old trace {}: {error}", path.display());
        }
    }
}

/// Returns the trace files of one history, each with the time of its alarm.
fn trace_files(stem: &Path) -> Vec<(i64, PathBuf)> {
    let prefix = stem.file_name().unwrap_or_default().to_string_lossy();
    let prefix = format!("{prefix}.alarm-");
    let time = |entry: fs::DirEntry| {
        let name = entry.file_name();
        let rest = name.to_str()?.strip_prefix(&prefix)?;
        let (at_ms, _) = rest.strip_suffix(".trace")?.split_once('-')?;
        Some((at_ms.parse().ok()?, entry.path()))
    };
    let entries = fs::read_dir(folder_of(stem))
        .into_iter()
        .flatten()
        .flatten();
    entries.filter_map(time).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn traces_go_by_number_and_by_age() {
        let folder = tempfile::tempdir().unwrap();
        let stem = folder.path().join("rig");
        let keep = |traces, trace_days| HistorySettings {
            traces,
            trace_days,
            ..HistorySettings::default()
        };
        let foreign = ["other.alarm-1-motion.trace", "rig.alarm-x-motion.trace"];
        for name in foreign {
            fs::write(folder.path().join(name), "").unwrap();
        }
        for day in 0..5 {
            for line in ["measure", "motion"] {
                fs::write(trace_path(&stem, day * DAY_MS, line), "").unwrap();
            }
        }
        let left = |traces, trace_days| {
            tidy(&stem, &keep(traces, trace_days), 5 * DAY_MS);
            let mut days: Vec<i64> = trace_files(&stem).iter().map(|it| it.0 / DAY_MS).collect();
            days.sort_unstable();
            days
        };
        assert_eq!(left(4, 30), [1, 1, 2, 2, 3, 3, 4, 4]);
        assert_eq!(left(4, 3), [2, 2, 3, 3, 4, 4]);
        assert_eq!(left(1, 3), [4, 4]);
        assert!(left(9, 0).is_empty());
        assert!(foreign.iter().all(|it| folder.path().join(it).exists()));
    }
    #[test]
    fn a_clock_set_back_deletes_no_new_trace() {
        let folder = tempfile::tempdir().unwrap();
        let stem = folder.path().join("rig");
        for day in [2, 8, 9] {
            fs::write(trace_path(&stem, day * DAY_MS, "motion"), "").unwrap();
        }
        let left = |traces, day| {
            let keep = HistorySettings {
                traces,
                trace_days: 30,
                ..HistorySettings::default()
            };
            tidy(&stem, &keep, day * DAY_MS);
            let mut days: Vec<i64> = trace_files(&stem).iter().map(|it| it.0 / DAY_MS).collect();
            days.sort_unstable();
            days
        };
        assert_eq!(left(3, 2), [2, 8, 9]);
        assert_eq!(left(2, 2), [2, 9]);
        assert_eq!(left(1, 2), [2]);
    }
}
