//! Points and curves as SVG, both axes logarithmic.
//!
//! Lengths are px. A point below the lowest line lies on it. The point of a method with wrong verdicts is hollow, and its
//! label counts them.

use history::report::svg::Svg;

/// A point of the plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Label beside the point; empty for none.
    pub name: String,
    /// Value along the x axis, above 0.
    pub x: f64,
    /// Value along the y axis, 0 or more.
    pub y: f64,
    /// Number of wrong verdicts; above 0 the point is hollow, so that speed does not hide wrong answers.
    pub wrong: u64,
    /// Number of the series, which chooses the colour.
    pub series: usize,
}

/// Content of the plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scatter {
    /// Title above the plot.
    pub title: String,
    /// Title of the x axis.
    pub x_title: String,
    /// Title of the y axis.
    pub y_title: String,
    /// Points, in the order of their lines.
    pub points: Vec<Point>,
    /// Whether a line joins neighbours of one series.
    pub is_joined: bool,
    /// Value of the lowest line, labelled `less`; `None` lets the points choose it.
    pub least: Option<f64>,
}

const LEFT: f64 = 92.0;
const TOP: f64 = 52.0;
const WIDE: f64 = 700.0;
const HIGH: f64 = 380.0;
const RIGHT: f64 = 30.0;
const BELOW: f64 = 64.0;
const COLOURS: [&str; 6] = [
    "#4a7ba6", "#c05621", "#2f855a", "#6b46c1", "#718096", "#b83280",
];
/// Least distance of two labels, px.
const LINE: f64 = 15.0;

impl Scatter {
    /// Returns the plot as an SVG file.
    pub fn svg(&self) -> String {
        let mut svg = Svg::new([LEFT + WIDE + RIGHT, TOP + HIGH + BELOW]);
        let (xs, ys) = (self.x_axis(), self.y_axis());
        self.grid(&mut svg, &xs, &ys);
        if self.is_joined {
            self.joined(&mut svg, &xs, &ys);
        }
        self.labelled(&mut svg, &xs, &ys);
        svg.file(&self.title)
    }

    fn x_axis(&self) -> Axis {
        let values = self.points.iter().map(|it| it.x);
        Axis::over(values, LEFT, LEFT + WIDE)
    }

    fn y_axis(&self) -> Axis {
        let values = self.points.iter().map(|it| it.y);
        let least = self.least;
        let above = values.map(|it| least.map_or(it, |least| it.max(least)));
        Axis::over(above.chain(least), TOP + HIGH, TOP)
    }

    fn grid(&self, svg: &mut Svg, xs: &Axis, ys: &Axis) {
        let (bottom, right) = (TOP + HIGH, LEFT + WIDE);
        let (grey, middle) = ("stroke=\"#ddd\"", "text-anchor=\"middle\"");
        for decade in xs.low..=xs.high {
            let x = xs.place(10f64.powi(decade));
            svg.line([x, TOP], [x, bottom], grey);
            svg.text([x, bottom + 18.0], middle, &power(decade));
        }
        for decade in ys.low..=ys.high {
            let y = ys.place(10f64.powi(decade));
            let text = match (self.least, decade == ys.low) {
                (Some(_), true) => "less".to_owned(),
                (_, _) => power(decade),
            };
            svg.line([LEFT, y], [right, y], grey);
            svg.text([LEFT - 8.0, y + 4.0], "text-anchor=\"end\"", &text);
        }
        let below = [LEFT + WIDE / 2.0, bottom + 46.0];
        svg.text(below, middle, &self.x_title);
        let (turned, centre) = ("transform=\"rotate(-90)\"", -TOP - HIGH / 2.0);
        svg.text([centre, 20.0], &format!("{turned} {middle}"), &self.y_title);
    }

    fn joined(&self, svg: &mut Svg, xs: &Axis, ys: &Axis) {
        let at = |it: &Point| [xs.place(it.x), ys.place(it.y)];
        for (a, b) in self.points.iter().zip(self.points.iter().skip(1)) {
            if a.series == b.series {
                let style = format!("stroke=\"{}\" stroke-dasharray=\"3 3\"", colour(a));
                svg.line(at(a), at(b), &style);
            }
        }
    }

    fn labelled(&self, svg: &mut Svg, xs: &Axis, ys: &Axis) {
        let mut taken: Vec<(f64, f64)> = Vec::new();
        for point in &self.points {
            let (x, y) = (xs.place(point.x), ys.place(point.y));
            let fill = if point.wrong == 0 {
                colour(point)
            } else {
                "#fff"
            };
            let stroke = colour(point);
            let style = format!("fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"2\"");
            svg.circle([x, y], 5.0, &style);
            if point.name.is_empty() {
                continue;
            }
            let mut line = y - 8.0;
            while taken
                .iter()
                .any(|(tx, ty)| (tx - x).abs() < 220.0 && (ty - line).abs() < LINE)
            {
                line -= LINE;
            }
            taken.push((x, line));
            // The labels point towards the middle, so that none leaves the plot.
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
            let style = format!("text-anchor=\"{anchor}\"");
            svg.text([x + aside, line], &style, &format!("{}{wrong}", point.name));
        }
    }
}

/// A logarithmic axis of whole decades between two coordinates.
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

/// Returns the label of a decade: `0.01`, `10`, and `1e-7` below 0.001 or above 100000.
fn power(decade: i32) -> String {
    match decade {
        -3..=0 => format!("{:.*}", decade.unsigned_abs() as usize, 10f64.powi(decade)),
        1..=5 => format!("{:.0}", 10f64.powi(decade)),
        _ => format!("1e{decade}"),
    }
}
