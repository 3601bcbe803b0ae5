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

/// Selects a span of time.
#[derive(Debug, Args)]
pub(super) struct SpanArgs {
    /// At this time or later (2026-11-22, today, -8h, RFC 3339)
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub since: Option<Moment>,
    /// Before this time (2026-11-22, today, -8h, RFC 3339)
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub until: Option<Moment>,
}

/// Selects parts of the runs.
#[derive(Debug, Args)]
pub(super) struct PartArgs {
    #[command(flatten)]
    pub runs: RunArgs,
    #[command(flatten)]
    pub span: SpanArgs,
    /// Only this verdict
    #[arg(long, value_parser = checks::VERDICTS)]
    pub verdict: Option<String>,
    /// Only parts for this bin
    #[arg(long)]
    pub bin: Option<String>,
    /// Only parts with this serial number
    #[arg(long, value_name = "SERIAL")]
    pub serial: Option<String>,
    /// Production parts, reference parts (golden), or both
    #[arg(long, value_parser = checks::KINDS, default_value = "lot")]
    pub kind: String,
    /// Only suspect parts: judged between a failed reference check and the reference check before it
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
    /// Only parts whose last attempt at this parameter gave a number and is not void
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

impl SpanArgs {
    /// Returns `filter`, restricted to this span.
    pub fn within(&self, filter: Filter) -> Filter {
        Filter {
            since: self.since,
            until: self.until,
            ..filter
        }
    }
}

impl PartArgs {
    pub fn filter(&self) -> Filter {
        Filter {
            verdict: self.verdict.clone(),
            bin: self.bin.clone(),
            serial: self.serial.clone(),
            kind: Some(self.kind.clone()),
            suspect: self.suspect,
            limit: self.limit,
            offset: self.offset,
            ..self.span.within(self.runs.filter())
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
