//! A plot of curves as SVG, both axes linear. Lengths are px.

use super::figure::shown;
use history::report::svg::Svg;
use std::fmt::Write;

/// Content of the plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curves {
    /// Title above the plot.
    pub title: String,
    /// Title of the x axis.
    pub x_title: String,
    /// Title of the y axis.
    pub y_title: String,
    /// Curves with their names, in the order of the key.
    pub series: Vec<(String, Vec<[f64; 2]>)>,
}

const LEFT: f64 = 72.0;
const TOP: f64 = 44.0;
const WIDE: f64 = 640.0;
const HIGH: f64 = 340.0;
/// Width of the key, px.
const KEY: f64 = 200.0;
const BELOW: f64 = 52.0;
/// Approximate number of grid lines along an axis.
const GRID: f64 = 6.0;
const COLOURS: [&str; 6] = [
    "#4a7ba6", "#c05621", "#2f855a", "#6b46c1", "#718096", "#b83280",
];

/// Ends of an axis and the distance of its grid lines.
struct Axis {
    low: f64,
    high: f64,
    step: f64,
}

impl Axis {
    /// Returns an axis around values; its ends are multiples of a step of 1, 2 or 5 times a power of ten.
    fn around(values: impl Iterator<Item = f64>) -> Self {
        let finite = values.filter(|it| it.is_finite());
        let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], it| {
            [low.min(it), high.max(it)]
        });
        let (low, high) = if low < high { (low, high) } else { (0.0, 1.0) };
        let rough = (high - low) / GRID;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|it| it * power);
        let step = step.into_iter().find(|it| *it >= rough).unwrap_or(power);
        Self {
            low: (low / step).floor() * step,
            high: (high / step).ceil() * step,
            step,
        }
    }

    fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    fn lines(&self) -> impl Iterator<Item = f64> {
        let count = ((self.high - self.low) / self.step).round() as i32;
        (0..=count).map(|line| {
            let value = self.low + f64::from(line) * self.step;
            (value / self.step).round() * self.step
        })
    }
}

impl Curves {
    /// Returns the plot as an SVG file.
    pub fn svg(&self) -> String {
        let points = || self.series.iter().flat_map(|(_, points)| points);
        let x = Axis::around(points().map(|it| it[0]));
        let y = Axis::around(points().map(|it| it[1]));
        let place = |[a, b]: [f64; 2]| [LEFT + WIDE * x.share(a), TOP + HIGH * (1.0 - y.share(b))];
        let mut svg = Svg::new([LEFT + WIDE + KEY, TOP + HIGH + BELOW]);
        self.grid(&mut svg, &x, &y, place);
        for (number, (name, points)) in self.series.iter().enumerate() {
            let colour = COLOURS[number % COLOURS.len()];
            let mut corners = String::new();
            for point in points
                .iter()
                .filter(|it| it.iter().all(|it| it.is_finite()))
            {
                let [a, b] = place(*point);
                let _ = write!(corners, "{a:.1},{b:.1} ");
            }
            svg.add(format_args!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>",
                corners.trim_end()
            ));
            let at = [LEFT + WIDE + 12.0, TOP + 16.0 + 18.0 * number as f64];
            svg.text(at, &format!("fill=\"{colour}\""), name);
        }
        svg.file(&self.title)
    }

    fn grid(&self, svg: &mut Svg, x: &Axis, y: &Axis, place: impl Fn([f64; 2]) -> [f64; 2]) {
        const PALE: &str = "stroke=\"#ddd\"";
        for value in x.lines() {
            let [a, b] = place([value, y.low]);
            svg.line([a, TOP], [a, b], PALE);
            svg.text([a, b + 16.0], "text-anchor=\"middle\"", &shown(value));
        }
        for value in y.lines() {
            let [a, b] = place([x.low, value]);
            svg.line([a, b], [a + WIDE, b], PALE);
            svg.text([a - 6.0, b + 4.0], "text-anchor=\"end\"", &shown(value));
        }
        let middle = LEFT + WIDE / 2.0;
        svg.text(
            [middle, TOP + HIGH + 40.0],
            "text-anchor=\"middle\"",
            &self.x_title,
        );
        svg.text([LEFT, TOP - 8.0], "text-anchor=\"middle\"", &self.y_title);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curves(points: Vec<[f64; 2]>) -> String {
        Curves {
            title: "error".into(),
            x_title: "s".into(),
            y_title: "K".into(),
            series: vec![("a < b".into(), points)],
        }
        .svg()
    }

    #[test]
    fn a_curve_runs_from_corner_to_corner() {
        let svg = curves(vec![[0.0, 0.0], [600.0, 0.5]]);
        assert!(svg.contains("points=\"72.0,384.0 712.0,44.0\""), "{svg}");
        assert!(svg.contains("a &lt; b") && svg.contains(">600<") && svg.contains(">0.30000<"));
    }

    #[test]
    fn a_curve_without_points_is_no_error() {
        let svg = curves(vec![[f64::NAN, 1.0]]);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
