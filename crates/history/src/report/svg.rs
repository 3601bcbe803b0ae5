//! A drawing area with axes, round ticks, lines and marks. Lengths in px of the view box.

use quality::ordered::round_step;
use std::fmt::Write;

/// Margins of the plot, px.
const LEFT: f64 = 58.0;
const BELOW: f64 = 24.0;
const ABOVE: f64 = 10.0;
const RIGHT: f64 = 64.0;

/// Colours that differ in grey print, too.
pub(super) const LINE: &str = "#1f5f99";
pub(super) const LIMIT: &str = "#a11212";
pub(super) const QUIET: &str = "#8a97a5";
pub(super) const GRID: &str = "#e3e8ed";

/// A plot under construction.
pub(super) struct Plot {
    text: String,
    width: f64,
    height: f64,
    x: [f64; 2],
    y: [f64; 2],
}

impl Plot {
    /// Makes an empty plot of this size over these ranges; an empty range is widened to 1.
    pub fn new([width, height]: [f64; 2], x: [f64; 2], y: [f64; 2]) -> Self {
        let mut plot = Self {
            text: String::new(),
            width,
            height,
            x: opened(x),
            y: opened(y),
        };
        plot.ticks();
        plot
    }

    /// Returns the x coordinate of a value, px.
    pub fn at_x(&self, value: f64) -> f64 {
        LEFT + (self.width - LEFT - RIGHT) * (value - self.x[0]) / (self.x[1] - self.x[0])
    }

    /// Returns the y coordinate of a value, px.
    pub fn at_y(&self, value: f64) -> f64 {
        let bottom = self.height - BELOW;
        bottom - (bottom - ABOVE) * (value - self.y[0]) / (self.y[1] - self.y[0])
    }

    /// Adds an element.
    pub fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(element);
        self.text.push('\n');
    }

    /// Writes a text below the plot, centred at a value of x.
    pub fn under(&mut self, x: f64, text: &str) {
        let (x, y) = (self.at_x(x), self.height - 8.0);
        self.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>",
            escaped(text)
        ));
    }

    /// Draws a horizontal line at a value of y with its name at the right.
    pub fn across(&mut self, y: f64, colour: &str, dashes: &str, name: &str) {
        let (at, end) = (self.at_y(y), self.width - RIGHT);
        self.add(format_args!(
            "<line x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{end}\" y2=\"{at:.1}\" stroke=\"{colour}\" \
             stroke-dasharray=\"{dashes}\"/>\n<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{colour}\">{}</text>",
            end + 3.0,
            at + 4.0,
            escaped(name)
        ));
    }

    /// Draws a vertical line at a value of x with its name at the top.
    pub fn upright(&mut self, x: f64, colour: &str, name: &str) {
        let (at, bottom) = (self.at_x(x), self.height - BELOW);
        self.add(format_args!(
            "<line x1=\"{at:.1}\" y1=\"{ABOVE}\" x2=\"{at:.1}\" y2=\"{bottom}\" stroke=\"{colour}\" \
             stroke-width=\"1.5\" stroke-dasharray=\"5 3\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" fill=\"{colour}\">{}</text>",
            at + 3.0,
            ABOVE + 9.0,
            escaped(name)
        ));
    }

    /// Returns the SVG.
    pub fn finish(self) -> String {
        let Self {
            text,
            width,
            height,
            ..
        } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"sans-serif\" font-size=\"11\" role=\"img\">\n{text}</svg>"
        )
    }

    /// Draws the frame and thin lines at round values of y.
    fn ticks(&mut self) {
        let [low, high] = self.y;
        let step = round_step((high - low) / 5.0).unwrap_or(1.0);
        let mut tick = (low / step).ceil();
        while tick * step <= high {
            let (value, at) = (tick * step, self.at_y(tick * step));
            self.add(format_args!(
                "<line x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{}\" y2=\"{at:.1}\" stroke=\"{GRID}\"/>\n\
                 <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                self.width - RIGHT,
                LEFT - 4.0,
                at + 4.0,
                ticked(value, step)
            ));
            tick += 1.0;
        }
        let (right, bottom) = (self.width - RIGHT, self.height - BELOW);
        self.add(format_args!(
            "<path d=\"M{LEFT} {ABOVE}V{bottom}H{right}\" fill=\"none\" stroke=\"{QUIET}\"/>"
        ));
    }
}

/// Formats a value with as many decimals as the step needs.
pub(super) fn ticked(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    // Adding 0 turns a negative zero into 0.
    format!("{:.decimals$}", value + 0.0)
}

fn opened([low, high]: [f64; 2]) -> [f64; 2] {
    if high > low {
        [low, high]
    } else {
        [low - 0.5, high + 0.5]
    }
}

/// Escapes a text for SVG.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
