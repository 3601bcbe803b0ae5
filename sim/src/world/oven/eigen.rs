//! Eigenvalues of a symmetric five-by-five matrix by Jacobi rotations.

/// Number of rows.
pub(super) const N: usize = 5;

/// A matrix by rows.
pub(super) type Matrix = [[f64; N]; N];

/// Number of sweeps, after which only rounding is left; a matrix of this size needs six to eight.
const SWEEPS: usize = 20;

/// Returns the eigenvalues and the eigenvectors, which are the columns of the matrix.
pub(super) fn symmetric(mut a: Matrix) -> ([f64; N], Matrix) {
    let mut vectors: Matrix =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for _ in 0..SWEEPS {
        let off: f64 = (0..N)
            .map(|i| (i + 1..N).map(|j| a[i][j].abs()).sum::<f64>())
            .sum();
        if off == 0.0 {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut a, &mut vectors, p, q);
            }
        }
    }
    (std::array::from_fn(|i| a[i][i]), vectors)
}

/// Makes the entry at row `p` and column `q` zero.
fn rotate(a: &mut Matrix, vectors: &mut Matrix, p: usize, q: usize) {
    if a[p][q].abs() <= f64::MIN_POSITIVE {
        a[p][q] = 0.0;
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = 1f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for row in a.iter_mut() {
        turn(row, p, q, c, s);
    }
    let (from_p, from_q) = (a[p], a[q]);
    a[p] = std::array::from_fn(|k| c * from_p[k] - s * from_q[k]);
    a[q] = std::array::from_fn(|k| s * from_p[k] + c * from_q[k]);
    (a[p][q], a[q][p]) = (0.0, 0.0);
    for row in vectors.iter_mut() {
        turn(row, p, q, c, s);
    }
}

fn turn(row: &mut [f64; N], p: usize, q: usize, c: f64, s: f64) {
    let (from_p, from_q) = (row[p], row[q]);
    row[p] = c * from_p - s * from_q;
    row[q] = s * from_p + c * from_q;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_and_values_give_the_matrix_back() {
        let entry = |i: usize, j: usize| {
            let (high, low) = (i.max(j), i.min(j));
            ((high * 7 + low * 3) as f64).sin() * 10f64.powi(high as i32 - 2)
        };
        let a: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        let (values, vectors) = symmetric(a);
        for (i, row) in a.iter().enumerate() {
            for (j, expected) in row.iter().enumerate() {
                let sum: f64 = (0..N)
                    .map(|k| vectors[i][k] * values[k] * vectors[j][k])
                    .sum();
                assert!((sum - expected).abs() < 1e-10, "{i} {j}: {sum}");
            }
        }
    }
}
