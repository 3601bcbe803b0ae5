//! Linear least squares with a few unknowns, by the normal equations.

/// Sums of the normal equations of `N` unknowns.
#[derive(Debug, Clone)]
pub struct Sums<const N: usize> {
    matrix: [[f64; N]; N],
    right: [f64; N],
    squares: f64,
    count: usize,
}

/// Solution with the standard deviation of the residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution<const N: usize> {
    /// Values of the unknowns.
    pub of: [f64; N],
    /// Standard deviation of the residuals, in the unit of the values.
    pub residual: f64,
    /// Standard uncertainty of each unknown, when the residuals are independent.
    pub u: [f64; N],
}

impl<const N: usize> Default for Sums<N> {
    fn default() -> Self {
        Self {
            matrix: [[0.0; N]; N],
            right: [0.0; N],
            squares: 0.0,
            count: 0,
        }
    }
}

impl<const N: usize> Sums<N> {
    /// Adds an equation: the sum of unknowns times `factors` is `value`.
    pub fn add(&mut self, factors: [f64; N], value: f64) {
        for (row, factor) in factors.iter().enumerate() {
            for (column, other) in factors.iter().enumerate().skip(row) {
                self.matrix[row][column] += factor * other;
            }
            self.right[row] += factor * value;
        }
        self.squares += value * value;
        self.count += 1;
    }

    /// Returns the number of equations.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Solves the equations; `None` when there are fewer than two for each unknown, or when an unknown remains open.
    pub fn solve(&self) -> Option<Solution<N>> {
        if self.count < 2 * N {
            return None;
        }
        let upper = |row: usize, column: usize| self.matrix[row.min(column)][row.max(column)];
        let matrix = std::array::from_fn(|row| std::array::from_fn(|column| upper(row, column)));
        let inverse = inverted(matrix)?;
        let of: [f64; N] = std::array::from_fn(|row| dot(&inverse[row], &self.right));
        let left = (self.squares - dot(&of, &self.right)).max(0.0);
        let residual = (left / (self.count - N) as f64).sqrt();
        let u = std::array::from_fn(|row| residual * inverse[row][row].max(0.0).sqrt());
        let is_finite = of.iter().all(|it| it.is_finite());
        is_finite.then_some(Solution { of, residual, u })
    }
}

fn dot<const N: usize>(one: &[f64; N], other: &[f64; N]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}

/// Inverts a symmetric positive matrix by Gauss-Jordan elimination; `None` when it is singular.
fn inverted<const N: usize>(mut matrix: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    const LEAST: f64 = 1e-12;
    let mut inverse = [[0.0; N]; N];
    let diagonal: [f64; N] = std::array::from_fn(|it| matrix[it][it]);
    for (row, line) in inverse.iter_mut().enumerate() {
        line[row] = 1.0;
    }
    for pivot in 0..N {
        let by = matrix[pivot][pivot];
        if by.is_nan() || by <= LEAST * diagonal[pivot] {
            return None;
        }
        for column in 0..N {
            matrix[pivot][column] /= by;
            inverse[pivot][column] /= by;
        }
        let (own, own_inverse) = (matrix[pivot], inverse[pivot]);
        for row in (0..N).filter(|row| *row != pivot) {
            let by = matrix[row][pivot];
            for column in 0..N {
                matrix[row][column] -= by * own[column];
                inverse[row][column] -= by * own_inverse[column];
            }
        }
    }
    Some(inverse)
}
