//! A scatter plot of points and curves as SVG, both axes logarithmic.
//!
//! Lengths are px. A point whose value lies below the lowest grid line appears on that line. A point of a method that
//! gives wrong verdicts is hollow, and its label states their number.

use history::report::svg::{Svg, text_width};

/// A point of the plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Label beside the point; empty for none.
    pub name: String,
    /// Value along the x axis, above 0.
    pub x: f64,
    /// Value along the y axis, 0 or more.
    pub y: f64,
    /// Number of wrong verdicts; a point with any is hollow, so that speed does not hide wrong answers.
    pub wrong: u64,
    /// Number of the series; it selects the colour.
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
    /// Whether a line joins consecutive points of one series.
    pub is_joined: bool,
    /// Value of the lowest grid line, labelled `less`; `None` derives it from the points.
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
/// Height of a label, px.
const LINE: f64 = 15.0;
/// Distance from the bottom of a label to its baseline, px.
const DESCENT: f64 = 3.0;
/// Radius of a point, px.
const RADIUS: f64 = 5.0;

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
        let at = |it: &Point| [xs.place(it.x), ys.place(it.y)];
        let mut taken: Vec<Area> = self.points.iter().map(|it| Area::around(at(it))).collect();
        for point in &self.points {
            let centre = at(point);
            let stroke = colour(point);
            let fill = if point.wrong == 0 { stroke } else { "#fff" };
            let style = format!("fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"2\"");
            svg.circle(centre, RADIUS, &style);
            if point.name.is_empty() {
                continue;
            }
            let text = match point.wrong {
                0 => point.name.clone(),
                some => format!("{}, {some} wrong", point.name),
            };
            let area = Area::beside(centre, text_width(&text), &taken);
            let is_right = area.left > centre[0];
            let (anchor, x) = match is_right {
                true => ("start", area.left),
                false => ("end", area.right),
            };
            let style = format!("text-anchor=\"{anchor}\"");
            svg.text([x, area.bottom - DESCENT], &style, &text);
            taken.push(area);
        }
    }
}

/// A rectangle that a point or a label already covers.
#[derive(Debug, Clone, Copy)]
struct Area {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Area {
    fn around([x, y]: [f64; 2]) -> Self {
        let reach = RADIUS + 1.0;
        let ([left, right], [top, bottom]) = ([x - reach, x + reach], [y - reach, y + reach]);
        Self {
            left,
            top,
            right,
            bottom,
        }
    }

    /// Returns the area for a label of this width beside its point: the free area inside the plot nearest to the height
    /// of the point; at equal distance the right side comes first. Without a free area the label goes above its point.
    fn beside([x, y]: [f64; 2], width: f64, taken: &[Self]) -> Self {
        let label = |step: f64, left: f64| {
            let top = y - LINE / 2.0 + step * LINE / 2.0;
            Self {
                left,
                top,
                right: left + width,
                bottom: top + LINE,
            }
        };
        let steps = (0..60).flat_map(|step| [-f64::from(step), f64::from(step)]);
        let aside = RADIUS + 4.0;
        let places = steps.flat_map(|step| [(step, x + aside), (step, x - aside - width)]);
        let mut free = places
            .map(|(step, left)| label(step, left))
            .filter(|it| it.is_in_plot() && !taken.iter().any(|other| it.covers(other)));
        free.next().unwrap_or_else(|| label(-2.0, x + aside))
    }

    fn is_in_plot(&self) -> bool {
        self.left >= LEFT && self.right <= LEFT + WIDE + RIGHT && self.is_in_height()
    }

    fn is_in_height(&self) -> bool {
        self.top >= TOP - LINE && self.bottom <= TOP + HIGH
    }

    fn covers(&self, other: &Self) -> bool {
        let wide = self.left < other.right && other.left < self.right;
        wide && self.top < other.bottom && other.top < self.bottom
    }
}

/// A logarithmic axis over whole decades, between two px coordinates.
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

/// Returns the label of a decade: `0.01` or `10`, but `1e-7` below 0.001 and above 100000.
fn power(decade: i32) -> String {
    match decade {
        -3..=0 => format!("{:.*}", decade.unsigned_abs() as usize, 10f64.powi(decade)),
        1..=5 => format!("{:.0}", 10f64.powi(decade)),
        _ => format!("1e{decade}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_cover_neither_points_nor_each_other() {
        let centres = (0..24u8).map(|it| [LEFT + WIDE - f64::from(it) * 9.0, TOP + f64::from(it)]);
        let mut taken: Vec<Area> = centres.clone().map(Area::around).collect();
        for centre in centres {
            let area = Area::beside(centre, text_width("25 ms, scans 1"), &taken);
            assert!(area.is_in_plot(), "{area:?}");
            assert!(!taken.iter().any(|it| area.covers(it)), "{area:?}");
            taken.push(area);
        }
    }
}
