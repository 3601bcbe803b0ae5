//! A drawing area with axes: converts values to places, draws ticks at round values, lines and marks. Lengths are in px
//! of the SVG's view box.

use super::svg::Svg;
use quality::ordered::round_step;

/// Margins on the four sides of the plot, px, for numbers and names.
const LEFT: f64 = 58.0;
const BELOW: f64 = 24.0;
const ABOVE: f64 = 10.0;
const RIGHT: f64 = 64.0;

/// Colours of a plot; they differ in lightness too, so that a grey print shows them apart.
pub(super) const LINE: &str = "#1f5f99";
pub(super) const LIMIT: &str = "#a11212";
pub(super) const QUIET: &str = "#8a97a5";
pub(super) const GRID: &str = "#e3e8ed";

/// A plot under construction.
pub(super) struct Plot {
    /// The drawing; the caller may add elements at places of its own.
    pub svg: Svg,
    width: f64,
    height: f64,
    x: [f64; 2],
    y: [f64; 2],
}

impl Plot {
    /// Makes an empty plot of `width` by `height` px over the ranges `x` and `y`; widens a range that is a single value
    /// by 0.5 on each side.
    pub fn new([width, height]: [f64; 2], x: [f64; 2], y: [f64; 2]) -> Self {
        let mut plot = Self {
            svg: Svg::new([width, height]),
            width,
            height,
            x: opened(x),
            y: opened(y),
        };
        plot.ticks();
        plot
    }

    /// Returns the place of a value on the x axis, px.
    pub fn at_x(&self, value: f64) -> f64 {
        LEFT + (self.width - LEFT - RIGHT) * (value - self.x[0]) / (self.x[1] - self.x[0])
    }

    /// Returns the place of a value on the y axis, px.
    pub fn at_y(&self, value: f64) -> f64 {
        let bottom = self.height - BELOW;
        bottom - (bottom - ABOVE) * (value - self.y[0]) / (self.y[1] - self.y[0])
    }

    /// Writes a text under the plot, centred at value `x`.
    pub fn under(&mut self, x: f64, text: &str) {
        let at = [self.at_x(x), self.height - 8.0];
        self.svg.text(at, "text-anchor=\"middle\"", text);
    }

    /// Draws a horizontal line at value `y`, with its name at the right.
    pub fn across(&mut self, y: f64, colour: &str, dashes: &str, name: &str) {
        let (at, end) = (self.at_y(y), self.width - RIGHT);
        let style = format!("stroke=\"{colour}\" stroke-dasharray=\"{dashes}\"");
        self.svg.line([LEFT, at], [end, at], &style);
        let style = format!("fill=\"{colour}\"");
        self.svg.text([end + 3.0, at + 4.0], &style, name);
    }

    /// Draws a vertical line at value `x`, with its name at the top.
    pub fn vertical_line(&mut self, x: f64, colour: &str, name: &str) {
        let (at, bottom) = (self.at_x(x), self.height - BELOW);
        let style = format!("stroke=\"{colour}\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\"");
        self.svg.line([at, ABOVE], [at, bottom], &style);
        let style = format!("fill=\"{colour}\"");
        self.svg.text([at + 3.0, ABOVE + 9.0], &style, name);
    }

    /// Draws a line through points; a value that is missing parts it.
    pub fn path(&mut self, points: impl Iterator<Item = (f64, Option<f64>)>, colour: &str) {
        let mut path = String::new();
        let mut joins = false;
        for (x, value) in points {
            if let Some(value) = value {
                let (x, y) = (self.at_x(x), self.at_y(value));
                path.push_str(&format!("{}{x:.1} {y:.1}", if joins { "L" } else { "M" }));
            }
            joins = value.is_some();
        }
        self.svg.add(format_args!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\"/>"
        ));
    }

    /// Returns the picture as SVG.
    pub fn finish(self) -> String {
        self.svg.inline()
    }

    /// Draws thin horizontal lines at round values of y, with their numbers, and the frame.
    fn ticks(&mut self) {
        let [low, high] = self.y;
        let step = round_step((high - low) / 5.0).unwrap_or(1.0);
        let (right, bottom) = (self.width - RIGHT, self.height - BELOW);
        let mut tick = (low / step).ceil();
        while tick * step <= high {
            let (value, at) = (tick * step, self.at_y(tick * step));
            let style = format!("stroke=\"{GRID}\"");
            self.svg.line([LEFT, at], [right, at], &style);
            let place = [LEFT - 4.0, at + 4.0];
            self.svg
                .text(place, "text-anchor=\"end\"", &ticked(value, step));
            tick += 1.0;
        }
        self.svg.add(format_args!(
            "<path d=\"M{LEFT} {ABOVE}V{bottom}H{right}\" fill=\"none\" stroke=\"{QUIET}\"/>"
        ));
    }
}

/// Formats a value with as many decimals as the step between two ticks needs.
pub(super) fn ticked(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    // Adding 0 turns -0 into 0.
    format!("{:.decimals$}", value + 0.0)
}

fn opened([low, high]: [f64; 2]) -> [f64; 2] {
    if high > low {
        [low, high]
    } else {
        [low - 0.5, high + 0.5]
    }
}
