//! Median, mean, robust deviation and slope of samples.

/// Ratio of the standard deviation of a normal quantity to its median absolute deviation.
const SD_OF_MAD: f64 = 1.4826;

/// Returns the middle value, or the mean of the two middle ones; `None` without values.
pub fn median(all: &[f64]) -> Option<f64> {
    let mut ordered = all.to_vec();
    ordered.sort_by(f64::total_cmp);
    let upper = ordered.get(ordered.len() / 2)?;
    let lower = ordered.get((ordered.len() - 1) / 2)?;
    Some((lower + upper) / 2.0)
}

/// Returns the mean of values; NaN without values.
pub fn mean<'a>(all: impl IntoIterator<Item = &'a f64, IntoIter: ExactSizeIterator>) -> f64 {
    let all = all.into_iter();
    let count = all.len() as f64;
    all.sum::<f64>() / count
}

/// Returns the median of values, and their standard deviation by the median of the deviations from it, which a few wild
/// values do not move; `None` without values.
pub fn robust(all: &[f64]) -> Option<(f64, f64)> {
    let middle = median(all)?;
    let off: Vec<f64> = all.iter().map(|it| (it - middle).abs()).collect();
    Some((middle, SD_OF_MAD * median(&off)?))
}

/// Returns the least-squares slope of samples one second apart, per second; NaN for fewer than two.
pub fn slope<'a>(all: impl IntoIterator<Item = &'a f64, IntoIter: ExactSizeIterator>) -> f64 {
    let all = all.into_iter();
    let middle = (all.len() as f64 - 1.0) / 2.0;
    let (over, under) = all
        .enumerate()
        .fold((0.0, 0.0), |(over, under), (place, it)| {
            let off = place as f64 - middle;
            (over + off * it, under + off * off)
        });
    over / under
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between_two() {
        assert_eq!(median(&[4.0, 1.0, 3.0]), Some(3.0));
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), Some(2.5));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn the_slope_of_a_line_is_its_rise_per_second() {
        assert!((slope(&[5.0, 7.0, 9.0]) - 2.0).abs() < 1e-12);
        assert!(slope(&[1.0, 0.0, 0.0, 1.0]).abs() < 1e-12);
    }
}
