//! Comparison of measuring methods: for each, a row of error with its seconds, and a bar in the plot.
//!
//! Seconds are the mean rig time of the method's stages over good parts. Error is the median over lots of the rms error
//! against the truth, bias the median over lots of the mean error, max the greatest error of any part.

use super::chart::Chart;
use super::error::{Pooled, unit};
use super::figure::{Bar, Figure};
use super::lot::{Lot, Part};
use super::order::Order;
use super::output::Report;
use super::variant::Variant;
use machine::dut::em_relay::Parameter;
use quality::Spread;

/// Baud rates of the comparison; the bars apply only to the first.
pub const BAUDS: [u32; 2] = [115_200, 9600];

/// A parameter and the stages of the test that measure it.
#[derive(Debug, Clone, Copy)]
pub struct TimedParameter {
    /// Parameter whose error the rows show.
    pub parameter: Parameter,
    /// Stages whose time counts for the parameter.
    pub stages: &'static [&'static str],
    /// Time that the parameter costs outside of its stages, seconds.
    pub more_s: f64,
}

impl TimedParameter {
    /// Creates a parameter whose time is that of `stages` alone.
    pub const fn of(parameter: Parameter, stages: &'static [&'static str]) -> Self {
        Self {
            parameter,
            stages,
            more_s: 0.0,
        }
    }

    /// Returns statistics of the rig time of the stages, seconds, over the good parts that ran at least one of them.
    pub fn seconds(&self, lots: &[Lot]) -> Spread {
        let time = |part: &Part| {
            let stages = self.stages.iter().filter_map(|it| part.stages.get(*it));
            let sum = stages.copied().reduce(|sum, it| sum + it);
            sum.map(|sum| sum + self.more_s)
        };
        let good = lots.iter().flat_map(Lot::good);
        Spread::of(&good.filter_map(time).collect::<Vec<f64>>())
    }

    /// Returns a row of error, with seconds as a further column.
    pub fn row(&self, name: impl Into<String>, lots: &[Lot]) -> Figure {
        let errors = Pooled::of(self.parameter, lots);
        self.row_of(name, lots, &errors)
    }

    /// Returns a row as [`Self::row`] does, but with the given errors instead of those of the parameter.
    pub fn row_of(&self, name: impl Into<String>, lots: &[Lot], errors: &Pooled) -> Figure {
        Figure::new(
            name,
            errors.n(),
            errors.median_rms(),
            unit(self.parameter.into()),
        )
        .with("bias", errors.median_bias())
        .with("max", errors.worst())
        .with("seconds", self.seconds(lots).mean())
    }

    /// Returns a row of seconds with a bar.
    pub fn time(&self, name: &str, lots: &[Lot], at_most_s: f64) -> Figure {
        let seconds = self.seconds(lots);
        Figure::new(format!("{name} time"), seconds.n(), seconds.mean(), "s")
            .with("longest", seconds.max())
            .bar(Bar::AtMost(at_most_s))
    }
}

/// Runs the lots of the order under a variant of the configuration.
///
/// # Errors
/// Fails when the configuration cannot be changed, or when a lot cannot be run.
pub fn lots(variant: &Variant, order: &Order) -> anyhow::Result<Vec<Lot>> {
    variant.of(order)?.order.run_all()
}

/// Makes the report of a study that compares methods; the chart has a bar for every row of the first `drawn` groups,
/// and lines at `marks`.
pub fn report(
    study: &'static str,
    order: &Order,
    groups: Vec<Vec<Figure>>,
    drawn: usize,
    marks: Vec<f64>,
) -> Report {
    let rows: Vec<&Figure> = groups.iter().take(drawn).flatten().collect();
    let about = order.about();
    let title = format!("rms error of a method: {about}");
    let unit = rows.first().map_or("", |row| row.unit);
    let chart = Chart::of(title, unit, marks, rows).with_axis_of_its_span();
    let about = format!("{about}, instruments without errors unless a row says so");
    Report::new(study, about, groups, chart)
}
