//! The filter as command line options.

use crate::history::{Filter, LimitsSeen, Moment};
use crate::quality::Limits;
use clap::Args;

/// Which runs.
#[derive(Debug, Args)]
pub(super) struct RunArgs {
    /// Only this lot
    #[arg(long, value_name = "LOT")]
    pub lot: Option<String>,
    /// Only this run of the lot (1, 2, ...)
    #[arg(long, value_name = "N")]
    pub run: Option<u32>,
    /// Only this recipe
    #[arg(long, value_name = "NAME")]
    pub recipe: Option<String>,
}

/// Which parts of them.
#[derive(Debug, Args)]
pub(super) struct PartArgs {
    #[command(flatten)]
    pub runs: RunArgs,
    /// Judged at this time or later (RFC 3339)
    #[arg(long, value_name = "TIME")]
    pub since: Option<Moment>,
    /// Judged before this time (RFC 3339)
    #[arg(long, value_name = "TIME")]
    pub until: Option<Moment>,
    /// Only this verdict
    #[arg(long, value_parser = ["pass", "fail", "void", "unjudged"])]
    pub verdict: Option<String>,
    /// Only parts for this bin
    #[arg(long)]
    pub bin: Option<String>,
    /// Production parts, golden parts, or both
    #[arg(long, value_parser = ["lot", "golden", "all"], default_value = "lot")]
    pub kind: String,
    /// Only parts between a good golden check and one that failed
    #[arg(long)]
    pub suspect: bool,
    /// At most so many parts, the first ones in order of judgement
    #[arg(long, value_name = "N")]
    pub limit: Option<u64>,
}

/// A range of values of one parameter.
#[derive(Debug, Args)]
pub(super) struct RangeArgs {
    /// Only parts with a judged value of this parameter
    #[arg(long, value_name = "KEY")]
    pub param: Option<String>,
    /// Least value of the parameter
    #[arg(long, value_name = "X", requires = "param", allow_hyphen_values = true)]
    pub min: Option<f64>,
    /// Greatest value of the parameter
    #[arg(long, value_name = "X", requires = "param", allow_hyphen_values = true)]
    pub max: Option<f64>,
}

impl RunArgs {
    pub fn filter(&self) -> Filter {
        Filter {
            lot: self.lot.clone(),
            run: self.run,
            recipe: self.recipe.clone(),
            ..Filter::default()
        }
    }
}

impl PartArgs {
    pub fn filter(&self) -> Filter {
        Filter {
            since: self.since,
            until: self.until,
            verdict: self.verdict.clone(),
            bin: self.bin.clone(),
            kind: Some(self.kind.clone()),
            suspect: self.suspect,
            limit: self.limit,
            ..self.runs.filter()
        }
    }

    /// With a range; refuses one that nothing can lie in.
    pub fn within(&self, range: &RangeArgs) -> anyhow::Result<Filter> {
        for (option, value) in [("--min", range.min), ("--max", range.max)] {
            if let Some(value) = value.filter(|it| !it.is_finite()) {
                anyhow::bail!("{option}: found {value}, expected a finite number");
            }
        }
        if let (Some(min), Some(max)) = (range.min, range.max)
            && min > max
        {
            anyhow::bail!("--min {min} is above --max {max}");
        }
        let param = range.param.clone();
        Ok(Filter {
            param,
            min: range.min,
            max: range.max,
            ..self.filter()
        })
    }
}

/// The limits that all runs agree on; none when they differ, for then a capability means nothing.
pub(super) fn limits_seen(seen: LimitsSeen) -> Limits {
    match seen {
        LimitsSeen::Same { low, high } => Limits { low, high },
        LimitsSeen::None | LimitsSeen::Differ => Limits::default(),
    }
}

/// Refuses a parameter that the history has never seen.
pub(super) fn known_parameter(known: &[String], param: &str) -> anyhow::Result<()> {
    if known.iter().any(|it| it == param) {
        return Ok(());
    }
    anyhow::bail!(
        "--param: found {param:?}, expected one of {}",
        known.join(", ")
    )
}
