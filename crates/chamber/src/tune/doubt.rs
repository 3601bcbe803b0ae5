//! Standard uncertainties of fitted figures, from the curvature of the misfit at its minimum and from the residuals.

/// Step of a figure for its derivative, as a share of the figure.
const STEP: f64 = 1e-3;
/// Least step; a share of a figure of zero would be no step.
const LEAST_STEP: f64 = 1e-4;

/// Returns the standard uncertainties of the figures of a model that was fitted to a response, one sample a second.
///
/// Where the shape of the model is not that of the chamber, the residuals of neighbouring seconds are alike: the
/// response holds fewer independent samples than seconds, and the uncertainties grow accordingly.
pub fn standard<const N: usize>(
    response: &[f64],
    figures: &[f64; N],
    model: impl Fn(&[f64; N], f64) -> f64,
) -> [f64; N] {
    let residuals: Vec<f64> = (response.iter().enumerate())
        .map(|(second, found)| found - model(figures, second as f64))
        .collect();
    let mut information = [[0.0; N]; N];
    for second in 0..response.len() {
        let row = gradient(figures, |it| model(it, second as f64));
        for (i, line) in information.iter_mut().enumerate() {
            for (j, cell) in line.iter_mut().enumerate() {
                *cell += row[i] * row[j];
            }
        }
    }
    let squares: f64 = residuals.iter().map(|it| it * it).sum();
    let freedom = residuals.len().saturating_sub(N).max(1) as f64;
    let scale = squares / freedom * alike(&residuals);
    diagonal_of_inverse(information).map(|it| (it * scale).sqrt())
}

/// Returns the partial derivatives of a value with respect to the figures.
fn gradient<const N: usize>(figures: &[f64; N], value: impl Fn(&[f64; N]) -> f64) -> [f64; N] {
    std::array::from_fn(|which| {
        let step = (STEP * figures[which].abs()).max(LEAST_STEP);
        let moved = |by: f64| {
            let mut moved = *figures;
            moved[which] += by;
            value(&moved)
        };
        (moved(step) - moved(-step)) / (2.0 * step)
    })
}

/// Returns the factor by which the correlation of neighbouring residuals reduces the number of independent samples, at
/// least 1.
fn alike(residuals: &[f64]) -> f64 {
    let squares: f64 = residuals.iter().map(|it| it * it).sum();
    let pairs: f64 = residuals.windows(2).map(|it| it[0] * it[1]).sum();
    let correlation = if squares > 0.0 { pairs / squares } else { 0.0 };
    let correlation = correlation.clamp(0.0, 0.99);
    (1.0 + correlation) / (1.0 - correlation)
}

/// Returns the diagonal of the inverse of a symmetric matrix by elimination; infinite where the matrix is singular.
fn diagonal_of_inverse<const N: usize>(mut rows: [[f64; N]; N]) -> [f64; N] {
    let mut inverse: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    for pivot in 0..N {
        let value = rows[pivot][pivot];
        if value.abs() < 1e-12 {
            return [f64::INFINITY; N];
        }
        let (row, mirror) = (rows[pivot], inverse[pivot]);
        for line in 0..N {
            let share = match line == pivot {
                true => 1.0 - 1.0 / value,
                false => rows[line][pivot] / value,
            };
            for column in 0..N {
                rows[line][column] -= share * row[column];
                inverse[line][column] -= share * mirror[column];
            }
        }
    }
    std::array::from_fn(|it| inverse[it][it])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line with noise of 0.1 that alternates in a pattern of four.
    fn noisy(samples: usize) -> Vec<f64> {
        let noise = [0.1, -0.1, -0.1, 0.1];
        (0..samples)
            .map(|it| 2.0 + 0.5 * it as f64 + noise[it % 4])
            .collect()
    }

    #[test]
    fn a_line_has_the_uncertainties_of_the_textbook() {
        let samples = 100;
        let found = standard(&noisy(samples), &[2.0, 0.5], |it, t| it[0] + it[1] * t);
        let n = samples as f64;
        let slope = 0.1 / (n * (n * n - 1.0) / 12.0_f64).sqrt();
        let start = 0.1 * ((2.0 * (2.0 * n - 1.0)) / (n * (n + 1.0))).sqrt();
        assert!((found[1] / slope - 1.0).abs() < 0.03, "{found:?} {slope}");
        assert!((found[0] / start - 1.0).abs() < 0.03, "{found:?} {start}");
    }

    #[test]
    fn residuals_that_drift_count_as_fewer_samples() {
        let wave: Vec<f64> = (0..200).map(|it| (f64::from(it) / 20.0).sin()).collect();
        let [drifting] = standard(&wave, &[0.0], |it, _| it[0]);
        assert!(drifting > 0.3, "{drifting}");
    }

    #[test]
    fn a_figure_without_effect_has_no_bound() {
        let found = standard(&noisy(20), &[2.0, 0.5], |it, t| it[0] + 0.5 * t);
        assert!(!found[1].is_finite(), "{found:?}");
    }
}
