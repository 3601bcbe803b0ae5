//! Gauge repeatability and reproducibility by analysis of variance with interaction.
//!
//! In a crossed study every operator measures every part the same number of times, at least twice. The analysis splits
//! the sum of squares among parts, operators, their interaction and the residual. When the F test of the interaction
//! gives p > 0.25, the analysis pools the interaction with the residual. Negative components of variance count as zero.
//! All results are standard deviations.

use super::crossing;
use super::squares::{Sizes, Squares};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use utoipa::ToSchema;

/// Value of p above which the interaction counts as chance (AIAG MSA, 4th edition, appendix on ANOVA).
const POOL_ABOVE: f64 = 0.25;

/// Factor that turns the ratio of part to gauge deviation into the number of distinct categories (AIAG: 1.41).
const CATEGORIES: f64 = 1.41;

/// One reading of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Identifier of the part.
    pub part: String,
    /// Operator, or rig, that measured.
    pub operator: String,
    /// Identifier of the repetition.
    pub trial: String,
    /// Measured value; must be finite.
    pub value: f64,
}

/// Standard deviation of each source of variation, in the unit of the readings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
pub struct GaugeRr {
    /// `anova`, or `average and range`.
    pub method: &'static str,
    /// Variation of repeated readings by the same operator on the same part.
    pub repeatability: f64,
    /// Variation between operators.
    pub reproducibility: f64,
    /// Interaction: variation between operators that depends on the part; 0 when it is pooled with the residual.
    pub interaction: f64,
    /// Repeatability and reproducibility with interaction, combined: the variation of the gauge.
    pub grr: f64,
    /// Variation between parts.
    pub part: f64,
    /// Variation of gauge and parts combined.
    pub total: f64,
    /// `grr` in per cent of `total`; `None` when nothing varies.
    pub pct_grr: Option<f64>,
    /// Number of distinct categories of parts that the gauge can tell apart, at least 1; `None` without gauge
    /// variation.
    pub ndc: Option<u64>,
    /// p of the F test of the interaction; `None` with one operator.
    pub interaction_p: Option<f64>,
}

/// Reason why a study cannot be evaluated.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GaugeRrError {
    /// The study has fewer than two parts or two trials, or no operator.
    #[error(
        "found {parts} parts, {operators} operators, {trials} trials; expected 2 parts, 1 operator and 2 trials at least"
    )]
    TooSmall {
        /// Number of parts found.
        parts: usize,
        /// Number of operators found.
        operators: usize,
        /// Number of trials found.
        trials: usize,
    },
    /// The study is larger than AIAG's tables of factors for averages and ranges.
    #[error(
        "found {parts} parts, {operators} operators, {trials} trials; averages and ranges have factors for up to 10, 3 and 3 (use anova for more)"
    )]
    NoFactors {
        /// Number of parts found.
        parts: usize,
        /// Number of operators found.
        operators: usize,
        /// Number of trials found.
        trials: usize,
    },
    /// A combination of part, operator and trial has no reading.
    #[error(
        "part {part:?}, operator {operator:?} has no trial {trial:?}: the study must be complete"
    )]
    Missing {
        /// Identifier of the part.
        part: String,
        /// Identifier of the operator.
        operator: String,
        /// Identifier of the trial.
        trial: String,
    },
    /// A combination of part, operator and trial has two readings.
    #[error("part {part:?}, operator {operator:?} has trial {trial:?} twice")]
    Twice {
        /// Identifier of the part.
        part: String,
        /// Identifier of the operator.
        operator: String,
        /// Identifier of the trial.
        trial: String,
    },
    /// A reading is not finite, or so large that its square is not finite.
    #[error("part {part:?}, operator {operator:?}, trial {trial:?}: expected a number below 1e150")]
    TooLarge {
        /// Identifier of the part.
        part: String,
        /// Identifier of the operator.
        operator: String,
        /// Identifier of the trial.
        trial: String,
    },
}

/// Evaluates a complete crossed study by analysis of variance.
pub fn anova(readings: &[Reading]) -> Result<GaugeRr, GaugeRrError> {
    let cells = crossing::cells(readings)?;
    let sizes = Sizes::of(&cells);
    let squares = Squares::of(&cells, &sizes);
    Ok(components(&sizes, &squares))
}

fn components(sizes: &Sizes, squares: &Squares) -> GaugeRr {
    let Sizes {
        parts,
        operators,
        trials,
    } = *sizes;
    let denominators = Denominators::of(sizes, squares);
    let above = |mean_square: f64, each: f64| ((mean_square - denominators.main) / each).max(0.0);
    let reproducibility = if operators > 1.0 {
        above(squares.operators / (operators - 1.0), parts * trials)
    } else {
        0.0
    };
    let interaction = ((denominators.main - denominators.error) / trials).max(0.0);
    let part = above(squares.parts / (parts - 1.0), operators * trials);
    deviations(
        "anova",
        [denominators.error, reproducibility, interaction, part],
        denominators.interaction_p,
    )
}

/// Mean squares that the F tests divide by.
struct Denominators {
    /// For parts and operators: mean square of the interaction, or of the pooled residual.
    main: f64,
    /// For the interaction: mean square of the residual, or of the pooled residual.
    error: f64,
    /// p of the F test of the interaction; `None` with one operator.
    interaction_p: Option<f64>,
}

impl Denominators {
    fn of(sizes: &Sizes, squares: &Squares) -> Self {
        let crossed = (sizes.parts - 1.0) * (sizes.operators - 1.0);
        let repeats = sizes.parts * sizes.operators * (sizes.trials - 1.0);
        let (main, error) = (squares.interaction / crossed, squares.repeats / repeats);
        let interaction_p = (crossed > 0.0).then(|| {
            let f = if main > 0.0 { main / error } else { 0.0 };
            upper_tail(f, crossed, repeats)
        });
        if interaction_p.is_some_and(|p| p <= POOL_ABOVE) {
            return Self {
                main,
                error,
                interaction_p,
            };
        }
        let pooled = (squares.interaction + squares.repeats) / (crossed + repeats);
        Self {
            main: pooled,
            error: pooled,
            interaction_p,
        }
    }
}

/// Returns the probability that F with these degrees of freedom exceeds `f`; 0 for an infinite `f`, which results when
/// all repetitions agree.
fn upper_tail(f: f64, above: f64, below: f64) -> f64 {
    if f.is_infinite() {
        return 0.0;
    }
    FisherSnedecor::new(above, below).map_or(1.0, |law| law.sf(f))
}

/// Converts variances into the standard deviations of the result.
pub(super) fn deviations(
    method: &'static str,
    [repeatability, reproducibility, interaction, part]: [f64; 4],
    interaction_p: Option<f64>,
) -> GaugeRr {
    let grr = repeatability + reproducibility + interaction;
    let total = (grr + part).sqrt();
    let (grr, part) = (grr.sqrt(), part.sqrt());
    GaugeRr {
        method,
        repeatability: repeatability.sqrt(),
        reproducibility: reproducibility.sqrt(),
        interaction: interaction.sqrt(),
        grr,
        part,
        total,
        pct_grr: (total > 0.0).then(|| 100.0 * grr / total),
        ndc: (grr > 0.0).then(|| ((CATEGORIES * part / grr).floor() as u64).max(1)),
        interaction_p,
    }
}

#[cfg(test)]
#[path = "gauge_rr_tests.rs"]
mod tests;
