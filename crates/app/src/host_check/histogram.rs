//! Draws the waits of a phase as bars of text, on a logarithmic scale.

use machine::view::LatenessView;

/// Length of the longest bar, characters.
const WIDTH: f64 = 40.0;

/// Returns a line for each class from the first to the last that holds a wait: upper edge, bar, count. The bar of one
/// wait is one character long. A last line counts the waits beyond the greatest class.
pub fn bars(lateness: &LatenessView) -> Vec<String> {
    let counts: Vec<u64> = lateness.buckets.iter().map(|it| it.count).collect();
    let most = counts.iter().copied().max().unwrap_or(0);
    let first = counts.iter().position(|count| *count > 0).unwrap_or(0);
    let end = counts
        .iter()
        .rposition(|count| *count > 0)
        .map_or(0, |at| at + 1);
    let row = |edge: &str, count| format!("{edge:>12} ms {:<40} {count:>8}", bar(count, most));
    let inside = lateness.buckets[..end].iter().skip(first);
    let mut rows: Vec<String> = inside
        .map(|it| row(&format!("<= {:.3}", it.up_to_ms), it.count))
        .collect();
    let beyond = lateness.waits.saturating_sub(counts.iter().sum());
    if let Some(last) = lateness.buckets.last().filter(|_| beyond > 0) {
        rows.push(row(&format!("> {:.3}", last.up_to_ms), beyond));
    }
    rows
}

fn bar(count: u64, most: u64) -> String {
    let length = match (count, most) {
        (0, _) => 0.0,
        (1, _) => 1.0,
        (_, _) => 1.0 + (WIDTH - 1.0) * (count as f64).ln() / (most.max(count) as f64).ln(),
    };
    "#".repeat(length.round() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use machine::view::Bucket;

    fn view(counts: &[u64], waits: u64) -> LatenessView {
        let edges = (0..).map(|octave| 0.064 * f64::from(1 << octave));
        let bucket = |(up_to_ms, count): (f64, &u64)| Bucket {
            up_to_ms,
            count: *count,
        };
        LatenessView {
            waits,
            buckets: edges.zip(counts).map(bucket).collect(),
            ..LatenessView::default()
        }
    }

    #[test]
    fn bars_are_logarithmic() {
        let table = [(0, 0), (1, 1), (10, 14), (100, 27), (1_000, 40)];
        for (count, length) in table {
            assert_eq!(bar(count, 1_000).len(), length, "{count}");
        }
        assert_eq!(bar(1, 1).len(), 1);
    }

    #[test]
    fn only_classes_between_first_and_last_are_shown() {
        let rows = bars(&view(&[0, 100, 0, 1, 0, 0], 101));
        let shown: Vec<Vec<&str>> = rows
            .iter()
            .map(|row| row.split_whitespace().collect())
            .collect();
        let longest = "#".repeat(40);
        let expected: [&[&str]; 3] = [
            &["<=", "0.128", "ms", &longest, "100"],
            &["<=", "0.256", "ms", "0"],
            &["<=", "0.512", "ms", "#", "1"],
        ];
        assert_eq!(shown, expected);
    }

    #[test]
    fn waits_beyond_the_last_class_have_a_row() {
        let rows = bars(&view(&[5, 0], 7));
        assert_eq!(rows.len(), 2, "{rows:?}");
        assert!(rows[1].contains("> 0.128 ms ####"), "{rows:?}");
        assert!(bars(&LatenessView::default()).is_empty());
    }
}
