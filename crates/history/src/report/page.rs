//! Frame of a printable page: A4, one style, head, foot, boxes to sign.

use super::Paper;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use texts::Lang;

/// Orientation of the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    /// Taller than wide.
    Portrait,
    /// Wider than tall.
    Landscape,
}

const STYLE: &str = include_str!("page.css");

/// Returns a complete HTML file, with SIMULATION across it for simulated parts.
pub(super) fn page(paper: &Paper, format: Format, title: &str, body: &Markup) -> String {
    let size = match format {
        Format::Portrait => "@page { size: A4 portrait; }",
        Format::Landscape => "@page { size: A4 landscape; }",
    };
    let class = match format {
        Format::Portrait => "portrait",
        Format::Landscape => "landscape",
    };
    let whole = html! {
        (DOCTYPE)
        html lang=(paper.language.tag()) {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(size)) }
            }
            body class=(class) {
                @if paper.simulated { p.simulation { (paper.language.text("simulation")) } }
                main { (body) }
                footer { (paper.made) }
            }
        }
    };
    whole.into_string()
}

/// Returns title and subtitle of a page.
pub(super) fn head(title: &str, about: &str) -> Markup {
    html! {
        header {
            h1 { (title) }
            p.about { (about) }
        }
    }
}

/// Returns pairs of name and text, laid out in two columns.
pub(super) fn facts(pairs: &[(&str, String)]) -> Markup {
    html! {
        dl.facts {
            @for (name, text) in pairs {
                div { dt { (name) } dd { (text) } }
            }
        }
    }
}

/// Returns boxes in which people write name and date.
pub(super) fn sign_off(language: Lang) -> Markup {
    let roles = [
        language.text("paper-tested_by"),
        language.text("paper-checked"),
        language.text("paper-approved"),
    ];
    html! {
        table.sign {
            tr { @for role in roles { th { (role) } td {} } }
            tr { @for _ in roles { th { (language.text("paper-date")) } td {} } }
        }
    }
}
