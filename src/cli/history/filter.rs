//! The filter as command line options.

use clap::Args;
use history::inquiry::{self, checks};
use history::{Filter, Moment};

/// Selects runs.
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

/// Selects parts of the runs.
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
    #[arg(long, value_parser = checks::VERDICTS)]
    pub verdict: Option<String>,
    /// Only parts for this bin
    #[arg(long)]
    pub bin: Option<String>,
    /// Production parts, reference parts (golden), or both
    #[arg(long, value_parser = checks::KINDS, default_value = "lot")]
    pub kind: String,
    /// Only parts between a passed and a failed reference check
    #[arg(long)]
    pub suspect: bool,
    /// At most N parts, the first in order of judgement
    #[arg(long, value_name = "N")]
    pub limit: Option<u64>,
    /// Skip N parts first
    #[arg(long, value_name = "N")]
    pub offset: Option<u64>,
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
            offset: self.offset,
            ..self.runs.filter()
        }
    }

    /// Returns the filter with a range; refuses an empty range.
    pub fn within(&self, range: &RangeArgs) -> inquiry::Result<Filter> {
        let filter = Filter {
            param: range.param.clone(),
            min: range.min,
            max: range.max,
            ..self.filter()
        };
        checks::validate(&filter)?;
        Ok(filter)
    }
}
