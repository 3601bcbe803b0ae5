//! A picture drawn from the figures of a run.

use super::plan::Plot;
use super::result::Row;
use crate::scatter::{Point, Scatter};

/// Draws the picture as an SVG file; `None` when no figure has the column.
pub fn svg(plot: &Plot, title: &str, rows: &[Row]) -> Option<String> {
    let is_drawn = |row: &&Row| plot.figures.iter().all(|word| row.figure.contains(word));
    let drawn: Vec<&Row> = rows.iter().filter(is_drawn).collect();
    let start = plot.column.strip_suffix('*');
    let points: Vec<Point> = match start {
        Some(start) => (0..)
            .zip(&drawn)
            .flat_map(|(series, row)| curve(row, start, series, &label(plot, row)))
            .collect(),
        None => drawn
            .iter()
            .filter_map(|row| point(row, &plot.column, label(plot, row)))
            .collect(),
    };
    let scatter = Scatter {
        title: title.to_owned(),
        x_title: plot.x.clone(),
        y_title: plot.y.clone(),
        points,
        is_joined: start.is_some(),
        least: None,
    };
    (!scatter.points.is_empty()).then(|| scatter.svg())
}

/// Returns the name of a figure without the words that select the figures of the plot.
fn label(plot: &Plot, row: &Row) -> String {
    let shared = plot.figures.iter();
    let own = shared.fold(row.figure.clone(), |name, word| name.replacen(word, "", 1));
    match own.trim_matches([' ', ',']) {
        "" => row.figure.clone(),
        own => own.to_owned(),
    }
}

/// Returns the point of a figure, x from the column and y from the value; `None` when either is missing.
fn point(row: &Row, column: &str, name: String) -> Option<Point> {
    Some(Point {
        name,
        x: row.columns.get(column).copied()??,
        y: row.value?,
        wrong: 0,
        series: 0,
    })
}

/// Returns the curve of a figure: a point for each column with the prefix `start`; only the last point has a label.
fn curve(row: &Row, start: &str, series: usize, label: &str) -> Vec<Point> {
    let columns = row.columns.iter().filter_map(|(key, y)| {
        let x = key.strip_prefix(start)?.parse::<f64>().ok()?;
        Some((x, (*y)?))
    });
    let mut places: Vec<(f64, f64)> = columns.collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let last = places.len().saturating_sub(1);
    let name = |at: usize| match at == last {
        true => label.to_owned(),
        false => String::new(),
    };
    let point = |(at, (x, y))| Point {
        name: name(at),
        x,
        y,
        wrong: 0,
        series,
    };
    places.into_iter().enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn row(figure: &str, columns: [(&str, f64); 3]) -> Row {
        Row {
            figure: figure.to_owned(),
            n: 1,
            value: Some(2.0),
            unit: String::new(),
            bar: None,
            columns: columns.map(|(key, y)| (key.to_owned(), Some(y))).into(),
        }
    }

    fn plot(column: &str) -> Plot {
        Plot {
            figures: vec!["any hit".to_owned()],
            column: column.to_owned(),
            x: "elements".to_owned(),
            y: "time, ns".to_owned(),
        }
    }

    #[test]
    fn a_curve_has_a_point_per_column_and_one_label() {
        let columns = [("ns_at_10", 50.0), ("ns_at_100", 60.0), ("bytes", 7.0)];
        let rows = [row("jog, any hit", columns), row("jog, clearance", columns)];
        let svg = svg(&plot("ns_at_*"), "growth", &rows).unwrap();
        assert_eq!(svg.matches("<circle").count(), 2);
        assert_eq!(svg.matches("stroke-dasharray").count(), 1);
        assert!(svg.contains(">jog<") && !svg.contains("clearance"), "{svg}");
    }

    #[test]
    fn a_point_has_the_column_as_its_place() {
        let columns = [("seconds", 0.1), ("max", 3.0), ("bias", 0.0)];
        let rows = [row("any hit", columns), row("any hit twice", columns)];
        let drawn = svg(&plot("seconds"), "speed", &rows).unwrap();
        assert_eq!(drawn.matches("<circle").count(), 2);
        assert!(!drawn.contains("stroke-dasharray") && drawn.contains(">twice<"));
        assert_eq!(svg(&plot("minutes"), "speed", &rows), None);
    }
}
