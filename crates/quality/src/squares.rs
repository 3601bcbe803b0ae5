//! Sums of squares of a crossed study.
//!
//! Means are subtracted before squaring, so no digits are lost when readings differ only in their last places.

use super::crossing::Cells;

/// Numbers of parts, operators and trials.
pub(super) struct Sizes {
    pub parts: f64,
    pub operators: f64,
    pub trials: f64,
}

impl Sizes {
    pub fn of(cells: &Cells) -> Self {
        let operators = cells.first().map_or(0, Vec::len);
        let trials = cells
            .first()
            .and_then(|row| row.first())
            .map_or(0, Vec::len);
        Self {
            parts: cells.len() as f64,
            operators: operators as f64,
            trials: trials as f64,
        }
    }
}

/// Sum of squares of each source of variation.
pub(super) struct Squares {
    pub parts: f64,
    pub operators: f64,
    pub interaction: f64,
    pub repeats: f64,
}

impl Squares {
    pub fn of(cells: &Cells, sizes: &Sizes) -> Self {
        let means = Means::of(cells);
        let from_grand = |of: &[f64]| of.iter().map(|it| square(it - means.grand)).sum::<f64>();
        let (mut interaction, mut repeats) = (0.0, 0.0);
        for ((row, cells_of), part) in cells.iter().zip(&means.cell).zip(&means.part) {
            for ((readings, mean), operator) in row.iter().zip(cells_of).zip(&means.operator) {
                interaction += square(mean - part - operator + means.grand);
                repeats += readings.iter().map(|it| square(it - mean)).sum::<f64>();
            }
        }
        Self {
            parts: from_grand(&means.part) * sizes.operators * sizes.trials,
            operators: from_grand(&means.operator) * sizes.parts * sizes.trials,
            interaction: interaction * sizes.trials,
            repeats,
        }
    }
}

/// Means over all readings, and by part, operator and cell.
pub(super) struct Means {
    cell: Vec<Vec<f64>>,
    pub part: Vec<f64>,
    pub operator: Vec<f64>,
    grand: f64,
}

impl Means {
    pub fn of(cells: &Cells) -> Self {
        let of_row = |row: &Vec<Vec<f64>>| row.iter().map(|cell| mean(cell)).collect();
        let cell: Vec<Vec<f64>> = cells.iter().map(of_row).collect();
        let part: Vec<f64> = cell.iter().map(|row| mean(row)).collect();
        let operators = cell.first().map_or(0, Vec::len);
        let column = |n: usize| cell.iter().map(|row| row[n]).collect::<Vec<f64>>();
        let operator = (0..operators).map(|n| mean(&column(n))).collect();
        Self {
            grand: mean(&part),
            cell,
            part,
            operator,
        }
    }
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn square(it: f64) -> f64 {
    it * it
}
