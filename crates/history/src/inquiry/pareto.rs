//! Ranks the reasons of rejects, and the alarms: the most frequent first.

use super::{Result, checks};
use crate::{Alarm, Archive, Filter, Part};
use machine::dut::Reason;
use machine::dut::reason::Code;
use machine::station::catalogue::AlarmCode;
use serde::Serialize;
use std::collections::BTreeMap;
use texts::Lang;
use utoipa::ToSchema;

/// Verdicts of rejects.
const REJECTED: [&str; 2] = ["fail", "void"];

/// A reason or an alarm, with its count.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Ranked {
    /// Name in English.
    pub en: String,
    /// Name in Chinese.
    pub zh: String,
    /// Number of parts with this reason, or of occurrences of this alarm.
    pub n: u64,
    /// Share of all counts from the first entry to this one, 0 to 1.
    pub cumulative: f64,
    /// Time for which the alarms were active, s; `None` for a reason.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub active_s: Option<f64>,
}

/// Rejects of the selected parts.
#[derive(Debug, Clone, PartialEq, Default, Serialize, ToSchema)]
pub struct Rejects {
    /// Reasons, the most frequent first. A part with several reasons counts for each.
    pub reasons: Vec<Ranked>,
    /// Number of rejects.
    pub rejects: u64,
    /// Number of selected parts.
    pub parts: u64,
    /// The first rejects, in order of judgement.
    #[serde(skip)]
    pub first: Vec<Part>,
}

/// Returns the rejects that the filter selects; `first` holds at most `listed` of them.
pub fn rejects(archive: &Archive, filter: &Filter, listed: usize) -> Result<Rejects> {
    checks::known_runs(archive, filter)?;
    let mut counts = BTreeMap::<[String; 2], (u64, Option<f64>)>::new();
    let mut first: Vec<Part> = Vec::new();
    let mut rejects = 0;
    for verdict in REJECTED {
        let verdict = Some(verdict.to_owned());
        let filter = Filter {
            verdict,
            ..filter.clone()
        };
        let mut kept = 0;
        archive.each(&filter, |part| {
            rejects += 1;
            let mut names: Vec<_> = part.reason_codes.iter().map(names).collect();
            names.sort();
            names.dedup();
            for name in names {
                counts.entry(name).or_default().0 += 1;
            }
            if kept < listed {
                kept += 1;
                first.push(part);
            }
            Ok::<(), super::InquiryError>(())
        })??;
    }
    first.sort_by_key(|part| part.time);
    first.truncate(listed);
    assert!(first.len() as u64 <= rejects, "a reject listed twice");
    Ok(Rejects {
        reasons: ranked(counts),
        rejects,
        parts: archive.count_parts(filter)?,
        first,
    })
}

/// Counts the alarms that the filter selects, per code; see [`by_code`].
pub fn alarms(archive: &Archive, filter: &Filter) -> Result<Vec<Ranked>> {
    checks::known_runs(archive, filter)?;
    Ok(by_code(&archive.alarms(filter)?))
}

/// Counts alarms per code, the most frequent first. An alarm that has not been cleared adds no active time.
pub fn by_code(alarms: &[Alarm]) -> Vec<Ranked> {
    let mut counts = BTreeMap::<[String; 2], (u64, Option<f64>)>::new();
    for alarm in alarms {
        let known = AlarmCode::from_name(&alarm.code);
        let cause = |lang| match known {
            Some(code) => format!("{}: {}", alarm.code, code.help(lang)[0]),
            None => alarm.code.clone(),
        };
        let count = counts.entry([Lang::En, Lang::Zh].map(cause)).or_default();
        count.0 += 1;
        let cleared = alarm.cleared.unwrap_or(alarm.raised);
        let active_s = (cleared.0 - alarm.raised.0) as f64 / 1e6;
        *count.1.get_or_insert(0.0) += active_s;
    }
    ranked(counts)
}

/// Returns the names of a reason, without the figures that differ from part to part.
pub fn names(reason: &Reason) -> [String; 2] {
    let detail = match reason.code {
        Code::Interrupted | Code::Unclassified => reason.detail.clone(),
        Code::OutsideLimit(_)
        | Code::NotProven(_)
        | Code::NotMeasured(_)
        | Code::RigTrouble
        | Code::Serial(_)
        | Code::Finding(_) => String::new(),
    };
    let reason = Reason {
        detail,
        ..reason.clone()
    };
    [Lang::En, Lang::Zh].map(|lang| reason.short(lang))
}

/// Ranks entries by their counts. A key is the English and the Chinese name; a value is the count, and for an alarm
/// the time for which it was active, s.
pub fn ranked(counts: BTreeMap<[String; 2], (u64, Option<f64>)>) -> Vec<Ranked> {
    let all: u64 = counts.values().map(|(n, _)| n).sum();
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, (n, _))| std::cmp::Reverse(*n));
    let mut so_far = 0;
    let entries = counts.into_iter().map(|([en, zh], (n, active_s))| {
        so_far += n;
        Ranked {
            en,
            zh,
            n,
            cumulative: so_far as f64 / all as f64,
            active_s,
        }
    });
    entries.collect()
}
