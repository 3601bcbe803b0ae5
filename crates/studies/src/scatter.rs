//! Speed against error as SVG: a point per method, both axes logarithmic.
//!
//! Lengths in px. A point whose error is zero, or below the lowest line, stands on the bottom line, which
//! says so; a method with wrong verdicts is drawn hollow and says how many.

use super::chart::escaped;
use std::fmt::Write;

/// A method.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Beside the point.
    pub name: String,
    /// To the right, > 0.
    pub x: f64,
    /// Upwards, >= 0.
    pub y: f64,
    /// Wrong verdicts: the reader must not take a wrong answer for a fast one.
    pub wrong: u64,
    /// Number of the series: its colour; points of one series are joined.
    pub series: usize,
}

/// What to draw.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scatter {
    /// Above the plot.
    pub title: String,
    /// Below the axes.
    pub x_title: String,
    /// At the left.
    pub y_title: String,
    /// Methods.
    pub points: Vec<Point>,
}

const LEFT: f64 = 92.0;
const TOP: f64 = 52.0;
const WIDE: f64 = 700.0;
const HIGH: f64 = 380.0;
const RIGHT: f64 = 30.0;
const BELOW: f64 = 64.0;
/// Errors below this are drawn at the bottom, mm.
const LEAST: f64 = 1e-10;
const COLOURS: [&str; 5] = ["#4a7ba6", "#c05621", "#2f855a", "#6b46c1", "#718096"];
/// Least distance of two labels, px.
const LINE: f64 = 15.0;

impl Scatter {
    /// The file.
    pub fn svg(&self) -> String {
        let (width, height) = (LEFT + WIDE + RIGHT, TOP + HIGH + BELOW);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
             <text x=\"12\" y=\"24\" font-size=\"15\">{}</text>\n",
            escaped(&self.title)
        );
        let (xs, ys) = (self.x_axis(), self.y_axis());
        self.grid(&mut svg, &xs, &ys);
        self.joined(&mut svg, &xs, &ys);
        self.labelled(&mut svg, &xs, &ys);
        svg.push_str("</svg>\n");
        svg
    }

    fn x_axis(&self) -> Axis {
        let values = self.points.iter().map(|it| it.x);
        Axis::over(values, LEFT, LEFT + WIDE)
    }

    fn y_axis(&self) -> Axis {
        let values = self.points.iter().map(|it| it.y.max(LEAST));
        Axis::over(values.chain([LEAST]), TOP + HIGH, TOP)
    }

    fn grid(&self, svg: &mut String, xs: &Axis, ys: &Axis) {
        let (bottom, right) = (TOP + HIGH, LEFT + WIDE);
        for decade in xs.low..=xs.high {
            let x = xs.place(10f64.powi(decade));
            let _ = writeln!(
                svg,
                "<line x1=\"{x:.1}\" y1=\"{TOP}\" x2=\"{x:.1}\" y2=\"{bottom}\" stroke=\"#ddd\"/>\n\
                 <text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                bottom + 18.0,
                power(decade)
            );
        }
        for decade in ys.low..=ys.high {
            let y = ys.place(10f64.powi(decade));
            let text = if decade == ys.low {
                "less".to_owned()
            } else {
                power(decade)
            };
            let _ = writeln!(
                svg,
                "<line x1=\"{LEFT}\" y1=\"{y:.1}\" x2=\"{right}\" y2=\"{y:.1}\" stroke=\"#ddd\"/>\n\
                 <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                LEFT - 8.0,
                y + 4.0
            );
        }
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            LEFT + WIDE / 2.0,
            bottom + 46.0,
            escaped(&self.x_title),
            TOP + HIGH / 2.0,
            escaped(&self.y_title)
        );
    }

    fn joined(&self, svg: &mut String, xs: &Axis, ys: &Axis) {
        for (a, b) in self.points.iter().zip(self.points.iter().skip(1)) {
            if a.series == b.series {
                let _ = writeln!(
                    svg,
                    "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{}\" stroke-dasharray=\"3 3\"/>",
                    xs.place(a.x),
                    ys.place(a.y.max(LEAST)),
                    xs.place(b.x),
                    ys.place(b.y.max(LEAST)),
                    colour(a)
                );
            }
        }
    }

    fn labelled(&self, svg: &mut String, xs: &Axis, ys: &Axis) {
        let mut taken: Vec<(f64, f64)> = Vec::new();
        for point in &self.points {
            let (x, y) = (xs.place(point.x), ys.place(point.y.max(LEAST)));
            let fill = if point.wrong == 0 {
                colour(point)
            } else {
                "#fff"
            };
            let mut line = y - 8.0;
            while taken
                .iter()
                .any(|(tx, ty)| (tx - x).abs() < 220.0 && (ty - line).abs() < LINE)
            {
                line -= LINE;
            }
            taken.push((x, line));
            // Towards the middle, so that no label leaves the plot.
            let (anchor, aside) = if x > LEFT + 0.7 * WIDE {
                ("end", -6.0)
            } else {
                ("start", 6.0)
            };
            let wrong = match point.wrong {
                0 => String::new(),
                1 => ", 1 wrong".to_owned(),
                some => format!(", {some} wrong"),
            };
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"{fill}\" stroke=\"{}\" stroke-width=\"2\"/>\n\
                 <text x=\"{:.1}\" y=\"{line:.1}\" text-anchor=\"{anchor}\">{}{wrong}</text>",
                colour(point),
                x + aside,
                escaped(&point.name)
            );
        }
    }
}

/// Whole decades between two places.
struct Axis {
    low: i32,
    high: i32,
    from: f64,
    to: f64,
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Axis {
        let known = values
            .filter(|it| *it > 0.0 && it.is_finite())
            .map(f64::log10);
        let (least, most) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), it| {
            (least.min(it), most.max(it))
        });
        let (least, most) = if least <= most {
            (least, most)
        } else {
            (0.0, 1.0)
        };
        let low = least.floor() as i32;
        Axis {
            low,
            high: (most.ceil() as i32).max(low + 1),
            from,
            to,
        }
    }

    fn place(&self, value: f64) -> f64 {
        let share = (value.log10() - f64::from(self.low)) / f64::from(self.high - self.low);
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }
}

fn colour(point: &Point) -> &'static str {
    COLOURS[point.series % COLOURS.len()]
}

/// `0.01`, `10`, and beyond that `1e-7`.
fn power(decade: i32) -> String {
    match decade {
        -3..=0 => format!("{:.*}", decade.unsigned_abs() as usize, 10f64.powi(decade)),
        1..=5 => format!("{:.0}", 10f64.powi(decade)),
        _ => format!("1e{decade}"),
    }
}
