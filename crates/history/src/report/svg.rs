//! Builds a picture as SVG text. Lengths are in px of the SVG's view box; `style` holds further attributes of an
//! element.

use std::fmt::Write;

/// A picture under construction.
pub struct Svg {
    text: String,
    size: [f64; 2],
}

impl Svg {
    /// Makes an empty picture of this width and height.
    pub fn new(size: [f64; 2]) -> Self {
        let text = String::new();
        Self { text, size }
    }

    /// Adds an element.
    pub fn add(&mut self, element: std::fmt::Arguments<'_>) {
        writeln!(self.text, "{element}").expect("a String takes every text");
    }

    /// Adds a line.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], style: &str) {
        self.add(format_args!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>"
        ));
    }

    /// Adds a text; characters that have a meaning in XML are escaped.
    pub fn text(&mut self, [x, y]: [f64; 2], style: &str, text: &str) {
        let text = escaped(text);
        self.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" {style}>{text}</text>"
        ));
    }

    /// Adds a filled rectangle.
    pub fn rect(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], fill: &str) {
        self.add(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{fill}\"/>"
        ));
    }

    /// Adds a circle.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: &str) {
        self.add(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" {style}/>"
        ));
    }

    /// Returns the picture without a size of its own, for a page that sets the size.
    pub fn inline(self) -> String {
        let Self { text, size } = self;
        let [width, height] = size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"sans-serif\" font-size=\"11\" role=\"img\">\n{text}</svg>"
        )
    }

    /// Returns the picture as an SVG file, on white, under a title.
    pub fn file(self, title: &str) -> String {
        let Self { text, size } = self;
        let ([width, height], title) = (size, escaped(title));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
             <text x=\"12\" y=\"22\" font-size=\"15\">{title}</text>\n{text}</svg>\n"
        )
    }
}

/// Returns an upper bound for the width of a text in a file of [`Svg::file`], px; the width differs with the viewer's
/// font.
pub fn text_width(text: &str) -> f64 {
    const LETTER: f64 = 7.8;
    text.chars().count() as f64 * LETTER
}

/// Escapes the characters that have a meaning in XML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
