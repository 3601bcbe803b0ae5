//! A bar chart as SVG: one horizontal bar per row, and a vertical line at each limit of the study.
//!
//! Lengths are px. Plain text and fixed colours make the file look the same in a page, in a viewer and on paper.

use super::figure::{Figure, shown};
use history::report::svg::{Svg, text_width};

/// Content of a chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Title above the chart.
    pub title: String,
    /// Unit behind every number.
    pub unit: &'static str,
    /// Value at the left end of the axis; above 0 on a logarithmic axis.
    pub from: f64,
    /// Whether the axis is logarithmic.
    pub is_logarithmic: bool,
    /// Values at which a vertical line crosses all bars, such as limits.
    pub marks: Vec<f64>,
    /// Label and value, from top to bottom; `None` draws no bar.
    pub bars: Vec<(String, Option<f64>)>,
}

/// Width of the column of labels, px; longer labels make it wider.
const LABEL: f64 = 300.0;
const PLOT: f64 = 480.0;
const NUMBER: f64 = 100.0;
const TOP: f64 = 44.0;
const ROW: f64 = 24.0;
/// Ratio of the greatest to the least value. Above it, the eye no longer tells short bars on a linear axis apart.
const WIDE_SPAN: f64 = 30.0;
/// Height of one line of the numbers below the axis, px.
const NUMBER_LINE: f64 = 15.0;

impl Chart {
    /// Creates a chart of labels and values; its axis starts at 0.
    pub fn new(
        title: impl Into<String>,
        unit: &'static str,
        marks: Vec<f64>,
        bars: impl IntoIterator<Item = (String, Option<f64>)>,
    ) -> Self {
        Self {
            title: title.into(),
            unit,
            from: 0.0,
            is_logarithmic: false,
            marks,
            bars: bars.into_iter().collect(),
        }
    }

    /// Creates a chart with a bar for each figure.
    pub fn of<'a>(
        title: impl Into<String>,
        unit: &'static str,
        marks: Vec<f64>,
        figures: impl IntoIterator<Item = &'a Figure>,
    ) -> Self {
        let bars = figures.into_iter().map(|it| (it.name.clone(), it.value));
        Self::new(title, unit, marks, bars)
    }

    /// Returns the chart with a logarithmic axis when its values and marks are positive and the greatest exceeds
    /// [`WIDE_SPAN`] times the least; otherwise returns it unchanged.
    pub fn with_axis_of_its_span(mut self) -> Self {
        let least = self.values().fold(f64::INFINITY, f64::min);
        let greatest = self.values().fold(0.0, f64::max);
        if least > 0.0 && greatest > WIDE_SPAN * least {
            self.from = 10.0_f64.powf(least.log10().floor());
            self.is_logarithmic = true;
        }
        self
    }

    /// Returns the finite values of bars and marks.
    fn values(&self) -> impl Iterator<Item = f64> {
        let bars = self.bars.iter().filter_map(|(_, value)| *value);
        let all = bars.chain(self.marks.iter().copied());
        all.filter(|it| it.is_finite())
    }

    /// Returns the value at the right end of the axis. On a logarithmic axis it is 1.1 times the greatest value or
    /// mark. On a linear one it lies beyond that by 2 % of the way from the left end.
    fn to(&self) -> f64 {
        let greatest = self.values().fold(self.from, f64::max);
        match greatest > self.from {
            true if self.is_logarithmic => 1.1 * greatest,
            true => greatest + 0.02 * (greatest - self.from),
            false => self.from + 1.0,
        }
    }

    /// Returns the x coordinate of the left end of the axis.
    fn left(&self) -> f64 {
        let labels = self.bars.iter().map(|(label, _)| text_width(label) + 16.0);
        labels.fold(LABEL, f64::max)
    }

    /// Returns the x coordinate of a value, clamped to the plot.
    fn x(&self, value: f64) -> f64 {
        let share = match self.is_logarithmic {
            true => (value / self.from).ln() / (self.to() / self.from).ln(),
            false => (value - self.from) / (self.to() - self.from),
        };
        self.left() + PLOT * share.clamp(0.0, 1.0)
    }

    /// Returns the chart as an SVG file.
    pub fn svg(&self) -> String {
        let (left, bottom) = (self.left(), TOP + ROW * self.bars.len() as f64);
        let ends = std::iter::once(&self.from).chain(&self.marks);
        let lines = self.number_lines(ends.copied());
        let last = lines.iter().map(|(_, line)| *line).max().unwrap_or(0);
        let below = 28.0 + f64::from(last) * NUMBER_LINE;
        let mut svg = Svg::new([left + PLOT + NUMBER, bottom + below]);
        for (place, (label, value)) in self.bars.iter().enumerate() {
            self.bar(&mut svg, TOP + ROW * place as f64, label, *value);
        }
        for mark in &self.marks {
            let x = self.x(*mark);
            let dashed = "stroke=\"#b00\" stroke-dasharray=\"4 3\"";
            svg.line([x, TOP], [x, bottom], dashed);
        }
        for (place, (value, line)) in lines.into_iter().enumerate() {
            let colour = if place == 0 { "" } else { "fill=\"#b00\" " };
            let style = format!("{colour}text-anchor=\"middle\"");
            let y = bottom + 16.0 + f64::from(line) * NUMBER_LINE;
            svg.text([self.x(value), y], &style, &shown(value));
        }
        svg.file(&self.title)
    }

    /// Assigns each value below the axis to a line of text, 0 for the highest, so that no two numbers overlap; returns
    /// the values with their lines.
    fn number_lines(&self, values: impl Iterator<Item = f64>) -> Vec<(f64, u32)> {
        let mut placed: Vec<(f64, u32)> = Vec::new();
        for value in values {
            let overlaps = |line: u32| {
                let reach = |it: f64| text_width(&shown(it)) / 2.0;
                placed.iter().any(|(other, on)| {
                    let apart = (self.x(*other) - self.x(value)).abs();
                    *on == line && apart < reach(*other) + reach(value)
                })
            };
            let free = (0..).find(|line| !overlaps(*line));
            placed.push((value, free.unwrap_or(0)));
        }
        placed
    }

    fn bar(&self, svg: &mut Svg, top: f64, label: &str, value: Option<f64>) {
        let line = top + 16.0;
        svg.text([self.left() - 8.0, line], "text-anchor=\"end\"", label);
        let Some(value) = value else { return };
        let end = self.x(value);
        svg.rect(
            [self.left(), top + 4.0],
            [end - self.left(), 16.0],
            "#4a7ba6",
        );
        let number = format!("{} {}", shown(value), self.unit);
        svg.text([end + 6.0, line], "", &number);
    }
}
