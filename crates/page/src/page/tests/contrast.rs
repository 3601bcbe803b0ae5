//! Tests of the contrast of every text with its background, by the formula of WCAG 2.2, clause 1.4.3.

use super::super::LOOK;

/// Colour of a text, and its backgrounds.
const PAIRS: [(&str, &[&str]); 4] = [
    ("text", &["ground", "panel"]),
    ("soft", &["ground", "panel"]),
    ("bad", &["bad-ground", "ground", "panel"]),
    ("warn", &["warn-ground"]),
];

fn colour(theme: &str, name: &str) -> [f64; 3] {
    let block = LOOK.split(theme).nth(1).unwrap().split('}').next().unwrap();
    let hex = block.split(&format!("--{name}: #")).nth(1).unwrap();
    [0, 2, 4].map(|at| f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0)
}

fn luminance(colour: [f64; 3]) -> f64 {
    let linear = |it: f64| match it <= 0.04045 {
        true => it / 12.92,
        false => ((it + 0.055) / 1.055).powf(2.4),
    };
    let [red, green, blue] = colour.map(linear);
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[test]
fn every_text_has_contrast_4_5_in_both_themes() {
    for theme in [":root {", "[data-theme=\"dark\"] {"] {
        for (text, grounds) in PAIRS {
            for ground in grounds {
                let (a, b) = (
                    luminance(colour(theme, text)),
                    luminance(colour(theme, ground)),
                );
                let contrast = (a.max(b) + 0.05) / (a.min(b) + 0.05);
                assert!(contrast >= 4.5, "{theme} {text} on {ground}: {contrast:.2}");
            }
        }
    }
}
